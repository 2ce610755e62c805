"""The page of irsig serve in a real browser, wide and narrow: what it shows is what irsig prints.

usage: page_test.py <irsig executable> <source folder> <folder for screenshots>
"""
import json
import pathlib
import shlex
import shutil
import sqlite3
import subprocess
import sys
import unittest

from page_fixture import IRSIG, SHOTS, WIDTHS, PageCase, number, rows
from serve_fixture import Server, irsig


class PageTest(PageCase):
    def test_opens_and_shows_what_the_query_prints(self):
        for name, page in self.each():
            self.open(page)
            self.assertIn("288 of 288 rows from 24 viewpoints", page.text("#about"))
            self.assertEqual(page.text("#map-title"), "In-band intensity")
            row = self.row_of(page)
            self.check_values(page, row)
            for cause in ("emitted", "sun_reflected", "sky_reflected", "surface_reflected", "interreflected"):
                self.assertEqual(self.shown(page, f"{cause}_w_sr", "#ledger"), row[f"{cause}_w_sr"])
            self.assertIn("24 of 24 jobs, complete", page.text("#progress"))
            self.check_layout(page)
            self.assertEqual(page.errors, [])
            page.screenshot(SHOTS / f"page-{name}.png")

    def test_chosen_by_hand_and_by_keyboard(self):
        for name, page in self.each():
            self.open(page)
            box = page.box("#dome")
            middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
            page.tap(*middle) if WIDTHS[name][2] else page.click(*middle)
            page.wait("location.search.includes('aspect')")
            page.settle()
            row = self.row_of(page)
            (zenith, *_) = rows(self.db, "--aspect", "0,90", "--nearest", 1)
            self.assertEqual((row["aspect_azimuth_deg"], row["aspect_elevation_deg"]),
                             (zenith["aspect_azimuth_deg"], zenith["aspect_elevation_deg"]))
            self.check_values(page, row)
            page.run("document.getElementById('dome').focus()")
            before = row
            page.key("ArrowRight")  # from above, starboard is to the right
            page.settle()
            row = self.row_of(page)
            self.assertNotEqual(row["row"], before["row"])
            self.assertGreater(self.starboard(row), self.starboard(before))
            self.check_values(page, row)
            page.key("ArrowDown", shift=True)
            self.assertEqual(self.state(page)["turn"], "180.0,80.0")
            self.assertEqual(page.errors, [])

    @staticmethod
    def starboard(row):
        from math import cos, radians, sin
        return cos(radians(row["aspect_elevation_deg"])) * sin(radians(row["aspect_azimuth_deg"]))

    def test_dragging_turns_and_does_not_choose(self):
        page = self.pages["wide"]
        self.open(page)
        box = page.box("#dome")
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse("mouseMoved", x, y)
        page.mouse("mousePressed", x, y)
        for step in range(1, 9):
            page.mouse("mouseMoved", x + 5 * step, y - 10 * step)
        page.mouse("mouseReleased", x + 40, y - 80)
        page.settle()
        state = self.state(page)
        self.assertNotIn("aspect", state)
        azimuth, elevation = map(float, state["turn"].split(","))
        self.assertTrue(60 < elevation < 70 and 185 < azimuth < 200, state)

    def test_controls(self):
        for name, page in self.each():
            self.open(page)
            page.choose("[name=season]", "summer")
            page.choose("[name=band]", "lwir")
            page.choose("[name=quantity]", "contrast_intensity")
            self.assertEqual(page.text("#map-title"), "In-band contrast intensity")
            self.check_values(page, self.row_of(page))
            state = self.state(page)
            self.assertEqual((state["season"], state["band"], state["quantity"]), ("summer", "lwir", "contrast_intensity"))
            before = state["time"]
            page.run("document.querySelector('[name=time_slider]').focus()")
            page.key("ArrowRight")
            page.settle()
            state = self.state(page)
            self.assertNotEqual(state["time"], before)
            self.assertEqual(page.run("document.querySelector('[name=time]').value"), state["time"])
            self.check_values(page, self.row_of(page))
            self.assertFalse(page.run("document.querySelector('#map > .words').innerText.includes('stored range')"))
            page.choose("[name=range_m]", "12000")
            self.assertIn("This map is of the stored range", page.text("#map > .words"))
            self.assertIn("Of the stored range", page.text("#cut > .readout"))
            page.settle()
            row = self.row_of(page, "--range-m", 12000)
            self.assertEqual(row["range_m"], 12000)
            self.check_values(page, row)
            self.assertEqual(self.shown(page, "numerical_error", "#budget"), row["contrast_numerical_error_w_sr"])
            for wrong, words in (("1e300", "is too far: expected from 20 lengths of the target to 1e+09 m"), ("50", "20 lengths")):
                page.choose("[name=range_m]", wrong)
                self.assertIn(words, page.text("#values > .words"))
                self.assertNotIn("nan", page.text("main"))
            self.assertIn("20 lengths", page.text("#values > .words"))
            self.assertTrue(page.run("document.querySelector('#values .body').hidden && document.querySelector('#spectrum .body').hidden"))
            self.check_layout(page)

    def test_spectrum(self):
        for name, page in self.each():
            self.open(page, band="lwir", season="spring")
            row = self.row_of(page)
            spectrum = rows(self.db, "--row", row["row"], "--spectrum")
            self.assertEqual(page.run("document.querySelector('#spectrum path.curve.a').getAttribute('d').split('L').length"), len(spectrum))
            self.assertEqual(page.run("document.querySelectorAll('#spectrum path.band.a').length"), 1)
            # The stack's areas are the causes that are not zero; its top is the whole.
            causes = page.run("[...document.querySelectorAll('#spectrum path.cause')].map(p => p.dataset.cause)")
            self.assertEqual(causes, [c for c in ("emitted", "sun_reflected", "sky_reflected", "surface_reflected", "interreflected")
                                      if any(s[f"spectral_{c}_w_sr_um"] for s in spectrum)])
            top, line = (page.run(f"document.querySelector('#spectrum path.{c}').getAttribute('d').split('L')[40].split(' ').map(Number)[1]")
                         for c in (f"cause.{causes[-1]}", "curve.a"))
            self.assertAlmostEqual(top, line, delta=0.1)
            box = page.box("#spectrum svg")
            page.mouse("mouseMoved", box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
            page.settle()
            words = page.text("#spectrum .readout")
            at = number(words)
            (point,) = [s for s in spectrum if abs(s["lambda_um"] - at) < 1e-6]
            value, error = (number(w) for w in words.split(":")[1].split("±"))
            factor = 1000 if "kW" in words else 1
            self.assertAlmostEqual(value * factor / point["spectral_intensity_w_sr_um"], 1, delta=1e-4)
            self.assertAlmostEqual(error * factor / point["spectral_intensity_stderr_w_sr_um"], 1, delta=0.06)

    def test_cut(self):
        for name, page in self.each():
            self.open(page, season="summer", band="mwir", elevation_deg=30)
            printed = irsig(IRSIG, *shlex.split(page.run("document.querySelector('#cut [data-command]').dataset.command"))[1:])
            lines = [line.split(",") for line in printed.splitlines()[1:]]
            curve = [line for line in lines if line[5] == "interpolated"]
            self.assertEqual(page.run("document.querySelector('#cut path.curve.a').getAttribute('d').split('L').length"), len(curve))
            self.assertEqual(page.run("document.querySelectorAll('#cut circle.mark.a').length"), sum(line[5] == "near" for line in lines))
            self.assertEqual(page.text("#cut output"), "30°")
            box = page.box("#cut svg")
            page.mouse("mouseMoved", box["x"] + 0.75 * box["width"], box["y"] + box["height"] / 2)  # starboard
            page.settle()
            words = page.text("#cut .readout")
            (at_beam,) = [line for line in curve if float(line[6]) == 90]
            self.assertTrue(words.startswith("90°"), words)
            value = number(words.split(":")[1]) * (1000 if "kW" in words else 1)
            self.assertAlmostEqual(value / float(at_beam[8]), 1, delta=1e-4)
            page.choose("#elevation", "45")
            self.assertEqual(self.state(page)["elevation_deg"], "45")
            self.assertIn("elevation 45°", page.run("document.querySelector('#cut svg').getAttribute('aria-label')"))

    def test_budget_and_ledger(self):
        for name, page in self.each():
            self.open(page, season="winter", band="mwir", quantity="apparent_intensity")
            row = self.row_of(page)
            explained = json.loads(irsig(IRSIG, "explain", self.db, "--row", row["row"], "--format", "json"))
            stated = {p["name"]: p for p in explained["error_budget"] if p["quantity"] == "apparent_intensity" and p["error_w_sr"] > 0}
            drawn = page.run("[...document.querySelectorAll('#budget [data-part]')].map(e => [e.dataset.part, Number(e.dataset.value)])")
            self.assertEqual(dict(drawn), {k: p["error_w_sr"] for k, p in stated.items()})
            widths = page.run("[...document.querySelectorAll('#budget tbody tr')].map(r => [r.querySelector('[data-part]').dataset.part,"
                              " r.querySelector('.fill').getBoundingClientRect().width / r.querySelector('.bar').getBoundingClientRect().width])")
            for part, width in widths:
                self.assertAlmostEqual(width, max(0.005, stated[part]["share"]), delta=0.02)
            self.assertEqual(self.shown(page, "numerical_error", "#budget"), row["apparent_numerical_error_w_sr"])
            effects = page.run("[...document.querySelectorAll('#ledger table')].find(t => t.caption.textContent === 'Effects').tBodies[0].rows.length")
            absent = [e["effect"].replace("_", " ") for e in explained["effects"] if e["state"] == "absent"]
            self.assertEqual(effects + len(absent), len(explained["effects"]))
            idle = [e for e in explained["effects"] if e["state"] == "on" and (e["bound_w_sr"] or 0) > abs(row["intensity_w_sr"])]
            marked = page.run("[...document.querySelectorAll('#ledger .effects td small')].filter(s => s.textContent.includes('does not matter')).length")
            self.assertEqual(marked, len(idle))
            self.assertGreater(marked, 0)
            # At 390 px no effect is cut off: every cell lies within the table's box.
            self.assertTrue(page.run("(() => { const box = document.querySelector('#ledger .effects .scroll').getBoundingClientRect();"
                                     "return [...document.querySelectorAll('#ledger .effects td, #ledger .effects tbody th')].every(c => {"
                                     "const r = c.getBoundingClientRect(); return r.left >= box.left - 1 && r.right <= box.right + 1; }); })()"))
            self.assertEqual(page.text("#ledger .absent"), f"Nothing here causes: {', '.join(absent)}.")
            self.open(page, quantity="background_radiance")
            self.assertIn("no bounds are stored", page.text("#budget .words"))

    def test_thumbnail_follows_the_pointer(self):
        page = self.pages["wide"]
        self.open(page)
        label = "document.querySelector('#image canvas').getAttribute('aria-label')"
        first = page.run(label)
        self.assertIn(self.chosen(page)[0], first)
        box = page.box("#dome")
        page.mouse("mouseMoved", box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        page.wait(f"{label} !== {json.dumps(first)}")
        self.assertNotIn("aspect", self.state(page))  # looked at, not chosen
        (zenith, *_) = rows(self.db, "--aspect", "0,90", "--nearest", 1)
        self.assertIn(f"elevation {zenith['aspect_elevation_deg']:.4g}", page.run(label))
        page.mouse("mouseMoved", 2, 2)
        page.wait(f"{label} === {json.dumps(first)}")

    def test_bands(self):
        for name, page in self.each():
            self.open(page, season="summer", band="lwir")
            self.assertTrue(page.run("document.getElementById('bands-form').hidden"))
            page.run("document.getElementById('bands-open').click()")
            page.settle()
            self.assertEqual(page.run("document.querySelector('[name=detector]').value"), "0")  # the one that was named
            self.assertIn("outside the stored band", page.text("#bands > .words"))
            page.choose("[name=detector]", "none")
            page.settle()
            self.assertFalse(page.run("!!document.querySelector('[name=clutter]')"))  # a ship at sea has none
            self.assertEqual(self.state(page)["bands"], "1")

            def check():
                (printed, *_) = json.loads(irsig(IRSIG, *shlex.split(page.run("document.querySelector('#bands [data-command]').dataset.command"))[1:-2],
                                                 "--format", "json"))
                self.assertEqual(page.run("Number(document.querySelector('#bands [data-merit]').dataset.merit)"), printed["merit"])
                first = f"{printed['lambda_min_um']:.5g} to {printed['lambda_max_um']:.5g}"
                self.assertEqual(page.text("#bands tbody th"), first)
                self.assertIn(first, page.text("#bands .readout"))
                self.assertIn(first, page.run("document.querySelector('#bands svg').getAttribute('aria-label')"))
                return printed
            check()
            windows = page.run("document.querySelectorAll('#bands svg rect:not(.here)').length")
            self.assertEqual(windows, 81 * 82 // 2 - 2)  # the first and the last bin are cut by the band's limits
            page.choose("[name=merit]", "percentile")
            page.choose("[name=percentile]", "40")
            printed = check()
            page.choose("[name=nei_w_m2]", "1e-7")
            self.assertAlmostEqual(check()["merit"] / printed["merit"], 0.01, delta=1e-8)
            near = check()["merit"]
            page.choose("[name=range_m]", "10000")
            self.assertIn("seen from 10 km", page.text("#bands caption"))
            self.assertLess(check()["merit"], 0.3 * near)
            page.choose("[name=range_m]", "")
            page.choose("[name=detector]", "0")
            self.assertIn("outside the stored band", page.text("#bands > .words"))
            self.assertTrue(page.run("document.querySelector('#bands .body').hidden"))
            page.choose("[name=band]", "mwir")
            page.choose("[name=over]", "conditions")
            self.assertIn("over 144 rows, InSb", page.text("#bands caption"))
            check()
            box = page.box("#bands svg")
            page.mouse("mouseMoved", box["x"] + 0.3 * box["width"], box["y"] + 0.3 * box["height"])
            page.settle()
            self.check_layout(page)
            page.screenshot(SHOTS / f"bands-{name}.png")
            page.open(page.run("location.href"))  # the address is all of it
            check()
            self.assertFalse([e for e in page.errors if "Failed to load resource" not in e], page.errors)

    def test_links_and_the_back_button(self):
        for name, page in self.each():
            self.open(page)
            first = page.text("#values .where")
            page.choose("[name=season]", "summer")
            second = page.text("#values .where")
            page.choose("[name=band]", "lwir")
            third, address = page.text("#values .where"), page.run("location.href")
            self.assertEqual(len({first, second, third}), 3)
            page.run("history.back()")
            page.wait(f"document.querySelector('#values .where').innerText === {json.dumps(second)}")
            page.run("history.back()")
            page.wait(f"document.querySelector('#values .where').innerText === {json.dumps(first)}")
            self.assertEqual(page.run("document.querySelector('[name=season]').value"), self.state(page)["season"])
            page.open(address)
            self.assertEqual(page.text("#values .where"), third)
            self.assertEqual(page.errors, [])

    def test_commands_print_what_is_shown(self):
        page = self.pages["wide"]
        self.open(page, season="summer", band="lwir", quantity="contrast_intensity", range_m=9000)
        commands = {panel: page.run(f"document.querySelector('#{panel} > .tools [data-command]').dataset.command")
                    for panel in ("map", "values", "spectrum", "cut", "budget", "ledger")}
        for command in commands.values():
            self.assertTrue(irsig(IRSIG, *shlex.split(command)[1:]), command)
        (row,) = json.loads(irsig(IRSIG, *shlex.split(commands["values"])[1:]))
        self.check_values(page, row)
        page.run("document.querySelector('#values > .tools [data-command]').click()")
        page.wait("document.getElementById('said').textContent !== ''")
        self.assertIn(commands["values"], page.text("#said"))
        for link in page.run("[...document.querySelectorAll('.tools a')].map(a => a.getAttribute('href'))"):
            self.assertEqual(self.server.request(link)[0], 200, link)

    def test_words_in_place_of_plots(self):
        victim = self.path / "victim.sigdb"
        shutil.copy(self.db, victim)
        with sqlite3.connect(victim) as db:
            db.execute("UPDATE thumbnail SET exr = zeroblob(500)")
        db.close()
        server = Server(IRSIG, victim)
        self.addCleanup(server.end)
        self.other_urls = [server.url]
        page = self.browser.page(390, 844)
        self.addCleanup(page.close)
        self.open(page, server, season="autumn", quantity="brightness")
        self.assertIn("There is no season “autumn” here", page.text("#trouble"))
        self.assertIn("There is no quantity “brightness”", page.text("#trouble"))
        page.wait("!document.querySelector('#image .words').hidden")
        self.assertIn("is damaged", page.text("#image .words"))
        self.check_layout(page)
        self.assertTrue(page.run("document.querySelector('#map > .words').hidden"))
        victim.unlink()
        page.choose("[name=season]", "summer")
        self.assertIn("no such file", page.text("#map > .words"))
        self.open(page, server)
        self.assertIn("no such file", page.text("#trouble"))
        server.end()
        page.run("document.querySelector('[name=season]') || 0")
        self.assertFalse([e for e in page.errors if "Failed to load resource" not in e], page.errors)

    def test_workers_and_what_accuracy_costs(self):
        address = f"unix:{self.path}/farm"
        accuracy = self.path / "accuracy.html"
        accuracy.write_text('<!DOCTYPE html><title>costs</title><style>p{color:rgb(1, 2, 3)}</style><p>a point</p><svg width="9" height="9"></svg>')
        farm = subprocess.Popen([pathlib.Path(IRSIG).with_name("irsig-coordinator"), "--db", self.path / "farm.sigdb", "--listen", address],
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(farm.communicate)
        self.addCleanup(farm.kill)
        self.assertIn("listening", farm.stdout.readline())
        worker = subprocess.Popen([pathlib.Path(IRSIG).with_name("irsig-worker"), "--coordinator", address, "--name", "<b>ann</b>"],
                                  stderr=subprocess.DEVNULL)
        self.addCleanup(worker.wait)
        self.addCleanup(worker.kill)
        server = Server(IRSIG, self.db, "--coordinator", address, "--accuracy", accuracy)
        self.addCleanup(server.end)
        self.other_urls = [server.url]
        for width, height, touch in WIDTHS.values():
            page = self.browser.page(width, height, touch=touch)
            self.addCleanup(page.close)
            self.open(page, server)
            page.wait("(document.querySelector('#workers summary')?.textContent ?? '').startsWith('1 worker: 1 idle')")
            page.run("document.querySelector('#workers summary').click()")
            self.assertIn("<b>ann</b>", page.text("#workers tbody"))
            self.check_layout(page)
            page.run("document.querySelector('#about a').click()")
            page.wait("document.title === 'costs'")
            self.assertEqual(page.run("getComputedStyle(document.querySelector('p')).color"), "rgb(1, 2, 3)")
            self.assertEqual(page.errors, [])
        # A coordinator that has gone is words, and the rest stays.
        self.open(page, server)
        page.wait("!!document.querySelector('#workers')")
        farm.kill()
        farm.wait()
        page.wait("!!document.querySelector('#progress .words')")
        self.assertIn(address, page.text("#progress .words"))
        self.assertIn("24 of 24 jobs, complete", page.text("#progress"))

    def test_the_server_ends(self):
        server = Server(IRSIG, self.db)
        self.other_urls = [server.url]
        page = self.browser.page(1280, 900)
        self.addCleanup(page.close)
        self.open(page, server)
        server.end()
        page.choose("[name=season]", "summer")
        self.assertIn("does not answer", page.text("#map > .words"))

    def test_dark(self):
        page = self.browser.page(1280, 900, dark=True)
        self.addCleanup(page.close)
        self.open(page, season="summer", band="lwir", turn="150,35")
        contrast = """(() => {
          const light = c => { const [r, g, b] = c.match(/[\\d.]+/g).slice(0, 3).map(v => v / 255).map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
            return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
          const panel = light(getComputedStyle(document.querySelector('section')).backgroundColor);
          return [['body', 'color'], ['.hint', 'color'], ['.plot text', 'fill'], ['button', 'color'], ['path.curve.a', 'stroke']].map(([s, p]) => {
            const ink = light(getComputedStyle(document.querySelector(s))[p]);
            return [s, (Math.max(ink, panel) + 0.05) / (Math.min(ink, panel) + 0.05)]; }); })()"""
        self.open(self.pages["wide"])
        for where, shown in (("dark", page), ("light", self.pages["wide"])):
            for selector, ratio in shown.run(contrast):
                self.assertGreater(ratio, 3 if "curve" in selector else 4.5, (where, selector))  # WCAG 2.1, 1.4.3 and 1.4.11
        self.assertEqual(page.errors, [])
        page.screenshot(SHOTS / "page-dark.png")

    def test_pictures_for_the_documentation(self):
        page = self.pages["wide"]
        condition = {"season": "summer", "band": "lwir", "elevation_deg": 20}
        for name, state in (("page", {"turn": "150,40"}), ("page-comparison", {"compare": 1, "b_season": "winter", "b_band": "lwir"})):
            self.open(page, **condition, **state)
            self.assertFalse(page.run("document.querySelector('#image > .body').hidden"))
            picture = SHOTS / f"{name}.png"
            page.screenshot(picture, clip=(1280, 1110, 0.68))
            self.assertLess(picture.stat().st_size, 150_000)
            self.assertEqual(page.errors, [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
