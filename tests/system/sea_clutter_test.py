"""The structure of the sea around a target, at the front door.

usage: sea_clutter_test.py <irsig>
"""
import csv, io, math, pathlib, subprocess, sys, tempfile, unittest

IRSIG = pathlib.Path(sys.argv[1]).resolve()

# A block of 20 x 10 x 10 m on a sea, by night and with the sun in the east, from four places.
SWEEP = """
time = ["00:00Z", "09:00Z"]
[place]
latitude_deg = 40
longitude_deg = 0
heading_deg = HEADING
[model]
generate = "box"
triangles = 12
length_m = 20
width_m = 10
height_m = 10
[[part]]
name = "box"
material = "MATERIAL"
temperature_k = 300
[[season]]
name = "any"
date = 2025-06-21
profile = "midlatitude_summer"
air_temperature_k = 290
relative_humidity_percent = 70
pressure_pa = 101300
wind_speed_m_s = WIND
surroundings = { sea_temperature_k = 290 }
[[band]]
name = "mwir"
lambda_min_um = 3.5
lambda_max_um = 4.1
step_um = 0.1
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ ASPECTS ]
[surroundings]
kind = "sea"
[air]
model = "atmosphere"
aerosol = "maritime"
visibility_m = 23000
[transport]
sun = true
[accuracy]
relative_error = 0.05
[output]
thumbnail_px = 0
"""


class SeaClutter(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def rows(self, name, *, heading=0, wind=6, material="generic_grey_paint", aspects=((105, 30), (285, 30), (105, 10), (105, 80)), sweep=SWEEP):
        file, database = self.folder / f"{name}.toml", self.folder / f"{name}.sigdb"
        views = ", ".join(f"{{ azimuth_deg = {a - heading}, elevation_deg = {e} }}" for a, e in aspects)
        text = sweep.replace("HEADING", str(heading)).replace("WIND", str(wind)).replace("MATERIAL", material).replace("ASPECTS", views)
        file.write_text(text)
        done = subprocess.run([IRSIG, "run", file, "--db", database, "--workers", "1"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        out = subprocess.run([IRSIG, "query", database, "--format", "csv"], capture_output=True, text=True, check=True).stdout
        self.database = database
        found = []
        for row in csv.DictReader(io.StringIO(out)):
            found.append({k: float(v) if v and v.replace(".", "").replace("e", "").replace("-", "").replace("+", "").isdigit() else v
                          for k, v in row.items()})
        return found

    def by(self, rows, azimuth, elevation, band, hour):
        return next(r for r in rows if abs(math.remainder(r["aspect_azimuth_deg"] - azimuth, 360)) < 1e-6 and r["aspect_elevation_deg"] == elevation
                    and r["band"] == band and f"T{hour:02d}" in r["time_utc"])

    def test_its_mean_is_the_background_that_the_target_hides(self):
        rows = self.rows("mean")
        for r in rows:
            with self.subTest(view=(r["aspect_azimuth_deg"], r["aspect_elevation_deg"]), band=r["band"], time=r["time_utc"]):
                self.assertAlmostEqual(r["clutter_mean_w_m2_sr"] / r["background_radiance_w_m2_sr"], 1, delta=0.02)
                self.assertGreater(r["clutter_patch_sigma_w_m2_sr"], 0)
                self.assertLess(r["clutter_patch_sigma_w_m2_sr"], r["clutter_sigma_w_m2_sr"] * (1 + 1e-9))
        # The sea glitters for a sensor that looks towards the sun, in 3.5-4.1 um far more than in 8-12 um.
        def sigma(azimuth, band, hour):
            return self.by(rows, azimuth, 30, band, hour)["clutter_patch_sigma_w_m2_sr"]
        lit, away, night = sigma(285, "mwir", 9), sigma(105, "mwir", 9), sigma(285, "mwir", 0)
        self.assertGreater(lit, 20 * away)
        self.assertGreater(lit, 20 * night)
        self.assertLess(sigma(285, "lwir", 9) / sigma(285, "lwir", 0), 0.5 * lit / night)

    def test_the_turned_world_is_the_same(self):
        a = self.rows("north", heading=0)
        b = self.rows("turned", heading=70)
        for one in a:
            other = self.by(b, one["aspect_azimuth_deg"] - 70, one["aspect_elevation_deg"], one["band"], 9 if "T09" in one["time_utc"] else 0)
            for key in ("clutter_sigma_w_m2_sr", "clutter_correlation_m", "clutter_mean_w_m2_sr"):
                self.assertAlmostEqual(other[key] / one[key], 1, delta=0.02, msg=f"{key} {one['aspect_azimuth_deg']} {one['time_utc']}")

    def test_it_does_not_depend_on_the_target(self):
        """A blackbody needs no light from around: the sea's is computed for its clutter all the same."""
        grey, black = self.rows("grey"), self.rows("black", material="blackbody")
        for a, b in zip(grey, black):
            self.assertAlmostEqual(a["clutter_sigma_w_m2_sr"] / b["clutter_sigma_w_m2_sr"], 1, delta=1e-3)
        # The middle of a block 20 m up is nearer to the sensor than its range, which counts in fog.
        fog = SWEEP.replace('"maritime"', '"radiation_fog"').replace("23000", "800").replace("range_m = 1000", "range_m = 300")
        fog = fog.replace("height_m = 10", "height_m = 10\noffset_m = [0, 0, 20]")
        everything = fog + '[effects]\nmode = "all"\n'
        grey, black = self.rows("grey_fog", sweep=everything), self.rows("black_fog", material="blackbody", sweep=fog)
        for a, b in zip(grey, black):
            with self.subTest(view=(a["aspect_azimuth_deg"], a["aspect_elevation_deg"]), band=a["band"], time=a["time_utc"]):
                self.assertAlmostEqual(a["clutter_mean_w_m2_sr"] / b["clutter_mean_w_m2_sr"], 1, delta=1e-5)

    def test_level_sensors_have_none(self):
        rows = self.rows("level", aspects=((105, 0), (105, 5)))
        self.assertEqual({r["aspect_elevation_deg"]: r["clutter_sigma_w_m2_sr"] != "" for r in rows}, {0: False, 5: True})

    def test_targets_in_the_air_have_none(self):
        """The sea behind them is farther away than they are, behind more air."""
        text = SWEEP.replace("heading_deg = HEADING", "heading_deg = HEADING\nabove_surface_m = 300")
        rows = self.rows("air", sweep=text, aspects=((105, 30),))
        self.assertEqual({r["clutter_sigma_w_m2_sr"] for r in rows}, {""})

    def test_bands_are_chosen_in_it(self):
        self.rows("bands")
        done = subprocess.run([IRSIG, "bands", self.database, "--band", "lwir", "--clutter", "--nei", "1e-9"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("clutter", done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
