"""Windows and responses of stored rows against direct runs whose bands they are, with other seeds: by how much both differ, in
units of their errors together. Sunlit paint whose colour changes with wavelength, hot parts, behind the air, above a sea.

usage: window_errors_test.py <irsig> <repository> [viewpoints]      40 of them; 240 for the figures of docs/evidence/validation.md
"""
import csv, io, itertools, math, pathlib, random, subprocess, sys, tempfile, unittest

import numpy

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
VIEWPOINTS = int(sys.argv[3]) if len(sys.argv) > 3 else 40
sys.path.insert(0, str(ROOT / "python"))
import irsig  # noqa: E402

PARTS = {"hull": 293.15, "deck": 301.15, "superstructure": 296.15, "funnel": 310.15, "mast": 293.15, "turret": 293.15,
         "funnel_top": 400, "mast_hot": 380}
SWEEP = """
name = "ship"
time = ["10:30+09:00"]
seed = {seed}
[model]
generate = "frigate"
triangles = 2000
length_m = 153.8
width_m = 20.4
height_m = 6.4
[place]
latitude_deg = 25
longitude_deg = 130
heading_deg = 0
[[material]]
name = "paint"
kind = "lambert"
emissivity_table = [ {{ lambda_um = 2.5, value = 0.5 }}, {{ lambda_um = 3.6, value = 0.9 }}, {{ lambda_um = 5.5, value = 0.6 }},
                     {{ lambda_um = 9.0, value = 0.95 }}, {{ lambda_um = 13.0, value = 0.7 }} ]
{parts}
[[season]]
name = "summer"
date = 2025-06-21
profile = "midlatitude_summer"
wind_speed_m_s = 5
air_temperature_k = 294.15
relative_humidity_percent = 75
pressure_pa = 101300
surroundings = {{ sea_temperature_k = 293.15 }}
{bands}
[viewpoints]
kind = "fibonacci"
count = {viewpoints}
range_m = 4000
[surroundings]
kind = "sea"
sea_model = "cox_munk"
[air]
model = "atmosphere"
aerosol = "maritime"
visibility_m = 23000
[transport]
sun = true
max_reflections = 16
[accuracy]
samples_per_replicate = {samples}
"""
# Narrow and wide, in and beside the bands of carbon dioxide and ozone.
WHOLE_BINS = ((3.075, 3.325), (3.475, 4.075), (4.125, 4.525), (4.575, 4.875), (8.225, 8.625), (8.775, 9.375), (9.425, 10.025), (10.175, 11.875))
CUT_BINS = ((3.1, 3.35), (3.5, 4.1), (4.15, 4.55), (4.6, 4.9), (8.21, 8.66), (8.8, 9.4), (9.45, 10.05), (10.2, 11.91))
STORED = "".join(f'[[band]]\nname = "{name}"\nlambda_min_um = {low}\nlambda_max_um = {high}\nstep_um = 0.05\n'
                 for name, low, high in (("mwir", 3, 5), ("lwir", 8, 12)))
QUANTITIES = ("intensity_w_sr", "apparent_intensity_w_sr", "contrast_intensity_w_sr")


def run(*arguments):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=6000)
    assert done.returncode == 0, done.stderr
    return done.stdout


def table(*arguments):
    return list(csv.DictReader(io.StringIO(run("query", *arguments, "--csv"))))


def key(row):
    return row["aspect_azimuth_deg"], row["aspect_elevation_deg"]


def random_responses():
    """Within both bands, linear between points at random places."""
    dice = random.Random(5)
    for band, low, high in (("mwir", 3.1, 4.9), ("lwir", 8.1, 11.9)):
        places = sorted(round(dice.uniform(low + 0.05, high - 0.05), 3) for _ in range(5))
        yield band, [(low, 0), *((um, round(dice.uniform(0.1, 1), 3)) for um in places), (high, 0)]


class WindowErrors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        cls.run_sweep("stored", STORED, 1)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def run_sweep(cls, name, bands, seed, samples=256):
        parts = "".join(f'[[part]]\nname = "{part}"\nmaterial = "paint"\ntemperature_k = {k}\n' for part, k in PARTS.items())
        file = cls.path / f"{name}.toml"
        file.write_text(SWEEP.format(seed=seed, parts=parts, bands=bands, viewpoints=VIEWPOINTS, samples=samples))
        run("run", file, "--db", cls.path / f"{name}.sigdb")

    def deviations(self, ours, theirs, whole_bins=None):
        """Of two tables of the same places: (ours - theirs) / errors of both, by quantity. whole_bins: a window that cuts no bin; what
        the bound is above that window's is due to the bins that are cut, and counts as 1 / sqrt(3) of it."""
        by_key = {key(row): row for row in theirs}
        bounds = {key(row): row for row in whole_bins or ours}
        for row in ours:
            self.assertEqual(row["errors_from"], "modes")
            other = by_key[key(row)]
            for quantity in QUANTITIES:
                stderr, bound = (quantity.replace(*name) for name in (("_w_sr", "_stderr_w_sr"), ("intensity", "bound")))
                cut = float(row["in_band_" + bound]) - float(bounds[key(row)]["in_band_" + bound])
                yield quantity, ((float(row["in_band_" + quantity]) - float(other[quantity]))
                                 / math.hypot(float(row["in_band_" + stderr]), float(other[stderr]), cut / math.sqrt(3)))

    def check(self, what, found, bounded=False):
        """found: [(quantity, deviation)]. Of views alone are deviations independent: each has several. bounded: the errors hold bounds of
        what spectra do inside bins, which is less as a rule."""
        for quantity in QUANTITIES:
            of = numpy.array([t for q, t in found if q == quantity])
            rms = math.sqrt(float(numpy.mean(of ** 2)))
            print(f"{what}, {quantity}: {len(of)} rows, rms {rms:.3f}, mean {numpy.mean(of):+.3f}, largest {numpy.abs(of).max():.2f}")
            # Of n squares of normal numbers the mean has a scatter of sqrt(2 / n); counted once for each view, 4 of them. 32
            # replicates on both sides: 1.7 %.
            self.assertLess(rms - 1.017, max(0.09, 4 * math.sqrt(0.5 / VIEWPOINTS)))
            self.assertGreater(rms - 1.017, -0.6 if bounded else -max(0.09, 4 * math.sqrt(0.5 / VIEWPOINTS)))
            self.assertLess(abs(numpy.mean(of)), 4 / math.sqrt(VIEWPOINTS))

    def windows(self, name, windows, seed):
        """Of each window our rows and those of the direct run."""
        self.run_sweep(name, "".join(
            f'[[band]]\nname = "{low}-{high}"\nlambda_min_um = {low}\nlambda_max_um = {high}\nstep_um = 0.05\n' for low, high in windows), seed)
        for low, high in windows:
            yield ("mwir" if high < 6 else "lwir", table(self.path / "stored.sigdb", "--band", "mwir" if high < 6 else "lwir", "--window", f"{low},{high}"),
                   table(self.path / f"{name}.sigdb", "--band", f"{low}-{high}"))

    def test_windows(self):
        found = []
        for _, ours, theirs in self.windows("whole", WHOLE_BINS, 2):
            found += self.deviations(ours, theirs)
        self.check("windows of whole bins", found)

    def test_windows_that_cut_bins(self):
        whole_bins = {"mwir": table(self.path / "stored.sigdb", "--band", "mwir", "--window", "3.475,4.075"),
                      "lwir": table(self.path / "stored.sigdb", "--band", "lwir", "--window", "8.225,8.625")}
        found = []
        for band, ours, theirs in self.windows("cut", CUT_BINS, 5):
            found += self.deviations(ours, theirs, whole_bins[band])
        self.check("windows that cut bins", found, bounded=True)

    def test_responses(self):
        responses = list(random_responses())
        self.run_sweep("responses", "".join(
            f'[[band]]\nname = "{band}"\nlambda_min_um = {points[0][0]}\nlambda_max_um = {points[-1][0]}\nstep_um = 0.05\nresponse = ['
            + ", ".join(f"{{ lambda_um = {um}, value = {value} }}" for um, value in points) + "]\n" for band, points in responses), 3)
        found = []
        for band, points in responses:
            file = self.path / f"{band}.csv"
            file.write_text("wavelength_um,response\n" + "".join(f"{um},{value}\n" for um, value in points))
            ours = table(self.path / "stored.sigdb", "--band", band, "--response", file)
            found += self.deviations(ours, table(self.path / "responses.sigdb", "--band", band))
        self.check("responses", found, bounded=True)

    def test_differences_of_windows(self):
        """Contrasts of colours: one window less as much of another as they have on average, between two seeds."""
        self.run_sweep("again", STORED, 4)
        found = []
        with irsig.open(self.path / "stored.sigdb") as one, irsig.open(self.path / "again.sigdb") as two:
            for band, quantity in itertools.product(("mwir", "lwir"), QUANTITIES):
                spectrum = quantity.replace("intensity", "spectral_intensity") + "_um"
                sides = []
                for db in (one, two):
                    rows = db.query(band=band)
                    values, stderrs = (rows.spectra(n) for n in (spectrum, spectrum.replace("_w_sr", "_stderr_w_sr")))
                    sides.append({(rows["aspect_azimuth_deg"][i], rows["aspect_elevation_deg"][i]): of
                                  for i, of in enumerate(zip(values, stderrs, rows.modes(spectrum)))})
                lambda_um = next(iter(sides[0].values()))[0][0]
                mean = numpy.mean([of[0][1] for of in sides[0].values()], axis=0)
                for low, high in itertools.combinations([w for w in WHOLE_BINS if (w[1] < 6) == (band == "mwir")], 2):
                    first, second = (((lambda_um > w[0]) & (lambda_um < w[1])).astype(float) for w in (low, high))
                    weight = first - second * (first @ mean) / (second @ mean)
                    for place, ((_, ours), (_, error), modes) in sides[0].items():
                        (_, theirs), (_, other_error), other_modes = sides[1][place]
                        variance = 0
                        for e, m in ((error, modes), (other_error, other_modes)):
                            rest = numpy.sqrt(numpy.maximum(0, e ** 2 - (m ** 2).sum(0)))
                            variance += ((m @ weight) ** 2).sum() + (abs(weight) @ rest) ** 2
                        found.append((quantity, weight @ (ours - theirs) / math.sqrt(variance)))
        self.check("differences", found)

    def test_windows_at_another_range(self):
        """Two seeds, both moved: what moving itself errs by is alike."""
        self.run_sweep("moved", STORED, 6)
        found = []
        for low, high in WHOLE_BINS:
            ours, theirs = (table(self.path / f"{name}.sigdb", "--band", "mwir" if high < 6 else "lwir", "--window", f"{low},{high}", "--range-m", "9000")
                            for name in ("stored", "moved"))
            by_key = {key(row): row for row in theirs}
            for row in ours:
                self.assertEqual(row["errors_from"], "modes")
                other = by_key[key(row)]
                for quantity in QUANTITIES:
                    stderr = "in_band_" + quantity.replace("_w_sr", "_stderr_w_sr")
                    found.append((quantity, (float(row["in_band_" + quantity]) - float(other["in_band_" + quantity]))
                                  / math.hypot(float(row[stderr]), float(other[stderr]))))
        self.check("windows at another range", found)

    def test_the_whole_band_is_what_is_stored(self):
        for band, limits in (("mwir", "3,5"), ("lwir", "8,12")):
            stored = {key(row): row for row in table(self.path / "stored.sigdb", "--band", band)}
            for row in table(self.path / "stored.sigdb", "--band", band, "--window", limits):
                for quantity in QUANTITIES:
                    of = float(stored[key(row)][quantity])
                    slack = float(row["in_band_" + quantity.replace("intensity", "bound")])
                    self.assertAlmostEqual(float(row["in_band_" + quantity]), of, delta=slack + 1e-6 * abs(of))
                    stderr = quantity.replace("_w_sr", "_stderr_w_sr")
                    error = float(stored[key(row)][stderr])
                    self.assertAlmostEqual(float(row["in_band_" + stderr]), error, delta=0.01 * error)

    def test_modes_in_netcdf_are_those_of_the_database(self):
        import xarray
        file = self.path / "stored.nc"
        run("export", self.path / "stored.sigdb", "--band", "mwir", "--out", file)
        with irsig.open(self.path / "stored.sigdb") as db, xarray.open_dataset(file) as exported:
            ours = db.query(band="mwir").to_xarray()
            for name in ("spectral_intensity", "apparent_spectral_intensity", "contrast_spectral_intensity"):
                theirs = exported[name + "_modes_w_sr_um"].values
                self.assertEqual(exported[name + "_modes_w_sr_um"].attrs["units"], "W sr-1 um-1")
                mine = ours[name + "_modes_w_sr_um"].values
                self.assertGreater(numpy.abs(mine).max(), 0)
                by_place = {(a, e): i for i, (a, e) in enumerate(zip(exported.aspect_azimuth_deg.values, exported.aspect_elevation_deg.values))}
                for i, place in enumerate(zip(ours.aspect_azimuth_deg.values, ours.aspect_elevation_deg.values)):
                    one, other = mine[0, 0, 0, i], theirs[by_place[place]].reshape(-1, mine.shape[-1])
                    numpy.testing.assert_allclose(one, other[:len(one)], rtol=1e-6, atol=0)
                    self.assertEqual(numpy.abs(other[len(one):]).max(initial=0), 0)

    def test_windows_add_up(self):
        """Values add up; standard errors at most."""
        parts = [table(self.path / "stored.sigdb", "--band", "lwir", "--window", w) for w in ("8.1,9.33", "9.33,11.2", "8.1,11.2")]
        for first, second, whole in zip(*parts):
            for quantity in QUANTITIES:
                a, b, both = (float(r["in_band_" + quantity]) for r in (first, second, whole))
                self.assertAlmostEqual(a + b, both, delta=1e-9 * (abs(a) + abs(b)))
                stderr = "in_band_" + quantity.replace("_w_sr", "_stderr_w_sr")
                self.assertLessEqual(float(whole[stderr]), 1.001 * (float(first[stderr]) + float(second[stderr])))

    def test_rows_without_modes_and_bad_questions(self):
        import shutil, sqlite3
        old = self.path / "old.sigdb"
        shutil.copy(self.path / "stored.sigdb", old)
        sql = sqlite3.connect(old)
        sql.execute("DELETE FROM spectral_modes")
        sql.commit()
        sql.close()
        done = subprocess.run([IRSIG, "query", old, "--band", "lwir", "--window", "9,10", "--csv"], capture_output=True, text=True)
        self.assertIn("the largest that they can be", done.stderr)
        known = table(self.path / "stored.sigdb", "--band", "lwir", "--window", "9,10")
        for row, better in zip(csv.DictReader(io.StringIO(done.stdout)), known):
            self.assertEqual(row["errors_from"], "all as one")
            for quantity in QUANTITIES:
                stderr = "in_band_" + quantity.replace("_w_sr", "_stderr_w_sr")
                self.assertGreaterEqual(float(row[stderr]), 0.999 * float(better[stderr]))
        bad = self.path / "bad.csv"
        db = self.path / "stored.sigdb"
        for arguments, text, said in (
                (("--window", "7.9,9", "--band", "lwir"), "", "7.9 to 9 um is outside the stored band, 8 to 12 um"),
                (("--window", "9,10"), "", "outside the stored band, 3 to 5 um"),
                (("--window", "10,9"), "", "the shorter one first"),
                (("--window", "nan,9"), "", "the shorter one first"),
                (("--window", "9"), "", "--window"),
                (("--window", "9,10", "--spectrum"), "", "excludes"),
                (("--window", "9,10", "--band", "lwir", "--aspect", "45,10", "--interpolate"), "", "interpolated row"),
                (("--response", bad), "lambda_um,response\n9,1\n8,1\n", "bad.csv:3:1: wavelength 8 is not above"),
                (("--response", bad), "wavelength_um,response\n9,-1\n10,1\n", "bad.csv:2:3: response = -1, expected 0 or more"),
                (("--response", bad), "wavelength_um,qe\n9,1\n10,1\n", "bad.csv:1:1: the columns are not those of a response"),
                (("--response", bad), "wavelength_um,response\n9,0\n10,0\n", "bad.csv:2:1: response is 0 everywhere"),
                (("--response", bad, "--band", "lwir"), "wavelength_um,response\n9,1\n13,1\n", "outside the stored band"),
                (("--response", self.path / "none.csv"), "", "none.csv:1:1: ")):
            bad.write_text(text)
            done = subprocess.run([IRSIG, "query", db, *map(str, arguments)], capture_output=True, text=True)
            self.assertNotEqual(done.returncode, 0, arguments)
            self.assertIn(said, done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
