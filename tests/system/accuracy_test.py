"""irsig accuracy: pictures, numbers and page of a small scene, and what is refused.

usage: accuracy_test.py <irsig executable>
"""
import csv
import html.parser
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

IRSIG = str(pathlib.Path(sys.argv[1]).resolve())

SWEEP = """
name = "small"
time = ["12:00Z"]
[model]
generate = "box"
triangles = 1200
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.8
[[part]]
name = "body"
match = ["*"]
material = "paint"
temperature_k = 320
[[season]]
name = "one"
date = 2025-06-21
[[season]]
name = "two"
date = 2025-12-21
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[[band]]
name = "mwir"
lambda_min_um = 3
lambda_max_um = 5
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 5000
[[viewpoints.aspect]]
azimuth_deg = 30
elevation_deg = 20
[surroundings]
kind = "none"
sky_temperature_k = 250
lower_radiance_w_m2_sr_um = 0
[air]
model = "vacuum"
[transport]
sun = false
max_reflections = 4
[output]
thumbnail_px = 0
"""


def accuracy(*arguments, exit_code=0):
    done = subprocess.run([IRSIG, "accuracy", *map(str, arguments)], capture_output=True, text=True, timeout=300)
    if done.returncode != exit_code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout if exit_code == 0 else done.stderr


class Page(html.parser.HTMLParser):
    """What a page asks for from outside, and what it holds."""

    def __init__(self):
        super().__init__()
        self.tags, self.outside = [], []

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.outside += [v for k, v in attributes if k in ("src", "href") and not v.startswith("#")]


class Accuracy(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)
        cls.sweep = cls.path / "small.toml"
        cls.sweep.write_text(SWEEP)
        cls.out = cls.path / "page"
        cls.printed = accuracy(cls.sweep, "--out", cls.out, "--seconds", 4)

    def test_files(self):
        self.assertEqual({p.name for p in self.out.iterdir()},
                         {"accuracy.csv", "accuracy.html", "accuracy.md", "accuracy-small-lwir.svg",
                          "accuracy-small-mwir.svg"})
        for svg in self.out.glob("*.svg"):
            text = svg.read_text()
            self.assertNotIn("nan", text)
            xml.etree.ElementTree.fromstring(text)

    def test_numbers(self):
        with open(self.out / "accuracy.csv", newline="") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual({r["band"] for r in rows}, {"lwir", "mwir"})
        self.assertEqual({r["season"] for r in rows}, {"one"}, "the first condition")
        self.assertEqual({r["group"] for r in rows}, {"methods", "reflections", "sharing", "tracing"})
        self.assertEqual(len({r["method"] for r in rows if r["group"] == "methods"}), 4)
        self.assertEqual(len({r["method"] for r in rows if r["group"] == "reflections"}), 5)
        for r in rows:
            for column in ("samples", "cpu_s", "relative_error_intensity", "relative_error_spectrum"):
                self.assertTrue(math.isfinite(float(r[column])) and float(r[column]) > 0, r)
            self.assertGreaterEqual(int(r["seeds"]), 2)
        for method in {r["method"] for r in rows if r["group"] != "reflections"}:
            errors = [float(r["relative_error_intensity"]) for r in rows
                      if r["method"] == method and r["band"] == "lwir"]
            self.assertLess(errors[-1], errors[0], method)
        # Without a reflection the 20 % that the box reflects of the sky are missing, and stay so.
        none = [float(r["relative_error_intensity"]) for r in rows
                if r["method"] == "0 reflections" and r["band"] == "lwir"]
        self.assertGreater(none[-1], 0.02)

    def test_page_is_self_contained(self):
        page = Page()
        text = (self.out / "accuracy.html").read_text()
        page.feed(text)
        self.assertEqual(page.outside, [])
        self.assertNotIn("script", page.tags)
        self.assertNotIn("link", page.tags)
        self.assertNotIn("url(http", text)
        self.assertEqual(page.tags.count("svg"), 2)
        self.assertGreaterEqual(page.tags.count("table"), 8)

    def test_tables_are_printed(self):
        self.assertIn("| ours, quasi-Monte Carlo |", self.printed)
        self.assertIn((self.out / "accuracy.md").read_text().splitlines()[0].lstrip("# "), self.printed)

    def test_one_row(self):
        out = self.path / "one"
        accuracy(self.sweep, "--out", out, "--seconds", 2, "--season", "two", "--band", "mwir", "--aspect", "90,10",
                 "--time", "2025-12-21T14:00:00+02:00")
        with open(out / "accuracy.csv", newline="") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual({(r["season"], r["band"], float(r["aspect_azimuth_deg"])) for r in rows},
                         {("two", "mwir", 90.0)})

    def test_what_is_refused(self):
        for arguments, what in ((("--season", "none"), "--season"), (("--band", "x"), "--band"),
                                (("--aspect", "400,0"), "--aspect"), (("--time", "noon"), "--time")):
            self.assertIn(what, accuracy(self.sweep, "--out", self.path / "x", *arguments, exit_code=2))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
