"""A target in the air, and a ship behind the horizon, at the front door.

usage: air_target_test.py <irsig> <folder with the sources>
"""
import pathlib, sqlite3, subprocess, sys, tempfile, unittest

IRSIG, SOURCE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()

# A black sphere 3 km up, in vacuum, seen from 5 km. pi m2 x the band radiance of 320 K: 164.53 W/sr from everywhere.
SPHERE = """
time = ["12:00Z"]
[model]
generate = "sphere"
triangles = 20000
radius_m = 1
OFFSET
[[part]]
name = "sphere"
material = "blackbody"
temperature_k = 320
[[season]]
name = "any"
date = 2025-06-21
[[band]]
name = "b"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.05
[viewpoints]
kind = "list"
range_m = 5000
aspect = [ { azimuth_deg = 90, elevation_deg = -90 }, { azimuth_deg = 90, elevation_deg = -45 }, { azimuth_deg = 90, elevation_deg = 0 },
           { azimuth_deg = 90, elevation_deg = 45 }, { azimuth_deg = 90, elevation_deg = 90 } ]
[surroundings]
kind = "none"
sky_radiance_w_m2_sr_um = 0
lower_radiance_w_m2_sr_um = 0
[air]
model = "vacuum"
[transport]
sun = false
[output]
thumbnail_px = 0
"""
IN_AIR = "[place]\nabove_surface_m = 3000"
SPHERE_W_SR = 164.53

# A ship of 154 m and a mast of 41 m in real air.
SHIP = """
time = ["00:00Z"]
[model]
generate = "frigate"
triangles = 2000
[[part]]
name = "ship"
match = ["*"]
material = "generic_grey_paint"
temperature_k = 300
[[season]]
name = "any"
date = 2025-06-21
wind_speed_m_s = 5
[[band]]
name = "b"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
ASPECTS
[surroundings]
kind = "sea"
sea_temperature_k = 290
[air]
model = "atmosphere"
profile = "midlatitude_summer"
aerosol = "maritime"
visibility_m = 23000
[transport]
sun = false
[accuracy]
relative_error = 0.02
[output]
thumbnail_px = 0
"""


class AirTarget(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def irsig(self, *arguments, exit_code=0):
        done = subprocess.run([IRSIG, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, exit_code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def rows(self, name, text, columns):
        (self.folder / f"{name}.toml").write_text(text)
        self.irsig("run", f"{name}.toml", "--db", f"{name}.sigdb")
        db = sqlite3.connect(self.folder / f"{name}.sigdb")
        out = db.execute(f"SELECT aspect_elevation_deg, {columns} FROM signature_view ORDER BY row").fetchall()
        db.close()
        return out

    def test_a_black_sphere_is_the_same_from_everywhere(self):
        rows = self.rows("sphere", SPHERE.replace("OFFSET", IN_AIR), "intensity_w_sr, numerical_error_w_sr, projected_area_m2")
        self.assertEqual([r[0] for r in rows], [-90, -45, 0, 45, 90])
        for elevation_deg, value, error, area_m2 in rows:
            self.assertLess(error, 0.011 * SPHERE_W_SR)
            self.assertAlmostEqual(value, SPHERE_W_SR, delta=4 * error + 1e-3 * SPHERE_W_SR, msg=elevation_deg)

    def test_offset_m_is_refused_beyond_the_target_s_size_with_the_line_that_is_meant(self):
        for offset, said in (("offset_m = [0, 0, 3000]", "put the target into the air: above_surface_m = 3000 in [place]"),
                             ("offset_m = [900, 0, 0]", "leave offset_m out: viewpoints are where the sensor is")):
            (self.folder / "old.toml").write_text(SPHERE.replace("OFFSET", offset))
            output = self.irsig("run", "old.toml", "--db", "old.sigdb", exit_code=2)
            self.assertIn("old.toml:7:1: model.offset_m: moves the target by ", output)
            self.assertIn(said, output)
            self.assertFalse((self.folder / "old.sigdb").exists())
        # Within its size it keeps its meaning, in the air too.
        (low, *_), = {r[1:] for r in self.rows("near", SPHERE.replace("OFFSET", "offset_m = [0, 0, 2]\n" + IN_AIR)
                                               .replace("relative_error", "").split("aspect = [")[0]
                                               + "aspect = [ { azimuth_deg = 90, elevation_deg = 0 } ]\n[surroundings]"
                                               + SPHERE.split("[surroundings]")[1], "intensity_w_sr")}
        self.assertAlmostEqual(low, SPHERE_W_SR, delta=0.02 * SPHERE_W_SR)

    def test_what_a_height_does_not_go_with(self):
        drone = (SOURCE / "jobs/examples/drone.toml").read_text().replace("../models", str(SOURCE / "jobs/models"))
        for change, said in (
                (("above_surface_m = 500 ", "above_surface_m = -5 "), "place.above_surface_m = -5, expected a number from 0 to 100000"),
                (("above_surface_m = 500 ", "above_surface_m = 400 "), "lies under the ground, and 2 more"),
                (('name = "summer"', 'name = "summer"\nabove_surface_m = 0.5'), "above_surface_m = 0.5, expected a number from 1 to 100000"),
                (("[transport]", '[[profile]]\nname = "p"\nat_m = [0, 0, 0]\nfootprint_width_m = 0.1\nfootprint_height_m = 0.1\n'
                                 "[vary]\nabove_surface_m = [500, 600]\n[transport]"), "[[profile]] needs one above_surface_m"),
                (("[place]\nlatitude_deg = 48\nlongitude_deg = 11\nheading_deg = 30\n", "[place]\n"), "place.latitude_deg is missing")):
            self.assertIn(change[0], drone)
            (self.folder / "wrong.toml").write_text(drone.replace(*change))
            self.assertIn(said, self.irsig("run", "wrong.toml", "--db", "wrong.sigdb", exit_code=2), change)

    def test_the_drone_of_the_examples(self):
        drone = (SOURCE / "jobs/examples/drone.toml").read_text().replace("../models", str(SOURCE / "jobs/models"))
        rows = self.rows("drone", drone.replace("relative_error = 0.01", "relative_error = 0.02\n[output]\nthumbnail_px = 0"),
                         "band, projected_area_m2, intensity_w_sr, contrast_intensity_w_sr, background_radiance_w_m2_sr")
        lwir = {r[0]: r[2:] for r in rows if r[1] == "lwir"}
        self.assertEqual(sorted(lwir), [-90, -60, -30, 0, 30, 90])
        # From above and below its plan, closed forms: a box, four octagons, four bars (make_drone.py).
        octagon_m2 = 2 * 2**0.5 * 0.03**2
        bar_m2 = 0.02 * ((0.2**2 + 0.25**2) ** 0.5 - 0.03 - 0.02)
        plan_m2 = 0.30 * 0.20 + 4 * octagon_m2 + 4 * bar_m2
        for elevation_deg in (-90, 90):
            self.assertAlmostEqual(lwir[elevation_deg][0], plan_m2, delta=0.01 * plan_m2)
        # Against the cold sky it is bright by far; against warm land it hardly shows.
        for elevation_deg in (-90, -60, -30):
            area_m2, intensity, contrast, background = lwir[elevation_deg]
            self.assertGreater(contrast, 0.15 * intensity, elevation_deg)
            self.assertLess(background, 0.8 * lwir[90][3], elevation_deg)
        for elevation_deg in (30, 90):
            self.assertLess(abs(lwir[elevation_deg][2]), 0.3 * lwir[elevation_deg][1], elevation_deg)

    def test_heights_in_one_sweep_are_those_of_sweeps_of_their_own(self):
        drone = (SOURCE / "jobs/examples/drone.toml").read_text().replace("../models", str(SOURCE / "jobs/models"))
        drone = drone.replace("relative_error = 0.01", "samples_per_replicate = 512\n[output]\nthumbnail_px = 0")
        head, tail = drone.split("aspect = [\n")
        drone = head + "aspect = [ { azimuth_deg = 90, elevation_deg = 0, range_m = 50 }, { azimuth_deg = 90, elevation_deg = 40, range_m = 50 } ]\n" \
            + tail.split("]\n", 1)[1]
        columns = "band, season, intensity_w_sr, apparent_intensity_w_sr, contrast_intensity_w_sr, numerical_error_w_sr"
        shared = self.rows("shared", drone.replace("[transport]", "[vary]\nabove_surface_m = [100, 2000]\n[transport]"), columns)
        self.assertEqual(len(shared), 8)
        db = sqlite3.connect(self.folder / "shared.sigdb")
        self.assertEqual(db.execute("SELECT count(DISTINCT job_id) FROM signature").fetchone(), (2,))
        db.close()
        for height_m in (100, 2000):
            alone = self.rows(f"alone{height_m}", drone.replace("above_surface_m = 500 ", f"above_surface_m = {height_m} "), columns)
            here = [r for r in shared if r[2].endswith(f"above_surface_m = {height_m}")]
            self.assertEqual(len(here), len(alone))
            for a, b in zip(alone, here):
                for x, y in zip(a[3:6], b[3:6]):
                    self.assertAlmostEqual(x, y, delta=2 * (a[6] + b[6]), msg=(a, b))

    def test_a_ship_is_seen_as_long_as_its_mast_is(self):
        # A sensor 10 m above the sea; straight lines and a sphere would hide 19, 34 and 39 m.
        def aspect(range_m, height_m=10):
            radius = 6371229
            up = ((radius + height_m) ** 2 - radius**2 - range_m**2) / (2 * radius)
            import math
            return f"{{ azimuth_deg = 90, elevation_deg = {math.degrees(math.asin(up / range_m)):.9f}, range_m = {range_m} }}"
        columns = "range_m, projected_area_m2, apparent_intensity_w_sr, background_radiance_w_m2_sr"
        rows = self.rows("ship", SHIP.replace("ASPECTS", f"aspect = [ {aspect(5000)}, {aspect(27000)}, {aspect(30000)}, {aspect(35000)} ]"),
                         columns)
        areas = [r[2] for r in rows]
        self.assertEqual(areas, sorted(areas, reverse=True))
        self.assertGreater(areas[0], 1500)
        self.assertGreater(areas[3], 0.5)  # of the mast
        self.assertLess(areas[3], 0.05 * areas[0])
        for row in rows:
            self.assertGreater(row[3], 0)
            self.assertGreater(row[4], 0)
        (self.folder / "far.toml").write_text(SHIP.replace("ASPECTS", f"aspect = [ {aspect(50000)} ]"))
        output = self.irsig("run", "far.toml", "--db", "far.sigdb", exit_code=2)
        self.assertIn("viewpoints: the sensor at azimuth 90,", output)
        self.assertIn("has nothing of the target in sight: the Earth hides what is lower than", output)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
