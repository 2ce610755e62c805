"""Land through a day: jobs/examples/land_day.toml with fewer hours and pixels against what its paper says in words.

usage: land_day_test.py <irsig> <source folder>
"""
import csv, pathlib, re, subprocess, sys, tempfile, unittest

IRSIG, SOURCE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
HOURS = (0, 6, 8, 10, 12, 13, 14, 16, 20, 23)
# Pixels of the image of 80 x 64.
REGIONS = {"lawn": "32,34,47,38", "road": "67,49,72,50", "river": "24,44,33,49", "wheat": "65,28,76,33",
           "soil": "3,20,15,27", "east_wall": "38,23,46,27", "south_wall": "32,19,34,23"}


def run(*words):
    done = subprocess.run([IRSIG, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


class LandDay(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        folder = pathlib.Path(cls.folder.name)
        text = (SOURCE / "jobs/examples/land_day.toml").read_text()
        times = ", ".join(f'"{h:02}:00+07:00"' for h in HOURS)
        text = re.sub(r"time = \[.*?\n\]", f"time = [{times}]", text, flags=re.S)
        text = text.replace("pixels = [160, 128]", "pixels = [80, 64]").replace("samples = 32", "samples = 4")
        text = re.sub(r'"(\.\./models|land_day)/', lambda m: f'"{SOURCE}/jobs/examples/{m[1]}/', text)
        sweep, cls.db = folder / "day.toml", folder / "day.sigdb"
        sweep.write_text(text)
        run("run", sweep, "--db", cls.db, "--workers", 1)
        table = folder / "regions.csv"
        asked = [word for name, box in REGIONS.items() for word in ("--region", f"{name}={box}")]
        run("plot", cls.db, "--kind", "regions", *asked, "--out", table)
        cls.kelvin, cls.radiance = {}, {}
        with open(table) as file:
            for row in csv.DictReader(file):
                hour = (int(row["time_utc"][11:13]) + 7) % 24
                cls.kelvin[row["region"], hour] = float(row["temperature_k"])
                cls.radiance[row["region"], row["band"], hour] = float(row["radiance_w_m2_sr"])

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_the_road_is_hotter_by_day_than_fields_water_and_building(self):
        for hour in (12, 14):
            for other in ("lawn", "wheat", "river", "east_wall", "south_wall"):
                self.assertGreater(self.kelvin["road", hour], self.kelvin[other, hour] + 8, (other, hour))
                self.assertGreater(self.radiance["road", "mwir", hour], self.radiance[other, "mwir", hour])

    def test_the_river_is_colder_than_land_by_day_and_warmer_at_night(self):
        for other in ("lawn", "wheat", "soil"):
            self.assertLess(self.kelvin["river", 14], self.kelvin[other, 14] - 8, other)
            self.assertGreater(self.kelvin["river", 23], self.kelvin[other, 23] + 1, other)
            self.assertGreater(self.radiance["river", "mwir", 23], self.radiance[other, "mwir", 23], other)

    def test_the_road_stays_warm_longest_of_dry_land(self):
        for other in ("lawn", "wheat", "soil"):
            self.assertGreater(self.kelvin["road", 23], self.kelvin[other, 23] + 1, other)

    def test_the_evening_is_warmer_than_the_morning(self):
        for region in REGIONS:
            if region != "east_wall":  # it has the sun at 6 h
                self.assertGreater(self.kelvin[region, 20], self.kelvin[region, 6], region)

    def test_the_east_wall_is_warm_before_the_south_wall(self):
        peak = {wall: max(HOURS, key=lambda hour: self.kelvin[wall, hour]) for wall in ("east_wall", "south_wall")}
        self.assertLess(peak["east_wall"], peak["south_wall"])
        self.assertGreater(self.kelvin["east_wall", 8], self.kelvin["south_wall", 8] + 5)
        self.assertLess(self.kelvin["east_wall", 16], self.kelvin["south_wall", 16] + 1)

    def test_land_is_hottest_after_noon(self):
        for region in ("lawn", "road", "wheat", "soil"):
            self.assertIn(max(HOURS, key=lambda hour: self.kelvin[region, hour]), (13, 14), region)

    def diagonal(self, hour):
        """Radiances of the pictures a to e along the diagonal of the image in 3-5 um, [place][picture]."""
        table = pathlib.Path(self.folder.name) / f"diagonal{hour}.csv"
        run("plot", self.db, "--kind", "diagonal", "--band", "mwir", "--time", f"2013-07-12T{hour - 7:02}:00:00Z",
            "--out", table)
        pictures = ("without_air", "emitted", "with_sky", "with_sun", "all")
        with open(table) as file:
            return [[float(row[f"{name}_w_m2_sr"]) for name in pictures] for row in csv.DictReader(file)]

    def test_effects_of_air_sky_and_sun_add_up(self):
        day, night = self.diagonal(14), self.diagonal(23)
        for without_air, emitted, with_sky, with_sun, everything in day + night:
            self.assertAlmostEqual(with_sky + with_sun - emitted, everything, delta=1e-6 * everything)
            self.assertGreaterEqual(with_sky, emitted)
            self.assertGreaterEqual(with_sun, emitted)
        # What lies beyond the land is in none of them.
        self.assertAlmostEqual(day[0][0], day[0][4], delta=1e-6)
        self.assertLess(sum(abs(row[0] - row[4]) < 1e-6 for row in day), 0.2 * len(day))
        spread = [max(column) - min(column) for column in zip(*day)]
        self.assertLess(spread[1], 0.8 * spread[0])  # air
        added = [sum(row[k] - row[1] for row in day) for k in (2, 3)]
        self.assertGreater(added[0], 0)
        self.assertGreater(added[1], 2 * added[0])
        self.assertTrue(all(row[3] == row[1] for row in night))

    def test_effects_are_drawn(self):
        drawing = pathlib.Path(self.folder.name) / "effects.svg"
        run("plot", self.db, "--kind", "effects", "--band", "mwir", "--time", "2013-07-12T07:00:00Z", "--out", drawing)
        text = drawing.read_text()
        for label in ("a: emission, without air", "e: all", "In-band radiance"):
            self.assertIn(label, text)

    def test_the_lawn_is_smoother_than_the_scene(self):
        cells = []
        for x in range(0, 80, 4):
            for y in range(8, 64, 4):
                cells += ["--region", f"c{x}_{y}={x},{y},{x + 4},{y + 4}"]
        table = pathlib.Path(self.folder.name) / "cells.csv"
        run("plot", self.db, "--kind", "regions", "--band", "mwir", *cells, "--out", table)
        spread = {}
        with open(table) as file:
            for row in csv.DictReader(file):
                if "T07:00" in row["time_utc"]:  # 14 h there
                    spread[row["region"]] = float(row["radiance_w_m2_sr"])
        lawn = [spread[f"c{x}_{y}"] for x in (32, 36, 40) for y in (36,)]
        self.assertLess(max(lawn) - min(lawn), 0.1 * (max(spread.values()) - min(spread.values())))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
