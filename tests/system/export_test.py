"""What `irsig export` hands over: tables long and wide, cubes and pictures, of several ranges and several sweeps.

usage: export_test.py <irsig> <irsig-picture> <repository>
"""
import csv, io, json, os, pathlib, re, resource, shutil, signal, sqlite3, struct, subprocess, sys, tempfile, time, unittest, zlib

IRSIG, PICTURE, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:4])


def irsig(*arguments, expect=0, env=None):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=300, env=env)
    assert done.returncode == expect, f"{arguments}: {done.returncode}\n{done.stderr}"
    return done


def table(text):
    return list(csv.DictReader(io.StringIO(text)))


def grey(path, bits=8):
    """Pixels of a grey PNG, by the specification."""
    data, at, packed = path.read_bytes(), 8, b""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        at += 12 + size
        if name == b"IHDR":
            width, height, depth, kind = struct.unpack(">IIBB", body[:10])
            assert (depth, kind) == (bits, 0)
        elif name == b"IDAT":
            packed += body
    step = bits // 8
    size = width * step
    raw, rows, before = zlib.decompress(packed), [], bytes(size)
    for y in range(height):
        how, line = raw[y * (size + 1)], bytearray(raw[y * (size + 1) + 1:(y + 1) * (size + 1)])
        for x in range(size):
            left, up, corner = (line[x - step] if x >= step else 0), before[x], (before[x - step] if x >= step else 0)
            p = left + up - corner
            paeth = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))[2]
            line[x] = (line[x] + (0, left, up, (left + up) // 2, paeth)[how]) & 255
        rows.append(struct.unpack(f">{width}{'BH'[step - 1]}", line))
        before = line
    return rows


class Export(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        text = (ROOT / "jobs/examples/quickstart.toml").read_text().replace("count = 24", "count = 3")
        cls.db = cls.path / "s.sigdb"
        for name, text in (("quickstart", text), ("other", text.replace('name = "quickstart"', 'name = "other"'))):
            sweep = cls.path / (name + ".toml")
            sweep.write_text(text)
            irsig("run", sweep, "--db", cls.db, "--workers", "2")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def export(self, name, *options):
        irsig("export", self.db, "--out", self.path / name, *options)
        return self.path / name

    def test_several_ranges_are_one_after_the_other(self):
        chosen = ("--sweep", "quickstart", "--causes", "--csv")
        together = table(irsig("query", self.db, *chosen, "--range-m", "20000,5000,10000").stdout)
        self.assertEqual(len(together), 3 * 18)
        for i, range_m in enumerate((20000, 5000, 10000)):
            self.assertEqual(together[i::3], table(irsig("query", self.db, *chosen, "--range-m", range_m).stdout))
        exported = table(self.export("r.csv", "--sweep", "quickstart", "--range-m", "20000,5000,10000").read_text())
        self.assertEqual(exported, together)
        limit = ("--quantity", "contrast_intensity", "--max-relative-error", "0.05")
        exact = table(irsig("query", self.db, *chosen, "--range-m", "20000,5000,10000", *limit).stdout)
        self.assertEqual(exact, [r for r in together if float(r["contrast_numerical_error_w_sr"]) <= 0.05 * abs(float(r["contrast_intensity_w_sr"]))])
        self.assertNotIn(len(exact), (0, len(together)))

    def test_a_cube_has_an_axis_of_ranges(self):
        import numpy
        import xarray
        rows = table(self.export("r2.csv", "--sweep", "quickstart", "--range-m", "20000,5000").read_text())
        one = irsig("query", self.db, "--row", "1", "--sweep", "quickstart", "--range-m", "20000", "--spectrum", "--csv")
        with xarray.open_dataset(self.export("r.nc", "--sweep", "quickstart", "--range-m", "20000,5000")) as d:
            self.assertEqual(d["range_m"].values.tolist(), [5000, 20000])
            self.assertEqual(d["contrast_intensity_w_sr"].dims, ("viewpoint", "season", "time_of_day", "band", "range_m"))
            self.assertEqual(set(d["stored_range_m"].values.tolist()), {float(rows[0]["stored_range_m"])})
            for name in ("contrast_intensity_w_sr", "apparent_numerical_error_w_sr", "intensity_w_sr", "range_bound_w_sr"):
                for i, range_m in enumerate((20000, 5000)):
                    there = d[name].sel(range_m=range_m)
                    for r in rows[i::2]:
                        near = int(numpy.argmin(abs(d["aspect_azimuth_deg"].values - float(r["aspect_azimuth_deg"]))))
                        self.assertEqual(float(there.isel(viewpoint=near, time_of_day=0).sel(season=r["season"], band=r["band"])), float(r[name]), name)
            first = table(one.stdout)
            spectrum = d["contrast_spectral_intensity_w_sr_um"].sel(range_m=20000, season=first[0]["season"], band=first[0]["band"])
            for value, r in zip(spectrum.isel(viewpoint=0, time_of_day=0).values, first):
                self.assertAlmostEqual(float(value), float(r["contrast_spectral_intensity_w_sr_um"]), delta=1e-6 * abs(value))
        # Without ranges of its own a cube is as it was.
        with xarray.open_dataset(self.export("p.nc", "--sweep", "quickstart")) as d:
            self.assertEqual(d["range_m"].dims, ("viewpoint",))

    def test_tables_long_and_wide_hold_the_same(self):
        for more in ((), ("--range-m", "20000")):
            chosen = ("--band", "lwir", "--quantity", "contrast_intensity", *more)
            long = table(self.export("long.csv", "--spectra", "long", *chosen).read_text())
            wide = table(self.export("wide.csv", "--spectra", "wide", *chosen).read_text())
            self.assertEqual(len(wide), 2 * 9)  # of both sweeps
            self.assertEqual({r["sweep"] for r in wide}, {"quickstart", "other"})
            lines = iter(long)
            for row in wide:
                for name in row:
                    if not name.startswith("contrast_spectral_intensity_w_sr_um_at_"):
                        continue
                    line = next(lines)
                    self.assertEqual((line["sweep"], line["row"]), (row["sweep"], row["row"]))
                    at = name.split("_at_")[1]
                    self.assertEqual(f"{float(line['lambda_um']):g}um", at)
                    self.assertEqual(row[name], line["contrast_spectral_intensity_w_sr_um"])
                    self.assertEqual(row["contrast_spectral_intensity_stderr_w_sr_um_at_" + at], line["contrast_spectral_intensity_stderr_w_sr_um"])
            self.assertEqual(list(lines), [])
        both = irsig("export", self.db, "--spectra", "wide", "--out", self.path / "no.csv", expect=2)
        self.assertIn("expected --band", both.stderr)
        self.assertFalse((self.path / "no.csv").exists())
        self.assertIn("belongs to the format csv", irsig("export", self.db, "--spectra", "long", "--out", self.path / "no.nc", expect=2).stderr)

    def test_plots_have_a_curve_for_each_range(self):
        chosen = ("--sweep", "quickstart", "--band", "lwir", "--range-m", "5000,20000")
        for kind, more in (("spectrum", ("--row", "2", "--quantity", "contrast_intensity")), ("transmittance", ("--row", "2"))):
            irsig("plot", self.db, "--kind", kind, *chosen, *more, "--out", self.path / "r.svg")
            text = (self.path / "r.svg").read_text()
            self.assertIn("winter, 5 km", text)
            self.assertIn("winter, 20 km", text)
        self.assertIn("one range", irsig("plot", self.db, "--kind", "map", *chosen, "--out", self.path / "r.svg", expect=2).stderr)
        self.assertIn("belongs to --kind polar or", irsig("plot", self.db, "--kind", "hours", *chosen, "--out", self.path / "r.svg", expect=2).stderr)

    def labels(self, folder):
        rows = table((folder / "labels.csv").read_text())
        self.assertEqual(sorted(r["image"] for r in rows), sorted(str(p.relative_to(folder)) for p in folder.glob("images/*.png")))
        return rows

    def pixels(self, exr):
        """As core/image/apart/picture_subprocess.h has it."""
        image = exr.read_bytes()
        task = b"irsig pictures 2\n" + struct.pack("=I3B2fi3d2Q", 4096, 0, 1, 0, 0, 0, 8, 0, 0, 0, 0, len(image)) + image
        done = subprocess.run([PICTURE, str(len(task))], input=task, capture_output=True, check=True)
        head = b"irsig answers 1\n"
        self.assertEqual(done.stdout[:len(head)], head)
        damage, hottest, width, height, *box, png, count = struct.unpack_from("=Qf7IQQ", done.stdout, len(head))
        self.assertEqual((damage, png, count), (0, 0, width * height))
        flat = struct.unpack(f"={count}f", done.stdout[-4 * count:])
        return [flat[y * width:(y + 1) * width] for y in range(height)]

    def test_thumbnails_are_on_one_scale(self):
        folder = self.export("t", "--format", "thumbnails", "--sweep", "quickstart", "--exr")
        rows = self.labels(folder)
        self.assertEqual(len(rows), 18)
        self.assertEqual([int(r["row"]) for r in rows], list(range(1, 19)))
        stored = {r["row"]: r for r in table(irsig("query", self.db, "--sweep", "quickstart", "--csv").stdout)}
        hottest = {}
        for r in rows:
            pixels = self.pixels((folder / r["image"]).with_suffix(".exr"))
            hottest[r["band"]] = max(hottest.get(r["band"], 0), max(map(max, pixels)))
        for r in rows:
            self.assertEqual(float(r["black_w_m2_sr"]), 0)
            self.assertAlmostEqual(float(r["white_w_m2_sr"]), hottest[r["band"]], delta=1e-6 * hottest[r["band"]])
            for name in ("contrast_intensity_w_sr", "aspect_azimuth_deg", "numerical_error_w_sr", "season", "range_m"):
                self.assertEqual(r[name], stored[r["row"]][name], name)
        r = rows[5]
        pixels, shades = self.pixels((folder / r["image"]).with_suffix(".exr")), grey(folder / r["image"])
        for line, shade in zip(pixels, shades, strict=True):
            for value, is_ in zip(line, shade, strict=True):
                self.assertLessEqual(abs(255 * value / float(r["white_w_m2_sr"]) - is_), 0.51)
        shown = [(x, y) for y, line in enumerate(pixels) for x, v in enumerate(line) if v]
        self.assertEqual(int(r["target_px"]), len(shown))
        left, top = min(x for x, _ in shown), min(y for _, y in shown)
        self.assertEqual([int(r[f"box_{n}_px"]) for n in ("left", "top", "width", "height")],
                         [left, top, max(x for x, _ in shown) - left + 1, max(y for _, y in shown) - top + 1])
        parts = table(irsig("query", self.db, "--sweep", "quickstart", "--row", "6", "--parts", "--csv").stdout)
        self.assertEqual({p["part"]: p["part_intensity_w_sr"] for p in parts},
                         {n.split(":")[0]: v for n, v in r.items() if n.endswith(":part_intensity_w_sr")})

    def test_of_several_sweeps_on_scales_of_ones_own(self):
        folder = self.export("own", "--thumbnails", "--thumbnail-scale", "own", "--band", "mwir")
        rows = self.labels(folder)
        self.assertEqual(len(rows), 18)
        self.assertEqual({r["image"].split("/")[1][0] for r in rows}, {"1", "2"})
        self.assertTrue(all(max(map(max, grey(folder / r["image"]))) == 255 for r in rows))
        stated = self.export("stated", "--thumbnails", "--thumbnail-scale", "2,30", "--row", "3")
        self.assertEqual({(r["black_w_m2_sr"], r["white_w_m2_sr"]) for r in self.labels(stated)}, {("2", "30")})

    def test_pictures_before_the_background(self):
        folder = self.export("sea", "--thumbnails", "--background", "--exr", "--sweep", "quickstart", "--season", "winter", "--thumbnail-scale", "own")
        rows = {r["row"]: r for r in table(irsig("query", self.db, "--sweep", "quickstart", "--csv").stdout)}
        for label in self.labels(folder):
            r = {k: float(v) for k, v in rows[label["row"]].items() if v and k.endswith(("_w_sr", "_w_m2_sr", "_m2"))}
            shades, white = grey(folder / label["image"]), float(label["white_w_m2_sr"])
            stored = self.pixels((folder / label["image"]).with_suffix(".exr"))
            pixel_m2 = (float(label["pixel_rad"]) * float(label["range_m"])) ** 2
            area_px = float(label["target_area_px"])
            self.assertAlmostEqual(area_px * pixel_m2, r["projected_area_m2"], delta=1e-9 * r["projected_area_m2"])
            path, sea = r["path_radiance_w_m2_sr"], r["background_radiance_w_m2_sr"]
            gain = (r["apparent_intensity_w_sr"] - r["projected_area_m2"] * path) / r["intensity_w_sr"]
            filled = self.filled(label["row"])
            self.assertAlmostEqual(sum(map(sum, filled)), area_px, delta=0.02 * area_px)
            for y, line in enumerate(stored):
                for x, radiance in enumerate(line):
                    is_ = gain * radiance + filled[y][x] * path + (1 - filled[y][x]) * sea
                    self.assertLessEqual(abs(shades[y][x] - 255 * is_ / white), 0.51, (label["image"], x, y))

    IMAGER = """name = "test"
[optics]
aperture_m = 0.05
f_number = 0.5
[detector]
pitch_m = 15e-6
netd_k = 0.02
fixed_pattern_k = 0.01
margin_px = 16
[counts]
bits = 16
black_k = 250
white_k = 420
"""

    def imager(self, name, change=("", "")):
        file = self.path / name
        file.write_text(self.IMAGER.replace(*change))
        return ("--thumbnails", "--sweep", "quickstart", "--background", "--imager", file)

    def test_counts_of_an_imager(self):
        chosen = (*self.imager("camera.toml"), "--masks", "--coco", "--exr", "--season", "winter")
        folder = self.export("counts", *chosen)
        coco = json.loads((folder / "annotations.json").read_text())
        for label, image, object_ in zip(self.labels(folder), coco["images"], coco["annotations"], strict=True):
            self.assertEqual(label["imager"], "test")
            self.assertNotIn("black_w_m2_sr", label)
            self.assertEqual(float(label["pixel_rad"]), 6e-4)
            counts, mask = grey(folder / label["image"], 16), grey(folder / label["mask"])
            size = (int(label["width_px"]), int(label["height_px"]))
            self.assertEqual(size, (image["width"], image["height"]))
            for pixels in (counts, mask):
                self.assertEqual((len(pixels[0]), len(pixels)), size)
            self.assertEqual(label["saturated_px"], "0")
            # What the counts say of the radiance: the row's contrast, less the tails of the point spread beyond the margin (0.4 %).
            gain, offset = float(label["counts_per_w_m2_sr"]), float(label["offset_counts"])
            noiseless = self.pixels((folder / label["image"]).with_suffix(".noiseless.exr"))
            pixel_m2 = (6e-4 * float(label["range_m"])) ** 2
            sea, contrast = float(label["background_radiance_w_m2_sr"]), float(label["contrast_intensity_w_sr"])
            sent = pixel_m2 * sum(v - sea for line in noiseless for v in line)
            self.assertAlmostEqual(sent, contrast, delta=0.015 * contrast + float(label["contrast_numerical_error_w_sr"]))
            # Noise and fixed pattern, by the deviation from the noiseless image.
            off = [c - gain * v - offset for row, line in zip(counts, noiseless, strict=True) for c, v in zip(row, line, strict=True)]
            rms = (sum(x * x for x in off) / len(off)) ** 0.5
            stated = gain * float(label["noise_w_m2_sr"]) * 1.25 ** 0.5
            self.assertAlmostEqual(rms, (stated ** 2 + 1 / 12) ** 0.5, delta=4 * stated / (2 * len(off)) ** 0.5)
            # Masks and labels lie on the imager's pixels.
            area_px = float(label["target_area_px"])
            self.assertAlmostEqual(area_px * pixel_m2, float(label["projected_area_m2"]), delta=1e-6 * float(label["projected_area_m2"]))
            self.assertAlmostEqual(object_["area"], area_px, delta=0.02 * area_px)
            self.assertTrue(min(object_["bbox"][:2]) >= 16 and object_["bbox"][0] + object_["bbox"][2] <= size[0] - 16)
            self.assertEqual([int(label[f"box_{n}_px"]) for n in ("left", "top")], [16, 16])
            self.assertLess(abs(sum(m > 0 for line in mask for m in line) - area_px), 0.2 * area_px)
        same = lambda folder: {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
        # Rows of a slice have other numbers and the same counts.
        irsig("slice", self.db, "--sweep", "quickstart", "--season", "winter", "--out", self.path / "cut.sigdb")
        irsig("export", self.path / "cut.sigdb", *chosen, "--out", self.path / "cut")
        for whole, part in zip(self.labels(folder), self.labels(self.path / "cut"), strict=True):
            self.assertEqual((folder / whole["image"]).read_bytes(), (self.path / "cut" / part["image"]).read_bytes())
        # A call that ends early, here for want of room in its table, is gone on with by the same imager alone.
        partial, question = self.path / "early.partial", ("--out", self.path / "early")
        small = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
        early = subprocess.run([IRSIG, "export", self.db, *map(str, (*chosen, *question))], capture_output=True, preexec_fn=small)
        self.assertTrue(early.returncode != 0 and (partial / "progress").exists(), early.stderr)
        other = self.imager("other.toml", ("netd_k = 0.02", "netd_k = 0.03"))
        self.assertIn("another export", irsig("export", self.db, *other, *chosen[len(other):], *question, expect=2).stderr)
        irsig("export", self.db, *chosen, *question)
        self.assertEqual(same(self.path / "early"), same(folder))
        # Hotter than white in places: the counts end at full scale.
        for bits, full in ((8, 255), (14, 16383)):
            few = self.export(f"bits{bits}", *self.imager("few.toml", ("bits = 16\nblack_k = 250\nwhite_k = 420", f"bits = {bits}\nblack_k = 250\nwhite_k = 290")), "--row", "1")
            label, counts = self.labels(few)[0], grey(few / "images/0000001.png", 8 if bits == 8 else 16)
            self.assertEqual(max(map(max, counts)), full)
            self.assertTrue(0 < int(label["saturated_px"]) <= sum(c in (0, full) for line in counts for c in line))

    def test_the_imager_of_a_sweep_is_applied_by_default(self):
        file = self.path / "of_file.toml"
        file.write_text(self.IMAGER)
        tables = self.IMAGER.replace('name = "test"', '[imager]\nname = "test"')
        for name in ("optics", "detector", "counts"):
            tables = tables.replace(f"[{name}]", f"[imager.{name}]")
        sweep, db = self.path / "recorded.toml", self.path / "recorded.sigdb"
        text = (self.path / "quickstart.toml").read_text()
        sweep.write_text(text + tables)
        # A camera computes nothing anew: the rows are those of the sweep without it.
        shutil.copy(self.db, db)
        self.assertIn("0 of 3 jobs to compute", irsig("run", sweep, "--db", db, "--workers", "1").stderr)
        self.assertEqual(*(irsig("digest", d).stdout.split()[0] for d in (self.db, db)))
        one = lambda *options: {p.name: p.read_bytes() for p in self.exported(db, *options).rglob("*.png")}
        chosen = ("--thumbnails", "--sweep", "quickstart", "--season", "winter")
        said = irsig("export", db, *chosen, "--out", self.path / "said").stderr
        self.assertIn("counts of test as [imager] of the sweep states it", said)
        by_sweep = {p.name: p.read_bytes() for p in (self.path / "said").rglob("*.png")}
        self.assertEqual(by_sweep, one(*chosen, "--background", "--imager", file))
        self.assertEqual(one(*chosen, "--no-imager"), {p.name: p.read_bytes() for p in self.exported(self.db, *chosen).rglob("*.png")})
        self.assertNotEqual(by_sweep, one(*chosen, "--no-imager", "--background"))
        # A stored radiance is asked for: it is exported, with words.
        said = irsig("export", db, *chosen, "--bits", "16", "--out", self.path / "sixteen").stderr
        self.assertIn("[imager] of the sweep is not applied: --bits", said)
        # Sweeps whose cameras differ have no common one.
        said = irsig("export", db, "--thumbnails", "--out", self.path / "no", expect=2).stderr
        self.assertIn("choose one sweep with --sweep", said)
        # The picture is of the same counts, and so is its scale.
        irsig("plot", db, "--sweep", "quickstart", "--kind", "picture", "--row", "1", "--out", self.path / "counts.svg")
        drawn = (self.path / "counts.svg").read_text()
        self.assertIn("Counts of test, 16 bits", drawn)
        irsig("plot", db, "--sweep", "quickstart", "--kind", "picture", "--row", "1", "--no-imager", "--out", self.path / "plain.svg")
        self.assertNotIn("Counts", (self.path / "plain.svg").read_text())
        said = irsig("plot", db, "--sweep", "quickstart", "--kind", "picture", "--row", "1", "--pixels", "32", "--out", self.path / "no.svg", expect=2).stderr
        self.assertIn("--no-imager", said)

    def exported(self, db, *options):
        """The folder of an export that there was not yet."""
        self.exports = getattr(self, "exports", 0) + 1
        folder = self.path / f"exported{self.exports}"
        irsig("export", db, *options, "--out", folder)
        return folder

    def test_an_imager_that_cannot_be_is_refused(self):
        chosen = self.imager("camera.toml")
        for options, why in (((*chosen, "--bits", "16"), "excludes"), ((*chosen, "--thumbnail-scale", "own"), "excludes"),
                             ([o for o in chosen if o != "--background"], "add --background"),
                             (self.imager("bits.toml", ("bits = 16", "bits = 12")), "bits.toml:11:1: counts.bits = 12, expected 8, 14 or 16"),
                             (self.imager("long.toml", ("f_number = 0.5", "f_number = 2")), "[output] thumbnail_px = ")):
            said = irsig("export", self.db, *options, "--out", self.path / "no", expect=2).stderr
            self.assertIn(why, said)
            self.assertFalse((self.path / "no").exists() or (self.path / "no.partial").exists())

    def filled(self, row, has=lambda part: True):
        """[row][column] Fraction of each pixel that the parts fill, by the description of the tables."""
        with sqlite3.connect(f"file:{self.db}?mode=ro", uri=True) as db:
            job, = db.execute("SELECT s.job_id FROM signature s JOIN signature_view v USING (signature_id) "
                              "WHERE v.row = ? AND v.sweep = 'quickstart'", (int(row),)).fetchone()
            width, height, samples = db.execute("SELECT width_px, height_px, pixel_samples FROM silhouette WHERE job_id = ?", (job,)).fetchone()
            out = [[0.0] * width for _ in range(height)]
            for part, left, top, w, h, packed in db.execute(
                    "SELECT p.name, x.left_px, x.top_px, x.width_px, x.height_px, x.samples FROM part_pixels x JOIN part p USING (part_id) "
                    "WHERE x.job_id = ?", (job,)):
                counts = struct.unpack(f"<{w * h}H", zlib.decompress(packed))
                for i, count in enumerate(counts):
                    out[top + i // w][left + i % w] += count / samples if has(part) else 0
        return out

    def test_masks_and_objects_are_those_of_the_silhouette(self):
        funnel = lambda part: part.startswith("funnel")
        folder = self.export("coco", "--thumbnails", "--sweep", "quickstart", "--masks", "--coco", "--bits", "16", "--thumbnail-scale", "0,40",
                             "--category", "ship=*", "--category", "stack=funnel*,nothing", "--validation", "0.4", "--split-seed", "3")
        value = {r["part"]: int(r["value"]) for r in table((folder / "parts.csv").read_text())}
        rows = self.labels(folder)
        self.assertEqual({r["split"] for r in rows}, {"train", "validation"})
        side = {}
        for r in rows:  # all images of a viewpoint are on one side
            self.assertEqual(side.setdefault((r["aspect_azimuth_deg"], r["aspect_elevation_deg"]), r["split"]), r["split"])
        seen = 0
        for split in ("train", "validation"):
            labels = json.loads((folder / f"{split}.json").read_text())
            self.assertEqual([c["name"] for c in labels["categories"]], ["ship", "stack"])
            images = {i["id"]: i for i in labels["images"]}
            self.assertEqual([i["file_name"] for i in labels["images"]], [r["image"] for r in rows if r["split"] == split])
            ids = [a["id"] for a in labels["annotations"]]
            self.assertEqual(len(set(ids)), len(ids))
            for a in labels["annotations"]:
                seen += 1
                image = images[a["image_id"]]
                filled = self.filled(image["row"], funnel if a["category_id"] == 2 else lambda part: True)
                self.assertAlmostEqual(a["area"], sum(map(sum, filled)), delta=1e-5 * a["area"])
                inside = {(x, y) for y, line in enumerate(filled) for x, f in enumerate(line) if f >= 0.5 - 1e-9}
                # Runs outside and inside by turns, down the columns.
                height, width = a["segmentation"]["size"]
                self.assertEqual((width, height), (image["width"], image["height"]))
                flat = [bool(i % 2) for i, n in enumerate(a["segmentation"]["counts"]) for _ in range(n)]
                self.assertEqual(len(flat), width * height)
                self.assertEqual({(i // height, i % height) for i, on in enumerate(flat) if on}, inside)
                left, top = min(x for x, _ in inside), min(y for _, y in inside)
                self.assertEqual(a["bbox"], [left, top, max(x for x, _ in inside) - left + 1, max(y for _, y in inside) - top + 1])
                self.hold(a["rectangle"], inside, a["bbox"])
                if a["category_id"] == 1:
                    mask = grey(folder / "masks" / pathlib.Path(image["file_name"]).name)
                    self.assertEqual({(x, y) for y, line in enumerate(mask) for x, v in enumerate(line) if v}, inside)
                    self.assertLessEqual({v for line in mask for v in line}, {0, *value.values()})
                    stack = {v for part, v in value.items() if funnel(part)}
                    # Of a part that fills most of a pixel; of three parts in one, another may fill most of it.
                    alone = {(x, y) for part in value if funnel(part)
                             for y, line in enumerate(self.filled(image["row"], lambda name: name == part))
                             for x, f in enumerate(line) if f > 0.5}
                    self.assertLessEqual(alone, {(x, y) for y, line in enumerate(mask) for x, v in enumerate(line) if v in stack})
        self.assertGreater(seen, 18)
        pixels, shades = self.pixels_of(rows[0]), grey(folder / rows[0]["image"], 16)
        for line, shade in zip(pixels, shades, strict=True):
            for radiance, is_ in zip(line, shade, strict=True):
                self.assertLessEqual(abs(65535 * min(radiance, 40) / 40 - is_), 0.51)

    def hold(self, rectangle, inside, box):
        """All pixels are in the rectangle, which is no larger than the box."""
        corners = list(zip(rectangle[::2], rectangle[1::2]))
        a, b, _, d = corners
        u, v = (b[0] - a[0], b[1] - a[1]), (d[0] - a[0], d[1] - a[1])
        uu, vv = u[0] ** 2 + u[1] ** 2, v[0] ** 2 + v[1] ** 2
        self.assertAlmostEqual(u[0] * v[0] + u[1] * v[1], 0, delta=1e-3 * (uu * vv) ** 0.5)
        self.assertLessEqual((uu * vv) ** 0.5, box[2] * box[3] * (1 + 1e-4))
        for x, y in inside:
            for p in ((x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)):
                for w, ww in ((u, uu), (v, vv)):
                    along = ((p[0] - a[0]) * w[0] + (p[1] - a[1]) * w[1]) / ww
                    self.assertTrue(-1e-3 < along < 1 + 1e-3, (rectangle, p))

    def pixels_of(self, label):
        folder = self.path / "radiances"
        if not folder.exists():
            self.export("radiances", "--thumbnails", "--exr", "--sweep", "quickstart")
        return self.pixels((folder / label["image"]).with_suffix(".exr"))

    def test_a_partial_without_a_journal_is_made_anew(self):
        """What an end between two removals leaves, or one before the first step."""
        partial = self.path / "anew.partial"
        (partial / "images").mkdir(parents=True)
        (partial / "masks").mkdir()
        for old in ("images/0000099.png", "masks/0000099.png", "train.json", "parts.csv", "labels.csv"):
            (partial / old).write_text("of another question")
        folder = self.export("anew", "--thumbnails", "--coco", "--category", "ship=*", "--row", "3", "--sweep", "quickstart")
        self.assertEqual(sorted(p.name for p in folder.rglob("*") if p.is_file()), ["0000003.png", "annotations.json", "labels.csv"])
        # A category takes one text, not the database behind it.
        irsig("export", "--thumbnails", "--coco", "--category", "ship=*", self.db, "--row", "3", "--sweep", "quickstart", "--out", self.path / "behind")

    def test_a_missing_silhouette_is_damage(self):
        damaged = self.path / "missing.sigdb"
        shutil.copy(self.db, damaged)
        with sqlite3.connect(damaged) as db:
            db.execute("DELETE FROM part_pixels WHERE job_id = 1")
            db.execute("DELETE FROM silhouette WHERE job_id = 1")
        self.assertIn("images that are damaged", irsig("doctor", damaged, expect=1).stdout)

    def test_pixels_have_errors(self):
        folder = self.export("errors", "--thumbnails", "--exr", "--sweep", "quickstart")
        for label in self.labels(folder):
            path = folder / label["image"]
            radiance, error = self.pixels(path.with_suffix(".exr")), self.pixels(path.with_suffix(".stderr.exr"))
            filled = self.filled(label["row"])
            inner = [(r, e) for lines in zip(radiance, error, filled, strict=True) for r, e, f in zip(*lines, strict=True) if f == 1]
            self.assertTrue(all(e > 0 for _, e in inner), label["image"])
            self.assertLess(sorted(e / r for r, e in inner)[len(inner) // 2], 0.05, label["image"])

    def test_what_is_of_thumbnails_is_refused_elsewhere(self):
        for options in (("--masks",), ("--coco",), ("--bits", "16"), ("--validation", "0.2"), ("--exr",)):
            said = irsig("export", self.db, "--out", self.path / "no.csv", *options, expect=2).stderr
            self.assertIn(f"{options[0]}: belongs to the format thumbnails", said)
        for options, why in ((("--category", "ship=*"), "belong to --coco"), (("--coco", "--category", "ship"), "expected NAME=PATTERN,PATTERN"),
                             (("--validation", "1"), "expected a fraction"), (("--bits", "12"), "expected one of 8, 16, 32"),
                             (("--coco", "--each-part", "--category", "ship=*"), "excludes")):
            self.assertIn(why, irsig("export", self.db, "--thumbnails", "--out", self.path / "no", *options, expect=2).stderr)
            self.assertFalse((self.path / "no").exists() or (self.path / "no.partial").exists())

    def test_an_export_that_was_killed_goes_on(self):
        chosen = ("--thumbnails", "--exr", "--masks", "--coco", "--validation", "0.4")
        question = (*chosen, "--out", self.path / "k")
        partial = self.path / "k.partial"
        whole = self.export("k0", *chosen)
        # Killed at some moment; then gone on with by the same question alone.
        for wait_s in (0.05, 0.15, 0.3):
            process = subprocess.Popen([IRSIG, "export", self.db, *question], stderr=subprocess.DEVNULL)
            time.sleep(wait_s)
            process.send_signal(signal.SIGKILL)
            process.wait()
            self.assertFalse((self.path / "k").exists() and partial.exists())
        if partial.exists() and (partial / "progress").exists():
            other = irsig("export", self.db, *question, "--band", "lwir", expect=2)
            self.assertIn("is of another export", other.stderr)
        if not (self.path / "k").exists():
            irsig("export", self.db, *question)
        same = lambda folder: {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
        self.assertEqual(same(self.path / "k"), same(whole))
        self.assertFalse(partial.exists())

    def test_a_journal_is_gone_on_with(self):
        """What an end in between leaves: all images looked at, none painted, half a table."""
        folder, partial = self.path / "j", self.path / "j.partial"
        question = ("--thumbnails", "--sweep", "other", "--out", folder)
        whole = self.export("j0", "--thumbnails", "--sweep", "other")
        irsig("export", self.db, *question)
        os.rename(folder, partial)
        (partial / "progress").write_text("of something else\n0 0 0 0 0\n")
        self.assertIn("another export", irsig("export", self.db, *question, expect=2).stderr)
        (partial / "progress").unlink()
        with open(partial / "labels.csv", "a") as f:
            f.write("torn")
        (partial / "progress.10366.partial").write_text("half a journal")
        irsig("export", self.db, *question)
        self.assertEqual((folder / "labels.csv").read_text(), (whole / "labels.csv").read_text())
        self.assertEqual(sorted(os.listdir(folder)), sorted(os.listdir(whole)))

    def damaged(self, *statements):
        copy = self.path / "damaged.sigdb"
        shutil.copy(self.db, copy)
        connection = sqlite3.connect(copy)
        for statement in statements:
            self.assertGreater(connection.execute(statement).rowcount, 0)
        connection.commit()
        connection.close()
        return copy

    def test_damaged_images_are_named_and_leave_nothing(self):
        """Once "irsig-picture: -: image: Failed OpenEXR read", of no row, and a folder that could not be gone on with; and a
        damaged PNG written with exit code 0."""
        of_row = ("WHERE signature_id = (SELECT signature_id FROM signature_view WHERE sweep = 'quickstart' AND row = 7)")
        db = self.damaged(f"UPDATE thumbnail SET png = substr(png, 1, 100), exr = substr(exr, 1, length(exr) - 100) {of_row}")
        row, one = ("--sweep", "quickstart", "--row", 7), self.path / "one.png"
        before = sorted(os.listdir(self.path))
        for options in ((), ("--thumbnail-scale", "own"), ("--thumbnail-scale", "0,9"), ("--background",), ("--exr",)):
            said = irsig("export", db, "--thumbnails", "--out", self.path / "d", *options, expect=1).stderr
            self.assertIn("the stored image of row 7 of sweep quickstart (images/1-0000007.png) is damaged", said)
        self.assertIn("row 7 (images/0000007.png)", irsig("export", db, "--thumbnails", "--sweep", "quickstart", "--out", self.path / "d", expect=1).stderr)
        self.assertIn("the stored image of row 7 is damaged", irsig("query", db, *row, "--thumbnail", one, expect=1).stderr)
        self.assertIn("the stored image of row 7 is damaged", irsig("query", db, *row, "--thumbnail", self.path / "one.exr", expect=1).stderr)
        self.assertIn("of row 7 is damaged", irsig("query", db, *row, "--thumbnail", one, "--thumbnail-scale", "0,9", expect=1).stderr)
        self.assertIn("the stored image of row 7 is damaged", irsig("plot", db, "--kind", "picture", *row, "--out", self.path / "one.svg", expect=1).stderr)
        same_band = ("--sweep", "quickstart", "--row", 9, "--thumbnail", one, "--thumbnail-scale", "common")
        self.assertIn("of the images that share the scale one cannot be read", irsig("query", db, *same_band, expect=1).stderr)
        self.assertEqual(sorted(os.listdir(self.path)), before)
        irsig("export", db, "--thumbnails", "--sweep", "other", "--out", self.path / "d")
        shutil.rmtree(self.path / "d")

    def test_more_pixels_than_the_sweep_asked_for_are_not_decoded(self):
        """One of 1.6 MB that stated 20 000 x 20 000 pixels took 4.7 GB."""
        connection = sqlite3.connect(self.db)
        identity, exr = connection.execute("SELECT signature_id, exr FROM thumbnail WHERE signature_id = (SELECT signature_id FROM signature_view "
                                           "WHERE sweep = 'quickstart' AND row = 7)").fetchone()
        connection.close()
        window = exr.index(b"dataWindow\0box2i\0") + len(b"dataWindow\0box2i\0") + 4
        large = exr[:window] + struct.pack("<4i", 0, 0, 19999, 19999) + exr[window + 16:] + bytes(20000 * 8)
        db = self.damaged(f"UPDATE thumbnail SET exr = x'{large.hex()}', width_px = 20000, height_px = 20000 WHERE signature_id = {identity}")
        row, one = ("--sweep", "quickstart", "--row", 7), self.path / "one.png"
        said = "the stored image of row 7 is damaged: image: its header states 20000 x 20000 pixels, expected sides of at most 128"
        self.assertIn(said, irsig("query", db, *row, "--thumbnail", one, "--thumbnail-scale", "0,9", expect=1).stderr)
        self.assertIn(said, irsig("query", db, *row, "--thumbnail", self.path / "one.exr", expect=1).stderr)
        self.assertIn(said, irsig("plot", db, "--kind", "picture", *row, "--out", self.path / "one.svg", expect=1).stderr)
        self.assertIn("states 20000 x 20000 pixels", irsig("export", db, "--thumbnails", "--out", self.path / "d", expect=1).stderr)
        self.assertFalse((self.path / "d.partial").exists())

    def test_folders_with_tabs_and_newlines(self):
        """Once "irsig-picture: no two files", and a call that waited for ever: paths passed between the programs in lines."""
        odd = self.path / "a\tb\nc"
        odd.mkdir(exist_ok=True)
        whole = self.export("plain", "--thumbnails", "--sweep", "other")
        irsig("export", self.db, "--thumbnails", "--sweep", "other", "--out", odd / "t", env={**os.environ, "TMPDIR": str(odd)})
        same = lambda folder: {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
        self.assertEqual(same(odd / "t"), same(whole))
        irsig("query", self.db, "--sweep", "other", "--row", 1, "--thumbnail", odd / "one.png", "--thumbnail-scale", "common", env={**os.environ, "TMPDIR": str(odd)})
        self.assertEqual((odd / "one.png").read_bytes()[1:4], b"PNG")

    def test_what_a_spreadsheet_would_run_is_text(self):
        """Of a database that somebody else has written: sweep files have no such names."""
        evil = '=HYPERLINK("http://x","a")'
        db = self.damaged("UPDATE condition SET season = '" + evil + "' WHERE season = 'winter'", "UPDATE part SET name = '@SUM(1)' WHERE name = 'hull'")
        question = ("--sweep", "quickstart", "--band", "lwir")
        before = table(irsig("query", self.db, *question, "--csv", "--causes").stdout)
        for command in (("query", db, *question, "--csv", "--causes"), ("export", db, *question, "--out", "-")):
            text = irsig(*command).stdout
            rows = table(text)
            self.assertEqual({r["season"] for r in rows}, {"'" + evil, "spring", "summer"})
            self.assertIsNone(re.search(r'(^|,)"?[=@+]', text, re.M), text[:2000])
            for now, then in zip(rows, before):
                for key in then:
                    if key in now and key != "season":
                        self.assertEqual(now[key], then[key])
        self.assertIn(json.dumps(evil), irsig("query", db, *question, "--json").stdout)
        self.assertIn("-", irsig("query", db, *question, "--csv").stdout)

    def test_gas_has_no_picture_before_a_background(self):
        db = self.damaged("UPDATE signature SET plume_w_sr = 1, plume_stderr_w_sr = 0.1 WHERE signature_id > 9")
        # A folder of that name that holds something else stays.
        for there in ((), ("mine.txt",)):
            partial = self.path / "gas.partial"
            for name in there:
                partial.mkdir()
                (partial / name).touch()
            for options in ((), ("--thumbnail-scale", "own"), ("--thumbnail-scale", "0,9", "--exr")):
                said = irsig("export", db, "--thumbnails", "--background", "--out", self.path / "gas", *options, expect=2).stderr
                self.assertIn("has hot gas", said)
                self.assertFalse((self.path / "gas").exists())
                self.assertEqual(os.listdir(partial) if partial.exists() else [], list(there))
        shutil.rmtree(partial)

    def test_a_cube_of_each_sweep_and_of_dates(self):
        import numpy
        import xarray
        file = self.export("both.nc")
        for sweep in ("quickstart", "other"):
            with xarray.open_dataset(self.export("one.nc", "--sweep", sweep)) as one, xarray.open_dataset(file, group=sweep) as same:
                xarray.testing.assert_identical(one, same)
        dated = self.export("summer.nc", "--sweep", "other", "--season", "summer", "--band", "mwir")
        with xarray.open_dataset(dated) as d, xarray.open_dataset(file, group="other") as whole:
            day = d.sel(season="summer", band="mwir", time="2025-06-21T01:30")
            same = whole.sel(season="summer", band="mwir").swap_dims(time_of_day="time").sel(time="2025-06-21T01:30")
            self.assertEqual(day["intensity_w_sr"].values.ravel().tolist(), same["intensity_w_sr"].values.ravel().tolist())
            self.assertTrue(numpy.isfinite(day["intensity_w_sr"].values).all())
            again = self.path / "again.nc"
            day.to_netcdf(again)
        with xarray.open_dataset(again) as copy:
            self.assertEqual(copy["lambda_um"].attrs["bounds"], "lambda_bounds_um")
            self.assertEqual(copy["contrast_intensity_w_sr"].values.tolist(), day["contrast_intensity_w_sr"].values.tolist())
        for f in (file, dated):
            self.assertIn("no signature matches", irsig("export", self.db, "--out", f, "--max-relative-error", "1e-12", expect=2).stderr)

    def read_tsf(self, path):
        """STK's target signature file, by its public description: keywords and numbers with blanks or tabs between them, of any case;
        TIME, RHO and THETA hold for what follows. {(time, rho, theta): {wavelength: W/(sr um)}} and the axes."""
        axes, now, out = {"RHOAXIS": "RHOFROMX", "THETAAXIS": "THETAFROMZ"}, {"TIME": 0.0, "RHO": None, "THETA": None}, {}
        for line in path.read_text().splitlines():
            word, *rest = line.split()
            if word.upper() in axes:
                axes[word.upper()] = rest[0].upper()
            elif word.upper() == "INTENSITY":
                lambda_um, value = map(float, rest)
                spectrum = out.setdefault((now["TIME"], now["RHO"], now["THETA"]), {})
                self.assertNotIn(lambda_um, spectrum)
                self.assertTrue(not spectrum or lambda_um > max(spectrum))
                spectrum[lambda_um] = value
            else:
                now[word.upper()] = float(rest[0])
                self.assertTrue(-180 <= (now["THETA"] or 0) <= 180 and 0 <= (now["RHO"] or 0) <= 180)
        return out, axes

    def test_a_target_signature_file(self):
        import math
        sweep = self.path / "ring.toml"
        text = (ROOT / "jobs/examples/quickstart.toml").read_text().replace('name = "quickstart"', 'name = "ring"')
        text = re.sub(r"(?ms)^\[viewpoints\].*?(?=^\[)", '[viewpoints]\nkind = "ring"\ncount = 4\nelevation_deg = [5, 90]\nrange_m = 5000\n', text)
        text = re.sub(r"(?m)^time = .*", 'time = ["10:30+09:00", "10:35+09:00"]', text)
        sweep.write_text(text)
        irsig("run", sweep, "--db", self.path / "ring.sigdb", "--relative-error", "0.1")
        choice = ("--season", "summer", "--band", "lwir")
        file = self.path / "ring.tsf"
        said = irsig("export", self.path / "ring.sigdb", *choice, "--out", file).stderr
        self.assertIn("TIME 0 is 2025-06-21T01:30:00Z", said)
        self.assertNotIn("no grid", said)
        found, axes = self.read_tsf(file)
        self.assertEqual(axes, {"RHOAXIS": "RHOFROMZ", "THETAAXIS": "THETAFROMX"})
        self.assertEqual({key[0] for key in found}, {0, 300})
        self.assertEqual({key[1:] for key in found}, {(rho, theta) for rho in (95, 180) for theta in (-180, -90, 0, 90, 180)})
        rows = table(irsig("query", self.path / "ring.sigdb", *choice, "--spectrum", "--csv").stdout)
        self.assertEqual(len(rows), 2 * 8 * 81)
        for row in rows:
            # The direction as a vector of the body's axes (forward, starboard, down), once from each pair of angles.
            azimuth, elevation = (math.radians(float(row[f"aspect_{n}_deg"])) for n in ("azimuth", "elevation"))
            towards = (math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), -math.sin(elevation))
            time = 300 if "01:35" in row["time_utc"] else 0
            theta = (float(row["aspect_azimuth_deg"]) + 180) % 360 - 180  # at the pole each has a row of its own
            of_row = [key for key in found if key[0] == time and abs((key[2] - theta + 180) % 360 - 180) < 1e-6 and all(abs(a - b) < 1e-6 for a, b in zip(towards, (
                math.sin(math.radians(key[1])) * math.cos(math.radians(key[2])),
                math.sin(math.radians(key[1])) * math.sin(math.radians(key[2])), math.cos(math.radians(key[1])))))]
            self.assertTrue(of_row, row)
            for key in of_row:
                value = found[key][float(row["lambda_um"])]
                self.assertAlmostEqual(value, float(row["spectral_intensity_w_sr_um"]), delta=2e-6 * value)
        # One direction and time: the file says nothing of either.
        irsig("export", self.path / "ring.sigdb", "--row", "1", "--out", file)
        self.assertEqual(set(self.read_tsf(file)[0]), {(0, None, None)})
        said = irsig("export", self.db, "--sweep", "other", *choice, "--out", file).stderr
        self.assertIn("no grid of rho and theta", said)
        for options, text in ((("--season", "summer"), 'one band, but there are "mwir" and "lwir": choose one with --band'),
                              (("--band", "lwir"), "choose one with --season"),
                              ((*choice, "--quantity", "contrast_intensity"), "STK puts its own air")):
            self.assertIn(text, irsig("export", self.path / "ring.sigdb", *options, "--out", self.path / "n.tsf", expect=2).stderr)
        self.assertFalse((self.path / "n.tsf").exists())

    def test_an_unknown_ending_is_an_error(self):
        for ending in (".h5", ".xyz", ".TSV", ".dat"):
            said = irsig("export", self.db, "--out", self.path / f"x{ending}", expect=2).stderr
            self.assertIn("no format is known by this ending, expected a name that ends in .csv, .nc, .sli, .tsf, or --format", said)
            self.assertFalse((self.path / f"x{ending}").exists())
        irsig("export", self.db, "--out", self.path / "x.dat", "--format", "csv")
        self.assertIn("intensity_w_sr", (self.path / "x.dat").read_text())

    def test_bad_input(self):
        before = sorted(os.listdir(self.path))
        for options, text in ((("--thumbnail-scale", "3"), "expected common, own, or BLACK,WHITE"),
                              (("--range-m", "20000"), "of the stored range alone"),
                              (("--aspect", "0,10", "--interpolate"), "not interpolated"),
                              (("--season", "autumn"), 'no season "autumn"')):
            self.assertIn(text, irsig("export", self.db, "--thumbnails", "--out", self.path / "x", *options, expect=2).stderr)
        self.assertIn("exists already", irsig("export", self.db, "--thumbnails", "--out", self.path, expect=2).stderr)
        self.assertIn("need a folder", irsig("export", self.db, "--thumbnails", "--out", "-", expect=2).stderr)
        self.assertIn("belongs to the format thumbnails", irsig("export", self.db, "--exr", "--out", self.path / "x.csv", expect=2).stderr)
        self.assertIn("5000 comes twice", irsig("query", self.db, "--range-m", "5000,5000", expect=2).stderr)
        self.assertEqual(sorted(os.listdir(self.path)), before)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:], verbosity=2)
