"""The reading subcommands of irsig on a database that irsig run has made.

usage: cli_view_test.py <irsig executable>
"""
import csv
import io
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

IRSIG = sys.argv[1] if len(sys.argv) > 1 else "irsig"

SWEEP = """
name = "can"
time = ["10:30+09:00"]
[model]
generate = "cylinder"
triangles = 2000
[place]
latitude_deg = 25
longitude_deg = 130
height_m = 0
heading_deg = 0
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
[[part]]
name = "can"
match = ["*"]
material = "paint"
[[season]]
name = "winter"
date = 2025-12-21
part_temperature_k = { can = 280 }
[[season]]
name = "summer"
date = 2025-06-21
part_temperature_k = { can = 310 }
[[band]]
name = "mwir"
lambda_min_um = 3
lambda_max_um = 5
step_um = 0.25
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.25
[viewpoints]
kind = "fibonacci"
count = 40
range_m = 1000
[surroundings]
kind = "sea"
sky_temperature_k = 260
sea_temperature_k = 285
sea_emissivity = 0.98
[air]
model = "vacuum"
[transport]
sun = false
max_reflections = 1
[accuracy]
samples_per_replicate = 256
[output]
thumbnail_px = 32
"""


def irsig(*arguments, expect=0):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == expect, f"irsig {arguments}: exit code {done.returncode}, expected " \
                                      f"{expect}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    return done


class FrontDoor(unittest.TestCase):
    def test_version_and_help(self):
        self.assertRegex(irsig("--version").stdout, r"^irsig \d+\.\d+\.\d+ \(build ")
        help_text = irsig("--help").stdout
        for command in ("run", "submit", "status", "cancel", "digest", "query", "export", "plot",
                        "show", "model"):
            self.assertIn(f"  {command} ", help_text)
            self.assertIn("--help", irsig(command, "--help").stdout)

    def test_what_is_shown_without_a_database(self):
        for what in "solids", "effects":
            for options in ([], ["--format", "text"], ["--csv"], ["--json"]):
                with self.subTest(f"{what} {options}"):
                    done = subprocess.run([IRSIG, "show", what, *options], capture_output=True, text=True)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertGreater(done.stdout.count("\n"), 5)

    def test_wrong_options_are_the_users(self):
        for arguments in ([], ["fly"], ["--fast"], ["query"], ["query", "a.sigdb", "--colour"],
                          ["query", "a.sigdb", "--format", "xml"], ["plot", "a.sigdb"],
                          ["query", "a.sigdb", "--aspect", "45"],
                          ["plot", "a.sigdb", "--kind", "map", "--elevation", "3", "--out", "x.svg"]):
            done = irsig(*arguments, expect=2)
            self.assertEqual(done.stdout, "")
            self.assertTrue(done.stderr.startswith("irsig: "), done.stderr)

    def test_what_is_no_database(self):
        with tempfile.TemporaryDirectory() as folder:
            missing = pathlib.Path(folder, "missing.sigdb")
            for command in (["query"], ["export", "--format", "csv", "--out", f"{folder}/x"],
                            ["plot", "--kind", "polar", "--out", f"{folder}/x"], ["digest"]):
                done = irsig(command[0], missing, *command[1:], expect=2)
                self.assertIn("missing.sigdb", done.stderr)
            self.assertFalse(missing.exists())
            text = pathlib.Path(folder, "text.sigdb")
            text.write_text("no database\n" * 500)
            irsig("query", text, expect=2)
            self.assertEqual(text.read_text(), "no database\n" * 500)


class Views(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        sweep = cls.path / "can.toml"
        sweep.write_text(SWEEP)
        cls.db = cls.path / "can.sigdb"
        irsig("run", sweep, "--db", cls.db, "--workers", 1)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def rows(self, *arguments):
        text = irsig("query", self.db, *arguments, "--format", "csv").stdout
        return list(csv.DictReader(io.StringIO(text)))

    def test_rows_are_complete_and_ordered(self):
        rows = self.rows()
        self.assertEqual([int(r["row"]) for r in rows], list(range(1, 40 * 2 * 2 + 1)))
        self.assertEqual(rows[0]["time_utc"], "2025-12-21T01:30:00Z")
        self.assertEqual(rows[0]["mean_solar_time"], "10:10")  # 130 deg east
        for r in rows:
            self.assertGreater(float(r["intensity_w_sr"]), 0)
            self.assertGreaterEqual(float(r["numerical_error_w_sr"]), float(r["intensity_stderr_w_sr"]))

    def test_filters(self):
        summer = self.rows("--season", "summer", "--band", "lwir", "--time", "2025-06-20T20:30:00-05:00")
        self.assertEqual(len(summer), 40)
        nearest = self.rows("--season", "summer", "--band", "lwir", "--aspect", "90,30", "--nearest", 3)
        self.assertEqual(len(nearest), 3)
        done = irsig("query", self.db, "--season", "autumn", expect=2)
        self.assertIn("summer, winter", done.stderr)
        none = irsig("query", self.db, "--max-relative-error", "1e-12", "--format", "csv")
        self.assertEqual(none.stdout.count("\n"), 1)
        self.assertIn("no signature matches", none.stderr)

    def test_spectrum_integrates_to_the_band(self):
        lines = self.rows("--row", 2, "--spectrum")
        self.assertEqual(len(lines), 17)
        s = [float(r["spectral_intensity_w_sr_um"]) for r in lines]
        trapezoid = 0.25 * (sum(s) - 0.5 * (s[0] + s[-1]))
        # Bin means by the trapezoid rule: h^2/12 of the curvature, < 0.5 % at 0.25 um.
        self.assertAlmostEqual(trapezoid / float(lines[0]["intensity_w_sr"]), 1, delta=0.005)

    def test_windows_are_no_narrower_than_what_is_stored(self):
        """Once a window of 0.01 um of bins of 0.25 um was answered: 0.15 +- 2.7 W/sr."""
        for window, step in (("3,3.01", "0.005"), ("3.3,3.5", "0.1"), ("4.9,5", "0.05"), ("3.0,3.2499", "0.12495")):
            said = irsig("query", self.db, "--band", "mwir", "--window", window, expect=2).stderr
            self.assertIn("--window: band mwir: ", said)
            self.assertIn("is narrower than the stored step of 0.25 um", said)
            self.assertIn(f"ask for step_um = {step} in the [[band]] of the sweep", said)
        narrow = self.path / "narrow.csv"
        narrow.write_text("wavelength_um,response\n3.5,0\n3.6,1\n3.65,0\n4,0\n")
        said = irsig("query", self.db, "--band", "mwir", "--response", narrow, expect=2).stderr
        self.assertIn("3.5 to 3.65 um is narrower than the stored step of 0.25 um", said)
        # As wide as a bin, wherever its limits lie.
        for window in ("3,3.25", "3.1,3.35", "4.75,5", "3.125,3.375", "3.07,4.93"):
            self.assertEqual(len(self.rows("--band", "mwir", "--window", window)), 80)

    def test_json_and_table(self):
        rows = json.loads(irsig("query", self.db, "--format", "json", "--causes").stdout)
        self.assertEqual(len(rows), 160)
        r = rows[0]
        causes = sum(r[c] for c in ("emitted_w_sr", "sun_reflected_w_sr", "sky_reflected_w_sr",
                                    "surface_reflected_w_sr", "interreflected_w_sr"))
        self.assertAlmostEqual(causes / r["intensity_w_sr"], 1, delta=1e-6)
        self.assertIn("[W/sr]", irsig("query", self.db).stdout)

    def test_interpolation_meets_a_viewpoint_and_its_error_covers_it(self):
        viewpoint = self.rows("--row", 82)[0]
        aspect = f"{viewpoint['aspect_azimuth_deg']},{viewpoint['aspect_elevation_deg']}"
        there = self.rows("--aspect", aspect, "--interpolate", "--season", viewpoint["season"],
                          "--band", viewpoint["band"])[0]
        off = abs(float(there["intensity_w_sr"]) - float(viewpoint["intensity_w_sr"]))
        self.assertLessEqual(off, 2 * float(there["numerical_error_w_sr"]))
        irsig("query", self.db, "--aspect", "0,-40", "--interpolate", expect=2)

    def test_thumbnail(self):
        png, exr = self.path / "t.png", self.path / "t.exr"
        irsig("query", self.db, "--row", 1, "--thumbnail", png)
        irsig("query", self.db, "--row", 1, "--thumbnail", exr)
        self.assertEqual(png.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(exr.read_bytes()[:4], b"\x76\x2f\x31\x01")
        self.assertIn("--row 2", irsig("query", self.db, "--thumbnail", png, expect=2).stderr)

    def test_exports(self):
        import numpy
        import xarray
        nc, text = self.path / "all.nc", self.path / "all.csv"
        irsig("export", self.db, "--format", "netcdf", "--out", nc)
        irsig("export", self.db, "--format", "csv", "--out", text)
        with xarray.open_dataset(nc) as d, open(text) as f:
            values = d["intensity_w_sr"].values
            self.assertEqual(values.shape, (40, 2, 1, 2))
            rows = list(csv.DictReader(f))
            self.assertEqual([float(r["intensity_w_sr"]) for r in rows], values.ravel().tolist())
            spectrum = d["spectral_intensity_w_sr_um"] * d["in_band_weight_um"]
            self.assertLess(float(abs(spectrum.sum("bin") / d["intensity_w_sr"] - 1).max()), 2e-3)
        irsig("export", self.db, "--format", "csv", "--out", self.path / "no" / "x.csv", expect=2)

    def test_spectral_library(self):
        import spectral.io.envi
        sli = self.path / "ship.sli"
        arguments = ["--band", "lwir", "--quantity", "apparent_intensity", "--season", "summer"]
        irsig("export", self.db, *arguments, "--out", sli)
        library = spectral.io.envi.open(str(self.path / "ship.hdr"), str(sli))
        rows = self.rows(*arguments)
        self.assertEqual(library.spectra.shape[0], len(rows))
        for at in (0, len(rows) - 1):
            self.assertTrue(library.names[at].startswith(f"row {rows[at]['row']} summer "), library.names[at])
            stored = self.rows("--row", rows[at]["row"], "--spectrum")
            self.assertEqual([float(r["lambda_um"]) for r in stored], [round(x, 12) for x in library.bands.centers])
            for ours, row in zip(library.spectra[at], stored):
                self.assertAlmostEqual(ours, float(row["apparent_spectral_intensity_w_sr_um"]), delta=1e-6 * abs(ours))
        self.assertIn("expected --band", irsig("export", self.db, "--out", sli, expect=2).stderr)
        self.assertIn("needs a file", irsig("export", self.db, "--envi", "--out", "-", expect=2).stderr)

    def test_plots_are_svg(self):
        for arguments in (["polar"], ["polar", "--elevation", 30, "--season", "summer"],
                          ["spectrum", "--aspect", "45,20"], ["map", "--band", "lwir"],
                          ["picture", "--row", 1], ["picture", "--row", 1, "--scale", "0,50"],
                          ["temperatures", "--aspect", "30,40", "--season", "summer", "--pixels", 64]):
            out = self.path / "plot.svg"
            irsig("plot", self.db, "--kind", *arguments, "--out", out)
            root = xml.etree.ElementTree.parse(out).getroot()
            self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
            self.assertNotIn("nan", out.read_text())
        irsig("plot", self.db, "--kind", "spectrum", "--out", out, expect=2)


GREY = """model = "homogeneous"
absorption_m2_kg = 2e-4
pressure_pa = 101325
gas_constant_j_kg_k = 287
path_emission = true
"""


def ranged_sweep(range_m, name="far"):
    """A can of 8 x 4 m in sunlight over a sea, through homogeneous air."""
    text = SWEEP.replace('name = "can"\ntime', f'name = "{name}"\ntime')
    text = text.replace("triangles = 2000", "triangles = 2000\nlength_m = 8\nradius_m = 2")
    text = text.replace("date = 2025", "air_temperature_k = 288\ndate = 2025")
    text = text.replace('kind = "fibonacci"\ncount = 40\nrange_m = 1000',
                        f'kind = "grid"\nazimuth_deg = [0, 60]\nelevation_deg = [3, 30]\n'
                        f'range_m = {range_m}')
    text = text.replace('model = "vacuum"\n', GREY).replace("sun = false", "sun = true")
    return text.replace("samples_per_replicate = 256", "samples_per_replicate = 512")


def through_the_atmosphere(text):
    """The same under the embedded atmosphere, with waves on the sea."""
    text = text.replace(GREY, 'model = "atmosphere"\naerosol = "maritime"\nvisibility_m = 23000\n')
    text = text.replace("air_temperature_k = 288", "air_temperature_k = 288\n"
                        "relative_humidity_percent = 70\npressure_pa = 101325\nwind_speed_m_s = 5")
    text = text.replace("sky_temperature_k = 260\n", "").replace("sea_emissivity = 0.98\n", "")
    return text.replace("lambda_min_um = 3\n", "lambda_min_um = 3.5\n")


class OtherRanges(unittest.TestCase):
    """query --range-m against what irsig run computes there."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        for range_m in (1000, 5000):
            sweep = cls.path / f"{range_m}.toml"
            sweep.write_text(ranged_sweep(range_m))
            irsig("run", sweep, "--db", cls.path / f"{range_m}.sigdb", "--workers", 1)
            sweep.write_text(through_the_atmosphere(ranged_sweep(range_m)))
            irsig("run", sweep, "--db", cls.path / f"air {range_m}.sigdb", "--workers", 1)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def rows(self, range_m, *arguments):
        done = irsig("query", self.path / f"{range_m}.sigdb", *arguments, "--format", "csv")
        return list(csv.DictReader(io.StringIO(done.stdout)))

    def test_moved_rows_are_what_is_computed_there(self):
        for air, stored, asked in (("", 1000, 5000), ("", 5000, 1000),
                                   ("air ", 1000, 5000), ("air ", 5000, 1000)):
            moved = self.rows(f"{air}{stored}", "--range-m", asked)
            computed = self.rows(f"{air}{asked}")
            self.assertEqual(len(moved), len(computed))
            for m, c in zip(moved, computed):
                self.assertEqual(float(m["range_m"]), asked)
                self.assertEqual(float(m["stored_range_m"]), stored)
                for value, error in (("apparent_intensity_w_sr", "apparent_numerical_error_w_sr"),
                                     ("contrast_intensity_w_sr", "contrast_numerical_error_w_sr")):
                    off = abs(float(m[value]) - float(c[value]))
                    # 16 rows x 2 quantities x 4: 4 sigma of the difference.
                    self.assertLess(off, 4 * (float(m[error]) ** 2 + float(c[error]) ** 2) ** 0.5)
                self.assertAlmostEqual(float(m["path_transmittance"]),
                                       float(c["path_transmittance"]), delta=1e-9)
                self.assertAlmostEqual(float(m["background_radiance_w_m2_sr"]) /
                                       float(c["background_radiance_w_m2_sr"]), 1, delta=1e-3)

    def test_the_own_range_changes_nothing(self):
        for m, c in zip(self.rows("air 1000", "--range-m", 1000), self.rows("air 1000")):
            for name in ("apparent_intensity_w_sr", "contrast_intensity_w_sr",
                         "apparent_numerical_error_w_sr", "background_radiance_w_m2_sr"):
                self.assertAlmostEqual(float(m[name]), float(c[name]),
                                       delta=1e-9 * abs(float(c[name])) + 1e-12)
            self.assertNotIn("stored_range_m", c)

    def test_spectra_are_moved_with_their_rows(self):
        lines = self.rows(1000, "--range-m", 5000, "--row", 1, "--spectrum")
        for line in lines:
            self.assertEqual(float(line["stored_range_m"]), 1000)
        there = self.rows(5000, "--row", 1, "--spectrum")
        for a, b in zip(lines, there):
            self.assertAlmostEqual(float(a["path_transmittance"]), float(b["path_transmittance"]),
                                   delta=1e-6)

    def test_too_near_is_refused(self):
        done = irsig("query", self.path / "1000.sigdb", "--range-m", 100, expect=2)
        self.assertIn("below 20 lengths", done.stderr)
        irsig("query", self.path / "1000.sigdb", "--range-m", "0", expect=2)
        irsig("query", self.path / "1000.sigdb", "--range-m", 5000, "--aspect", "30,10",
              "--interpolate", expect=2)

    def test_contrast_is_asked_for_sorted_and_drawn(self):
        database = self.path / "1000.sigdb"
        rows = self.rows(1000, "--sort", "contrast_intensity_w_sr", "--descending")
        contrast = [float(r["contrast_intensity_w_sr"]) for r in rows]
        self.assertEqual(contrast, sorted(contrast, reverse=True))
        limit = sorted(float(r["contrast_numerical_error_w_sr"]) / abs(c)
                       for r, c in zip(rows, contrast))[7]
        exact = self.rows(1000, "--quantity", "contrast_intensity", "--max-relative-error", limit)
        self.assertEqual(len(exact), 8)
        self.assertIn("contrast", irsig("query", database, "--quantity", "contrast_intensity").stdout)
        self.assertIn("beauty", irsig("query", database, "--sort", "beauty", expect=2).stderr)
        irsig("query", database, "--quantity", "beauty", expect=2)
        for kind in ("contrast_intensity", "apparent_intensity", "background_radiance"):
            out = self.path / f"{kind}.svg"
            irsig("plot", database, "--kind", "spectrum", "--row", 1, "--quantity", kind, "--out", out)
            xml.etree.ElementTree.parse(out)
        irsig("plot", database, "--kind", "transmittance", "--row", 1, "--out", out)
        self.assertIn("Transmittance", out.read_text())
        xml.etree.ElementTree.parse(out)
        irsig("plot", database, "--kind", "transmittance", "--aspect", "30,10", "--interpolate",
              "--out", out, expect=2)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
