"""Small cross-tests through the program: test_crosstest.py LOAM-BIN. The sets of two kinds of test, and what hinders."""
import re
import subprocess
import unittest

import h5py
from small_runs import PROGRAM, SAND, RunTest, without_times

# A soil with one test of each kind that crosstest compares, of few readings; boxes and cells of few particles.
CROSSED = """
particles = 100
runs = 20
law = "linear-damped"
[set]
young_modulus = 2e7
[direct_shear]
box_diameters = 10
[engine]
inertial_number = 2e-3
haste = 3
[calibration]
replicates = 1
confirmation_packings = 1
max_rounds = 0
posterior_draws = 200
"""
CROSSED_SAMPLE = """name = "crossed"
source = "made for this test"
licence = "CC0-1.0"
measured = false
[soil]
grain_density_kg_m3 = 2600
[[test]]
kind = "triaxial"
file = "triaxial.csv"
cell_pressure_kPa = 100
initial_void_ratio = 0.72
[[test]]
kind = "direct_shear"
file = "shear.csv"
normal_stress_kPa = 100
initial_void_ratio = 0.85
box_length_mm = 60
box_height_mm = 40
"""
CROSSED_CURVES = {
    "triaxial.csv": "axial_strain,deviatoric_stress_kPa,volumetric_strain\n0,0,0\n0.005,60,0.002\n0.02,120,0.002\n0.05,150,-0.002\n",
    "shear.csv": "shear_displacement_mm,shear_stress_kPa,settlement_mm\n0,0,0\n0.3,30,0.03\n1,50,0.03\n3,60,-0.1\n",
}


class Crosstest(RunTest):
    def setUp(self):
        super().setUp()
        self.settings.write_text(CROSSED, encoding="utf-8")
        self.sample = self.folder / "crossed"
        self.sample.mkdir()
        (self.sample / "sample.toml").write_text(CROSSED_SAMPLE, encoding="utf-8")
        for file, text in CROSSED_CURVES.items():
            (self.sample / file).write_text(text, encoding="utf-8")

    def cross(self, out, *words, sample=None):
        return subprocess.run([PROGRAM, "crosstest", sample or self.sample, "--config", self.settings, "--out", self.folder / out, *words],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=200, check=False)

    def test_three_sets_on_every_test(self):
        run = self.cross("cross")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("one parameter set (p = ", run.stdout)
        result = self.result("cross")
        self.assertEqual(set(result["sets"]), {"triaxial", "direct_shear", "joint"})
        self.assertEqual({(e["set"], e["file"], e["channel"]) for e in result["errors"]},
                         {(s, f, c) for s in result["sets"] for f, c in
                          [("triaxial.csv", "deviatoric_stress"), ("triaxial.csv", "volumetric_strain"),
                           ("shear.csv", "shear_stress"), ("shear.csv", "settlement")]})
        self.assertEqual(result["verdict"]["agree"], result["verdict"]["p_value"] >= result["verdict"]["false_alarm_rate"])
        with h5py.File(self.folder / "cross" / "ensemble.h5") as ensemble:
            direct = [k for k, purpose in enumerate(ensemble["purpose"]) if purpose == b"confirmation"]
            self.assertEqual(len(direct), 3)
            self.assertEqual(len({ensemble["packing_seed"][k] for k in direct}), 1, "sets are compared on the same packings")
            self.assertNotIn(ensemble["packing_seed"][direct[0]],
                             [seed for k, seed in enumerate(ensemble["packing_seed"]) if k not in direct])
        again = self.cross("cross")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(without_times(self.result("cross")), without_times(result))

    def test_a_set_gets_rounds_of_its_own_until_direct_runs_agree(self):
        self.settings.write_text(CROSSED.replace("max_rounds = 0", "max_rounds = 3\nruns_per_round = 4"), encoding="utf-8")
        run = self.cross("rounds")
        self.assertEqual(run.returncode, 0, run.stderr)
        log = (self.folder / "rounds/log.txt").read_text(encoding="utf-8")
        directs = 0
        for name in ("triaxial", "direct shear"):
            made = re.findall(rf" {name}: (direct|added) runs: (\d+) runs", log)
            self.assertEqual(made[:2], [("added", "4"), ("direct", "1")], "a round before the first direct runs")
            checks = re.findall(rf" {name}: \d+ runs: direct runs differ from the emulator by (\S+) of .* by (\S+) standard deviations \(limit (\S+)\)", log)
            agree = [float(difference) <= 1 and float(shift) <= float(limit) for difference, shift, limit in checks]
            self.assertEqual(agree.count(True), agree[-1], "the first that agrees is the last")
            self.assertTrue(agree[-1] or len(made) > 2, log)
            directs += len(checks)
        with h5py.File(self.folder / "rounds/ensemble.h5") as ensemble:
            purpose, seed, index = (list(ensemble[key]) for key in ("purpose", "packing_seed", "index"))
        of_sets = {s for p, s, i in zip(purpose, seed, index) if p == b"confirmation" and (i - 3_000_000) // 10_000 >= 20}
        self.assertGreater(directs, 2, "a set that direct runs contradicted gets further rounds")
        self.assertFalse(of_sets & {s for p, s in zip(purpose, seed) if p != b"confirmation"})

    def test_what_cannot_be_crossed(self):
        run = self.cross("none", sample=SAND)
        self.assertEqual((run.returncode, run.stdout), (2, ""))
        self.assertIn("has no direct_shear test to fit", run.stderr)
        self.assertFalse((self.folder / "none").exists())
        settings = self.settings.read_text(encoding="utf-8")
        for before, after, says in [("box_diameters = 10", "box_diameters = 6", "must be at least 10"),
                                    ("[set]", "[triaxial]\nboundary = \"wall\"\n[set]", "did you mean 'walls'?")]:
            self.settings.write_text(settings.replace(before, after), encoding="utf-8")
            run = self.cross("none")
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertIn(says, run.stderr)
        packing = self.folder / "packing.csv"
        packing.write_text("# periodic cell x,y,z in m: 1,1,1\nx_m,y_m,z_m,radius_m\n0.5,0.5,0.5,0.1\n", encoding="utf-8")
        self.settings.write_text(settings, encoding="utf-8")
        run = subprocess.run([PROGRAM, "simulate", self.sample, "--config", self.settings, "--tests", "direct_shear", "--packing", packing,
                              "--out", self.folder / "none"], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("lies between walls", run.stderr)

    def test_a_box_of_a_wrong_size(self):
        toml = self.sample / "sample.toml"
        self.settings.write_text(CROSSED.replace("box_diameters = 10", ""), encoding="utf-8")
        check = [PROGRAM, "check", self.sample]
        toml.write_text(CROSSED_SAMPLE.replace("box_height_mm = 40", "box_width_mm = 600\nbox_height_mm = 100000"), encoding="utf-8")
        for run in (self.cross("high"), subprocess.run(check, capture_output=True, text=True, check=False)):
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertIn("sample.toml: key 'box_length_mm, box_width_mm, box_height_mm': value '60, 600, 100000'", run.stderr)
        self.assertFalse((self.folder / "high").exists())
        toml.write_text(CROSSED_SAMPLE.replace("box_height_mm = 40", "box_height_mm = 2.5"), encoding="utf-8")
        run = subprocess.run(check, capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("warning: shear.csv: the proportions of its box", run.stderr)
        self.assertRegex(run.stderr, r"make a specimen of 13\d\d\d\d particles, where 700 are asked for")
        toml.write_text(CROSSED_SAMPLE, encoding="utf-8")
        self.assertNotIn("box", subprocess.run(check, capture_output=True, text=True, check=False).stderr)

    def test_a_curve_without_readings_is_named_with_its_folder(self):
        head, *_ = CROSSED_CURVES["triaxial.csv"].splitlines()
        (self.sample / "triaxial.csv").write_text(f"{head}\n0,0,0\n0.6,60,0.002\n0.7,120,0.002\n", encoding="utf-8")
        for run in (self.cross("none"), subprocess.run([PROGRAM, "check", self.sample], capture_output=True, text=True, check=False)):
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertIn(f"{self.sample / 'triaxial.csv'}: has no reading at an axial strain between 0 and 0.5", run.stderr)

    def test_a_box_of_too_few_grains(self):
        toml = self.sample / "sample.toml"
        toml.write_text(CROSSED_SAMPLE.replace("[[test]]", 'grading = "grading.csv"\n[[test]]', 1), encoding="utf-8")
        (self.sample / "grading.csv").write_text("sieve_mm,passing_percent\n6,0\n10,50\n14,100\n", encoding="utf-8")
        self.settings.write_text(CROSSED.replace("[direct_shear]\nbox_diameters = 10\n", ""), encoding="utf-8")
        run = self.cross("coarse")
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("is less than ten particles", run.stderr)
        self.assertIn("set direct_shear.box_diameters", run.stderr)
        run = subprocess.run([PROGRAM, "check", self.sample], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("is less than ten particles", run.stderr)
        self.assertIn(f"{toml}: key 'box_length_mm': value '60'", run.stderr)


if __name__ == "__main__":
    unittest.main()
