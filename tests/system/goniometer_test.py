"""irsig goniometer and irsig model particles from the command line, and the way of a measured BRDF back into a sweep.

usage: goniometer_test.py <irsig executable>
"""
import csv
import io
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

IRSIG = sys.argv[1] if len(sys.argv) > 1 else "irsig"

BENCH = """
name = "bench"
{ground}
[[material]]
name = "chalk"
kind = "lambert"
reflectance = 0.4
[[part]]
name = "ground"
match = ["*"]
material = "chalk"
[[band]]
name = "swir"
lambda_min_um = 2.0
lambda_max_um = 2.4
step_um = 0.2
[source]
zenith_deg = [0, 20, 40, 60, 80]
[sensor]
field_width_m = 0.01
[view]
zenith_max_deg = 80
zenith_step_deg = 20
azimuth_step_deg = 45
[accuracy]
samples_per_replicate = {samples}
"""
PARTICLES = """
[particles]
width_m = 0.01
tiles = 3
{amount}
size = [{{diameter_m = 0.001, fraction = 1}}, {{diameter_m = 0.0005, fraction = 3}}]
fractions_by = "number"
subdivisions = 0
"""

SWEEP = """
name = "plate"
time = ["08:00Z"]
[model]
generate = "disk"
triangles = 100
[place]
latitude_deg = 0
longitude_deg = 0
heading_deg = 90
[[material]]
name = "chalk"
{material}
[[part]]
name = "plate"
match = ["*"]
material = "chalk"
temperature_k = 300
[[season]]
name = "any"
date = 2025-03-20
[[band]]
name = "swir"
lambda_min_um = 2.0
lambda_max_um = 2.4
step_um = 0.2
[viewpoints]
kind = "list"
range_m = 1000
aspect = [{{azimuth_deg = 0, elevation_deg = 0}}, {{azimuth_deg = 50, elevation_deg = 20}}]
[surroundings]
kind = "none"
sky_radiance_w_m2_sr_um = 5
lower_radiance_w_m2_sr_um = 3
[air]
model = "vacuum"
[transport]
sun = true
max_reflections = 2
[accuracy]
samples_per_replicate = 1024
[output]
thumbnail_px = 0
"""


def irsig(*arguments, expect=0, cwd=None):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=300, cwd=cwd)
    assert done.returncode == expect, f"irsig {arguments}: exit code {done.returncode}, expected " \
                                      f"{expect}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    return done


def table(path):
    lines = [line for line in pathlib.Path(path).read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


class Goniometer(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def bench(self, amount, samples, name="bench.toml"):
        path = self.path / name
        path.write_text(BENCH.format(ground=PARTICLES.format(amount=amount), samples=samples))
        return path

    def test_tables_are_complete_and_pictures_are_svg(self):
        done = irsig("goniometer", self.bench("coverage = [0.5]", 32), "--out", self.path / "out")
        self.assertIn("coverage", done.stdout)
        brdf = table(self.path / "out/brdf.csv")
        self.assertEqual(len(brdf), 5 * 5 * 8)
        for row in brdf:
            self.assertGreater(float(row["brdf_per_sr"]), 0)
            self.assertAlmostEqual(float(row["reflectance_factor"]) / 3.14159265 / float(row["brdf_per_sr"]), 1, 5)
        self.assertEqual(len(table(self.path / "out/emissivity.csv")), 5 * 8)
        material = table(self.path / "out/material.csv")
        self.assertEqual(len(material), 5 * 5 * 5)
        self.assertEqual(list(material[0]), ["lambda_um", "theta_i_deg", "theta_r_deg", "phi_deg", "brdf_per_sr"])
        self.assertTrue((self.path / "out/material.csv").read_text().startswith("# irsig goniometer, build"))
        for picture in ("brdf_swir_source40.svg", "planes_source40.svg"):
            xml.etree.ElementTree.parse(self.path / "out" / picture)

    def test_threads_and_repetition_do_not_change_a_byte(self):
        spec = self.bench("coverage = [0.5]", 16)
        for threads, out in ((1, "one"), (3, "three")):
            irsig("goniometer", spec, "--out", self.path / out, "--threads", threads)
        for name in ("brdf.csv", "emissivity.csv", "material.csv", "summary.txt"):
            self.assertEqual((self.path / "one" / name).read_bytes(), (self.path / "three" / name).read_bytes())

    def test_several_coverages_make_a_trend(self):
        irsig("goniometer", self.bench("coverage = [0, 0.3, 0.6]", 16), "--out", self.path / "out")
        trend = table(self.path / "out/coverage.csv")
        self.assertEqual(len(trend), 3 * 5)
        self.assertEqual(sorted({round(float(row["coverage"]), 1) for row in trend}), [0, 0.3, 0.6])
        xml.etree.ElementTree.parse(self.path / "out/coverage.svg")
        self.assertTrue((self.path / "out/coverage_0.3/brdf.csv").exists())

    def test_mistakes_have_their_place(self):
        spec = self.bench("coverage = [2]", 16)
        done = irsig("goniometer", spec, "--out", self.path / "out", expect=2)
        self.assertRegex(done.stderr, r"bench\.toml:\d+:\d+: particles\.coverage\[0\] = 2, expected")
        self.assertFalse((self.path / "out").exists())
        spec.write_text(spec.read_text().replace("coverage = [2]", "coverage = [0.5]")
                        .replace("field_width_m = 0.01", "field_width_m = 1"))
        done = irsig("goniometer", spec, "--out", self.path / "out", expect=2)
        self.assertIn("m beyond the model, expected a smaller field or a larger model", done.stderr)

    def test_particles_as_a_model_file(self):
        """The OBJ of `irsig model particles` gives what [particles] gives: the same grains from the same seed."""
        done = irsig("model", "particles", "--diameter-m", "0.001,0.0005", "--fraction", "1,3", "--width-m", 0.01,
                     "--tiles", 3, "--coverage", 0.5, "--subdivisions", 0, "--seed", 1, "--out", self.path / "grains.obj")
        self.assertRegex(done.stdout, r"coverage 0\.[45]\d+  packing_fraction 0\.\d+")
        self.assertRegex(done.stdout, r"rms_height_m")
        irsig("goniometer", self.bench("coverage = [0.5]", 64), "--out", self.path / "inline")
        model = '[model]\nfile = "grains.obj"\nunit_m = 1\nforward_axis = "+x"\nup_axis = "+z"\n'
        (self.path / "file.toml").write_text(BENCH.format(ground=model, samples=64))
        irsig("goniometer", self.path / "file.toml", "--out", self.path / "file")
        inline, file = table(self.path / "inline/brdf.csv"), table(self.path / "file/brdf.csv")
        for a, b in zip(inline, file, strict=True):
            self.assertAlmostEqual(float(a["brdf_per_sr"]), float(b["brdf_per_sr"]),
                                   delta=1e-3 * float(a["brdf_per_sr"]))
        irsig("model", "particles", "--diameter-m", 0.001, "--width-m", 0.01, "--out", self.path / "x.obj", expect=2)
        irsig("model", "sphere", "--triangles", 100, expect=2)

    def intensities(self, material):
        name = re.sub(r"\W", "", material)[:12]
        path = self.path / f"{name}.toml"
        path.write_text(SWEEP.format(material=material))
        irsig("run", path, "--db", self.path / f"{name}.sigdb", "--replace")
        done = irsig("query", self.path / f"{name}.sigdb", "--format", "csv")
        return [(float(row["intensity_w_sr"]), float(row["numerical_error_w_sr"]))
                for row in csv.DictReader(io.StringIO(done.stdout))]

    def test_the_examples_run(self):
        """The files that README names, with few rays and views: grains are parts that no model file has."""
        examples = sorted((pathlib.Path(__file__).parents[2] / "jobs/examples").glob("goniometer_*.toml"))
        self.assertEqual(len(examples), 2)
        for example in examples:
            text = example.read_text()
            for key, value in (("samples_per_replicate", "8"), ("zenith_step_deg", "40"), ("azimuth_step_deg", "90")):
                text, count = re.subn(rf"(?m)^{key} = .*", f"{key} = {value}", text)
                self.assertEqual(count, 1, key)
            text = re.sub(r"(?m)^coverage = .*", "coverage = [0.3]", text)
            spec = self.path / example.name
            spec.write_text(text)
            irsig("goniometer", spec, "--out", self.path / example.stem)
            self.assertGreater(len(table(self.path / example.stem / "brdf.csv")), 8)

    def test_a_measured_plate_is_the_plate(self):
        """Rationale: the goniometer's material is a material: a target made of it must look like what was measured.
        Expected: the in-band intensity of a disk of the tabulated BRDF of a bare diffuse plate, in the sun and under a
        sky, is that of a diffuse disk, within 1e-3 (tables of DHR; the seven digits of the file) and 4 errors.
        Source: the definition of the BRDF."""
        irsig("goniometer", self.bench("coverage = [0]", 32), "--out", self.path / "out")
        measured = self.intensities('kind = "tabulated"\nbrdf_file = "out/material.csv"')
        diffuse = self.intensities('kind = "lambert"\nreflectance = 0.4')
        self.assertEqual(len(measured), 2)
        for (a, da), (b, db) in zip(measured, diffuse, strict=True):
            self.assertGreater(b, 1)
            self.assertAlmostEqual(a, b, delta=1e-3 * b + 4 * (da ** 2 + db ** 2) ** 0.5)

    def test_a_bed_of_grains_is_darker_than_its_grains(self):
        """Rationale: the same way for a real measurement, which no closed form knows.
        Expected: a bed of grains that reflect 40 % reflects less than 40 % (light is caught between them) and more
        than 15 %: the disk's intensity lies between those of diffuse disks of these two reflectances."""
        irsig("goniometer", self.bench("layers = 3", 128), "--out", self.path / "out")
        bed = self.intensities('kind = "tabulated"\nbrdf_file = "out/material.csv"')
        bright = self.intensities('kind = "lambert"\nreflectance = 0.4')
        dark = self.intensities('kind = "lambert"\nreflectance = 0.15')
        for (low, _), (value, _), (high, _) in zip(dark, bed, bright, strict=True):
            self.assertLess(low, value)
            self.assertLess(value, high)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
