"""The report in headless Chromium: test_report.py RENDER_REPORT, where RENDER_REPORT turns a document into HTML.

Every test opens a page of its own and fails on any console message, any chart that is not drawn, any other request.
"""
import copy
import html.parser
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import fixture  # noqa: E402

RENDER = ""
SECTIONS = ["parameters", "tests", "posterior", "sensitivity", "emulator", "packing", "quasi_static", "settings"]


class Page(html.parser.HTMLParser):
    """What a test asks of a page: elements with attributes, and the text outside scripts and styles."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.elements, self.text, self.silent, self.groups = [], [], 0, []
        self.feed(text)
        self.text = re.sub(r"\s+", " ", " ".join(self.text))

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "g":
            self.groups.append(attributes.get("class", ""))
        self.elements.append((tag, {**attributes, "group": self.groups[-1] if self.groups else ""}))
        self.silent += tag in ("script", "style")

    def handle_endtag(self, tag):
        self.silent -= tag in ("script", "style")
        if tag == "g" and self.groups:
            self.groups.pop()

    def handle_data(self, data):
        if self.silent <= 0:
            self.text.append(data)

    def all(self, tag, **wanted):
        return [a for t, a in self.elements if t == tag and all(a.get(k) == v for k, v in wanted.items())]

    def count(self, name):
        return int(self.all("html")[0][name])


def render(document):
    made = subprocess.run([RENDER], input=json.dumps(document).encode(), capture_output=True, timeout=60, check=True)
    return made.stdout.decode()


def open_in_browser(source):
    """The page after its scripts have run, and the lines of its console."""
    chromium = shutil.which("chromium")
    if not chromium:
        raise AssertionError("the report is tested in Chromium, which is missing: apt-get install chromium")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "report.html")
        with open(path, "w", encoding="utf-8") as file:
            file.write(source)
        ran = subprocess.run(
            [chromium, "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
             "--disable-background-networking", "--disable-component-update", "--disable-sync",
             f"--user-data-dir={folder}/profile", "--window-size=1200,1000", "--enable-logging=stderr",
             "--virtual-time-budget=20000", "--dump-dom", f"file://{path}"],
            capture_output=True, timeout=120, check=False)
    if ran.returncode != 0 or b"<html" not in ran.stdout:
        raise AssertionError(f"chromium gave up with status {ran.returncode}: {ran.stderr.decode()[-800:]}")
    return Page(ran.stdout.decode()), re.findall(r"CONSOLE.*", ran.stderr.decode())


class ReportTest(unittest.TestCase):
    def opened(self, document, errors=0):
        page, console = open_in_browser(render(document))
        self.assertEqual(console, [], "the console must stay empty")
        self.assertEqual(page.all("html")[0].get("data-report"), "complete")
        self.assertEqual(page.count("data-chart-errors"), errors, re.findall(r'.{40}could not be drawn.{120}', page.text))
        if errors == 0:
            self.assertEqual(page.count("data-charts-drawn"), page.count("data-charts-expected"))
            self.assertEqual(len(page.all("svg", role="img")), page.count("data-charts-drawn"))
        return page

    def test_whole_report(self):
        document = fixture.document()
        source = render(document)
        self.assertLess(len(source.encode()), 1.5e6)
        page = self.opened(document)
        # 3 curves, 5 marginals, pairs, 2 maps and 5 pairs of curves, 4 of the emulator, the packing
        self.assertEqual(page.count("data-charts-drawn"), 3 + 5 + 1 + 2 + 5 + 4 + 1)
        self.assertEqual([s["id"] for s in page.all("section")], [name.replace("_", "-") for name in SECTIONS])
        for text in [document["verdict"], document["warnings"][0], "2.65 MPa", "0.513 rad (29.4°)", "0.452 to 0.568 rad",
                     "(25.9° to 32.5°)", "not identified", "fixed by the user", "7 min 12 s", "89 %", "held out",
                     'law = "linear-cohesive"', "measured, unloading", "729 particles at 1.20 MPa", "3 of 5"]:
            self.assertIn(text, page.text)

    def test_no_request_leaves_the_page(self):
        source = render(fixture.document(draws=50, runs=10, side=3))
        page = Page(source)
        policy = page.all("meta", **{"http-equiv": "Content-Security-Policy"})[0]["content"]
        self.assertTrue(policy.startswith("default-src 'none'"), policy)
        self.assertNotIn("http", policy)
        for tag, attributes in page.elements:
            self.assertNotIn(tag, ("link", "iframe", "object", "embed", "base"))
            self.assertFalse({"src", "href", "data", "action"} & set(attributes), (tag, attributes))
        self.assertNotRegex(source, r"@import|url\(\s*['\"]?http|sourceMappingURL")

    def test_numbers_stand_where_they_belong(self):
        """Strain grows downwards, stress to the right on a logarithmic axis; every reading is a point."""
        document = {"verb": "simulate", "name": "curve", "tests": [copy.deepcopy(fixture.document(side=2, draws=2, runs=2)["tests"][0])]}
        test = document["tests"][0]
        test.update({"x": [1e4, 1e5, 1e6], "phase": ["loading"] * 3, "measured": [0.0, 0.05, 0.1], "simulated": [0.0, 0.05, 0.08]})
        for key in ("band_lower", "band_upper", "residual", "residual_sd", "replicates"):
            del test[key]
        page, console = open_in_browser(render(document))
        self.assertEqual(console, [])
        places = [tuple(float(v) for v in re.findall(r"-?[\d.]+", a["transform"])) for t, a in page.elements
                  if t == "path" and "mark-symbol role-mark" in a["group"]]
        self.assertEqual(len(places), 6)
        curve, residual = places[:3], places[3:]
        self.assertLess(curve[0][1], curve[1][1])
        self.assertAlmostEqual(curve[1][1] - curve[0][1], curve[2][1] - curve[1][1], delta=0.01)
        self.assertAlmostEqual(curve[1][0] - curve[0][0], curve[2][0] - curve[1][0], delta=0.01)
        self.assertAlmostEqual(residual[0][1], residual[1][1], delta=0.01)
        self.assertLess(residual[2][1], residual[0][1], "a positive residual, measured above simulated, points up")
        self.assertIn("at most +2.0 % strain, at axial stress 1.00 MPa", page.text)

    def test_hostile_text_stays_text(self):
        hostile = "</script><img src=x onerror=\"console.error('run')\"> \u2028 \" ' & {{document}} {{style}} 𝛗 <!--<script>"
        document = fixture.document(draws=60, runs=12, side=3)

        def poison(value):
            if isinstance(value, dict):
                return {k: poison(v) for k, v in value.items()}
            if isinstance(value, list):
                return [poison(v) for v in value]
            return value + hostile if isinstance(value, str) else value

        keep = {"verb", "x_unit", "y_unit", "unit"}
        for key in list(document):
            if key not in keep:
                document[key] = poison(document[key])
        page = self.opened(document)
        self.assertEqual(page.all("img"), [])
        self.assertEqual(len(page.all("script")), 2)
        shown = re.sub(r"\s+", " ", hostile)
        self.assertIn(f"report-fixture{shown}", page.text)
        self.assertIn(re.sub(r"\s+", " ", document["warnings"][0]), page.text)

    def test_sections_are_optional(self):
        whole = fixture.document(draws=60, runs=12, side=3)
        head = {"verb": "simulate", "name": "parts"}
        page = self.opened(head)
        self.assertEqual(page.all("section"), [])
        self.assertEqual(page.count("data-charts-expected"), 0)
        for parts in (["parameters", "posterior", "packing"], ["sensitivity", "quasi_static"], ["tests", "emulator", "settings"]):
            page = self.opened({**head, **{key: whole[key] for key in parts}})
            self.assertEqual({s["id"].replace("-", "_") for s in page.all("section")}, set(parts))
        # A simulation: values without intervals, curves without bands.
        document = {**head, "parameters": [{k: p[k] for k in ("name", "symbol", "unit", "estimate")} for p in whole["parameters"]],
                    "tests": [{k: v for k, v in t.items() if not k.startswith(("band", "residual", "replicates"))} for t in whole["tests"]],
                    "packing": {k: whole["packing"][k] for k in ("x", "radius")}}
        page = self.opened(document)
        self.assertNotIn("Identified?", page.text)
        self.assertNotIn("credible band", page.text)

    def test_atlas(self):
        whole = fixture.document(draws=2, runs=2, side=2)
        keep = ("file", "channel", "x_name", "x_unit", "x_log", "y_unit", "x", "phase", "simulated", "band_lower", "band_upper")
        curves = [{**{k: t[k] for k in keep}, "band_name": "without it", "largest": size, "at": t["x"][1], "certain": size < 0}
                  for t, size in zip(whole["tests"], (-0.25, 0.004, 0.5))]
        row = {"meaning": "a moment against rolling", "rotation": "free", "curves": curves}
        page = self.opened({"verb": "bench atlas", "name": "signatures", "atlas": [
            {**row, "effect": "rolling_resistance", "strength": 0.25, "parameter": "rolling_friction", "unit": "1"},
            {**row, "effect": "rotation", "strength": None}]})
        self.assertEqual(page.count("data-charts-drawn"), 6)
        for text in ["rolling friction 0.25 ", "there or not", "−25 %", "+50 %", "without it", "A moment against rolling. Here:"]:
            self.assertIn(text, page.text)
        self.assertNotIn("credible band", page.text)
        self.assertNotRegex(page.text, r"\bNaN\b|\bundefined\b|\bnull\b")

    def test_missing_numbers_leave_gaps(self):
        rng = random.Random(5)

        def thin(value):
            if isinstance(value, list):
                return [thin(v) for v in value]
            if isinstance(value, dict):
                return {k: thin(v) for k, v in value.items()}
            number = isinstance(value, (int, float)) and not isinstance(value, bool)
            return None if number and rng.random() < 0.15 else value

        document = thin(fixture.document(draws=100, runs=20, side=3))
        page = self.opened(document)
        self.assertGreater(page.count("data-charts-drawn"), 15)
        self.assertNotRegex(page.text, r"\bNaN\b|\bundefined\b|\bInfinity\b|\bnull\b")

    def test_the_largest_draw_has_a_bar(self):
        # 24 bins of (high - low) / 24 end by rounding one bit below this largest value.
        low, high = 0.011346606661515104, 0.9891893963662334
        self.assertLess(low + 24 * ((high - low) / 24), high)
        document = fixture.document(draws=100, runs=20, side=3)
        for k, draw in enumerate(document["posterior"]["draws"]):
            draw[1] = low + (high - low) * k / 99
        document["posterior"]["draws"][-1][1] = high
        self.opened(document)

    def test_a_failing_chart_says_so(self):
        document = fixture.document(draws=20, runs=4, side=2)
        document["packing"] = {"x": [None, 3], "radius": [1], "cell": [1, 1, 1]}
        document["posterior"]["draws"] = [[None] * 5]
        page = self.opened(document, errors=7)  # the packing, five marginals, the pairs
        self.assertIn("could not be drawn", page.text)
        self.assertLess(page.count("data-charts-drawn"), page.count("data-charts-expected"))
        self.assertIn("Settings", page.text, "what follows is still shown")


if __name__ == "__main__":
    RENDER = sys.argv.pop(1)
    unittest.main(verbosity=2)
