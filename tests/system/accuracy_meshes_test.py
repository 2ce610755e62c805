"""irsig accuracy --meshes: the same views on meshes of several densities, and what is refused.

usage: accuracy_meshes_test.py <irsig executable>
"""
import csv
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

IRSIG = str(pathlib.Path(sys.argv[1]).resolve())

SWEEP = """
name = "ball"
time = ["12:00Z"]
[model]
generate = "sphere"
triangles = 1000
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.8
[[part]]
name = "sphere"
material = "paint"
temperature_k = 320
[[season]]
name = "one"
date = 2025-06-21
[[season]]
name = "two"
date = 2025-12-21
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[[band]]
name = "mwir"
lambda_min_um = 3
lambda_max_um = 5
step_um = 0.5
[viewpoints]
kind = "fibonacci"
count = 12
range_m = 5000
[surroundings]
kind = "none"
sky_temperature_k = 250
lower_radiance_w_m2_sr_um = 0
[air]
model = "vacuum"
[transport]
sun = false
max_reflections = 4
[accuracy]
relative_error = 0.003
[output]
thumbnail_px = 0
"""


def irsig(*arguments, exit_code=0):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    if done.returncode != exit_code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout if exit_code == 0 else done.stderr


def meshes(sweep, what, *arguments, exit_code=0):
    return irsig("accuracy", sweep, "--meshes", what, *arguments, exit_code=exit_code)


class Meshes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)
        cls.sweep = cls.path / "ball.toml"
        cls.sweep.write_text(SWEEP)
        for kind, triangles in (("sphere", 100), ("sphere", 2000), ("box", 100)):
            irsig("model", kind, "--triangles", triangles, "--out", cls.path / f"{kind}{triangles}.obj")
        cls.file_sweep = cls.path / "file.toml"
        cls.file_sweep.write_text(SWEEP.replace(
            'generate = "sphere"\ntriangles = 1000\n',
            'file = "sphere2000.obj"\nunit_m = 1\nforward_axis = "+x"\nup_axis = "+z"\n'))

    def rows(self, folder):
        with open(folder / "meshes.csv", newline="") as stream:
            return list(csv.DictReader(stream))

    def test_densities_of_a_sphere(self):
        out = self.path / "out"
        printed = meshes(self.sweep, "2,0.05,1", "--out", out)
        self.assertEqual((out / "meshes.md").read_text(), printed)
        rows = self.rows(out)
        self.assertEqual(len(rows), 3 * 8 * 2, "meshes, viewpoints, bands")
        self.assertEqual({r["season"] for r in rows}, {"one"}, "the first")
        names = list(dict.fromkeys(r["mesh"] for r in rows))
        self.assertEqual(names, ["0.05", "1", "2"], "by the number of facets")
        self.assertEqual([int(next(r for r in rows if r["mesh"] == n)["triangles_asked"]) for n in names],
                         [50, 1000, 2000])
        for r in rows:
            facets = int(r["facets"])
            self.assertAlmostEqual(facets / int(r["triangles_asked"]), 1, delta=0.1)
            # The generator's spheres all have the surface of the true one (core/scene/mesh.h), and differ by
            # less than 3 / facets of the projected area.
            self.assertAlmostEqual(float(r["surface_area_m2"]), 4 * math.pi, delta=1e-9)
            area, error = float(r["projected_area_m2"]), float(r["projected_area_stderr_m2"])
            self.assertGreater(error, 0)
            self.assertAlmostEqual(area, math.pi, delta=3 / facets * math.pi + 5 * error)
            finest = next(x for x in rows if x["mesh"] == "2" and
                          all(x[k] == r[k] for k in ("band", "aspect_azimuth_deg", "aspect_elevation_deg")))
            for name, error_name in (("intensity", "numerical_error_w_sr"), ("projected_area", "projected_area_stderr_m2")):
                unit = "w_sr" if name == "intensity" else "m2"
                value, reference = (float(x[f"{name}_{unit}"]) for x in (r, finest))
                errors = [float(x[error_name]) / float(x[f"{name}_{unit}"]) for x in (r, finest)]
                self.assertAlmostEqual(float(r[f"{name}_deviation"]), value / reference - 1, delta=1e-12)
                self.assertAlmostEqual(float(r[f"{name}_deviation_error"]),
                                       value / reference * math.hypot(*errors), delta=1e-12)
        lines = {tuple(c.strip() for c in line.strip("|").split("|"))[:2]: line for line in printed.splitlines()
                 if line.startswith("| ")}
        self.assertIn("| yes |", lines["projected area", "0.05"], "50 facets are off by far more than the errors")
        self.assertIn("| no |", lines["lwir intensity", "1"], "1000 and 2000 differ by less than 0.3 %")
        self.assertIn("finest mesh (2)", printed)
        self.assertIn("The limit of ever more facets", printed)

    def test_order_of_a_cylinder(self):
        """Its cross-section is a polygon of m corners with the circle's area, m about 1.3 sqrt(facets): too wide by 0.8 to
        2.5 / m^2 (core/scene/mesh.h), so that areas are off as 1 / facets, but for that range."""
        sweep = self.path / "cylinder.toml"
        sweep.write_text(SWEEP.replace('"sphere"', '"cylinder"').replace("triangles = 1000", "triangles = 20000"))
        printed = meshes(sweep, "0.01,0.1,1", "--relative-error", 3e-4, "--band", "lwir")
        limit = printed[printed.index("The limit of ever more facets"):]
        for quantity in ("surface area", "projected area", "lwir intensity"):
            cells = next(line for line in limit.splitlines() if line.startswith(f"| {quantity} ")).split("|")
            order, coarsest = float(cells[2].split()[0]), cells[4].split()
            self.assertTrue(0.6 < order < 1.7, limit)
            self.assertEqual(coarsest[1], "%")
            self.assertTrue(0.1 < float(coarsest[0]) < 1.5, limit)

    def test_same_bits_again(self):
        first, second = (self.path / name for name in ("first", "second"))
        for out in (first, second):
            meshes(self.sweep, "0.1,1", "--views", 2, "--relative-error", 0.03, "--out", out)
        clocks = ("cpu_s", "setup_cpu_s")
        self.assertEqual(*([{k: v for k, v in r.items() if k not in clocks} for r in self.rows(out)]
                           for out in (first, second)))

    def test_which_rows(self):
        out = self.path / "rows"
        printed = meshes(self.sweep, "0.1,1", "--views", 3, "--season", "two", "--band", "mwir", "--relative-error", 0.03,
                         "--out", out)
        rows = self.rows(out)
        self.assertEqual({(r["season"], r["band"]) for r in rows}, {("two", "mwir")})
        self.assertEqual(len({(r["aspect_azimuth_deg"], r["aspect_elevation_deg"]) for r in rows}), 3)
        self.assertIn("2 meshes, 3 viewpoints", printed)
        self.assertNotIn("The limit of ever more facets", printed, "of two meshes")

    def test_files(self):
        coarse, fine = self.path / "sphere100.obj", self.path / "sphere2000.obj"
        out = self.path / "files"
        printed = meshes(self.file_sweep, f"{fine},{coarse}", "--views", 2, "--out", out)
        rows = self.rows(out)
        self.assertEqual([r["mesh"] for r in rows], [str(coarse)] * 4 + [str(fine)] * 4)
        self.assertEqual({r["triangles_asked"] for r in rows}, {""})
        self.assertIn(f"finest mesh ({fine})", printed)

    def test_a_database(self):
        db = self.path / "ball.sigdb"
        irsig("run", self.sweep, "--db", db, "--relative-error", 0.03)
        self.assertIn("2 meshes, 1 viewpoint\n", meshes(db, "0.5,1", "--views", 1))

    def test_what_is_refused(self):
        sphere, box = self.path / "sphere100.obj", self.path / "box100.obj"
        for sweep, what, expected in (
                (self.sweep, "1", "two or more"), (self.sweep, "", "two or more"), (self.sweep, "1,,2", "a name is empty"),
                (self.sweep, "0,1", "positive"), (self.sweep, "-1,1", "positive"), (self.sweep, "nan,1", "positive"),
                (self.sweep, "1,inf", "positive"), (self.sweep, f"1,{sphere}", "expected factors"),
                (self.sweep, "1,1.0", "the same mesh as 1"), (self.sweep, "0.001,1", "expected 8 to 50000000"),
                (self.sweep, "1,1e-9", "expected 8 to 50000000"), (self.sweep, "1,1e300", "expected 8 to 50000000"),
                (self.file_sweep, "0.5,1", "expected mesh files"), (self.file_sweep, f"{sphere},2", "expected mesh files"),
                (self.file_sweep, f"{sphere},{sphere}", "the same mesh"),
                (self.file_sweep, f"{sphere},{self.path / 'none.obj'}", "none.obj"),
                (self.file_sweep, f"{sphere},{box}", "box100.obj: part[0].match: no group")):
            message = meshes(sweep, what, exit_code=2)
            self.assertIn("--meshes", message)
            self.assertIn(expected, message)
            self.assertNotIn("views\n", message, "refused before anything is traced")

    def test_options_that_do_not_go_together(self):
        for arguments in (("--aspect", "10,10"), ("--seconds", 4), ("--primary-rays", 1e6), ("--check-errors",)):
            self.assertIn("--meshes", meshes(self.sweep, "0.5,1", *arguments, exit_code=2))
        self.assertIn("--season", meshes(self.sweep, "0.5,1", "--season", "three", exit_code=2))
        self.assertIn("--views", irsig("accuracy", self.sweep, "--views", 2, "--out", self.path / "x", exit_code=2))
        self.assertIn("--meshes", irsig("accuracy", self.sweep, "--relative-error", 0.1, exit_code=2))
        timed = self.path / "timed.toml"
        timed.write_text(SWEEP.replace("relative_error = 0.003", "time_budget_s = 10"))
        self.assertIn("--relative-error", meshes(timed, "0.5,1", exit_code=2))
        (self.path / "t.csv").write_text("x,y,z,temperature\n0,0,0,320\n")
        field = self.path / "field.toml"
        field.write_text(SWEEP.replace("temperature_k = 320\n", "").replace("[[season]]", '[[temperature_field]]\nname = "camera"\n'
                         'file = "t.csv"\nunit = "K"\nmatch = "centroid"\nmax_distance_m = 10\nerror_k = 1\n[[season]]\n'
                         'temperature_field = "camera"', 1).replace("[[season]]\nname = \"two\"", '[[season]]\ntemperature_field = "camera"\nname = "two"'))
        self.assertIn('temperature field "camera"', meshes(field, "0.5,1", exit_code=2))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
