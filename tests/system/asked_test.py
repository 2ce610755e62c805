"""What was asked for and not got is said: floors in place of errors, meshes that are seen from behind.

usage: asked_test.py <irsig executable> <source folder>
"""
import csv
import io
import json
import pathlib
import re
import sqlite3
import subprocess
import sys
import tempfile
import unittest

IRSIG, SOURCE = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2])

QUICK = (SOURCE / "jobs/examples/quickstart.toml").read_text().replace("count = 24", "count = 2").replace(
    "triangles = 20000", "triangles = 2000")

# Two panels in the plane x = 0, 4 m2 towards the bow and `back` turned away from it.
PANELS = """
v 0 0 0
v 0 4 0
v 0 4 1
v 0 0 1
v 0 5 0
v 0 {y} 0
v 0 {y} 1
v 0 5 1
g front
f 1 2 3 4
g back
f 5 8 7 6
"""

SWEEP = """
name = "panels"
time = ["12:00Z"]
[model]
file = "panels.obj"
unit_m = 1
forward_axis = "+x"
up_axis = "+z"
{model}
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
[[part]]
name = "front"
material = "paint"
temperature_k = 300
[[part]]
name = "back"
material = "paint"
temperature_k = 300
{part}
[[season]]
name = "any"
date = 2025-06-21
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ {{ azimuth_deg = 0, elevation_deg = 0 }} ]
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


class Asked(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        self.db = self.path / "a.sigdb"

    def irsig(self, *arguments, code=0):
        done = subprocess.run([IRSIG, *map(str, arguments)], cwd=self.path, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}{done.stderr}")
        return done

    def write(self, name, text):
        (self.path / name).write_text(text)
        return self.path / name

    def panels(self, back_m2=1.0, model="", part=""):
        self.write("panels.obj", PANELS.format(y=5 + back_m2))
        return self.write("panels.toml", SWEEP.format(model=model, part=part))

    def rows(self):
        return list(csv.DictReader(io.StringIO(self.irsig("query", self.db, "--format", "csv").stdout)))

    # --- a floor in place of the error that was asked for ---

    def test_a_floor_is_not_the_error_that_was_asked_for(self):
        sweep = self.write("small.toml", QUICK)
        asked = ("--relative-error", 1e-5)
        plan = self.irsig("plan", sweep, *asked).stdout
        self.assertRegex(plan, r"(?m)^rows that reach the error asked for: 0 %; 100 % stop above it, at the floor of 0.05 K")
        done = self.irsig("run", sweep, "--db", self.db, *asked)
        self.assertRegex(done.stdout, r"worst error [\d.]+ % \(0 of 12 rows reach 0.001 %, 12 only the floor of 0.05 K \(floor_reached\)\)")
        for row in self.rows():
            self.assertEqual(row["stop_reason"], "floor_reached")
            error, floor = float(row["numerical_error_w_sr"]), float(row["absolute_floor_w_sr"])
            self.assertLessEqual(error, floor)
            self.assertGreater(error, 1e-5 * float(row["intensity_w_sr"]))
        self.assertIn("12 of 12 rows stopped at the floor of 0.05 K, above the 0.001 % that was asked for",
                      self.irsig("query", self.db).stderr)
        report = self.irsig("report", self.db).stdout
        self.assertIn("stopped by: floor_reached 12", report)
        self.assertIn("the floor of 0.05 K", report)
        self.assertIn("stopped   floor_reached", self.irsig("explain", self.db, "--row", 1).stdout)
        # The same command again says so again.
        self.assertIn("12 only the floor of 0.05 K", self.irsig("run", sweep, "--db", self.db, *asked).stdout)

    def test_nothing_is_said_where_all_is_reached(self):
        done = self.irsig("run", self.write("small.toml", QUICK), "--db", self.db)
        self.assertRegex(done.stdout, r"worst error [\d.]+ %, ")
        self.assertNotIn("floor", done.stdout + done.stderr + self.irsig("query", self.db).stderr)
        self.assertEqual({row["stop_reason"] for row in self.rows()}, {"accuracy_reached"})
        # A closed mesh has no back faces: not one.
        self.assertEqual({float(row["backface_fraction"]) for row in self.rows()}, {0.0})

    # --- meshes seen from behind ---

    def test_a_mesh_seen_from_behind_fails(self):
        done = self.irsig("run", self.panels(), "--db", self.db, "--workers", 1, code=1)
        said = re.search(r"([\d.]+) % of the silhouette are one-sided facets seen from behind", done.stderr)
        self.assertTrue(said, done.stderr)
        self.assertAlmostEqual(float(said[1]), 20, delta=1)
        for remedy in ("two_sided = true", "irsig model check FILE --repair", "model.accepted_backface_fraction"):
            self.assertIn(remedy, done.stderr)
        # Before it ran, the sweep's own place was named.
        self.assertRegex(done.stderr, r"panels.toml:\d+:\d+: warning: part\[1\]: 2 facets of \"back\" belong to open shells")
        self.irsig("plan", self.path / "panels.toml", code=1)

    def test_accepted_back_faces_are_a_warning_everywhere(self):
        sweep = self.panels(model="accepted_backface_fraction = 0.25")
        done = self.irsig("run", sweep, "--db", self.db)
        self.assertRegex(done.stderr, r"irsig: warning: panels: back faces: seen from 1 viewpoint, up to (19|20)[.\d]* % of the silhouette")
        (row,) = self.rows()
        self.assertAlmostEqual(float(row["backface_fraction"]), 0.2, delta=0.01)
        self.assertAlmostEqual(float(row["projected_area_m2"]), 4, delta=0.05)
        self.assertIn("back faces: ", row["warning"])
        query = self.irsig("query", self.db).stderr
        self.assertRegex(query, r"1 of 1 rows, up to (19|20)[.\d]* % of the silhouette: back faces: ")
        self.assertIn("two_sided = true", query)
        report = self.irsig("report", self.db).stdout
        self.assertIn("warning: back faces: ", report)
        self.assertNotIn("warnings: none", report)
        explained = self.irsig("explain", self.db, "--row", 1).stdout
        self.assertIn("warning: back faces: ", explained)
        self.assertRegex(explained, r"(?m)^seen from behind +(19|20)[.\d]* % of the silhouette")
        with sqlite3.connect(self.db) as db:
            (warning,) = db.execute("SELECT warning FROM signature_view").fetchone()
        self.assertIn("--repair", warning)

    def test_a_few_back_faces_are_a_warning(self):
        self.irsig("run", self.panels(back_m2=0.02), "--db", self.db)
        (row,) = self.rows()
        self.assertAlmostEqual(float(row["backface_fraction"]), 0.02 / 4.02, delta=0.002)
        self.assertIn("back faces: ", row["warning"])

    def test_two_sides_are_the_remedy(self):
        done = self.irsig("run", self.panels(part="two_sided = true"), "--db", self.db)
        self.assertNotIn("back faces", done.stderr)
        self.assertNotIn("part[1]", done.stderr)
        (row,) = self.rows()
        self.assertEqual((float(row["backface_fraction"]), row["warning"]), (0, ""))
        self.assertAlmostEqual(float(row["projected_area_m2"]), 5, delta=0.05)

    def test_the_share_is_a_share(self):
        for value in ("1.5", "-0.1"):
            self.assertIn("accepted_backface_fraction", self.irsig("run", self.panels(model=f"accepted_backface_fraction = {value}"),
                                                                "--db", self.db, code=2).stderr)

    def test_a_check_of_the_model_proposes_two_sides(self):
        self.panels()
        text = self.irsig("model", "check", "panels.obj", code=2).stdout
        self.assertIn("two_sided = true", text)
        self.assertRegex(text, r"(?m)^ +group back: 2 facets of open shells")
        report = json.loads(self.irsig("model", "check", "panels.obj", "--json", code=2).stdout)
        self.assertEqual(report["open_groups"], [{"group": "front", "facets": 2}, {"group": "back", "facets": 2}])
        self.irsig("model", "box", "--triangles", 12, "--out", "box.obj")
        self.assertNotIn("two_sided", self.irsig("model", "check", "box.obj").stdout)
        self.assertEqual(json.loads(self.irsig("model", "check", "box.obj", "--json").stdout)["open_groups"], [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
