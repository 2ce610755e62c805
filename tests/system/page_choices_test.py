"""What is chosen at the page of irsig serve, by hand, by keyboard and by touch: databases, conditions, what the map shows.

usage: page_choices_test.py <irsig executable> <source folder> <folder for screenshots>
"""
import csv
import io
import shlex
import sys
import unittest

from page_fixture import IRSIG, SHOTS, SOURCE, WIDTHS, PageCase, number, rows
from serve_fixture import FEW, POLAR, Server, empty_database, irsig, small_sweep


class PageChoices(PageCase):
    def test_sliders(self):
        for name, page in self.each():
            self.open(page)
            for slider, field in (("season_slider", "season"), ("time_slider", "time"), ("band_slider", "band")):
                page.run(f"document.querySelector('[name={slider}]').focus()")
                before = self.state(page)[field]
                page.key("ArrowRight")
                state = self.state(page)
                self.assertNotEqual(state[field], before)
                self.assertEqual(page.run(f"document.querySelector('[name={field}]').value"), state[field])
                words = page.run(f"document.querySelector('[name={slider}]').getAttribute('aria-valuetext')")
                self.assertTrue(words.startswith(state[field]), words)
                self.assertEqual(page.run("document.activeElement.name"), slider)  # to go on
                self.check_values(page, self.row_of(page))
            page.run("document.querySelector('[name=range_m_slider]').focus()")
            page.key("ArrowRight")
            self.assertEqual(self.state(page)["range_m"], "5600")  # a twentieth of a decade beyond 5 km
            self.assertEqual(page.run("document.querySelector('[name=range_m]').value"), "5600")
            self.assertEqual(page.run("document.activeElement.getAttribute('aria-valuetext')"), "5.6 km")
            self.check_values(page, self.row_of(page, "--range-m", 5600))
            page.key("ArrowLeft")
            self.assertNotIn("range_m", self.state(page))
            # A choice in words moves its slider.
            page.choose("[name=season]", "summer")
            self.assertEqual(page.run("document.querySelector('[name=season_slider]').getAttribute('aria-valuetext')"), "summer")
            self.check_layout(page)
            self.assertEqual(page.errors, [])

    def test_plots_are_read_out_by_keyboard_and_by_touch(self):
        """Of spectrum, cut and windows: each arrow says the next value, each tap the value below it."""
        for name, page in self.each():
            self.open(page, season="summer", band="lwir", bands=1, detector="none")
            row = self.row_of(page)
            spectrum = rows(self.db, "--row", row["row"], "--spectrum")
            for plot in ("spectrum", "cut", "bands"):
                self.assertEqual(page.run(f"document.querySelector('#{plot} .readout').getAttribute('aria-live')"), "polite")
                page.run(f"document.querySelector('#{plot} svg.plot').focus()")
                self.assertEqual(page.run("document.activeElement.closest('section').id"), plot)
                said = [page.text(f"#{plot} .readout")]
                for _ in range(3):
                    page.key("ArrowLeft" if plot == "spectrum" else "ArrowRight")
                    said.append(page.text(f"#{plot} .readout"))
                self.assertEqual(len(set(said)), 4, said)
                if plot == "spectrum":
                    at = [number(words) for words in said]
                    greatest = max(range(len(spectrum)), key=lambda k: spectrum[k]["spectral_intensity_w_sr_um"])
                    for k, um in enumerate(at):
                        self.assertAlmostEqual(um, spectrum[greatest - k]["lambda_um"], delta=1e-3)
                if plot == "cut":
                    at = [number(words) for words in said]
                    self.assertEqual([(b - a) % 360 for a, b in zip(at, at[1:])], [2, 2, 2])  # clockwise
                page.key("ArrowDown", shift=True)
                self.assertNotIn(page.text(f"#{plot} .readout"), said[-1:] if plot != "bands" else [])
                if not WIDTHS[name][2]:
                    continue
                said = set()
                for part in (0.35, 0.45):
                    box = page.box(f"#{plot} svg.plot")
                    page.tap(box["x"] + part * box["width"], box["y"] + 0.3 * box["height"])
                    said.add(page.text(f"#{plot} .readout"))
                self.assertEqual(len(said), 2, said)
            # A plot that is drawn anew while it is read keeps the focus.
            page.run("document.querySelector('#cut svg.plot').focus()")
            page.run("document.querySelector('#elevation').value = 45, document.querySelector('#elevation').dispatchEvent(new Event('change'))")
            page.settle()
            self.assertTrue(page.run("document.activeElement.matches('#cut svg.plot')"))
            self.assertEqual(page.errors, [])

    def test_left_out(self):
        """The map of how well the other viewpoints know each: what irsig plan --left-out writes."""
        for name, page in self.each():
            self.open(page, season="summer", band="lwir")
            page.choose("[name=show]", "left_out")
            self.assertEqual(page.text("#map-title"), "Error of interpolation from the other viewpoints: in-band intensity")
            self.assertIn("%", page.text("#bar"))
            command = shlex.split(page.run("document.querySelector('#map [data-command]').dataset.command"))
            irsig(IRSIG, *command[1:-1], self.path / "left_out.csv")
            written = (self.path / "left_out.csv").read_text()
            mine = [r for r in csv.DictReader(io.StringIO(written)) if (r["season"], r["band"]) == ("summer", "lwir") and r["time_utc"] == self.state(page)["time"]]
            self.assertGreater(len(mine), 10)
            (link,) = page.run("[...document.querySelectorAll('#map .tools a')].map(a => a.getAttribute('href'))")
            self.assertEqual(list(csv.DictReader(io.StringIO(self.server.request(link)[2].decode()))), mine)
            inner = max(mine, key=lambda r: float(r["aspect_elevation_deg"]))
            state = {"season": "summer", "band": "lwir", "show": "left_out"}
            self.open(page, **state, aspect=f"{inner['aspect_azimuth_deg']},{inner['aspect_elevation_deg']}")
            off = number(page.text("#dome-readout").split("off by")[1])
            self.assertAlmostEqual(off / (100 * float(inner["relative_deviation"])), 1, delta=6e-3)
            outer = min(rows(self.db, "--season", "summer", "--band", "lwir"), key=lambda r: r["aspect_elevation_deg"])
            if not any(float(r["aspect_azimuth_deg"]) == outer["aspect_azimuth_deg"] for r in mine):
                self.open(page, **state, aspect=f"{outer['aspect_azimuth_deg']},{outer['aspect_elevation_deg']}")
                self.assertIn("do not surround it", page.text("#dome-readout"))
            self.check_layout(page)
            self.assertEqual(page.errors, [])
            page.screenshot(SHOTS / f"left-out-{name}.png")

    def test_image_is_saved_and_printed(self):
        page = self.pages["wide"]
        self.open(page, season="summer")
        page.wait("!document.querySelector('#image .tools').hidden")
        command = shlex.split(page.run("document.querySelector('#image [data-command]').dataset.command"))
        irsig(IRSIG, *command[1:-1], self.path / command[-1])
        self.assertRegex(command[-1], r"^row-\d+\.png$")
        status, headers, body = self.server.request(page.run("document.querySelector('#image .tools a').getAttribute('href')"))
        self.assertEqual((status, headers["Content-Type"]), (200, "image/png"))
        self.assertEqual(body, (self.path / command[-1]).read_bytes())

    def test_comparison(self):
        for name, page in self.each():
            self.open(page, season="winter", band="lwir")
            page.run("document.querySelector('[name=compare]').click()")
            page.wait("location.search.includes('b_season')")
            page.settle()
            page.choose("[name=b_season]", "summer")
            state = self.state(page)
            a = self.row_of(page)
            (b,) = rows(self.db, "--season", "summer", "--time", state["b_time"], "--band", state["b_band"],
                        "--aspect", f"{a['aspect_azimuth_deg']},{a['aspect_elevation_deg']}", "--nearest", 1)
            self.assertEqual(page.text("#map-title"), "B − A of the in-band intensity")
            difference = b["intensity_w_sr"] - a["intensity_w_sr"]
            self.assertAlmostEqual(self.shown(page, "difference") / difference, 1, delta=1e-9)
            rest = [max(0, r["numerical_error_w_sr"] ** 2 - r["intensity_stderr_w_sr"] ** 2) ** 0.5 for r in (a, b)]
            error = (sum(rest) ** 2 + a["intensity_stderr_w_sr"] ** 2 + b["intensity_stderr_w_sr"] ** 2) ** 0.5
            self.assertAlmostEqual(self.shown(page, "sigmas") * error / difference, 1, delta=1e-6)
            self.assertEqual(page.run("document.querySelectorAll('#spectrum path.curve').length"), 2)
            self.assertEqual(page.run("document.querySelectorAll('#cut path.curve').length"), 2)
            self.check_layout(page)
            page.screenshot(SHOTS / f"comparison-{name}.png")
            page.choose("[name=show]", "b")
            self.assertEqual(page.text("#map-title"), "In-band intensity of B")
            page.choose("[name=b_band]", "mwir")
            self.assertIn("lwir (8 to 12 um) and mwir (3 to 5 um) are bands of different limits", page.text("#map > .words"))
            self.assertEqual([e for e in page.errors if "409" not in e], [])
            page.errors.clear()
            page.choose("[name=b_band]", "lwir")
            self.assertEqual(page.errors, [])

    def test_a_database_without_a_sweep(self):
        empty = self.path / "empty.sigdb"
        empty_database(IRSIG, empty)
        server = Server(IRSIG, empty, self.db)
        self.addCleanup(server.end)
        self.other_urls = [server.url]
        for width, height, touch in WIDTHS.values():
            page = self.browser.page(width, height, touch=touch)
            self.addCleanup(page.close)
            self.open(page, server)
            self.assertEqual(self.state(page)["db"], "1")  # what there is to see
            self.assertIn("empty.sigdb: no sweep yet", page.text("#about"))
            self.assertTrue(page.run("document.getElementById('trouble').hidden"))
            # Compared with its own seasons: the empty one shares nothing and is not offered.
            page.run("document.querySelector('[name=compare]').click()")
            page.settle()
            self.assertEqual(self.state(page)["b_db"], "1")
            self.assertEqual(page.run("[...document.querySelector('[name=b_db]').options].map(o => o.text)"), [self.db.name])
            page.run("document.querySelector('[name=compare]').click()")
            page.settle()
            page.choose("[name=db]", "0")
            self.assertIn("empty.sigdb holds no sweep yet", page.text("#trouble"))
            self.assertTrue(page.run("document.querySelector('main').hidden"))  # no old plots
            self.check_layout(page)
            page.choose("[name=db]", "1")
            self.assertTrue(page.run("document.getElementById('trouble').hidden"))
            self.check_values(page, self.row_of(page))
            # Asked for by an address.
            self.open(page, server, db=0)
            self.assertIn("empty.sigdb holds no sweep yet", page.text("#trouble"))
            self.open(page, server, db=1, compare=1, b_db=0)
            self.assertIn("empty.sigdb holds no sweep yet: there is nothing to compare with", page.text("#trouble"))
            self.check_values(page, self.row_of(page))
            self.check_layout(page)
            self.assertEqual(page.errors, [])

    def test_a_sweep_arrives_in_an_empty_database(self):
        empty = self.path / "arrives.sigdb"
        empty_database(IRSIG, empty)
        server = Server(IRSIG, empty)
        self.addCleanup(server.end)
        self.other_urls = [server.url]
        page = self.browser.page(1280, 900)
        self.addCleanup(page.close)
        self.open(page, server)
        self.assertIn("arrives.sigdb holds no sweep yet", page.text("#trouble"))
        self.assertEqual(page.text("#controls"), "")
        small_sweep(IRSIG, SOURCE, self.path / "arrives.toml", empty)
        page.wait("document.querySelector('#values .where')?.innerText.startsWith('Row') && !document.querySelector('main').hidden")
        page.wait("document.getElementById('trouble').hidden && document.querySelector('[name=season]') !== null")
        page.wait("document.getElementById('about').innerText.includes('288 of 288')")
        self.assertEqual(page.errors, [])

    def test_what_two_databases_share(self):
        few, polar = self.path / "few.sigdb", self.path / "polar.sigdb"
        small_sweep(IRSIG, SOURCE, self.path / "few.toml", few, FEW)
        small_sweep(IRSIG, SOURCE, self.path / "polar.toml", polar, POLAR)
        server = Server(IRSIG, self.db, few, polar)
        self.addCleanup(server.end)
        self.other_urls = [server.url]
        for width, height, touch in WIDTHS.values():
            page = self.browser.page(width, height, touch=touch)
            self.addCleanup(page.close)
            # The one that shares viewpoints; its season of the same name, or else its first.
            for season, other in (("winter", "polar"), ("summer", "summer")):
                self.open(page, server, season=season, band="lwir")
                page.run("document.querySelector('[name=compare]').click()")
                page.settle()
                state = self.state(page)
                self.assertEqual((state["b_db"], state["b_season"], state["b_band"]), ("2", other, "lwir"))
                self.assertTrue(page.run("document.getElementById('trouble').hidden"), page.text("#trouble"))
                self.assertTrue(page.run("document.querySelector('#map > .words').hidden"))
                self.assertEqual(page.run("[...document.querySelector('[name=b_db]').options].map(o => o.value)"), ["0", "2"])
            # Of two that share none, the comparison says so, and A is shown.
            self.open(page, server, season="summer", compare=1, b_db=1)
            self.assertIn("Nothing is compared, shown is A alone: the two have no aspect in common", page.text("#map > .words"))
            self.assertEqual(page.text("#map-title"), "In-band intensity")
            self.check_values(page, self.row_of(page))
            for plot in ("spectrum", "cut"):
                self.assertEqual(page.run(f"document.querySelectorAll('#{plot} path.curve').length"), 1)
            self.check_layout(page)
            # Viewpoints on one side: there is no cut all around, which has no option of a command.
            self.open(page, server, db=1)
            self.assertEqual(page.text("#cut > .words"), "no elevation is covered by viewpoints all around the target: choose one below")
            page.choose("[name=show]", "left_out")
            self.assertIn("Shown are the values: no viewpoint is surrounded by others", page.text("#map > .words"))
            self.assertEqual(page.text("#map-title"), "In-band intensity")
            self.assertFalse([e for e in page.errors if "Failed to load resource" not in e], page.errors)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
