"""irsig bands against a reference in numpy that reads the same database through irsig.py, and what it refuses.

usage: bands_test.py <irsig> <repository>
"""
import csv, io, math, pathlib, shutil, sqlite3, subprocess, sys, tempfile, unittest

import numpy

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
sys.path.insert(0, str(ROOT / "python"))
import irsig  # noqa: E402

SWEEP = """
name = "ship"
time = ["03:30Z", "15:30Z"]
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
[[part]]
name = "all"
match = ["*"]
material = "hull"
[[season]]
name = "summer"
date = 2025-06-21
part_temperature_k = {{ all = {kelvin} }}
air_temperature_k = 298.15
sun_irradiance_w_m2 = 1000
surroundings = {{ sea_temperature_k = 298.15, sky_temperature_k = 284.18 }}
[[band]]
name = "mwir"
lambda_min_um = 3.0
lambda_max_um = 5.0
step_um = 0.1
[[band]]
name = "lwir"
lambda_min_um = 8.0
lambda_max_um = 12.0
step_um = 0.2
[viewpoints]
kind = "ring"
range_m = 5000
count = 7
elevation_deg = [5, 40]
[surroundings]
kind = "sea"
sea_emissivity = 0.96
[air]
model = "vacuum"
[transport]
sun = true
max_reflections = 8
[accuracy]
samples_per_replicate = 256
"""
RESPONSE = [(3.05, 0.0), (3.2, 0.4), (3.87, 1.0), (4.6, 0.7), (4.95, 0.0)]
H, C = 6.62607015e-34, 299792458.0


def integrals(lambda_um, response, edges, factor=numpy.ones_like):
    """Weights [edge, bin] of the integrals from the first edge to each of response x factor(wavelength) x spectrum, the spectrum a straight line in
    each bin: through its mean, with the slope of the bins beside it. By Gauss's rule between all corners."""
    step = lambda_um[1] - lambda_um[0]
    bins = len(lambda_um)
    corners = sorted({*edges, *(um for um, _ in response), *(lambda_um - step / 2), lambda_um[-1] + step / 2})
    corners = [um for um in corners if edges[0] <= um <= edges[-1]]
    node, weight = numpy.polynomial.legendre.leggauss(4)
    of_edge = {edges[0]: numpy.zeros(bins)}
    total = numpy.zeros(bins)
    for low, high in zip(corners, corners[1:]):
        um = (low + high) / 2 + (high - low) / 2 * node
        k = min(bins - 1, max(0, int(round(((low + high) / 2 - lambda_um[0]) / step))))
        r = numpy.interp(um, *zip(*response), left=0, right=0) * factor(um) * weight * (high - low) / 2
        below, above = max(0, k - 1), min(bins - 1, k + 1)
        slope = (r @ (um - lambda_um[k])) / (lambda_um[above] - lambda_um[below])
        total[k] += r.sum()
        total[above] += slope
        total[below] -= slope
        for edge in edges:
            if abs(edge - high) < 1e-12:
                of_edge[edge] = total.copy()
    return numpy.array([of_edge[e] for e in edges])


class Bands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        for name, kelvin in (("ship", 300.15), ("decoy", 303.15)):
            (cls.path / f"{name}.toml").write_text(SWEEP.format(kelvin=kelvin))
            cls.irsig("run", cls.path / f"{name}.toml", "--db", cls.path / f"{name}.sigdb")
        cls.db = cls.path / "ship.sigdb"
        (cls.path / "response.csv").write_text("wavelength_um,response\n" + "".join(f"{um},{r}\n" for um, r in RESPONSE))
        (cls.path / "qe.csv").write_text("wavelength_um,quantum_efficiency\n" + "".join(f"{um},{r}\n" for um, r in RESPONSE))
        cls.nei = cls.detector("nei", 'response_file = "response.csv"\n[noise]\nkind = "nei"\nnei_w_m2 = 2e-8\n')
        cls.photons = cls.detector("photons", 'response_file = "qe.csv"\n[noise]\nkind = "background"\naperture_m = 0.05\nf_number = 2\n'
                                   'transmittance = 0.8\npixel_m = 2e-5\nintegration_s = 2e-3\nwell_electrons = 3e5\nread_electrons = 300\n')

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def irsig(cls, *arguments):
        done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stderr
        return done

    @classmethod
    def detector(cls, name, text):
        file = cls.path / f"{name}.toml"
        file.write_text(text)
        return file

    def csv(self, text):
        file = self.path / "bad.csv"
        file.write_text(text)
        return file

    def table(self, *arguments):
        return list(csv.DictReader(io.StringIO(self.irsig("bands", *arguments, "--csv").stdout)))

    def map(self, *arguments):
        self.irsig("bands", *arguments, "--map", self.path / "map.csv")
        rows = list(csv.DictReader(io.StringIO((self.path / "map.csv").read_text())))
        return {(float(r["lambda_min_um"]), float(r["lambda_max_um"])): r for r in rows}

    def spectra(self, db, band="mwir"):
        with irsig.open(db) as opened:
            rows = opened.query(band=band)
            get = lambda name: numpy.array([values for _, values in rows.spectra(name)])  # noqa: E731
            lambda_um = rows.spectra()[0][0]
            order = sorted(range(len(rows)), key=lambda i: (rows["time_utc"][i], rows["aspect_azimuth_deg"][i], rows["aspect_elevation_deg"][i]))
            view = [(rows["aspect_azimuth_deg"][i], rows["aspect_elevation_deg"][i]) for i in order]
            modes = rows.modes("contrast_spectral_intensity_w_sr_um")
            return (lambda_um, get("contrast_spectral_intensity_w_sr_um")[order], get("contrast_spectral_intensity_stderr_w_sr_um")[order],
                    get("background_radiance_w_m2_sr_um")[order], [modes[i] for i in order], view)

    def check(self, found, merit, lambda_um, snr_of):
        edges = sorted({um for window in found for um in window})
        self.assertEqual(len(found), len(edges) * (len(edges) - 1) // 2 - sum(b - a < 0.1 - 1e-9 for i, a in enumerate(edges) for b in edges[i + 1:]))
        for (low, high), row in found.items():
            expected = merit(snr_of(edges.index(low), edges.index(high), edges))
            self.assertAlmostEqual(float(row["merit"]), expected, delta=1e-6 * expected + 1e-12, msg=f"{low} to {high}")

    MERITS = (((), numpy.mean), (("--merit", "worst"), min), (("--merit", "above", "--threshold", "3"), lambda s: numpy.mean(s >= 3)),
              (("--merit", "percentile", "--percentile", "25"), lambda s: sorted(s)[math.ceil(0.25 * len(s) - 1e-9) - 1]))

    def test_every_window_is_that_of_the_reference(self):
        lambda_um, contrast, stderr, _, modes, view = self.spectra(self.db)
        edges = None
        for options, merit in self.MERITS:
            found = self.map(self.db, "--band", "mwir", "--detector", self.nei, "--weight", "rows", *options)
            if edges is None:
                edges = sorted({um for window in found for um in window})
                weights = integrals(lambda_um, RESPONSE, edges)
                self.assertAlmostEqual(edges[0], 3.05)
                self.assertAlmostEqual(edges[-1], 4.95)
            self.check(found, merit, lambda_um,
                       lambda a, b, _: abs(contrast @ (weights[b] - weights[a])) / 5000 ** 2 / 2e-8)
        # The mean's standard error, by modes of views.
        found = self.map(self.db, "--band", "mwir", "--detector", self.nei, "--weight", "rows")
        for (low, high), row in list(found.items())[::17]:
            weight = weights[edges.index(high)] - weights[edges.index(low)]
            variance = 0
            for place in set(view):
                rows = [i for i, v in enumerate(view) if v == place]
                sign = {i: math.copysign(1, contrast[i] @ weight) for i in rows}
                for k in range(max(len(modes[i]) for i in rows)):
                    variance += sum(sign[i] * (modes[i][k] @ weight) for i in rows if k < len(modes[i])) ** 2
                variance += sum(numpy.sqrt(numpy.maximum(0, stderr[i] ** 2 - (modes[i] ** 2).sum(0))) @ weight for i in rows) ** 2
            expected = math.sqrt(variance) / len(view) / 5000 ** 2 / 2e-8
            self.assertAlmostEqual(float(row["samples_stderr"]), expected, delta=1e-3 * expected)

    def test_noise_of_the_background(self):
        lambda_um, contrast, _, background, _, _ = self.spectra(self.db)
        found = self.map(self.db, "--band", "mwir", "--detector", self.photons, "--weight", "rows")
        edges = sorted({um for window in found for um in window})
        weights = integrals(lambda_um, RESPONSE, edges, lambda um: um) * math.pi * 0.05 ** 2 / 4 * 0.8 * 2e-3 * 1e-6 / (H * C)

        full = 0

        def snr(a, b, _):
            nonlocal full
            signal = contrast @ (weights[b] - weights[a]) / 5000 ** 2
            photons = background @ (weights[b] - weights[a]) * (2e-5 / (2 * 0.05)) ** 2
            kept = numpy.minimum(1, 3e5 / photons)
            full += (kept < 1).sum()
            return abs(kept * signal) / numpy.sqrt(kept * photons + 300 ** 2)
        self.check(found, numpy.mean, lambda_um, snr)
        self.assertTrue(0 < full < len(found) * len(contrast))  # the well fills in some of them

    def test_two_targets(self):
        lambda_um, ship, *_ = self.spectra(self.db)
        _, decoy, *_ = self.spectra(self.path / "decoy.sigdb")
        found = self.map(self.db, "--band", "mwir", "--detector", self.nei, "--weight", "rows", "--against", self.path / "decoy.sigdb")
        edges = sorted({um for window in found for um in window})
        weights = integrals(lambda_um, RESPONSE, edges)
        self.check(found, numpy.mean, lambda_um, lambda a, b, _: abs((ship - decoy) @ (weights[b] - weights[a])) / 5000 ** 2 / 2e-8)

    def test_listed_windows_differ(self):
        window = lambda row, name: (float(row[f"{name}_min_um"]), float(row[f"{name}_max_um"]))  # noqa: E731

        def shared(a, b):
            both = max(0, min(a[1], b[1]) - max(a[0], b[0]))
            return both / (a[1] - a[0] + b[1] - b[0] - both)

        for options, names in (((), ("lambda",)), (("--pairs", "matched"), ("lambda", "second")), (("--pairs", "difference"), ("lambda", "second"))):
            asked = (self.db, "--band", "mwir", "--detector", self.nei, *options)
            rows = self.table(*asked)
            self.assertGreater(len(rows), 2)
            for i, row in enumerate(rows):
                for above in rows[:i]:
                    self.assertLessEqual(min(shared(window(row, name), window(above, name)) for name in names), 0.5 + 1e-9, (row, above))
            alike = self.table(*asked, "--overlapping")
            self.assertEqual(alike[0]["merit"], rows[0]["merit"])
            self.assertGreater(max(min(shared(window(row, name), window(above, name)) for name in names)
                                   for i, row in enumerate(alike) for above in alike[:i]), 0.5)
            for row, better in zip(rows, alike):
                self.assertGreaterEqual(float(better["merit"]), float(row["merit"]))
            self.assertGreater(float(alike[-1]["merit"]), float(rows[-1]["merit"]))

    def test_margin(self):
        rows = self.table(self.db, "--band", "mwir", "--detector", self.nei, "--top", "40", "--overlapping")
        self.assertEqual(len(rows), 40)
        for column in ("best", "best_numerical"):
            self.assertAlmostEqual(sum(float(r[column]) for r in rows), 1)
        self.assertEqual(float(rows[0]["as_good"]), 1)
        found = self.map(self.db, "--band", "mwir", "--detector", self.nei)
        merits = sorted((float(r["merit"]) for r in found.values()), reverse=True)
        for row, merit in zip(rows, merits):
            self.assertAlmostEqual(float(row["merit"]), merit)
            # Drawn against computed: 400 draws scatter by 1 / sqrt(800) of it.
            computed = float(found[float(row["lambda_min_um"]), float(row["lambda_max_um"])]["samples_stderr"])
            self.assertAlmostEqual(float(row["samples_stderr"]) / computed, 1, delta=0.2)
            self.assertGreaterEqual(float(row["numerical_error"]), 0.95 * float(row["samples_stderr"]))
            # Two sigma away is told; what is as good as the first is not.
            if float(row["as_good"]) > 0.2 and row["rank"] != "1":
                self.assertTrue(row["samples_to_tell"] == "" or float(row["samples_to_tell"]) > 1, row)
            if float(row["as_good"]) == 0:
                self.assertTrue(row["samples_to_tell"] == "" or float(row["samples_to_tell"]) < 5, row)
        self.assertEqual(float(rows[0]["samples_to_tell"]), 0)
        # Ten times the noise: a tenth of every merit and error, and the same order.
        loud = self.detector("loud", 'response_file = "response.csv"\n[noise]\nkind = "nei"\nnei_w_m2 = 2e-7\n')
        for a, b in zip(rows, self.table(self.db, "--band", "mwir", "--detector", loud, "--top", "40", "--overlapping")):
            for column in ("merit", "samples_stderr", "numerical_error", "total_error"):
                self.assertAlmostEqual(float(a[column]), 10 * float(b[column]), delta=1e-9 * float(a[column]))
        # Without modes errors are taken as one: never smaller.
        old = self.path / "old.sigdb"
        shutil.copy(self.db, old)
        sql = sqlite3.connect(old)
        sql.execute("DELETE FROM spectral_modes")
        sql.commit()
        sql.close()
        done = self.irsig("bands", old, "--band", "mwir", "--detector", self.nei, "--csv", "--map", self.path / "old.csv")
        self.assertIn("they are taken as one", done.stderr)
        for row in csv.DictReader(io.StringIO((self.path / "old.csv").read_text())):
            known = found[float(row["lambda_min_um"]), float(row["lambda_max_um"])]
            self.assertGreaterEqual(float(row["samples_stderr"]), 0.999 * float(known["samples_stderr"]))

    def test_ranges(self):
        """Without air s goes as 1 / R^2: the range at which it falls to a threshold is known."""
        done = self.irsig("bands", self.db, "--band", "mwir", "--detector", self.nei, "--window", "3.05,4.95", "--csv",
                          "--range-m", "4000,8000,300000", "--threshold", "5")
        lambda_um, contrast, *_ = self.spectra(self.db)
        weight = integrals(lambda_um, RESPONSE, [3.05, 4.95])[1]
        ranges = sorted(math.sqrt(abs(j) / 2e-8 / 5) for j in contrast @ weight)
        said = done.stderr.split("half ")[1].split(" m,")[0]
        self.assertAlmostEqual(float(said), ranges[(len(ranges) - 1) // 2], delta=2e-3 * float(said))

    def test_solid_angles_of_some_aspects(self):
        """What is not chosen, or not there, gives its weight to nobody: those at the edge count no more than those in the middle."""
        def weights(*options):
            file = self.path / "solid.csv"
            self.irsig("bands", self.db, "--band", "mwir", "--detector", self.nei, "--window", "3.05,4.95", "--range-m", "4000,8000", "--detection", file, *options)
            return {(float(r["aspect_azimuth_deg"]), float(r["aspect_elevation_deg"])): float(r["weight"]) for r in csv.DictReader(file.open())}
        for options in ((), ("--aspect", "0,5", "--within", "110")):
            found = weights(*options)
            self.assertEqual(len(found), 14 if not options else len(found))
            for elevation in (5, 40):
                ring = [w for (_, e), w in found.items() if e == elevation]
                self.assertGreaterEqual(len(ring), 3)
                self.assertLess(max(ring) / min(ring), 1.05, found)

    def test_two_sweeps_in_the_other_file(self):
        other, both = self.path / "other.sigdb", self.path / "both.sigdb"
        (self.path / "other.toml").write_text(SWEEP.format(kelvin=310).replace('name = "ship"', 'name = "decoy"', 1))
        self.irsig("run", self.path / "other.toml", "--db", other)
        self.irsig("merge", self.db, other, "--out", both)
        options = (self.db, "--band", "mwir", "--detector", self.nei, "--window", "3.05,4.95", "--against", both)
        done = subprocess.run([IRSIG, "bands", *map(str, options)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("--against-sweep", done.stderr)
        self.assertEqual(float(self.table(*options, "--against-sweep", "ship")[0]["merit"]), 0)
        self.assertGreater(float(self.table(*options, "--against-sweep", "decoy")[0]["merit"]), 0)

    def test_weights_of_ones_own(self):
        lambda_um, contrast, _, _, _, view = self.spectra(self.db)
        edges = [3.05, 4.95]
        snr = abs(contrast @ integrals(lambda_um, RESPONSE, edges)[1]) / 5000 ** 2 / 2e-8
        times = self.times(self.db)
        (self.path / "hours.csv").write_text("time_utc,weight\n" + "".join(f"{t},{w}\n" for t, w in zip(sorted(set(times)), (1, 3))))
        (self.path / "aspects.csv").write_text("# bow and stern\naspect_azimuth_deg,aspect_elevation_deg,weight\n2,6,1\n-1,4,1\n181,39,5\n")

        def merit(*weights):
            options = sum((["--weights", self.path / name] for name in weights), [])
            return float(self.table(self.db, "--band", "mwir", "--detector", self.nei, "--window", "3.05,4.95", *options, "--weight", "rows")[0]["merit"])
        of_hour = numpy.array([1 if t == min(times) else 3 for t in times])
        self.assertAlmostEqual(merit("hours.csv"), (of_hour * snr).sum() / of_hour.sum(), delta=1e-6 * snr.mean())
        # Two directions to the viewpoint ahead, five times one to the one nearest to (181, 39).
        unit = lambda az, el: numpy.array([math.cos(math.radians(el)) * math.cos(math.radians(az)),  # noqa: E731
                                           math.cos(math.radians(el)) * math.sin(math.radians(az)), math.sin(math.radians(el))])
        nearest = lambda az, el: max(set(view), key=lambda v: unit(*v) @ unit(az, el))  # noqa: E731
        of_aspect = {}
        for az, el, w in ((2, 6, 1), (-1, 4, 1), (181, 39, 5)):
            of_aspect[nearest(az, el)] = of_aspect.get(nearest(az, el), 0) + w
        self.assertEqual(sorted(of_aspect.values()), [2, 5])
        expected = sum(w * snr[[i for i, v in enumerate(view) if v == a]].mean() for a, w in of_aspect.items()) / 7
        self.assertAlmostEqual(merit("aspects.csv"), expected, delta=1e-6 * expected)
        expected = sum(w * (numpy.array([1, 3]) @ [snr[i] for i, v in enumerate(view) if v == a]) / 4 for a, w in of_aspect.items()) / 7
        self.assertAlmostEqual(merit("aspects.csv", "hours.csv"), expected, delta=1e-6 * expected)

    def test_rows_of_an_aspect_share_its_weight(self):
        """Whose rows are not all there yet has the weight of its direction all the same."""
        lambda_um, contrast, _, _, _, view = self.spectra(self.db)
        snr = abs(contrast @ integrals(lambda_um, RESPONSE, [3.05, 4.95])[1]) / 5000 ** 2 / 2e-8
        places = sorted(set(view))
        (self.path / "two.csv").write_text("aspect_azimuth_deg,aspect_elevation_deg,weight\n" + "".join(f"{a},{e},{w}\n" for (a, e), w in zip(places[:2], (1, 3))))
        less = self.path / "unfinished.sigdb"
        shutil.copy(self.db, less)
        sql = sqlite3.connect(less)
        sql.execute("PRAGMA foreign_keys = ON")
        sql.execute("DELETE FROM signature WHERE signature_id = (SELECT signature_id FROM signature_view WHERE band = 'mwir' AND aspect_azimuth_deg = ? "
                    "AND aspect_elevation_deg = ? ORDER BY time_utc DESC LIMIT 1)", places[0])
        sql.commit()
        sql.close()
        of = [[snr[i] for i, v in enumerate(view) if v == place] for place in places[:2]]
        expected = (of[0][0] + 3 * numpy.mean(of[1])) / 4  # rows are in the order of their times
        found = self.table(less, "--band", "mwir", "--detector", self.nei, "--window", "3.05,4.95", "--weights", self.path / "two.csv")
        self.assertAlmostEqual(float(found[0]["merit"]), expected, delta=1e-6 * expected)

    def times(self, db):
        with irsig.open(db) as opened:
            rows = opened.query(band="mwir")
            return sorted(rows["time_utc"])

    def pairs(self, kind, *options):
        self.irsig("bands", self.db, "--band", "mwir", "--pairs", kind, "--weight", "rows", *options, "--map", self.path / "pairs.csv")
        return list(csv.DictReader(io.StringIO((self.path / "pairs.csv").read_text())))

    def check_pairs(self, found, table, edges, snr_of):
        """Every pair by the reference: the best that each window is part of, and the best of all."""
        span = [(a, b) for a in range(len(edges)) for b in range(a + 1, len(edges)) if edges[b] - edges[a] > 0.4 - 1e-9]
        best = {}
        for one in span:
            for other in span:
                if other[0] < one[1] and one[0] < other[1]:
                    continue
                if other[0] < one[1]:
                    continue  # the first lies below the second
                merit = snr_of(one, other).mean()
                for w in (one, other):
                    best[w] = max(best.get(w, 0), merit)
        self.assertEqual(len(found), len(best))
        for row in found:
            w = edges.index(float(row["lambda_min_um"])), edges.index(float(row["lambda_max_um"]))
            self.assertAlmostEqual(float(row["merit"]), best[w], delta=1e-6 * best[w])
        self.assertAlmostEqual(float(table[0]["merit"]), max(best.values()), delta=1e-6 * max(best.values()))

    def test_differences_take_the_background_away(self):
        lambda_um, contrast, _, background, _, _ = self.spectra(self.db)
        edges = sorted({float(r[c]) for r in self.pairs("difference", "--detector", self.photons) for c in ("lambda_min_um", "lambda_max_um")})
        rate = math.pi * 0.05 ** 2 / 4 * 0.8 * 2e-3 * 1e-6 / (H * C)
        weights = integrals(lambda_um, RESPONSE, edges, lambda um: um) * rate
        gains, left = {}, {}

        def snr(one, other):
            w1, w2 = weights[one[1]] - weights[one[0]], weights[other[1]] - weights[other[0]]
            b1, b2 = background @ w1, background @ w2
            gain = gains[one, other] = math.sqrt((b1 @ b1) / (b2 @ b2))
            left[one, other] = math.sqrt(((b1 - gain * b2) ** 2).sum() / (b1 @ b1))
            variance = 0
            for b, g in ((b1, 1), (b2, gain)):
                photons = b * (2e-5 / (2 * 0.05)) ** 2
                full = numpy.maximum(1, photons / 3e5)
                variance = variance + g ** 2 * (full * photons + full ** 2 * 300 ** 2)
            return abs(contrast @ w1 - gain * (contrast @ w2)) / 5000 ** 2 / numpy.sqrt(variance)
        options = "--detector", self.photons, "--min-width-um", "0.4"
        found = self.pairs("difference", *options)
        table = self.table(self.db, "--band", "mwir", "--pairs", "difference", "--weight", "rows", *options)
        self.check_pairs(found, table, edges, snr)
        first = table[0]
        pair = tuple((edges.index(float(first[f"{n}_min_um"])), edges.index(float(first[f"{n}_max_um"]))) for n in ("lambda", "second"))
        self.assertAlmostEqual(float(first["gain"]), gains[pair], delta=1e-6)
        self.assertAlmostEqual(float(first["background_left"]), left[pair], delta=1e-5)
        # With the windows the other way round it is the same.
        limits = [f"{first[f'{n}_min_um']},{first[f'{n}_max_um']}" for n in ("second", "lambda")]
        turned = self.table(self.db, "--band", "mwir", "--pairs", "difference", "--weight", "rows", *options[:2], "--window", limits[0], "--window", limits[1])[0]
        self.assertAlmostEqual(float(turned["merit"]), float(first["merit"]), delta=1e-9 * float(first["merit"]))
        for column in ("best", "best_numerical"):
            self.assertAlmostEqual(sum(float(r[column]) for r in table), 1)

    def test_ratios_tell_targets_apart(self):
        lambda_um, ship, *_ = self.spectra(self.db)
        _, decoy, *_ = self.spectra(self.path / "decoy.sigdb")
        options = "--detector", self.nei, "--against", self.path / "decoy.sigdb", "--min-width-um", "0.4"
        found = self.pairs("ratio", *options)
        edges = sorted({float(r[c]) for r in found for c in ("lambda_min_um", "lambda_max_um", "second_min_um", "second_max_um")})
        edges = sorted({*edges, *(float(r["lambda_min_um"]) for r in self.pairs("ratio", *options[:4]))})
        weights = integrals(lambda_um, RESPONSE, edges)

        def snr(one, other):
            a, b = ([j @ (weights[w[1]] - weights[w[0]]) / 5000 ** 2 / 2e-8 for w in (one, other)] for j in (ship, decoy))
            za, zb = a[0] + 1j * a[1], b[0] + 1j * b[1]
            return abs(numpy.angle(zb / za)) / numpy.sqrt(abs(za) ** -2 + abs(zb) ** -2)
        table = self.table(self.db, "--band", "mwir", "--pairs", "ratio", "--weight", "rows", *options)
        self.check_pairs(found, table, edges, snr)
        # A target against itself has the same colours.
        same = self.table(self.db, "--band", "mwir", "--detector", self.nei, "--pairs", "ratio", "--against", self.db, "--window", "3.4,3.9", "--window", "4.4,4.9")
        self.assertLess(float(same[0]["merit"]), 1e-6 * float(table[0]["merit"]))

    def test_clutter(self):
        """Windows and pairs against a background of two modes, by the reference."""
        lambda_um, contrast, *_ = self.spectra(self.db)
        bins = len(lambda_um)
        sigma = (0.02 * (1 + numpy.arange(bins) / bins)).astype("<f4")
        modes = numpy.array([numpy.full(bins, 26214), 19660 * numpy.where(numpy.arange(bins) < bins // 2, 1, -1)]).astype("<i2")
        land = self.path / "land.sigdb"
        shutil.copy(self.db, land)
        sql = sqlite3.connect(land)
        names = [n for (n,) in sql.execute("SELECT name FROM pragma_table_info('signature') WHERE name LIKE 'clutter%' OR name = 'visible_fraction'")]
        sql.execute("UPDATE signature SET " + ", ".join(f"{n} = 1" for n in names) + " WHERE band_id IN (SELECT band_id FROM band WHERE name = 'mwir')")
        sql.execute("UPDATE signature SET clutter_patch_sigma_stderr_w_m2_sr = 0.1 WHERE clutter_cells = 1")
        sql.execute("INSERT INTO clutter SELECT signature_id, ?, ? FROM signature WHERE clutter_cells = 1", (sigma.tobytes(), modes.tobytes()))
        sql.commit()
        sql.close()
        with irsig.open(land) as opened:
            rows = opened.query(band="mwir")
            order = sorted(range(len(rows)), key=lambda i: (rows["time_utc"][i], rows["aspect_azimuth_deg"][i], rows["aspect_elevation_deg"][i]))
            area = numpy.array(rows["projected_area_m2"])[order]
        found = self.map(land, "--band", "mwir", "--detector", self.nei, "--weight", "rows", "--clutter")
        edges = sorted({um for window in found for um in window})
        weights = integrals(lambda_um, RESPONSE, edges)

        def seen(window):
            w = (weights[window[1]] - weights[window[0]]) / 5000 ** 2
            return contrast @ w, numpy.outer(area, (modes / 32767 * sigma) @ w)
        for options, merit in self.MERITS:
            def scnr(a, b, _):
                signal, mode = seen((a, b))
                return abs(signal) / numpy.sqrt(2e-8 ** 2 + (mode ** 2).sum(1))
            found = self.map(land, "--band", "mwir", "--detector", self.nei, "--weight", "rows", "--clutter", *options)
            self.check(found, merit, lambda_um, scnr)
        plain = self.map(self.db, "--band", "mwir", "--detector", self.nei, "--weight", "rows")
        self.assertLess(float(found[edges[0], edges[-1]]["merit"]), 0.5 * float(plain[edges[0], edges[-1]]["merit"]))

        def matched(one, other):
            (s1, m1), (s2, m2) = seen(one), seen(other)
            v1, v2, w = (2e-8 ** 2 + (m1 ** 2).sum(1)), (2e-8 ** 2 + (m2 ** 2).sum(1)), (m1 * m2).sum(1)
            return numpy.array([math.sqrt(numpy.array([a, b]) @ numpy.linalg.solve([[x, z], [z, y]], [a, b])) for a, b, x, y, z in zip(s1, s2, v1, v2, w)])
        options = "--detector", self.nei, "--min-width-um", "0.4", "--clutter"
        table = self.table(land, "--band", "mwir", "--pairs", "matched", "--weight", "rows", *options)
        all_rows = list(csv.DictReader(io.StringIO(self.irsig("bands", land, "--band", "mwir", "--pairs", "matched", "--weight", "rows", *options,
                                                              "--map", self.path / "pairs.csv", "--csv").stdout)))
        self.assertEqual(all_rows, table)
        self.check_pairs(list(csv.DictReader(io.StringIO((self.path / "pairs.csv").read_text()))), table, edges, matched)
        for row in table:
            self.assertTrue(0 <= float(row["clutter_fraction"]) <= 1)
        # Its own standard error of a tenth is in the merit's.
        one = self.table(land, "--band", "mwir", "--detector", self.nei, "--weight", "rows", "--clutter", "--window", "3.05,4.95")[0]
        self.assertGreater(float(one["numerical_error"]), 0.01 * float(one["merit"]))
        # Without air, contrast and clutter fall alike.
        far = self.irsig("bands", land, "--band", "mwir", "--detector", self.nei, "--clutter", "--range-m", "4000,8000", "--csv").stderr
        self.assertIn("SCNR 5 of ", far)

    def test_filters(self):
        """A filter that is a window is that window; a slope is that of the reference."""
        lambda_um, contrast, *_ = self.spectra(self.db)
        (self.path / "box.csv").write_text("wavelength_um,transmittance\n3.45,1\n4.05,1\n")
        (self.path / "slope.csv").write_text("wavelength_um,transmittance\n3.5,0.1\n4.5,0.9\n")
        filters = "--filter", self.path / "box.csv", "--filter", self.path / "slope.csv"
        rows = self.table(self.db, "--band", "mwir", "--detector", self.nei, "--weight", "rows", *filters, "--window", "3.45,4.05")
        by_name = {r["filter"]: r for r in rows}
        self.assertEqual(set(by_name), {"box", "slope", ""})
        for column in ("merit", "samples_stderr", "numerical_error", "total_error"):
            self.assertAlmostEqual(float(by_name["box"][column]), float(by_name[""][column]), delta=1e-6 * float(by_name[""]["merit"]))
        ramp = lambda um: 0.1 + 0.8 * (um - 3.5)  # noqa: E731
        expected = abs(contrast @ integrals(lambda_um, RESPONSE, [3.5, 4.5], ramp)[1]).mean() / 5000 ** 2 / 2e-8
        self.assertAlmostEqual(float(by_name["slope"]["merit"]), expected, delta=1e-6 * expected)
        self.table(self.db, "--band", "mwir", "--detector", self.nei, *filters[2:], "--response-out", self.path / "through.csv")
        through = [tuple(map(float, line.split(","))) for line in (self.path / "through.csv").read_text().splitlines()[1:]]
        self.assertAlmostEqual(numpy.interp(4.2, *zip(*through)), numpy.interp(4.2, *zip(*RESPONSE)) * ramp(4.2), delta=1e-6)
        two = self.table(self.db, "--band", "mwir", "--detector", self.photons, *filters, "--pairs", "difference")
        self.assertEqual({(r["filter"], r["second_filter"]) for r in two}, {("box", "slope")})

    def test_how_far(self):
        """Without air s goes as 1 / R^2: each row is seen as far as its s at one range says."""
        lambda_um, contrast, *_, view = self.spectra(self.db)
        options = ("--band", "mwir", "--detector", self.nei, "--window", "3.05,4.95", "--weight", "rows", "--range-m", "4000,8000,300000", "--threshold", "5")
        self.irsig("bands", self.db, *options, "--detection", self.path / "far.csv", "--ranges", self.path / "ranges.csv")

        def irradiances(window):
            return abs(contrast @ integrals(lambda_um, RESPONSE, window)[1]) / 2e-8

        irradiance = numpy.sort(irradiances([3.05, 4.95]))
        far = list(csv.DictReader(io.StringIO((self.path / "far.csv").read_text())))
        self.assertEqual({(float(r["aspect_azimuth_deg"]), float(r["aspect_elevation_deg"])) for r in far}, set(view))
        self.assertAlmostEqual(sum(float(r["weight"]) for r in far), 1)
        for found, expected in zip(sorted(float(r["detection_range_m"]) for r in far), numpy.sqrt(irradiance / 5)):
            self.assertAlmostEqual(found, expected, delta=4e-3 * expected)
        for row in csv.DictReader(io.StringIO((self.path / "ranges.csv").read_text())):
            expected = irradiance.mean() / float(row["range_m"]) ** 2
            self.assertAlmostEqual(float(row["merit"]), expected, delta=4e-2 * expected)  # what stands behind changes with the range, too
        self.irsig("bands", self.db, *options, "--ranges", self.path / "ranges.svg")
        self.assertIn("3.05 to 4.95 um", (self.path / "ranges.svg").read_text())
        # As a merit: up to where all but so many are seen.
        (row,) = self.table(self.db, *options, "--merit", "range", "--percentile", "30")
        expected = numpy.sqrt(irradiance / 5)[math.ceil(0.3 * len(view)) - 1]
        self.assertAlmostEqual(float(row["merit"]), expected, delta=4e-2 * expected)
        self.assertLess(float(row["total_error"]), 0.5 * expected)
        # Beyond the ranges it goes on, nobody knows how surely, and no window is told from another.
        for threshold, said, nearest in (("1e-9", "farther than the farthest range, 300000 m", False), ("1e15", "less far than the nearest range, 4000 m", True)):
            done = self.irsig("bands", self.db, *options[:-1], threshold, "--window", "3.05,4.05", "--merit", "range", "--percentile", "30", "--csv")
            for row, window in zip(csv.DictReader(io.StringIO(done.stdout)), ([3.05, 4.95], [3.05, 4.05])):
                self.assertEqual([float(row["lambda_min_um"]), float(row["lambda_max_um"])], window)
                expected = numpy.sqrt(numpy.sort(irradiances(window)) / float(threshold))[math.ceil(0.3 * len(view)) - 1]
                self.assertAlmostEqual(float(row["merit"]), expected, delta=4e-2 * expected)
                for column in "samples_stderr", "numerical_error", "total_error", "best", "best_numerical", "as_good", "as_good_numerical", "samples_to_tell":
                    self.assertEqual(row[column], "", column)
            self.assertIn(said, done.stderr)
            self.assertNotIn("told from all", done.stderr)
        # A range that is just within them has the errors that it has far from their end (samples; bounds depend on how far a row is moved).
        order = numpy.sort(irradiances([3.05, 4.95]))[math.ceil(0.3 * len(view)) - 1]
        near_end, far_from_it = (
            self.table(self.db, *options[:8], "--range-m", ranges, "--threshold", order / 299000 ** 2, "--merit", "range", "--percentile", "30")[0]
            for ranges in ("4000,300000", "4000,900000"))
        self.assertAlmostEqual(float(near_end["merit"]), 299000, delta=1000)
        for column in "merit", "samples_stderr":
            self.assertAlmostEqual(float(near_end[column]) / float(far_from_it[column]), 1, delta=1e-3)
        options = ("--band", "mwir", "--detector", self.photons, "--range-m", "4000,300000", "--merit", "range")
        best = self.table(self.db, *options, "--top", "3")
        self.assertEqual(len(best), 3)
        for found in best:
            (again,) = self.table(self.db, *options, "--window", f"{found['lambda_min_um']},{found['lambda_max_um']}")
            self.assertEqual(again["merit"], found["merit"])
        (other,) = self.table(self.db, *options, "--window", "4.5,4.9")
        self.assertLess(float(other["merit"]), float(best[0]["merit"]))

    def test_damaged_spectra_are_refused(self):
        damaged = self.path / "damaged.sigdb"
        column = "contrast_spectral_intensity_w_sr_um"
        for number in "0000c07f", "0000807f":  # NaN, infinite
            shutil.copy(self.db, damaged)
            database = sqlite3.connect(damaged)
            database.execute(f"UPDATE spectrum SET {column} = CAST(substr({column}, 1, length({column}) - 4) || x'{number}' AS BLOB) WHERE signature_id = 3")
            database.commit()
            database.close()
            for merit in "mean", "percentile", "range":
                done = subprocess.run([IRSIG, "bands", damaged, "--band", "mwir", "--detector", self.nei, "--merit", merit, "--range-m", "4000,8000"],
                                      capture_output=True, text=True)
                self.assertNotEqual(done.returncode, 0)
                self.assertEqual(done.stdout, "")
                self.assertIn("signature 3: a stored spectrum has what is no finite number; `irsig doctor` lists", done.stderr)

    def test_files(self):
        best = self.path / "best.csv"
        picture = self.path / "map.svg"
        rows = self.table(self.db, "--band", "mwir", "--detector", self.nei, "--map", picture, "--response-out", best)
        self.assertTrue(picture.read_text().rstrip().endswith("</svg>"))
        low, high = float(rows[0]["lambda_min_um"]), float(rows[0]["lambda_max_um"])
        points = [tuple(map(float, line.split(","))) for line in best.read_text().splitlines()[1:]]
        self.assertAlmostEqual(points[0][0], low)
        self.assertAlmostEqual(points[-1][0], high)
        through = list(csv.DictReader(io.StringIO(self.irsig("query", self.db, "--band", "mwir", "--response", best, "--csv").stdout)))
        mean = numpy.mean([abs(float(r["in_band_contrast_intensity_w_sr"])) for r in through]) / 5000 ** 2 / 2e-8
        one = self.table(self.db, "--band", "mwir", "--detector", self.nei, "--weight", "rows", "--window", f"{low},{high}")
        self.assertAlmostEqual(float(one[0]["merit"]), mean, delta=1e-6 * mean)

    def test_what_is_wrong_is_said(self):
        def refused(detector, said, *arguments):
            done = subprocess.run([IRSIG, "bands", str(self.db), "--detector", str(detector), *(arguments or ("--band", "mwir"))],
                                  capture_output=True, text=True)
            with self.subTest(said):
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(said, done.stderr)

        def file(text):
            return self.detector("bad", text)
        refused(file('name = "a"\n'), "bad.toml:1:1: [noise] is missing")
        refused(file("[noise]\nnei_w_m2 = 1e-9\n"), "bad.toml:1:2: noise.kind is missing")
        refused(file('[noise]\nkind = "quiet"\n'), "bad.toml:2:1: noise.kind")
        refused(file('[noise]\nkind = "nei"\n'), "bad.toml:1:2: noise.nei_w_m2 is missing")
        refused(file('[noise]\nkind = "nei"\nnei_w_m2 = 0\n'), "bad.toml:3:1: noise.nei_w_m2 = 0")
        refused(file('[noise]\nkind = "nei"\nnei_w_m2 = 1e-9\nnetd_k = 0.02\n'), "bad.toml:4:1: noise.netd_k")
        refused(file('[noise]\nkind = "nei"\nnei_w_m2 = 1e-9\nnei = 1\n'), "bad.toml:4:1: ")
        refused(file('[noise]\nkind = "background"\naperture_m = 0.05\n'), "response_file is missing")
        refused(file('response_file = "none.csv"\n[noise]\nkind = "nei"\nnei_w_m2 = 1e-9\n'), "none.csv:1:1: ")
        refused(file('response_file = "qe.csv"\n[noise]\nkind = "nei"\nnei_w_m2 = 1e-9\n'), "qe.csv:1:1: the columns are not those")
        refused(self.path / "none.toml", "none.toml:1:1: ")
        refused(self.nei, "outside the stored band, 8 to 12 um", "--band", "lwir")
        refused(self.nei, "choose one with --band", "--season", "summer")
        refused(self.nei, "narrower than the stored step of 0.1 um; ask for step_um = 0.05", "--band", "mwir", "--min-width-um", "0.05")
        refused(self.nei, "narrower than the stored step of 0.1 um", "--band", "mwir", "--window", "4,4.05")
        refused(self.nei, "outside of what is stored", "--band", "mwir", "--window", "2.5,4")
        refused(self.nei, "wider than what is stored", "--band", "mwir", "--min-width-um", "3")
        refused(self.nei, "lengths of the target", "--band", "mwir", "--range-m", "500")
        refused(self.nei, "at 5000 m alone: ask for several (--range-m)", "--band", "mwir", "--merit", "range")
        refused(self.nei, "--ranges is the merit at each range", "--band", "mwir", "--merit", "range", "--range-m", "6000,8000", "--ranges", "ranges.csv")
        refused(self.nei, "has no clutter, nor has any other: neither [land] nor a sea", "--band", "mwir", "--clutter")
        refused(self.nei, "give the other one", "--band", "mwir", "--pairs", "ratio")
        refused(self.nei, "expected two or more", "--band", "mwir", "--pairs", "difference", "--window", "3.1,3.9")
        refused(self.nei, "not with --window", "--band", "mwir", "--window", "3.1,3.9", "--map", "map.svg")
        refused(self.nei, "nothing of what the detector responds to", "--band", "mwir", "--filter", str(self.csv("wavelength_um,transmittance\n8,1\n9,1\n")))
        refused(self.nei, "bad.csv:1:1: transmittance 1.5 at 3.5 um", "--band", "mwir", "--filter", str(self.csv("wavelength_um,transmittance\n3.5,1.5\n4,1\n")))
        for text, said in (("season,weigth\n", 'bad.csv:1:8: unknown column "weigth"'), ("season\nsummer\n", "bad.csv:1:1: expected the columns"),
                           ("season,weight\nwinter,1\n", 'no line for season "summer"'), ("season,weight\nsummer,-1\n", "bad.csv:2:8: weight"),
                           ("season,weight\nsummer,0\n", "no line has a weight above 0"), ("season,weight\nsummer,1\nsummer,2\n", "bad.csv:3:1: the same place"),
                           ("aspect_azimuth_deg,weight\n0,1\n", "bad.csv:1:1: expected"), ("season,weight\nsummer\n", "bad.csv:2:1: 1 cells")):
            refused(self.nei, said, "--band", "mwir", "--weights", str(self.csv(text)))
        refused(self.nei, "--percentile 0", "--band", "mwir", "--percentile", "0")
        refused(self.nei, "ends in .svg or .csv", "--band", "mwir", "--map", "map.png")
        newer = self.path / "newer.sigdb"
        shutil.copy(self.db, newer)
        sql = sqlite3.connect(newer)
        sql.execute("PRAGMA user_version = 999")
        sql.close()
        done = subprocess.run([IRSIG, "bands", str(newer), "--detector", str(self.nei)], capture_output=True, text=True)
        self.assertIn("999", done.stderr)
        # The other target lacks a place.
        less = self.path / "less.sigdb"
        shutil.copy(self.path / "decoy.sigdb", less)
        sql = sqlite3.connect(less)
        sql.execute("PRAGMA foreign_keys = ON")
        sql.execute("DELETE FROM signature WHERE signature_id = (SELECT max(signature_id) FROM signature_view WHERE band = 'mwir')")
        sql.commit()
        sql.close()
        refused(self.nei, "the other target has no row for", "--band", "mwir", "--against", str(less))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
