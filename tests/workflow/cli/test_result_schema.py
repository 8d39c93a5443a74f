"""The check of result.json finds what is wrong and passes what is right."""
import copy
import json
import os
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import validate_result  # noqa: E402

SOUND = {
    "verb": "calibrate", "name": "sand", "version": "0.1.0", "seed": 1, "seconds": 12.5, "dem_runs": 240, "dem_failed": 2,
    "warnings": [],
    "parameters": {"young_modulus": {"unit": "Pa", "estimate": 3e8, "q05": 1e8, "q50": 3e8, "q95": 9e8, "identified": True}},
    "tests": [{"kind": "oedometer", "file": "oedometer_1.csv", "channel": "axial_strain", "rmse": 4e-3, "unit": "1",
               "r": None, "points": 8, "held_out": False}],
    "model": {"law": "linear-cohesive", "rotation": "blocked", "effects": []},
}


def broken(path, value):
    """The sound result with one member replaced, or removed if the value is None."""
    result = copy.deepcopy(SOUND)
    place = result
    for step in path[:-1]:
        place = place[step]
    if value is None:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return result


class ResultSchema(unittest.TestCase):
    def test_a_sound_result_passes(self):
        self.assertEqual(validate_result.problems(json.dumps(SOUND)), [])

    def test_what_is_wrong_is_found(self):
        young = ("parameters", "young_modulus")
        for path, value in [(("verb",), "fit"), (("seed",), None), (("seed",), 1.5), (("dem_runs",), -1), (("warnings",), "none"),
                            (("parameters",), None), ((*young, "q05"), None), ((*young, "identified"), "yes"),
                            ((*young, "q05"), 5e8), (("tests", 0, "kind"), "shear"), (("tests", 0, "rmse"), -1e-3),
                            (("tests", 0, "points"), 0), (("tests", 0, "r"), 1.5), (("model", "rotation"), "fixed"),
                            (("model",), None)]:
            with self.subTest(path=path, value=value):
                self.assertNotEqual(validate_result.problems(json.dumps(broken(path, value))), [])

    def test_each_verb_needs_its_own_members(self):
        result = broken(("verb",), "simulate")
        self.assertTrue(any("curves" in problem for problem in validate_result.problems(json.dumps(result))))

    def test_what_is_not_json_is_found(self):
        self.assertNotEqual(validate_result.problems(json.dumps(broken(("seconds",), float("nan")))), [])
        self.assertNotEqual(validate_result.problems('{"verb": '), [])


if __name__ == "__main__":
    unittest.main()
