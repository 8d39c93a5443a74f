"""Bulk studies through the program: test_bulk.py LOAM-BIN. Dirty data sets, sampled confirmation, kills."""
import csv
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../report"))
import test_report  # noqa: E402
from small_runs import PROGRAM, RunTest  # noqa: E402

FLANDERS = pathlib.Path(__file__).resolve().parents[3] / "lab_data" / "sets" / "flanders_twin_125"
NAMES = [f"S{k:03}" for k in range(1, 11)]

# Few particles, one parameter: some hundredths of a second a simulation, and no good fits.
SMALL = """
particles = 100
runs = 24
[set]
young_modulus = 3e8
stiffness_ratio = 0.4
normal_cohesion = 1e3
shear_cohesion = 1e3
[engine]
inertial_number = 5e-3
[bulk]
confirmation_packings = 2
posterior_draws = 100
void_ratio = "off"
"""


# With the stiffness free, so few runs leave the emulator wrong about some samples.
HARDER = SMALL.replace("young_modulus = 3e8\n", "").replace("runs = 24", "runs = 40")


def without_times(result):
    return {name: value for name, value in result.items() if name not in ("seconds", "parts")}


class BulkTest(RunTest):
    def setUp(self):
        super().setUp()
        self.settings.write_text(SMALL, encoding="utf-8")
        self.set = self.folder / "set"
        (self.set / "curves").mkdir(parents=True)
        shutil.copy(FLANDERS / "dataset.toml", self.set)
        for name in NAMES:
            shutil.copy(FLANDERS / "curves" / f"{name}.csv", self.set / "curves")
        head, *rows = (FLANDERS / "samples.csv").read_text(encoding="utf-8").splitlines()
        self.rows = [head] + [row for row in rows if row.split(",")[0] in NAMES]
        self.write("\n".join(self.rows) + "\n")

    def write(self, text):
        (self.set / "samples.csv").write_bytes(text.encode("utf-8"))

    def start(self, out, *words):
        return subprocess.Popen([PROGRAM, "bulk", self.set, "--config", self.settings, "--out", self.folder / out, *words],
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def log(self, out):
        return (self.folder / out / "log.txt").read_text(encoding="utf-8")


class DirtyData(BulkTest):
    def test_what_cannot_be_read_stops_nothing_else(self):
        """Byte-order mark, semicolons, Windows line ends, an empty row, a word among numbers, a missing and an unreadable curve."""
        (self.set / "curves/S002.csv").unlink()
        (self.set / "curves/S003.csv").write_text("nonsense\n", encoding="utf-8")
        fields = self.rows[5].split(",")
        fields[self.rows[0].split(",").index("clay_kg_kg")] = "sandy"
        self.rows[5] = ",".join(fields)
        self.rows.insert(4, "")
        self.write("\ufeff" + "\r\n".join(row.replace(",", ";") for row in self.rows) + "\r\n")

        run = self.run_it("run", "--confirm", "3")
        self.assertEqual(run.returncode, 0, run.error)
        result = self.result("run")
        samples = {s["sample"]: s for s in result["samples"]}
        self.assertEqual(list(samples), NAMES)
        self.assertEqual({s["status"] for name, s in samples.items() if name not in ("S002", "S003")}, {"calibrated"})
        for name, reason in [("S002", "S002.csv' does not exist"), ("S003", "S003.csv:1: has a header but no readings")]:
            self.assertEqual(samples[name]["status"], "unreadable")
            self.assertIn(reason, samples[name]["reason"])
        self.assertTrue(any("samples.csv:7: column 'clay_kg_kg' is taken as labels" in w for w in result["warnings"]), result["warnings"])
        self.assertEqual((result["overall"]["calibrated"], result["overall"]["failed"]), (8, 2))

        # Three were confirmed, and they alone say whether they are followed.
        confirmed = [s for s in samples.values() if "followed" in s]
        self.assertEqual(len(confirmed), 3)
        self.assertEqual(result["overall"]["readings"], 3 * 8)
        with open(self.folder / "run/parameters.csv", encoding="utf-8", newline="") as file:
            table = list(csv.DictReader(file))
        self.assertEqual([row["sample"] for row in table], NAMES)
        self.assertEqual(float(table[0]["friction_angle_rad"]),
                         samples["S001"]["parameters"]["friction_angle"]["estimate"])
        page = json.loads((self.folder / "run/report.json").read_text(encoding="utf-8"))["bulk"]
        self.assertEqual(len(page["samples"]), len(NAMES))
        self.assertEqual(len(page["coverage"]), 8)
        self.assertNotIn("initial_void_ratio", {g["covariate"] for g in page["statistics"]["groupings"]})  # hardly repeats
        land_use = next(g for g in page["statistics"]["groupings"] if g["covariate"] == "land_use")
        self.assertEqual(sum(len(group["members"]) for group in land_use["groups"]), 8)

        source = (self.folder / "run/report.html").read_text(encoding="utf-8")
        shown, console = test_report.open_in_browser(source)
        self.assertEqual(console, [])
        self.assertEqual(shown.all("html")[0].get("data-report"), "complete")
        self.assertEqual((shown.count("data-chart-errors"), shown.count("data-charts-drawn")), (0, shown.count("data-charts-expected")))
        for text in ["Measured and simulated strain", "The samples that fit worst", "S003.csv:1: has a header", "Land use", "Rank correlations"]:
            self.assertIn(text, shown.text)

    def test_two_samples_of_one_name_are_refused(self):
        self.write("\n".join(self.rows + [self.rows[2]]) + "\n")
        run = self.run_it("run")
        self.assertEqual((run.returncode, run.output), (2, ""), run.error)
        self.assertIn("samples.csv:12: column 'sample': value 'S002' is there twice; give each sample a name", run.error)
        self.assertFalse((self.folder / "run").exists())

    def test_a_faulty_wish_to_confirm_is_refused(self):
        run = self.run_it("run", "--confirm", "some")
        self.assertEqual((run.returncode, run.output), (2, ""), run.error)
        self.assertIn("some", run.error)


class Mending(BulkTest):
    def test_samples_that_the_emulator_misled_are_fitted_and_confirmed_again(self):
        self.settings.write_text(HARDER + "mending_rounds = 0\n", encoding="utf-8")
        run = self.run_it("left")
        self.assertEqual(run.returncode, 0, run.error)
        left = self.result("left")
        self.assertEqual(left["overall"]["mended"], 0)
        self.assertFalse((self.folder / "left" / "fits-2.jsonl").exists())

        self.settings.write_text(HARDER + "mending_rounds = 1\n", encoding="utf-8")
        run = self.run_it("mended")
        self.assertEqual(run.returncode, 0, run.error)
        result = self.result("mended")
        lines = (self.folder / "mended" / "fits-2.jsonl").read_text(encoding="utf-8").splitlines()
        rows = {json.loads(line)["row"] for line in lines}
        self.assertEqual(result["overall"]["mended"], len(rows))
        self.assertGreater(len(rows), 0)
        # They alone are made again: 8 further runs and 2 on other packings for each.
        self.assertEqual(result["dem_runs"] - left["dem_runs"], 10 * len(rows))
        for row, (before, after) in enumerate(zip(left["samples"], result["samples"])):
            (self.assertNotEqual if row in rows else self.assertEqual)(before["rmse"], after["rmse"])

    def test_both_methods_stand_beside_each_other(self):
        self.settings.write_text(SMALL + "mending_rounds = 0\n", encoding="utf-8")  # mending adds runs
        self.assertEqual(self.run_it("run").returncode, 0)
        methods = self.result("run")["methods"]
        self.assertEqual(methods["samples"], 0, "24 runs are too few for kriging")
        self.settings.write_text(HARDER, encoding="utf-8")
        self.assertEqual(self.run_it("more").returncode, 0)
        methods = self.result("more")["methods"]
        self.assertGreater(methods["samples"], 0)
        self.assertGreater(methods["inverse-kriging"]["rmse"], 0)
        self.assertNotEqual(methods["inverse-kriging"]["rmse"], methods["emulator"]["rmse"])


class Kills(BulkTest):
    # LOAM_KILLS=20 makes more of them.
    KILLS = int(os.environ.get("LOAM_KILLS", "3"))

    def test_killed_it_ends_with_the_same_bits_and_repeats_nothing(self):
        self.settings.write_text(HARDER, encoding="utf-8")
        began = time.monotonic()
        whole = self.run_it("whole")
        self.assertEqual(whole.returncode, 0, whole.error)
        self.assertGreater(self.result("whole")["overall"]["mended"], 0, "kills are to meet mending, too")
        took = time.monotonic() - began
        moments, alive = random.Random(5), 0
        for _ in range(self.KILLS):
            process = self.start("killed", "--jobs", "1")
            time.sleep(moments.uniform(0.1, 0.5) * took * 3 / max(3, self.KILLS))
            alive += process.poll() is None
            process.kill()
            process.communicate(timeout=60)
        self.assertGreaterEqual(2 * alive, self.KILLS, "most kills must meet a run that is at work")
        last = self.run_it("killed")
        self.assertEqual(last.returncode, 0, last.error)
        self.assertEqual(without_times(self.result("killed")), without_times(self.result("whole")))
        table = "parameters.csv"
        self.assertEqual((self.folder / "killed" / table).read_bytes(), (self.folder / "whole" / table).read_bytes())
        again = self.run_it("killed")
        self.assertEqual(again.returncode, 0, again.error)
        log = self.log("killed")
        stages = re.findall(r": (\d+) runs, (\d+) of them made before", log[log.rindex("bulk"):])
        self.assertTrue(stages)
        for total, before in stages:
            self.assertEqual(total, before, log)

    def test_without_confirmation_nothing_is_said_of_errors(self):
        run = self.run_it("run", "--confirm", "none")
        self.assertEqual(run.returncode, 0, run.error)
        result = self.result("run")
        self.assertEqual((result["overall"]["calibrated"], result["overall"]["readings"]), (10, 0))
        self.assertNotIn("direct runs", self.log("run"))


if __name__ == "__main__":
    unittest.main()
