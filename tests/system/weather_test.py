"""Weather that goes on, at the front door: each hour has its own, in whatever time zone it is written; and what is refused.

usage: weather_test.py <irsig> <repository>
"""
import pathlib, sqlite3, subprocess, sys, tempfile, unittest

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
SHIPPED = (ROOT / "jobs/examples/weather/san_francisco.epw").read_text()
SWEEP = """
time = TIME
[model]
generate = "box"
triangles = 12
[place]
latitude_deg = LATITUDE
longitude_deg = -122.4
heading_deg = 0
[[part]]
name = "box"
material = "hull"
PART
[[season]]
name = "day"
date = DATE
SEASON
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 30, elevation_deg = 20 } ]
[surroundings]
kind = "sea"
sea_temperature_k = 286
[air]
model = "atmosphere"
aerosol = "maritime"
visibility_m = 23000
[transport]
sun = true
[accuracy]
samples_per_replicate = 64
[output]
thumbnail_px = 0
"""
STATED = {"TIME": '["12:00-08:00"]', "LATITUDE": "37.6", "DATE": "2025-07-21", "PART": "temperature_k = 295",
          "SEASON": 'weather_file = "sf.epw"'}


def sweep(**changes):
    text = SWEEP
    for key, value in (STATED | changes).items():
        text = text.replace(key, value)
    return text


class Weather(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def run_it(self, name, text, weather=SHIPPED):
        (self.path / "sf.epw").write_text(weather)
        (self.path / f"{name}.toml").write_text('name = "weather"\n' + text)
        return subprocess.run([IRSIG, "run", f"{name}.toml", "--db", f"{name}.sigdb"], cwd=self.path, capture_output=True,
                              text=True, timeout=300)

    def refused(self, text, *expected, weather=SHIPPED):
        done = self.run_it("wrong", text, weather)
        self.assertEqual(done.returncode, 2, done.stderr)
        for line in expected:
            self.assertIn(line, done.stderr)
        self.assertFalse((self.path / "wrong.sigdb").exists(), "something was left behind")

    def rows(self, name, text):
        done = self.run_it(name, text)
        self.assertEqual(done.returncode, 0, done.stderr)
        db = sqlite3.connect(self.path / f"{name}.sigdb")
        rows = db.execute("SELECT time_utc, intensity_w_sr, apparent_intensity_w_sr FROM signature_view ORDER BY time_utc").fetchall()
        db.close()
        return rows

    def test_time_zones_change_nothing(self):
        west = self.rows("west", sweep(TIME='["05:00-08:00", "12:00-08:00"]'))
        east = self.rows("east", sweep(TIME='["22:00+09:00", "13:00-07:00"]'))
        self.assertEqual(west, east)
        self.assertEqual(len(west), 2)
        self.assertNotEqual(west[0][2], west[1][2], "each hour has its own air")

    def test_the_hour_of_the_file_is_the_one_that_is_stated(self):
        # 2025-07-21, hour 12: 17.1 C, dew point 9.1 C (59 %), 101500 Pa, 7.5 m/s.
        by_file = self.rows("file", sweep())
        by_hand = self.rows("hand", sweep(SEASON="air_temperature_k = 290.25\nrelative_humidity_percent = 59.3\n"
                                                 "pressure_pa = 101500\nwind_speed_m_s = 7.5"))
        self.assertAlmostEqual(by_file[0][2] / by_hand[0][2], 1, delta=1e-4)

    def test_leap_day(self):
        self.refused(sweep(DATE="2024-02-29"), "sf.epw:152:1: season[0].weather_file: no record of month 2, day 29",
                     "typical years have no 29 February")

    def test_gap(self):
        lines = SHIPPED.splitlines(keepends=True)
        without = "".join(line for line in lines if not line.startswith("1976,7,21,12,"))
        self.refused(sweep(), "no record of month 7, day 21, hour 12", weather=without)

    def test_missing_value(self):
        self.refused(sweep(), "sf.epw:116:", "the air's temperature is missing at 2025-07-21T12:00-08:00",
                     weather=SHIPPED.replace(",17.1,9.1,59,101500,", ",99.9,9.1,59,101500,"))

    def test_rows_out_of_order(self):
        self.refused(sweep(), "sf.epw:116:6: month 7, day 21, hour 10 is not later in the year",
                     weather=SHIPPED.replace("1976,7,21,12,", "1976,7,21,10,"))

    def test_another_place(self):
        self.refused(sweep(LATITUDE="40"), "sf.epw:1:1: season[0].weather_file: the file is of latitude 37.62", "2.4 deg apart")

    def test_stated_against_file(self):
        self.refused(sweep(SEASON='weather_file = "sf.epw"\nair_temperature_k = 280'),
                     "season[0].air_temperature_k = 280, but season[0].weather_file has 290.25 at 2025-07-21T20:00:00Z")

    def test_no_file(self):
        self.refused(sweep(SEASON='weather_file = "nowhere.epw"'), "wrong.toml:", "nowhere.epw")

    def test_build_up_without_heat(self):
        self.refused(sweep(PART='build_up = "wall"'), 'part[0].build_up = "wall", but [heat] is missing')


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
