"""Whether `irsig bands` states its margins truly: of windows that it takes for as good as the first with a probability p, as many
must be. Many seeds of one coarse sweep against a run of 2500 times the samples; windows of much the same merit, drawn at random, in
the populations of single viewpoints. Sunlit paint whose colour changes with wavelength, behind the air, above a sea.

usage: bands_calibration_test.py <irsig> <repository> [seeds]      8 of them; 200 for the table of docs/evidence/validation.md
"""
import csv, io, pathlib, random, subprocess, sys, tempfile, unittest

import numpy

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
SEEDS = int(sys.argv[3]) if len(sys.argv) > 3 else 8
VIEWPOINTS, WINDOWS, SPREAD = 6, 8, 0.1
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
emissivity_table = [ {{ lambda_um = 2.5, value = 0.5 }}, {{ lambda_um = 3.6, value = 0.9 }}, {{ lambda_um = 5.5, value = 0.6 }} ]
[[part]]
name = "cool"
match = ["hull", "superstructure", "mast", "turret"]
material = "paint"
temperature_k = 295.15
[[part]]
name = "warm"
match = ["deck", "funnel"]
material = "paint"
temperature_k = 299.15
[[part]]
name = "hot"
match = ["*_top", "*_hot"]
material = "paint"
temperature_k = 320
[[season]]
name = "summer"
date = 2025-06-21
profile = "midlatitude_summer"
wind_speed_m_s = 5
air_temperature_k = 294.15
relative_humidity_percent = 75
pressure_pa = 101300
surroundings = {{ sea_temperature_k = 293.15 }}
[[band]]
name = "mwir"
lambda_min_um = 3
lambda_max_um = 5
step_um = 0.05
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
[output]
thumbnail_px = 0
[accuracy]
samples_per_replicate = {samples}
"""
DETECTOR = """
[noise]
kind = "background"
aperture_m = 0.05
f_number = 2
transmittance = 0.8
pixel_m = 2e-5
integration_s = 2e-4
well_electrons = 3e8
read_electrons = 300
"""


def run(*arguments):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=3000)
    assert done.returncode == 0, done.stderr
    return done.stdout


class Calibration(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        (self.path / "qe.csv").write_text("wavelength_um,quantum_efficiency\n3.05,0\n3.2,0.4\n3.87,0.6\n4.6,0.6\n4.95,0\n")
        self.detector = self.path / "detector.toml"
        self.detector.write_text('response_file = "qe.csv"\n' + DETECTOR)

    def sweep(self, name, seed, samples):
        file, db = self.path / f"{name}.toml", self.path / f"{name}.sigdb"
        file.write_text(SWEEP.format(seed=seed, samples=samples, viewpoints=VIEWPOINTS))
        run("run", file, "--db", db)
        return db

    def bands(self, db, row, *arguments):
        return run("bands", db, "--band", "mwir", "--row", row, "--detector", self.detector, "--csv", *arguments)

    def test_as_many_are_as_good_as_it_says(self):
        db = self.sweep("true", 1, 20000)
        truth = []
        for row in range(1, VIEWPOINTS + 1):
            self.bands(db, row, "--map", self.path / "map.csv")
            truth.append({(r["lambda_min_um"], r["lambda_max_um"]): float(r["merit"])
                          for r in csv.DictReader(io.StringIO((self.path / "map.csv").read_text()))
                          if 0.15 < float(r["lambda_max_um"]) - float(r["lambda_min_um"]) < 0.8})
        dice = random.Random(7)
        found = []
        for seed in range(100, 100 + SEEDS):
            db = self.sweep("seed", seed, 8)
            for row, true in enumerate(truth, 1):
                like = true[dice.choice(sorted(true))]
                near = sorted(w for w, merit in true.items() if abs(merit / like - 1) < SPREAD)
                chosen = dice.sample(near, min(WINDOWS, len(near)))
                rows = list(csv.DictReader(io.StringIO(self.bands(db, row, *(a for w in chosen for a in ("--window", f"{w[0]},{w[1]}"))))))
                merits = [true[r["lambda_min_um"], r["lambda_max_um"]] for r in rows]
                found += [(float(r["as_good_numerical"]), merit >= merits[0]) for r, merit in zip(rows[1:], merits[1:])]
            (self.path / "seed.sigdb").unlink()
        found = numpy.array(found, float)
        print(f"{len(found)} comparisons: {found[:, 0].sum():.0f} reversals stated, {found[:, 1].sum():.0f} found")
        for low, high in ((0, 0.02), (0.02, 0.1), (0.1, 0.2), (0.2, 0.3), (0.3, 0.4), (0.4, 1)):
            of = found[(found[:, 0] >= low) & (found[:, 0] < high)]
            if len(of) == 0:
                continue
            stated, share = of.mean(0)
            # Windows of one row share their paths: as many independent comparisons as rows with one in this class, at least a third.
            error = (max(stated * (1 - stated), 0.25 / len(of)) / max(1, len(of) / 3)) ** 0.5
            print(f"stated {low} to {high}: {len(of)} comparisons, mean {stated:.3f}, found {share:.3f}")
            self.assertLess(abs(share - stated), 0.1 + 3 * error)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
