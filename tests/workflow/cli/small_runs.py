"""What the tests of runs through the program share: a small calibration, its folder and its result."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import validate_result  # noqa: E402

# The program under test, handed over on the command line: test_NAME.py LOAM-BIN.
PROGRAM = sys.argv.pop(1)
SAND = pathlib.Path(__file__).resolve().parents[3] / "lab_data" / "sets" / "dobrany_sand"

# Soft, few particles, one parameter: some hundredths of a second a simulation.
SMALL = """
tests = ["oedometer"]
particles = 100
runs = 40
[set]
young_modulus = 3e7
stiffness_ratio = 0.4
normal_cohesion = 1e3
shear_cohesion = 1e3
[engine]
inertial_number = 5e-3
[calibration]
replicates = 2
confirmation_packings = 2
max_rounds = 1
runs_per_round = 2
posterior_draws = 200
"""


def without_times(result):
    return {name: value for name, value in result.items() if name != "seconds"}


class RunTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="loam runs "))
        self.addCleanup(shutil.rmtree, self.folder)
        self.settings = self.folder / "small.toml"
        self.settings.write_text(SMALL, encoding="utf-8")

    def start(self, verb, out, *words):
        return subprocess.Popen([PROGRAM, verb, SAND, "--config", self.settings, "--out", self.folder / out, *map(str, words)],
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def run_it(self, *words):
        process = self.start(*words)
        process.output, process.error = process.communicate(timeout=200)
        return process

    def result(self, out):
        text = (self.folder / out / "result.json").read_text(encoding="utf-8")
        self.assertEqual(validate_result.problems(text), [])
        return json.loads(text)

    def files(self, out):
        return {path.name for path in (self.folder / out).iterdir() if not path.name.startswith(".")}
