"""Two conditions and two databases side by side: values, ratio, difference, and whether it is more than the errors.

usage: compare_test.py <irsig executable>
"""
import csv
import io
import pathlib
import subprocess
import sys
import tempfile
import unittest

IRSIG = pathlib.Path(sys.argv[1]).resolve()

# Two boxes of one sweep: black, in vacuum, at TEMPERATURE and at 310 K.
SWEEP = """
name = "box"
time = ["12:00Z", "13:00Z"]
[model]
generate = "box"
triangles = 12
[[part]]
name = "body"
match = ["*"]
material = "blackbody"
[[season]]
name = "cold"
date = 2025-01-21
part_temperature_k = { body = TEMPERATURE }
[[season]]
name = "warm"
date = 2025-06-21
part_temperature_k = { body = 310 }
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[[band]]
name = "narrow"
lambda_min_um = 12.5
lambda_max_um = 13
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 1000
aspect = [{ azimuth_deg = 30, elevation_deg = 20 }, { azimuth_deg = 200, elevation_deg = 40 }]
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


class Compare(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)
        for name, kelvins in (("a", "300"), ("b", "305")):
            (cls.path / f"{name}.toml").write_text(SWEEP.replace("TEMPERATURE", kelvins))
            cls.irsig("run", f"{name}.toml", "--db", f"{name}.sigdb")

    @classmethod
    def irsig(cls, *arguments, code=0):
        done = subprocess.run([IRSIG, *arguments], cwd=cls.path, capture_output=True, text=True, timeout=300)
        assert done.returncode == code, f"{arguments}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
        return done

    def rows(self, *arguments):
        return list(csv.DictReader(io.StringIO(self.irsig("compare", *arguments, "--csv").stdout)))

    def test_two_databases(self):
        rows = self.rows("a.sigdb", "b.sigdb", "--band", "lwir")
        self.assertEqual(len(rows), 8)  # 2 seasons, 2 times, 2 aspects
        for row in rows:
            self.assertEqual(row["a_season"], row["b_season"])
            self.assertEqual(row["a_time_utc"], row["b_time_utc"])
            a, b = float(row["a_intensity_w_sr"]), float(row["b_intensity_w_sr"])
            self.assertAlmostEqual(float(row["ratio"]), b / a, places=12)
            self.assertAlmostEqual(float(row["difference_intensity_w_sr"]), b - a, places=9)
            changed = row["a_season"] == "cold"
            # Planck's law, 8 to 12 um: 305 K against 300 K.
            self.assertAlmostEqual(b / a, 1.0838 if changed else 1, delta=2e-3)
            self.assertEqual(row["exceeds_error"], "true" if changed else "false")

    def test_several_seasons_are_the_rows_of_each(self):
        each = [self.rows("a.sigdb", "b.sigdb", "--band", "lwir", "--season", name) for name in ("cold", "warm")]
        both = self.rows("a.sigdb", "b.sigdb", "--band", "lwir", "--season", "warm", "--season", "cold")
        self.assertEqual(len(both), 8)
        self.assertCountEqual(both, each[0] + each[1])
        said = self.irsig("compare", "a.sigdb", "b.sigdb", "--season", "cold", "--season", "wram", code=2).stderr
        self.assertIn('no season "wram" in this database; there is: cold, warm', said)

    def test_two_seasons_of_one(self):
        rows = self.rows("a.sigdb", "--season", "cold", "--b-season", "warm", "--band", "lwir")
        self.assertEqual(len(rows), 4)
        for row in rows:
            self.assertEqual((row["a_season"], row["b_season"]), ("cold", "warm"))
            self.assertEqual(row["a_time_utc"][11:], row["b_time_utc"][11:])
            self.assertGreater(float(row["ratio"]), 1.1)

    def test_bands(self):
        said = self.irsig("compare", "a.sigdb", "--band", "lwir", "--b-band", "narrow", code=2).stderr
        self.assertIn("are bands of different limits or responses", said)

    def test_what_has_no_partner(self):
        said = self.irsig("compare", "a.sigdb", "b.sigdb", "--season", "cold", "--b-time", "2025-01-21T13:00:00Z", code=2).stderr
        self.assertIn("would have the same partner: choose one of them with --sweep", said)
        said = self.irsig("compare", "a.sigdb", "b.sigdb", "--season", "cold", "--b-season", "wram", code=2).stderr
        self.assertIn('no season "wram"', said)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
