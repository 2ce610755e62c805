"""The image of a row at the page of irsig serve: its pixels are those of the database, by pointer and by keyboard.

usage: page_image_test.py <irsig executable> <source folder> <folder for screenshots>
"""
import json
import re
import shutil
import sqlite3
import struct
import sys
import unittest

from page_fixture import IRSIG, SHOTS, SOURCE, WIDTHS, PageCase
from serve_fixture import LAYERED, LAYERS, Server

sys.path.insert(0, str(SOURCE / "python"))
import irsig as irsig_py  # noqa: E402
import numpy  # noqa: E402

CANVAS = "document.querySelector('#image canvas')"
# The bar's own unit stands behind its numbers, before those of kelvin.
UNIT = "[...document.querySelectorAll('#image .scale svg > text:not(.middle)')][0].textContent"
NUMBER = r"−?[\d.]+(?:e−?\d+)?"


def numbers(text):
    return [float(n.replace("−", "-")) for n in re.findall(NUMBER, text)]


def band_radiance(low_um, high_um, kelvin):
    um = numpy.linspace(low_um, high_um, 2001)
    return numpy.trapezoid(1.1910429723971884e8 / um ** 5 / numpy.expm1(1.4387768775039338e4 / um / kelvin), um) if hasattr(numpy, "trapezoid") \
        else numpy.trapz(1.1910429723971884e8 / um ** 5 / numpy.expm1(1.4387768775039338e4 / um / kelvin), um)


class ImageCase(PageCase):
    changes = LAYERED

    def stored(self, page, layer=None, **condition):
        """(values, standard errors or None, fractions by part) of the chosen row."""
        row = int(re.match(r"Row (\d+):", page.text("#values .where"))[1])
        with irsig_py.open(self.db) as db:
            rows = db.query(row=row)
            return rows.images(layer)[0], rows.images(layer, stderr=True)[0], rows.silhouettes()[0]

    def check_readout(self, page, layer=None, band=(8, 12)):
        words = page.text("#image .readout")
        column, row = (int(n) for n in re.match(r"Column (\d+), row (\d+): ", words).groups())
        said = words.split(": ", 1)[1]
        value, stderr, parts = self.stored(page, layer)
        fraction = sum(parts.values())[row, column]
        name = max(parts, key=lambda part: parts[part][row, column])
        if fraction > 0:
            self.assertIn(f"{name} (", said)
        else:
            self.assertTrue(said.endswith("nothing of the target"), said)
        if layer in ("temperature", "range", "normal_x", "sunlit") and fraction == 0:
            self.assertEqual(said, "nothing of the target")
            return column, row
        self.assertAlmostEqual(numbers(said)[0], value[row, column], delta=6e-5 * abs(value[row, column]))
        self.assertEqual("±" in said, stderr is not None)
        if stderr is not None:
            self.assertAlmostEqual(numbers(said)[1], stderr[row, column], delta=0.06 * stderr[row, column])
        kelvin = re.search(rf"apparent temperature(?: of the target)? ({NUMBER}) K", said)
        self.assertEqual(bool(kelvin), layer == "at_sensor" or (layer is None and fraction > 0 and value[row, column] > 0), said)
        if kelvin:
            radiance = value[row, column] / (1 if layer else fraction)
            self.assertAlmostEqual(band_radiance(*band, float(kelvin[1])) / radiance, 1, delta=3e-4)
        return column, row

    def colours(self, page, which=0):
        """Painted pixels of a canvas, and the number of their colours."""
        return page.run(f"(c => {{ const d = new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer);"
                        " return [d.filter(p => p !== 0).length, new Set(d).size, d.length]; })"
                        f"(document.querySelectorAll('#image canvas')[{which}])")


class PageImage(ImageCase):
    def test_shows_the_pixels_of_the_database(self):
        for name, page in self.each():
            self.open(page, season="summer", band="lwir")
            painted, colours, pixels = self.colours(page)
            self.assertTrue(0.1 * pixels < painted < pixels and colours > 30, (painted, colours, pixels))
            self.assertEqual(page.run("[...document.querySelector('#image [name=layer]').options].map(o => o.value)"), ["", *LAYERS])
            self.assertEqual(page.run(UNIT), "W/(m² sr)")
            page.run(f"{CANVAS}.focus()")
            places = [self.check_readout(page)]  # the brightest pixel
            for key, shift in (("ArrowRight", False), ("ArrowDown", False), ("ArrowUp", True), ("ArrowLeft", True)):
                page.key(key, shift=shift)
                places.append(self.check_readout(page))
            steps = [(b[0] - a[0], b[1] - a[1]) for a, b in zip(places, places[1:])]
            self.assertEqual(steps[:2], [(1, 0), (0, 1)])
            self.assertTrue(steps[2][1] in (-10, -places[2][1]) and steps[3][0] == -10, steps)
            box = page.box("#image canvas")
            x, y = box["x"] + box["width"] * 40.5 / 96, box["y"] + box["height"] * 30.5 / 48
            page.tap(x, y) if WIDTHS[name][2] else page.mouse("mouseMoved", x, y)
            page.wait("document.querySelector('#image .readout').innerText.startsWith('Column 40, row 30:')")
            self.check_readout(page)
            for layer in ("at_sensor", "sun", "temperature", "normal_x", "sunlit", "range"):
                page.choose("#image [name=layer]", layer)
                page.wait(f"document.querySelector('#image .tools a').href.endsWith('layer={layer}')")
                self.assertEqual(self.state(page)["layer"], layer)
                self.check_readout(page, layer)
                self.check_layout(page)
            self.assertEqual(page.run(UNIT)[-1], "m")
            page.screenshot(SHOTS / f"image-{name}.png")

    def test_address_colours_and_outlines(self):
        page = self.pages["wide"]
        self.open(page, layer="at_sensor", band="lwir")
        self.assertEqual(page.run("document.querySelector('#image [name=layer]').value"), "at_sensor")
        self.assertEqual(self.colours(page)[0], self.colours(page)[2])  # no pixel is left out
        picture = f"{CANVAS}.toDataURL()"
        plain = page.run(picture)
        page.run("document.querySelector('#image [name=outlines]').click()")
        page.wait(f"{picture} !== {json.dumps(plain)}")
        self.document(page)
        lined = page.run(picture)
        page.choose("#image [name=colours]", "grey")
        page.wait(f"{picture} !== {json.dumps(lined)}")
        self.assertEqual({k: v for k, v in self.state(page).items() if k in ("layer", "colours", "outlines")},
                         {"layer": "at_sensor", "colours": "grey", "outlines": "1"})
        page.open(page.run("location.href"))
        self.assertTrue(page.run("document.querySelector('#image [name=outlines]').checked"))
        self.assertEqual(page.run("document.querySelector('#image [name=colours]').value"), "grey")
        page.choose("#image [name=layer]", "")
        page.wait("document.querySelector('#image .tools a').innerText === 'PNG'")
        page.run("history.back()")
        page.wait("document.querySelector('#image [name=layer]').value === 'at_sensor'")
        # A layer that there is not is words, and no markup.
        hostile = "<img src=x onerror=alert(1)>"
        self.open(page, layer=hostile, colours="pink", outlines="maybe")
        self.assertIn(f"This image has no layer “{hostile}”: shown is the radiance of the target.", page.text("#image .words"))
        self.assertEqual(page.run("document.querySelectorAll('img').length"), 0)
        self.assertGreater(self.colours(page)[0], 0)
        self.assertFalse([e for e in page.errors if "api/cut" not in e and "readback" not in e], page.errors)  # of six viewpoints there is no cut

    def document(self, page):
        """The picture for the documentation."""
        page.run(f"{CANVAS}.focus()")
        box = page.run("(({x, y, width, height}) => ({x: x + scrollX - 8, y: y + scrollY - 8, width: width + 16, height: height + 16}))(document.getElementById('image').getBoundingClientRect())")
        page.screenshot(SHOTS / "page-image.png", clip=box)
        self.assertLess((SHOTS / "page-image.png").stat().st_size, 100_000)

    def test_two_conditions_on_one_scale(self):
        for name, page in self.each():
            self.open(page, season="winter", band="lwir", compare=1, b_season="summer", b_band="lwir", layer="emitted")
            self.assertGreater(min(self.colours(page, k)[0] for k in (0, 1)), 0)
            page.run(f"{CANVAS}.focus()")
            words = page.text("#image .readout")
            column, row = numbers(words)[:2]
            a, b = (numbers(re.search(rf"{side} ({NUMBER}) ± {NUMBER} W", words)[1])[0] for side in "AB")
            self.assertIn("; B ", words)
            with irsig_py.open(self.db) as db:
                for value, pattern, panel in ((a, r"Row (\d+):", "#values .where"), (b, r"B is row (\d+):", "#values .where + .where")):
                    pixels = db.query(row=int(re.match(pattern, page.text(panel))[1])).images("emitted")[0]
                    self.assertAlmostEqual(value / pixels[int(row), int(column)], 1, delta=6e-5)
            self.assertGreater(b, a)
            self.check_layout(page)
            page.screenshot(SHOTS / f"image-two-{name}.png")
            page.run("document.querySelector('[name=compare]').click()")
            page.settle()
            self.assertFalse(page.run("document.querySelectorAll('#image canvas')[1].checkVisibility()"))

    def test_difference_of_two_conditions(self):
        for name, page in self.each():
            self.open(page, season="winter", band="lwir", compare=1, b_season="summer", b_band="lwir", layer="at_sensor")
            page.choose("#image [name=pictures]", "difference")
            page.wait("document.querySelector('#image .pictures span').textContent === 'B − A'")
            self.assertEqual(self.state(page)["pictures"], "difference")
            self.assertFalse(page.run("document.querySelectorAll('#image canvas')[1].checkVisibility()"))
            self.assertTrue(page.run("document.querySelector('#image [name=colours]').disabled"))
            bar = page.run("[...document.querySelectorAll('#image .scale svg > text.middle')].map(t => t.textContent)")
            self.assertEqual([numbers(bar[0])[0], "0" in bar], [-numbers(bar[-1])[0], True], bar)
            with irsig_py.open(self.db) as db:
                a, b = (db.query(row=int(re.match(pattern, page.text(panel))[1])) for pattern, panel in
                        ((r"Row (\d+):", "#values .where"), (r"B is row (\d+):", "#values .where + .where")))
                difference, = numpy.subtract(b.images("at_sensor"), a.images("at_sensor"), dtype=float)
                error, = numpy.hypot(a.images("at_sensor", stderr=True), b.images("at_sensor", stderr=True))
                behind, = numpy.subtract(b.images("background"), a.images("background"), dtype=float)
            page.run(f"{CANVAS}.focus()")
            for key in ("ArrowRight", "ArrowDown"):
                words = page.text("#image .readout")
                column, row = (int(n) for n in numbers(words)[:2])
                said = re.search(rf": B − A ({NUMBER}) ± ({NUMBER}) W/\(m² sr\), ({NUMBER}) σ", words)
                value, deviation, sigmas = (numbers(n)[0] for n in said.groups())
                self.assertAlmostEqual(value, difference[row, column], delta=6e-5 * abs(difference).max())
                self.assertAlmostEqual(deviation / error[row, column], 1, delta=0.06)
                self.assertAlmostEqual(sigmas / (difference[row, column] / error[row, column]), 1, delta=0.01)
                self.assertNotIn("apparent temperature", words)
                page.key(key)
            page.screenshot(SHOTS / f"image-difference-{name}.png")
            self.check_layout(page)
            # A layer without errors.
            page.choose("#image [name=layer]", "background")
            page.wait("document.querySelector('#image .tools a').href.endsWith('layer=background')")
            words = page.text("#image .readout")
            column, row, value = numbers(words.replace("B − A", ""))[:3]
            self.assertNotIn("±", words)
            self.assertAlmostEqual(value, behind[int(row), int(column)], delta=6e-5 * abs(behind).max())
            page.choose("#image [name=pictures]", "")
            page.wait("document.querySelector('#image .pictures span').textContent === 'A'")
            self.assertTrue(page.run("document.querySelectorAll('#image canvas')[1].checkVisibility()"))
            page.run("document.querySelector('[name=compare]').click()")
            page.settle()
            self.assertFalse(page.run("document.querySelector('#image [name=pictures]').checkVisibility()"))
            self.assertFalse([e for e in page.errors if "api/cut" not in e and "readback" not in e], page.errors)

    def test_words_in_place_of_images(self):
        victim = self.path / "victim.sigdb"
        shutil.copy(self.db, victim)
        (exr, stderr_exr), *_ = sqlite3.connect(victim).execute("SELECT exr, stderr_exr FROM thumbnail").fetchall()
        server = Server(IRSIG, victim)
        self.addCleanup(server.end)
        self.other_urls = [server.url]
        page = self.browser.page(390, 844)
        self.addCleanup(page.close)
        # Blocks that are there, with bytes that cannot be unpacked: the browser finds them out.
        def end_of(file, line, byte):  # the bytes of its last block
            begin = file.rindex(struct.pack("<i", line)) + 8
            return file[:begin] + byte * (len(file) - begin)
        for column, blob, words in (("exr", end_of(exr, 47, b"\x7f"), "a (run is too long|block is too short)"), ("exr", exr[:100], "has a damaged header"),
                                    ("stderr_exr", end_of(stderr_exr, 32, b"\xff"), "a block cannot be inflated")):
            with sqlite3.connect(victim) as db:
                db.execute(f"UPDATE thumbnail SET exr = ?, stderr_exr = ?", (exr, stderr_exr))
                db.execute(f"UPDATE thumbnail SET {column} = ?", (blob,))
            db.close()
            self.open(page, server)
            self.assertRegex(page.text("#image .words"), rf"The stored image of row \d+ .*{words}|the stored image of row \d+ is damaged: .*{words}")
            self.assertTrue(page.run("document.querySelector('#image > .body').hidden && document.querySelector('#image .tools').hidden"))
            self.assertIn("Row ", page.text("#values .where"))  # the rest is there
            self.check_layout(page)
        with sqlite3.connect(victim) as db:
            db.execute("UPDATE sweep SET thumbnail_px = 0")
        db.close()
        self.open(page, server)
        self.assertEqual(page.text("#image"), "This sweep was computed without images.")
        self.check_layout(page)
        self.assertFalse([e for e in page.errors if "Failed to load resource" not in e], page.errors)


class PageCounts(ImageCase):
    """A sweep with [imager]: its counts are shown first, on the camera's pixels."""
    changes = {**LAYERED, "[accuracy]\n": LAYERED["[accuracy]\n"].replace("[accuracy]\n", """[imager]
name = "test camera"
[imager.optics]
aperture_m = 0.05
f_number = 0.25
[imager.detector]
pitch_m = 15e-6
netd_k = 0.02
[imager.counts]
bits = 14
black_k = 250
white_k = 420

[accuracy]
""")}

    def test_counts_are_shown_first_with_radiance_and_kelvin(self):
        for name, page in self.each():
            self.open(page, season="summer", band="lwir")
            self.assertEqual(page.run("document.querySelector('#image [name=layer]').value"), "counts")
            self.assertEqual(page.run("[...document.querySelector('#image [name=layer]').options].map(o => o.value)"), ["radiance", "counts", *LAYERS])
            self.assertIn("counts of test camera, 14 bits", page.text("#image figcaption"))
            row = int(re.match(r"Row (\d+):", page.text("#values .where"))[1])
            info = self.server.json("/api/image.json", db=0, sweep="quickstart", row=row)
            (counts,) = info["counts"]
            self.assertEqual(counts["pixel_rad"], 1.2e-3)
            self.assertLess(counts["width_px"], info["width_px"] / 2 + 1)
            page.run(f"{CANVAS}.focus()")
            for key in ("ArrowRight", "ArrowDown", "ArrowLeft"):
                words = page.text("#image .readout")
                said = re.search(rf": ({NUMBER}) counts, ({NUMBER}) W/\(m² sr\), apparent temperature ({NUMBER}) K", words)
                value, radiance, kelvin = (numbers(n)[0] for n in said.groups())
                self.assertEqual(value, round(value))
                self.assertAlmostEqual(radiance / ((value - counts["offset_counts"]) / counts["counts_per_w_m2_sr"]), 1, delta=1e-4)
                self.assertAlmostEqual(band_radiance(8, 12, kelvin) / radiance, 1, delta=3e-4)
                page.key(key)
            # The bar has counts above and kelvin below.
            bar = page.run("[...document.querySelectorAll('#image .scale svg text')].map(t => t.textContent)")
            self.assertTrue({"counts", "K"} <= set(bar), bar)
            page.choose("#image [name=layer]", "radiance")
            page.wait("document.querySelector('#image .tools a').innerText === 'PNG'")
            self.check_readout(page)
            self.check_layout(page)
        self.assertEqual([e for e in self.pages["wide"].errors if "api/cut" not in e and "readback" not in e], [])

    def test_what_is_wrong_is_told(self):
        for path, code in (("/api/image.exr?db=0&sweep=quickstart&row=1&layer=counts&stderr=1", 404), ("/api/silhouette.json?db=0&sweep=quickstart&row=1&layer=counts", 200),
                           ("/api/image.exr?db=0&sweep=quickstart&row=1&layer=counts", 200), ("/api/image.exr?db=0&sweep=quickstart&row=1&layer=count", 400)):
            self.assertEqual(self.server.request(path)[0], code, path)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
