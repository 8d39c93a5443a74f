"""The program at its real entry: test_program.py LOAM-BIN. What it says, where it says it, its exit status."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = ""
SETS = pathlib.Path(__file__).resolve().parents[3] / "lab_data" / "sets"
SAND = SETS / "dobrany_sand"


def loam(*words, **options):
    return subprocess.run([PROGRAM, *map(str, words)], stdin=subprocess.DEVNULL, stdout=options.pop("stdout", subprocess.PIPE),
                          stderr=subprocess.PIPE, text=True, timeout=120, **options)


class ProgramTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="loam cli "))
        self.addCleanup(shutil.rmtree, self.folder)

    def file(self, name, text):
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        return path

    def sample(self, **changes):
        """A copy of the sand with some of its files replaced, None: removed."""
        copy = self.folder / "sand"
        shutil.copytree(SAND, copy)
        for name, text in changes.items():
            path = copy / name.replace("__", ".")
            path.unlink() if text is None else path.write_text(text, encoding="utf-8")
        return copy

    def refused(self, *words, says, status=2, **options):
        """The program refuses: that exit status, every text in `says` on standard error, nothing on standard output."""
        answer = loam(*words, **options)
        self.assertEqual(answer.returncode, status, answer.stderr)
        for text in [says] if isinstance(says, str) else says:
            self.assertIn(text, answer.stderr)
        self.assertEqual(answer.stdout or "", "")
        return answer


class Help(ProgramTest):
    def verbs(self):
        return re.findall(r"^  ([a-z]+) ", loam("--help").stdout.split("verbs:")[1], re.MULTILINE)

    def test_the_verbs_are_listed(self):
        self.assertLessEqual({"check", "simulate", "calibrate", "report", "effects", "test", "bench"}, set(self.verbs()))

    def test_each_verb_has_help_with_an_example(self):
        for verb in self.verbs():
            with self.subTest(verb=verb):
                answer = loam(verb, "--help")
                self.assertEqual((answer.returncode, answer.stderr), (0, ""))
                self.assertIn(f"Example: loam {verb}", answer.stdout)
                self.assertIn("Exit status:", answer.stdout)

    def test_the_common_options_are_there(self):
        text = loam("calibrate", "--help").stdout
        for option in ("--out DIR", "--seed N", "--jobs N", "--config FILE.toml", "--law NAME", "--rotation free|blocked",
                       "--effects NAME,...", "--set NAME=VALUE", "--particles N", "--runs N", "--quiet", "--json",
                       "--tests KIND,...", "--hold-out FILE,..."):
            self.assertIn(option, text)
        self.assertIn("SI", text)

    def test_version(self):
        self.assertRegex(loam("--version").stdout, r"^loam \d+\.\d+\.\d+\n$")


class WrongWords(ProgramTest):
    def test_no_verb(self):
        self.refused(says="a verb is missing")

    def test_unknown_verb(self):
        self.refused("calibrat", SAND, says="'calibrat' is not a verb; did you mean 'calibrate'?")

    def test_unknown_option(self):
        self.refused("calibrate", SAND, "--partciles", 300, says="'--partciles' is not an option of loam calibrate; did you mean '--particles'?")
        self.refused("calibrate", SAND, "--method", "inverse-kriging",
                     says="'--method' is not an option of loam calibrate; it is one of loam bulk, loam bench")
        self.refused("diagnose", SAND, "--twins=3", says="'--twins' is not an option of loam diagnose; it is one of loam bench")
        self.refused("check", SAND, "--seed=3", says="'--seed' is not an option of loam check")

    def test_one_word_too_many(self):
        self.refused("calibrate", SAND, "oedometer", says="'oedometer' is one word too many")

    def test_an_option_without_its_value(self):
        self.refused("calibrate", SAND, "--seed", says="--seed")

    def test_an_option_twice(self):
        self.refused("calibrate", SAND, "--seed", 1, "--seed", 2, says="--seed")

    def test_the_tests_are_the_launchers(self):
        self.refused("test", says="./loam test")


class WrongSettings(ProgramTest):
    def refused_run(self, *words, says):
        self.refused("calibrate", SAND, "--out", self.folder / "run", *words, says=says)
        self.assertFalse((self.folder / "run").exists())

    def test_options(self):
        for words, says in [(("--particles", "many"), "option '--particles': value 'many' must be an integer"),
                            (("--particles", "10"), "must be at least 100"),
                            (("--seed", "-1"), "option '--seed': value '-1' must be at least 0"),
                            (("--law", "linear-cohesion"), "did you mean 'linear-cohesive'?"),
                            (("--rotation", "locked"), "did you mean 'blocked'?"),
                            (("--effects", "creep"), "'creep' is not known here"),
                            (("--effects", "rolling_resistance"), "add --rotation free"),
                            (("--set", "rolling_friction=0.1"), "add --effects rolling_resistance"),
                            (("--tests", "oedometers"), "did you mean 'oedometer'?"),
                            (("--tests", "direct_shear"), "'direct_shear' is not among the tests of the sample"),
                            (("--hold-out", "oedometer_2.csv"), "did you mean 'oedometer_1.csv'?")]:
            with self.subTest(words=words):
                self.refused_run(*words, says=says)

    def test_options_that_contradict_each_other(self):
        for words, says in [(("--rotation", "blocked", "--effects", "rotation"), "'blocked' contradicts the effect rotation"),
                            (("--tests", "oedometer", "--hold-out", "triaxial_drained_50kPa.csv"), "is of kind triaxial, which is not among")]:
            with self.subTest(words=words):
                self.refused_run(*words, says=says)
        self.refused("bulk", SETS / "flanders_twin_125", "--tests", "triaxial", says="is not the kind of the data set")
        self.refused("crosstest", SETS / "twin_blocked", "--tests", "triaxial", says=["no direct_shear test to fit", "leave --tests out"])

    def test_each_set_takes_one_value(self):
        blocker = self.file("file", "x")
        self.refused("calibrate", "--set", "young_modulus=1e8", SAND, "--out", blocker, says=str(blocker))
        self.refused_run("--set", "young_modulus=1e8", "friction_angle=0.3", says="is one word too many")

    def test_a_flag_that_is_denied(self):
        self.refused("simulate", SAND, "--packing", self.file("none.csv", "x"), "--json=false", "--out", self.folder / "run", says="periodic cell")
        self.assertIn("\njson = false", (self.folder / "run" / "config.toml").read_text(encoding="utf-8"))
        # That run came to nothing, so its folder serves the next.
        self.refused("simulate", SAND, "--packing", self.file("other.csv", "y"), "--out", self.folder / "run", says="other.csv:1")

    def test_a_path_that_cannot_be(self):
        loop = self.folder / "loop"
        loop.symlink_to(loop)
        astray = self.folder / "astray"
        astray.symlink_to(self.folder / "nowhere")
        self.refused("calibrate", SAND, "--out", astray, says=["astray: cannot be written", "choose a folder"])
        for path, says in [("a" * 300, "File name too long"), (loop, "Too many levels of symbolic links")]:
            self.refused("calibrate", SAND, "--out", path, says=says)
            self.refused("report", path, says=says)

    def test_set(self):
        for text, says in [("young_modulus", "must be NAME=VALUE"), ("young_modulus=big", "must be a number"),
                           ("young_modulus=1,5e8", "write 1.5e8"), ("young_moduls=1e8", "did you mean 'young_modulus'?"),
                           ("friction_angle=30", "must lie in 0 to 1.56 rad; values are in SI, angles in rad")]:
            with self.subTest(text=text):
                self.refused_run("--set", text, says=["--set", says])

    def test_configuration(self):
        for text, says in [("seed = \n", "bad.toml:1:8: is not TOML"),
                           ("[engine]\ndampign = 0.3\n", "bad.toml:2:1: key 'dampign' is not a setting; did you mean 'damping'?"),
                           ("[engine]\ndamping = 2\n", "bad.toml:2:1: key 'engine.damping': value '2' must be at least 0 and below 1"),
                           ("a" + ".a" * 100_000 + " = 1\n", "bad.toml:1: has a key of more than 16 parts"),
                           ("[set]\nyoung_modulus = 1e8\n[priors.young_modulus]\nsd = 0.3\n", "bad.toml:3:9: key 'priors.young_modulus' contradicts"),
                           ("particles = '700'\n", "bad.toml:1:1: key 'particles': value ''700'' must be an integer")]:
            with self.subTest(text=text):
                bad = self.file("bad.toml", text)
                self.refused_run("--config", bad, says=says)
                self.refused_check(bad, says)

    def refused_check(self, path, says):
        answer = loam("check", path)
        self.assertEqual(answer.returncode, 2)
        self.assertIn(says, answer.stderr)

    def test_a_configuration_that_is_not_there(self):
        self.refused_run("--config", self.folder / "absent.toml", says="absent.toml")

    def test_a_missing_sample(self):
        self.refused("calibrate", says=["'sample' is missing", "loam calibrate lab_data/sets/dobrany_sand"])
        self.refused("calibrate", self.folder / "absent", says="absent")
        self.refused("simulate", self.folder, says=str(self.folder))

    def test_a_faulty_sample(self):
        curve = (SAND / "oedometer_1.csv").read_text(encoding="utf-8").splitlines()
        curve[2] = "abc," + curve[2].split(",", 1)[1]
        self.refused("calibrate", self.sample(oedometer_1__csv="\n".join(curve)), says=["oedometer_1.csv:3", "'abc'"])

    def test_an_out_folder_that_cannot_be(self):
        blocker = self.file("file", "x")
        for out in (blocker / "run", "/proc/loam/run"):
            with self.subTest(out=out):
                self.refused("calibrate", SAND, "--out", out, says=str(out))

    def test_an_out_folder_of_something_else(self):
        self.file("thesis.tex", "x")
        self.refused("calibrate", SAND, "--out", self.folder, says="not the folder of a run")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["thesis.tex"])

    def test_a_path_that_is_not_utf_8(self):
        self.refused("simulate", SAND, "--out", self.folder / os.fsdecode(b"caf\xe9"), says=["'--out'", "caf\\xe9' is not UTF-8"])
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_configuration_in_the_out_folder_is_not_overwritten(self):
        text = "# mine\nparticles = 300\n"
        own = self.file("config.toml", text)
        for words in (("--config", own), (), ("--packing", SAND / "sample.toml")):
            with self.subTest(words=words):
                self.refused("simulate", SAND, "--out", self.folder, *words, says="not the folder of a run")
                self.assertEqual(own.read_text(encoding="utf-8"), text)
        (self.folder / ".git").mkdir()
        self.refused("simulate", SAND, "--out", self.folder, says="not the folder of a run")
        self.assertEqual(own.read_text(encoding="utf-8"), text)


class Check(ProgramTest):
    def test_what_ships_is_sound(self):
        for sample in (path.parent for path in SETS.glob("*/*.toml")):
            with self.subTest(sample=sample.name):
                answer = loam("check", sample)
                self.assertEqual(answer.returncode, 0, answer.stderr)
                self.assertIn("sound", answer.stdout)

    def test_faults_are_told_with_file_line_and_remedy(self):
        description = (SAND / "sample.toml").read_text(encoding="utf-8")
        for changes, says in [({"sample__toml": description.replace("licence", "license")}, ["sample.toml:4", "'licence'"]),
                              ({"sample__toml": description + "= 3\n"}, ["sample.toml:"]),
                              ({"oedometer_1__csv": None}, ["oedometer_1.csv"]),
                              ({"oedometer_1__csv": ""}, ["oedometer_1.csv", "empty"]),
                              ({"oedometer_1__csv": "axial_stress_kPa,axial_strain\n10,0\n20,1,5\n"}, ["oedometer_1.csv:3"]),
                              ({"oedometer_1__csv": "axial_stress_bar,axial_strain\n1,0\n2,0.1\n"}, ["oedometer_1.csv:1", "axial_stress"])]:
            with self.subTest(changes=changes):
                sample = self.sample(**changes)
                answer = loam("check", sample)
                self.assertEqual(answer.returncode, 2)
                for text in says:
                    self.assertIn(text, answer.stderr)
                shutil.rmtree(sample)

    def test_nothing_there(self):
        self.refused("check", self.folder / "absent", says="absent")

    def test_a_configuration_and_its_sample(self):
        good = self.file("good.toml", f'particles = 500\nsample = "{SAND}"\n[set]\nfriction_angle = 0.5\n')
        answer = loam("check", good)
        self.assertEqual(answer.returncode, 0, answer.stderr)
        self.assertIn("4 parameters to fit, 1 held fixed", answer.stdout)
        self.assertIn("oedometer_1.csv", answer.stdout)

    def test_a_configuration_that_a_run_would_refuse(self):
        for text, says in [('hold_out = ["zz.csv"]', "is not a test of the sample"), ('hold_out = [""]', "bad.toml:2:1: key 'hold_out'"),
                           ('packing = "absent.csv"', "absent.csv"),
                           ('verb = "crosstest"', "has no direct_shear test"), ('tests = ["direct_shear"]', "is not among the tests")]:
            with self.subTest(text=text):
                answer = loam("check", self.file("bad.toml", f'sample = "{SAND}"\n{text}\n'))
                self.assertEqual(answer.returncode, 2, answer.stderr)
                self.assertIn(says, answer.stderr)

    def test_densities_that_one_soil_hardly_has(self):
        self.assertIn("initial void ratios span 0.524 (triaxial_drained_50kPa.csv) to 0.996 (oedometer_1.csv)", loam("check", SAND).stderr)

    def test_json(self):
        answer = loam("check", "--json", self.sample(oedometer_1__csv=None))
        report = json.loads(answer.stdout)
        self.assertEqual((answer.returncode, report["sound"], report["kind"]), (2, False, "sample"))
        self.assertTrue(report["errors"][0]["message"])
        self.assertTrue(json.loads(loam("check", "--json", SAND).stdout)["sound"])
        nothing = loam("check", "--json", self.folder / "absent")
        self.assertEqual((nothing.returncode, len(json.loads(nothing.stdout)["errors"])), (2, 1))


class Effects(ProgramTest):
    def test_each_parameter_declares_itself(self):
        law = json.loads(loam("effects", "--json").stdout)["laws"][0]
        self.assertEqual([p["name"] for p in law["parameters"]],
                         ["young_modulus", "stiffness_ratio", "friction_angle", "normal_cohesion", "shear_cohesion"])
        for parameter in law["parameters"]:
            for member in ("symbol", "unit", "meaning", "source"):
                self.assertTrue(parameter[member])
            self.assertLessEqual(parameter["lower"], parameter["prior"]["lower"])
            self.assertLess(parameter["prior"]["lower"], parameter["prior"]["upper"])
            self.assertLessEqual(parameter["prior"]["upper"], parameter["upper"])

    def test_the_text_names_them_too(self):
        text = loam("effects").stdout
        for word in ("linear-cohesive", "young_modulus", "Pa", "rad", "De Pue et al. 2019"):
            self.assertIn(word, text)


class Report(ProgramTest):
    def test_it_is_written_again(self):
        self.file("report.json", json.dumps({"verb": "calibrate", "name": "some sand"}))
        answer = loam("report", self.folder)
        self.assertEqual(answer.returncode, 0, answer.stderr)
        page = pathlib.Path(answer.stdout.strip())
        self.assertEqual(page, self.folder / "report.html")
        self.assertIn("some sand", page.read_text(encoding="utf-8"))

    def test_a_folder_without_a_finished_run(self):
        self.refused("report", self.folder, says="report.json")
        self.refused("report", self.folder / "absent", says="is not a folder")

    def test_a_document_that_is_none(self):
        for text in ("{", "[]", '{"verb": "calibrate"}'):
            with self.subTest(text=text):
                self.file("report.json", text)
                self.refused("report", self.folder, says="report.json")
                self.assertFalse((self.folder / "report.html").exists())


class Output(ProgramTest):
    def test_a_full_disk_behind_standard_output(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            self.refused("effects", stdout=full, says="standard output could not be written", status=1)

    def test_a_reader_that_has_gone(self):
        reading, writing = os.pipe()
        os.close(reading)
        with os.fdopen(writing, "w") as pipe:
            self.refused("effects", stdout=pipe, says="standard output could not be written", status=1)


class Bench(ProgramTest):
    def test_a_code_that_is_not_known_is_refused_with_those_that_are(self):
        self.refused("bench", "engine", "--against", "nonesuch", says=["--against", "'nonesuch'", "yade", "lammps"])
        self.refused("bench", "engine", "--against", "lamps", says="did you mean 'lammps'?")

    def test_other_codes_belong_to_the_engine(self):
        self.refused("bench", "rate", "--against", "yade", says=["--against", "loam bench engine"])

    def test_a_data_set_s_cost_is_told(self):
        small = self.file("small.toml", "particles = 100\nruns = 40\nconfirm = \"2\"\n[bulk]\nmending_rounds = 0\n")
        answer = loam("bench", "bulk", "--twins", "12", "--config", small, "--out", self.folder / "cost", "--json",
                      "--quiet")
        self.assertEqual(answer.returncode, 0, answer.stderr)
        rows = json.loads(answer.stdout)
        self.assertEqual([row["samples"] for row in rows], [12])
        self.assertGreater(rows[0]["calibrated"], 6)
        self.assertLess(rows[0]["training_seconds"], rows[0]["seconds"])
        self.assertGreater(rows[0]["peak_memory_MB"], 1)

    def test_codes_that_are_not_installed_are_named(self):
        answer = self.refused("bench", "engine", "--against", "yade,lammps", "--json", status=1, env={"PATH": str(self.folder)},
                              says=["yade is not installed", "lammps is not installed", "none of the codes"])
        self.assertIn("Debian package", answer.stderr)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
