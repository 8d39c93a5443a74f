"""loam bench atlas of small specimens, killed once on its way: bench_atlas.py LOAM-BIN. A minute and a half on two cores."""
import json
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = ""


class BenchAtlas(unittest.TestCase):
    def test_every_effect_does_what_physics_says(self):
        with tempfile.TemporaryDirectory(prefix="loam atlas ") as folder:
            out = pathlib.Path(folder) / "out"
            command = [PROGRAM, "bench", "atlas", "--particles", "150", "--out", out, "--json"]
            first = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            until = time.monotonic() + 600
            while time.monotonic() < until and first.poll() is None and len(list(out.rglob("ensemble.h5"))) < 3:
                time.sleep(0.2)
            self.assertIsNone(first.poll(), "it was to be killed at work")
            first.kill()
            first.communicate()
            again = subprocess.run(command, capture_output=True, text=True, timeout=1500, check=False)
            self.assertEqual(again.returncode, 0, again.stderr)
            self.assertIn("of them made before", (out / "log.txt").read_text(encoding="utf-8"))
            self.assertGreater((out / "report.html").stat().st_size, 10_000)
            rows = {row["effect"]: row for row in json.loads(again.stdout)}
            self.assertLessEqual({"rotation", "rolling_resistance", "adhesion", "capillarity", "cementation", "hertzian_stiffness",
                                  "plastic_contact", "wall_friction", "apparatus_compliance", "seating", "density_error"}, set(rows))

            def largest(effect, channel, file):
                curves = [c for c in rows[effect]["curves"] if c["channel"] == channel and c["file"].startswith(file)]
                self.assertEqual(len(curves), 1, (effect, channel, file))
                return curves[0]["largest"]

            for effect in ("apparatus_compliance", "seating", "density_error", "rotation"):
                self.assertGreater(largest(effect, "axial_strain", "oedometer"), 0, effect)
            for effect in ("rolling_resistance", "capillarity", "cementation"):
                self.assertGreater(largest(effect, "deviatoric_stress", "triaxial_50"), 0, effect)
            for effect in ("density_error", "rotation"):  # looser, or free to roll: weaker, and it contracts more
                self.assertLess(largest(effect, "deviatoric_stress", "triaxial_200"), 0, effect)
                self.assertGreater(largest(effect, "volumetric_strain", "triaxial_200"), 0, effect)
            # Periodic triaxial cells have no wall.
            self.assertEqual(largest("wall_friction", "deviatoric_stress", "triaxial_200"), 0)
            self.assertGreater(largest("wall_friction", "shear_stress", "direct_shear"), 0)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
