"""loam diagnose as its user runs it, on twins of its own making: test_diagnose.py LOAM-BIN."""
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import validate_result  # noqa: E402

PROGRAM = ""

SAMPLE = """
name = "twin"
source = "made by this test"
licence = "CC0-1.0"
measured = false
[soil]
grain_density_kg_m3 = 2600
"""
TEST = """
[[test]]
kind = "oedometer"
file = "{}.csv"
initial_void_ratio = {}
seating_stress_kPa = 2
"""
TRIAXIAL = """
[[test]]
kind = "triaxial"
file = "triaxial.csv"
cell_pressure_kPa = 50
initial_void_ratio = 0.75
"""
STRESSES = [10, 20, 40, 80, 160, 320, 80, 20]
STRAINS = [0.002, 0.005, 0.01, 0.015, 0.02, 0.03]  # of the triaxial test
VOID_RATIOS = {"loose": 0.85, "middle": 0.80, "dense": 0.75}

# Soft, few particles, one parameter: some hundredths of a second a simulation.
SETTINGS = """
particles = 100
runs = 40
[set]
stiffness_ratio = 0.4
friction_angle = 0.4
normal_cohesion = 1e3
shear_cohesion = 1e3
[priors.young_modulus]
kind = "lognormal"
mean = 7.3
sd = 0.2
lower = 8e6
upper = 6e7
[engine]
inertial_number = 5e-3
[calibration]
replicates = 4
confirmation_packings = 3
max_rounds = 1
runs_per_round = 4
posterior_draws = 200
specimen_particles = 1200
[diagnosis]
packings = 12
fingerprint_packings = 4
leaders = 2
runs = 40
candidates = ["seating", "apparatus_compliance"]
"""


def write_sample(folder, strains, noise=None):
    folder.mkdir()
    (folder / "sample.toml").write_text(SAMPLE + "".join(TEST.format(n, VOID_RATIOS[n]) for n in strains), encoding="utf-8")
    for name, curve in strains.items():
        rows = ["axial_stress_kPa,axial_strain,phase"]
        for k, (stress, strain) in enumerate(zip(STRESSES, curve)):
            error = 1 + 0.01 * noise.gauss(0, 1) if noise else 1
            rows.append(f"{stress},{strain * error:.7f},{'loading' if k < 6 else 'unloading'}")
        (folder / f"{name}.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


def add_triaxial(folder, stress, volume, noise=None):
    """A triaxial test (kPa and strains) beside the oedometers of the sample."""
    with (folder / "sample.toml").open("a", encoding="utf-8") as file:
        file.write(TRIAXIAL)
    rows = ["axial_strain,deviatoric_stress_kPa,volumetric_strain"]
    for strain, *both in zip(STRAINS, stress, volume):
        rows.append(",".join([str(strain)] + [f"{v * (1 + 0.01 * noise.gauss(0, 1) if noise else 1):.7f}" for v in both]))
    (folder / "triaxial.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


class Diagnose(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="loam diagnose "))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        (cls.folder / "settings.toml").write_text(SETTINGS, encoding="utf-8")
        guess = [1e-3 * (k + 1) for k in range(8)]
        write_sample(cls.folder / "plan", {name: guess for name in VOID_RATIOS})
        write_sample(cls.folder / "plan-of-two-kinds", {"dense": guess})
        add_triaxial(cls.folder / "plan-of-two-kinds", [20, 40, 60, 70, 75, 80], [1e-3] * len(STRAINS))

    def run_it(self, verb, sample, out, *words):
        process = subprocess.run([PROGRAM, verb, self.folder / sample, "--config", self.folder / "settings.toml", "--out",
                                  self.folder / out, "--json", *map(str, words)],
                                 capture_output=True, text=True, timeout=280, check=False)
        return process

    def twin(self, name, *words, plan="plan"):
        """A soil of other packings and more particles, with the effect that the words say; 1 % of noise."""
        process = self.run_it("simulate", plan, f"made-{name}", "--seed", 91, "--particles", 400,
                              "--set", "young_modulus=2.2e7", *words)
        self.assertEqual(process.returncode, 0, process.stderr)
        curves = {(pathlib.Path(c["file"]).stem, c["channel"]): c["simulated"] for c in json.loads(process.stdout)["curves"]}
        noise = random.Random(4)
        write_sample(self.folder / name, {file: c for (file, channel), c in curves.items() if channel == "axial_strain"}, noise)
        if ("triaxial", "deviatoric_stress") in curves:
            add_triaxial(self.folder / name, [q / 1e3 for q in curves["triaxial", "deviatoric_stress"]],
                         curves["triaxial", "volumetric_strain"], noise)

    def diagnose(self, name, out, *words):
        process = self.run_it("diagnose", name, out, *words)
        self.assertEqual(process.returncode, 0, process.stderr)
        text = (self.folder / out / "result.json").read_text(encoding="utf-8")
        self.assertEqual(validate_result.problems(text), [])
        self.assertEqual(json.loads(process.stdout), json.loads(text))
        return json.loads(text)

    def test_a_strong_effect_is_named_and_closes_the_gap(self):
        self.twin("bedded", "--effects", "seating", "--set", "bedding_strain=0.015")
        result = self.diagnose("bedded", "out-bedded")
        self.assertEqual((result["verdict"], result["effects"]), ("named", ["seating"]), result["text"])
        self.assertEqual(result["extended_model"]["effects"], ["seating"])
        self.assertLess(result["gap_after"], 0.5 * result["gap_before"])
        self.assertEqual(result["sets"], [])  # of one kind of test
        low = max((r for r in result["regions"] if r["region"] == "low stress"), key=lambda r: abs(r["z"]))
        self.assertEqual(low["sign"], 1, low)
        strength = result["parameters"]["bedding_strain"]
        self.assertLess(abs(strength["estimate"] - 0.015), 0.003)
        files = {p.name for p in (self.folder / "out-bedded").iterdir() if not p.name.startswith(".")}
        self.assertLessEqual({"config.toml", "result.json", "report.html", "report.json", "ensemble.h5", "log.txt", "effects"}, files)
        # The same command again makes no run and ends with the same numbers.
        again = self.diagnose("bedded", "out-bedded")
        self.assertEqual({k: v for k, v in again.items() if k != "seconds"}, {k: v for k, v in result.items() if k != "seconds"})
        log = (self.folder / "out-bedded" / "log.txt").read_text(encoding="utf-8")
        self.assertIn("25 runs, 25 of them made before", log)
        self.assertIn("15 runs, 15 of them made before", log)

    def test_sets_of_two_kinds_of_test_are_compared_before_and_after(self):
        # A bedding error is the larger share of the triaxial test's smaller strains, which thus ask for a softer soil.
        self.twin("parted", "--effects", "seating", "--set", "bedding_strain=0.015", plan="plan-of-two-kinds")
        result = self.diagnose("parted", "out-parted")
        pair, = result["sets"]
        self.assertEqual(sorted(pair["kinds"]), ["oedometer", "triaxial"])
        self.assertLess(pair["before"]["p_value"], 0.001)
        modulus = {kind: pair["before"]["parameters"][kind]["young_modulus"] for kind in pair["kinds"]}
        self.assertLess(modulus["triaxial"], 0.8 * modulus["oedometer"])
        self.assertEqual((result["verdict"], result["effects"]), ("named", ["seating"]), result["text"])
        self.assertGreater(pair["after"]["p_value"], 0.01)

    def test_no_effect_is_none_and_says_what_would_have_shown(self):
        self.twin("plain")
        result = self.diagnose("plain", "out-plain")
        self.assertEqual((result["verdict"], result["effects"]), ("none", []), result["text"])
        self.assertGreater(result["p_value"], 0.005)
        self.assertIsNone(result["shrink"])
        self.assertIsNone(result["next_test"])
        for candidate in result["candidates"]:
            self.assertEqual(candidate["stage"], "fingerprint")
            self.assertGreater(candidate["detectable_strength"], 0)

    def test_one_curve_names_nothing(self):
        self.twin("short", "--effects", "seating", "--set", "bedding_strain=0.015")
        for name in ("middle", "dense"):
            (self.folder / "short" / f"{name}.csv").unlink()
        (self.folder / "short" / "sample.toml").write_text(SAMPLE + TEST.format("loose", 0.85), encoding="utf-8")
        result = self.diagnose("short", "out-short")
        self.assertNotEqual(result["verdict"], "named")
        self.assertIsNone(result["gap_before"])

    def test_a_model_that_has_the_effect_is_not_offered_it(self):
        self.twin("known", "--effects", "seating", "--set", "bedding_strain=0.015")
        result = self.diagnose("known", "out-known", "--effects", "seating")
        self.assertNotIn("seating", [c["effect"] for c in result["candidates"]])
        self.assertEqual(result["verdict"], "none", result["text"])

    def test_mistakes_are_the_users(self):
        wrong = self.folder / "wrong.toml"
        wrong.write_text('[diagnosis]\ncandidates = ["seatings"]\n', encoding="utf-8")
        process = subprocess.run([PROGRAM, "diagnose", self.folder / "plan", "--config", wrong, "--out", self.folder / "out-wrong"],
                                 capture_output=True, text=True, timeout=60, check=False)
        self.assertEqual(process.returncode, 2)
        self.assertIn("seating", process.stderr)
        process = self.run_it("diagnose", "plan", "out-fixed", "--set", "young_modulus=2e7")
        self.assertEqual(process.returncode, 2)
        self.assertIn("leaves nothing to fit", process.stderr)
        process = self.run_it("diagnose", "nowhere", "out-nowhere")
        self.assertEqual(process.returncode, 2)
        self.assertFalse((self.folder / "out-nowhere").exists())


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
