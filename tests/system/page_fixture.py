"""The page of irsig serve in a real browser, for the tests of it: one server, a wide and a narrow page.

Their arguments: <irsig executable> <source folder> <folder for screenshots>
"""
import json
import pathlib
import re
import sys
import tempfile
import unittest
import urllib.parse

from browser import Browser
from serve_fixture import Server, irsig, small_sweep

IRSIG, SOURCE, SHOTS = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
WIDTHS = {"wide": (1280, 900, False), "narrow": (390, 844, True)}


def rows(*arguments):
    return json.loads(irsig(IRSIG, "query", *arguments, "--causes", "--format", "json"))


def number(text):
    """The first number of a text that is for people."""
    return float(re.search(r"−?\d+(\.\d+)?(e−?\d+)?", text)[0].replace("−", "-"))


class PageCase(unittest.TestCase):
    changes = {}  # of the sweep's text

    @classmethod
    def setUpClass(cls):
        SHOTS.mkdir(parents=True, exist_ok=True)
        cls.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = pathlib.Path(cls.folder.name)
        cls.db = cls.path / "quickstart.sigdb"
        small_sweep(IRSIG, SOURCE, cls.path / "small.toml", cls.db, cls.changes)
        cls.server = Server(IRSIG, cls.db, "--detector", SOURCE / "jobs/examples/detectors/insb.toml")
        cls.addClassCleanup(cls.server.end)
        cls.browser = Browser(cls.path / "profile")
        cls.addClassCleanup(cls.browser.__exit__)
        cls.pages = {name: cls.browser.page(*size[:2], touch=size[2]) for name, size in WIDTHS.items()}

    def setUp(self):
        for page in self.pages.values():
            page.errors.clear()

    def tearDown(self):
        for page in self.pages.values():
            elsewhere = [r for r in page.requests if not r.startswith((self.server.url, "about:", *self.others()))]
            self.assertEqual(elsewhere, [])

    def others(self):
        return getattr(self, "other_urls", [])

    def open(self, page, server=None, **state):
        page.open((server or self.server).url + ("?" + urllib.parse.urlencode(state) if state else ""))

    def each(self):
        return self.pages.items()

    def state(self, page):
        return dict(urllib.parse.parse_qsl(page.run("location.search.slice(1)")))

    def row_of(self, page, *more):
        state = self.state(page)
        azimuth, elevation = state["aspect"].split(",") if "aspect" in state else self.chosen(page)
        (row,) = rows(self.db, "--season", state["season"], "--time", state["time"], "--band", state["band"],
                      "--aspect", f"{azimuth},{elevation}", "--nearest", 1, *more)
        return row

    def chosen(self, page):
        words = page.text("#dome-readout")
        return re.search(r"azimuth ([\d.]+)°, elevation ([\d.]+)°", words).groups()

    def shown(self, page, column, panel="#values"):
        return page.run(f"JSON.parse(document.querySelector('{panel} [data-column=\"{column}\"]').dataset.value)")

    def check_values(self, page, row):
        for column in ("intensity_w_sr", "apparent_intensity_w_sr", "contrast_intensity_w_sr", "background_radiance_w_m2_sr",
                       "projected_area_m2", "source_radiance_temperature_k"):
            self.assertEqual(self.shown(page, column), row[column], column)
            # And as it can be read.
            seen = number(page.text(f"#values [data-column=\"{column}\"]"))
            self.assertLessEqual(abs(seen - row[column]), 1e-4 * abs(row[column]), column)
        self.assertIn(f"Row {row['row']}:", page.text("#values .where"))

    def check_layout(self, page):
        # Not innerWidth: a telephone widens that to what does not fit.
        self.assertLessEqual(page.run("document.documentElement.scrollWidth"), page.width)
        wide = page.run("[...document.querySelectorAll('body *')].filter(e => e.getClientRects().length && !e.closest('.scroll, .said, .skip, svg')"
                        f" && (e.getBoundingClientRect().right > {page.width + 0.5} || e.getBoundingClientRect().left < -0.5))"
                        ".map(e => e.tagName + '.' + e.className + ' ' + e.textContent.slice(0, 40))")
        self.assertEqual(wide, [])
        # No word of a plot leaves its picture.
        outside = page.run("[...document.querySelectorAll('svg.plot text')].filter(t => { const b = t.getBoundingClientRect(), "
                           "s = t.ownerSVGElement.getBoundingClientRect(); return b.left < s.left - 1 || b.right > s.right + 1 || b.bottom > s.bottom + 2; })"
                           ".map(t => t.textContent)")
        self.assertEqual(outside, [])
        self.assertEqual(page.unnamed_controls(), [])
