"""Images with a frame, an accuracy and layers of their own: from [image] of a sweep to databases, plots, exports and Python.

usage: image_layers_test.py <irsig> <repository>
"""
import csv, json, pathlib, sqlite3, struct, subprocess, sys, tempfile, unittest

import numpy

import readme_digest

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
sys.path.insert(0, str(ROOT / "python"))
import irsig as reader  # noqa: E402

LIGHT = ("emitted", "sun", "sky", "surface", "parts", "path", "background")
MEANS = ("temperature", "range", "normal_x", "normal_y", "normal_z", "sunlit")

TITLES = {"temperature": "Temperature in K", "range": "Distance from the sensor in m", "sunlit": "Fraction in the sun",
          **{f"normal_{axis}": "Component of the normal" for axis in "xyz"}}


def irsig(*arguments, expect=0):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == expect, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done


class ImageLayers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        text = (ROOT / "jobs/examples/camera.toml").read_text()
        text = text.replace("[320, 256]", "[64, 48]").replace("triangles = 20000", "triangles = 2000")
        text = text.replace('"range"]', '"range", "normal_x", "normal_y", "normal_z", "sunlit"]')
        text = text.replace("[image]\n", "[image]\nwhole_parts = true\n")
        cls.text = text.replace("pixel_error_percent = 0.5", "pixel_error_percent = 0.1\nmax_samples = 16")
        cls.sweep = cls.path / "camera.toml"
        cls.sweep.write_text(cls.text)
        cls.db = cls.path / "camera.sigdb"
        cls.run_output = irsig("run", cls.sweep, "--db", cls.db, "--workers", "2")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_layers_add_up_in_arrays_of_python(self):
        rows = reader.open(self.db).query()
        self.assertEqual(len(rows), 6)
        self.assertEqual(rows.image_layers()[0], sorted((*LIGHT, "hidden", "at_sensor", *MEANS)))
        for seen, *parts, hidden in zip(rows.images("at_sensor"), *map(rows.images, LIGHT), rows.images("hidden")):
            self.assertEqual(seen.shape, (48, 64))
            numpy.testing.assert_allclose(sum(parts) - hidden, seen, rtol=1e-6)
        stderr = rows.images("at_sensor", stderr=True)[0]
        self.assertTrue((stderr > 0).all() and stderr.max() < 1)
        # Beside the target: what lies between the directions at which the background is known.
        self.assertTrue((sum(rows.silhouettes()[0].values())[:, :3] == 0).all())
        self.assertGreater(stderr[:, 0].max(), 1e-6)
        self.assertEqual(rows.images("at_sensr"), [None] * 6)
        self.assertEqual(rows.images("background", stderr=True), [None] * 6)
        for layer in ("emitted", "sun", "sky", "surface", "parts", "hidden"):
            for value, error in zip(rows.images(layer), rows.images(layer, stderr=True)):
                self.assertEqual(error.shape, value.shape)
                self.assertTrue((error[value != 0] > 0).all(), layer)
                self.assertLess(numpy.sqrt((error.astype(float) ** 2).sum()), numpy.abs(value).sum(dtype=float) + 1e-9, layer)
        temperature, filled = rows.images("temperature")[0], sum(rows.silhouettes()[0].values())
        self.assertEqual(set(temperature[filled == 0]), {0})
        self.assertTrue(((temperature[filled > 0] > 313) & (temperature[filled > 0] < 400.01)).all())
        # From ahead, a little above: facets face the sensor. What is in the sun reflects some of it.
        x, y, z, sunlit = (rows.images(layer)[0] for layer in ("normal_x", "normal_y", "normal_z", "sunlit"))
        self.assertLessEqual(numpy.sqrt(x * x + y * y + z * z).max(), 1 + 1e-6)
        self.assertGreater((x * filled).sum(), 0)
        self.assertTrue(((sunlit >= 0) & (sunlit <= 1) & ((filled > 0) | (sunlit == 0))).all())
        self.assertTrue((rows.images("sun")[0][(sunlit == 0)] == 0).mean() > 0.99 and (sunlit > 0).any())

    def test_the_digest_is_what_the_readme_of_the_schema_defines(self):
        self.assertEqual(irsig("digest", self.db).stdout.split()[0], readme_digest.digest(self.db))

    def test_the_error_that_was_missed_is_said(self):
        said = "pixels are known to"
        self.assertIn(said, self.run_output.stdout + self.run_output.stderr)
        self.assertIn(said, irsig("report", self.db).stdout)
        self.assertIn("0.1 % was asked for; raise [image] max_samples", irsig("report", self.db).stdout)

    def test_any_number_of_workers_gives_the_same_bits(self):
        other = self.path / "one.sigdb"
        irsig("run", self.sweep, "--db", other, "--workers", "1")
        self.assertEqual(irsig("digest", self.db).stdout.split()[0], irsig("digest", other).stdout.split()[0])
        whole = self.path / "slice.sigdb"
        irsig("slice", self.db, "--out", whole)
        self.assertEqual(irsig("digest", self.db).stdout.split()[0], irsig("digest", whole).stdout.split()[0])

    def test_exports_have_the_layers_and_what_the_sensor_sees(self):
        out = self.path / "seen"
        irsig("export", self.db, "--thumbnails", "--background", "--exr", "--bits", "16", "--row", "1", "--out", out)
        layers = (out / "images/0000001.layers.exr").read_bytes()
        for name in (*LIGHT, "hidden", "at_sensor", "at_sensor_stderr", "emitted_stderr", "hidden_stderr", *MEANS):
            self.assertIn(f"{name}.Y\0".encode(), layers[:3000])
        labels = (out / "labels.csv").read_text().splitlines()
        white = float(dict(zip(labels[0].split(","), labels[1].split(",")))["white_w_m2_sr"])
        seen = reader.open(self.db).query(row=1).images("at_sensor")[0]
        self.assertAlmostEqual(white, float(seen.max()), delta=1e-6 * white)
        sun = self.path / "sun"
        irsig("export", self.db, "--thumbnails", "--layer", "sun", "--row", "1", "--out", sun)
        self.assertTrue((sun / "images/0000001.png").exists())
        for options, why in ((("--layer", "temperature"), "is no radiance"), (("--layer", "normal_x"), "is no radiance"), (("--layer", "sunn"), "--layer"),
                             (("--layer", "sun", "--background"), "--layer")):
            self.assertIn(why, irsig("export", self.db, "--thumbnails", *options, "--out", self.path / "none", expect=2).stderr)

    def objects(self, db, *options):
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.path)) / "coco"
        irsig("export", db, "--thumbnails", "--coco", *options, "--out", folder)
        labels = json.loads((folder / "annotations.json").read_text())
        rows = {image["id"]: image["row"] for image in labels["images"]}
        names = {c["id"]: c["name"] for c in labels["categories"]}
        return {(rows[a["image_id"]], names[a["category_id"]]): a for a in labels["annotations"]}

    def test_whole_objects_are_the_rays_that_meet_any_of_their_parts(self):
        rows = reader.open(self.db).query(band="lwir")
        objects = self.objects(self.db, "--band", "lwir", "--category", "ship=*", "--category", "stack=funnel*", "--category", "deck=deck")
        classes = {"ship": lambda part: True, "stack": lambda part: part.startswith("funnel"), "deck": lambda part: part == "deck"}
        hidden = 0
        for number, parts, sets in zip(rows["row"], rows.silhouettes(), rows.part_sets(), strict=True):
            filled = sum(array for array, _ in sets.values())
            numpy.testing.assert_allclose(filled, sum(parts.values()), atol=1e-12)
            for name, has in classes.items():
                whole = sum(array for names, (array, _) in sets.items() if any(map(has, names)))
                seen = sum(array for part, array in parts.items() if has(part))
                self.assertTrue((whole >= seen - 1e-12).all())
                if numpy.max(seen) == 0:
                    self.assertNotIn((number, name), objects)
                    continue
                found = objects[number, name]
                self.assertAlmostEqual(found["whole"]["area"], whole.sum(), delta=1e-5 * whole.sum())
                self.assertAlmostEqual(found["occlusion"], 1 - seen.sum() / whole.sum(), delta=1e-5)
                self.assertEqual(found["truncation"], 0)
                if name == "ship":
                    self.assertAlmostEqual(found["occlusion"], 0, delta=1e-9)
                    self.assertEqual(found["whole"]["segmentation"], found["segmentation"])
                hidden = max(hidden, found["occlusion"])
                flat = [bool(i % 2) for i, n in enumerate(found["whole"]["segmentation"]["counts"]) for _ in range(n)]
                inside = whole >= 0.5 - 1e-9 if whole.max() >= 0.5 else whole > 0
                numpy.testing.assert_array_equal(numpy.array(flat).reshape(64, 48).T, inside)
        self.assertGreater(hidden, 0.1)

    def test_a_camera_that_cuts_the_target_off_says_by_how_much(self):
        near = self.path / "near.toml"
        text = self.text.replace("field_of_view_deg = 1.83", "field_of_view_deg = 0.9").replace("pixel_error_percent = 0.1\nmax_samples = 16", "samples = 16")
        near.write_text(text.replace("whole_parts = true\n", "whole_parts = true\nlook_at_m = [76.9, 0, -5]\n"))
        db = self.path / "near.sigdb"
        irsig("run", near, "--db", db, "--workers", "2")
        rows = reader.open(db).query(band="lwir")
        objects = self.objects(db, "--band", "lwir", "--category", "ship=*")
        folder = self.path / "near"
        irsig("export", db, "--thumbnails", "--band", "lwir", "--out", folder)
        with open(folder / "labels.csv") as file:
            labels = {int(label["row"]): label for label in csv.DictReader(file)}
        cut = []
        for number, area_m2 in zip(rows["row"], rows["projected_area_m2"], strict=True):
            label, found = labels[number], objects[number, "ship"]
            whole_px, shown_px = float(label["target_area_px"]), float(label["target_in_frame_px"])
            self.assertAlmostEqual(shown_px, found["area"], delta=1e-4 * shown_px)
            self.assertAlmostEqual(found["truncation"], 1 - shown_px / whole_px, delta=0.02)
            cut.append(found["truncation"])
        self.assertGreater(max(cut), 0.3)
        self.assertEqual(irsig("digest", db).stdout.split()[0], readme_digest.digest(db))

    def test_plots_show_layers(self):
        for layer in ("at_sensor", *MEANS, "hidden"):
            file = self.path / f"{layer}.svg"
            irsig("plot", self.db, "--kind", "picture", "--layer", layer, "--row", "1", "--out", file)
            self.assertIn(TITLES.get(layer, "W/(m"), file.read_text())
        irsig("plot", self.db, "--kind", "sheet", "--layer", "at_sensor", "--band", "mwir", "--out", self.path / "sheet.svg")

    def test_regions_through_a_day_are_means_of_the_stored_pixels(self):
        text = self.text.replace('["10:30+09:00"]', '["04:00+09:00", "10:00+09:00", "16:00+09:00"]')
        text = text.replace("  { azimuth_deg = 90, elevation_deg = 0.3 },\n  { azimuth_deg = 40, elevation_deg = 20 },\n", "")
        sweep, db, table = (self.path / name for name in ("day.toml", "day.sigdb", "day.csv"))
        sweep.write_text(text)
        irsig("run", sweep, "--db", db, "--workers", "2")
        plot = ("plot", db, "--kind", "regions")
        irsig(*plot, "--region", "ship=20,18,44,28", "--region", "sky=0,0,64,6", "--out", table)
        lines = {(int(l["row"]), l["region"]): l for l in csv.DictReader(table.open())}
        rows = reader.open(db).query()
        self.assertEqual(len(lines), 2 * len(rows))
        for row, seen, stderr, kelvin, parts in zip(range(1, 7), rows.images("at_sensor"), rows.images("at_sensor", stderr=True),
                                                    rows.images("temperature"), rows.silhouettes()):
            filled = sum(parts.values())
            for name, box in (("ship", numpy.s_[18:28, 20:44]), ("sky", numpy.s_[0:6, 0:64])):
                line, target = lines[row, name], filled[box] > 0
                self.assertAlmostEqual(float(line["radiance_w_m2_sr"]), seen[box].mean(dtype=float), places=5)
                error = numpy.hypot(numpy.sqrt((stderr[box][target].astype(float) ** 2).sum()), stderr[box][~target].sum(dtype=float))
                self.assertAlmostEqual(float(line["radiance_stderr_w_m2_sr"]) / (error / seen[box].size), 1, places=4)
                self.assertAlmostEqual(float(line["target_fraction"]), filled[box].mean(dtype=float), places=5)
                if target.any():
                    mean = (filled[box] * kelvin[box].astype(float)).sum() / filled[box].sum(dtype=float)
                    self.assertAlmostEqual(float(line["temperature_k"]), mean, places=2)
                else:
                    self.assertEqual(line["temperature_k"], "")
        drawn = self.path / "day.svg"
        irsig(*plot, "--out", drawn)
        for words in (">hull<", ">whole image<", "Temperature in K", "Local mean solar time"):
            self.assertIn(words, drawn.read_text())
        self.assertIn("beyond the image of 64 x 48 pixels", irsig(*plot, "--region", "a=0,0,65,1", "--out", drawn, expect=2).stderr)

    def test_a_layer_that_is_not_there_or_damaged_has_words(self):
        few = self.path / "few.toml"
        few.write_text(self.text.replace('"range", ', ""))
        bare = self.path / "bare.sigdb"
        irsig("run", few, "--db", bare, "--workers", "2")
        self.assertIn("has no layer range: it has", irsig("plot", bare, "--kind", "picture", "--layer", "range", "--row", "1",
                                                          "--out", self.path / "x.svg", expect=2).stderr)
        connection = sqlite3.connect(bare)
        connection.execute("UPDATE image_layer SET exr = substr(exr, 1, length(exr) / 2) WHERE name = 'sun'")
        connection.commit()
        connection.close()
        self.assertIn("images that are damaged", irsig("doctor", bare, expect=1).stdout)
        with self.assertRaisesRegex(reader.Error, "sun"):
            reader.open(bare).query(row=1).images("sun")


# 2 to 4 m before a sphere of 1 m.
SLAB = '''
[plume]
kind = "slab"
position_m = [3, 0, 0]
length_m = 2
width_m = 2
height_m = 2
temperature_k = 1000
soot = 4e-8
voxel_m = 0.05
'''


class HotGasLayers(unittest.TestCase):
    def test_layers_of_a_plume_add_up_and_are_shown(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            text = (ROOT / "tests/unit/bad_sweeps/image_gas_layers.toml").read_text()
            layers = [*LIGHT, "hidden", "at_sensor", "gas_emitted", "gas_absorbed"]
            text = text.replace('layers = ["gas_emitted"]\n', f"layers = {json.dumps(layers)}\npixel_error_percent = 1\n{SLAB}")
            (path / "gas.toml").write_text(text)
            irsig("run", path / "gas.toml", "--db", path / "gas.sigdb")
            rows = reader.open(path / "gas.sigdb").query()
            of = {name: rows.images(name)[0] for name in layers}
            light = sum(of[name] for name in LIGHT) - of["hidden"] + of["gas_emitted"] - of["gas_absorbed"]
            numpy.testing.assert_allclose(light, of["at_sensor"], rtol=1e-6, atol=1e-6 * of["at_sensor"].max())
            for name in ("gas_emitted", "gas_absorbed"):
                self.assertGreater(of[name].max(), 0.01 * of["at_sensor"].max())
                self.assertGreater(rows.images(name, stderr=True)[0].max(), 0)
            # The gas reaches beyond the sphere and its edge, where it absorbs nothing: the background is black.
            near = numpy.pad(of["emitted"] > 0, 1)
            beside = ~numpy.any([near[y:y + 64, x:x + 64] for y in range(3) for x in range(3)], axis=0)
            self.assertGreater(of["gas_emitted"][beside].max(), 0)
            self.assertEqual(numpy.abs(of["gas_absorbed"][beside]).max(), 0)
            irsig("plot", path / "gas.sigdb", "--kind", "picture", "--layer", "gas_absorbed", "--row", 1, "--out", path / "gas.svg")
            self.assertIn("gas", (path / "gas.svg").read_text())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
