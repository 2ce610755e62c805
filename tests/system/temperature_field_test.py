"""Temperatures of facets: read from files in every form, in the rows, written out again.

usage: temperature_field_test.py <irsig> <repository>
"""
import csv, io, pathlib, sqlite3, subprocess, sys, tempfile, unittest

IRSIG = pathlib.Path(sys.argv[1]).resolve()

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

[[temperature_field]]
name = "camera"
file = "camera.csv"
unit = "degC"
match = "index"
error_k = 0

[[season]]
name = "any"
date = 2025-06-21
temperature_field = "camera"

[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
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
thumbnail_px = 16
"""
STATED = SWEEP.replace('temperature_field = "camera"', "part_temperature_k = { body = 300 }")
STATED = STATED[:STATED.index("[[temperature_field]]")] + STATED[STATED.index("[[season]]"):]
FACETS = 12


def field(celsius, times=(None,)):
    rows = ["facet,temperature" + (",time" if times[0] else "")]
    for n, time in enumerate(times):
        rows += [f"{f},{celsius[n][f] if isinstance(celsius, list) else celsius}" + (f",{time}" if time else "")
                 for f in range(FACETS)]
    return "\n".join(rows) + "\n"


class TemperatureFields(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)

    def irsig(self, *arguments, code=0):
        done = subprocess.run([IRSIG, *arguments], cwd=self.path, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def run_sweep(self, text, table=None, name="camera.csv"):
        (self.path / "sweep.toml").write_text(text)
        if table is not None:
            (self.path / name).write_text(table)
        (self.path / "x.sigdb").unlink(missing_ok=True)
        self.irsig("run", "sweep.toml", "--db", "x.sigdb")
        return list(csv.DictReader(io.StringIO(self.irsig("query", "x.sigdb", "--format", "csv").stdout)))

    def refused(self, text, table, expected, name="camera.csv"):
        (self.path / "sweep.toml").write_text(text)
        (self.path / name).write_text(table)
        message = self.irsig("run", "sweep.toml", "--db", "no.sigdb", code=2).stderr
        self.assertRegex(message, expected)
        self.assertRegex(message, r"sweep\.toml:\d+:\d+: ")
        self.assertNotIn("sweep.toml:1:1: ", message, "the key's place")
        self.assertFalse((self.path / "no.sigdb").exists())

    def test_one_temperature_is_that_of_the_part(self):
        stated = self.run_sweep(STATED)
        fields = self.run_sweep(SWEEP, field(26.85))
        self.assertEqual(len(fields), 4)
        for a, b in zip(stated, fields):
            self.assertAlmostEqual(float(b["intensity_w_sr"]) / float(a["intensity_w_sr"]), 1, delta=1e-6)
            self.assertEqual(float(b["temperature_bound_w_sr"]), 0)

    def test_hours_errors_and_the_way_back(self):
        times = ("2025-06-21T12:00:00Z", "2025-06-21T14:00:00Z")
        warm = [[20 + 2 * f for f in range(FACETS)], [26 + 2 * f for f in range(FACETS)]]
        text = SWEEP.replace("error_k = 0", "error_k = 0.25")
        rows = self.run_sweep(text, field(warm, times))
        noon, one = rows[0], rows[1]
        self.assertGreater(float(one["intensity_w_sr"]), 1.03 * float(noon["intensity_w_sr"]))
        # 0.25 K of about 1.6 % a kelvin; at 13 h a quarter of 6 K more.
        self.assertAlmostEqual(float(noon["temperature_bound_w_sr"]) / float(noon["intensity_w_sr"]), 0.004, delta=0.0005)
        self.assertGreater(float(one["temperature_bound_w_sr"]), 6 * float(noon["temperature_bound_w_sr"]))
        self.assertIn("temperature bound", self.irsig("explain", "x.sigdb", "--row", "1").stdout)

        self.irsig("export", "x.sigdb", "--format", "temperatures", "--out", "back.csv")
        back = list(csv.DictReader(io.StringIO((self.path / "back.csv").read_text())))
        self.assertEqual(len(back), 2 * FACETS)
        self.assertAlmostEqual(float(back[3]["temperature"]), 273.15 + 26, delta=1e-4)
        self.assertAlmostEqual(float(back[FACETS + 3]["temperature"]), 273.15 + 29, delta=1e-4)
        self.assertAlmostEqual(float(back[FACETS + 3]["error"]), 0.25 + 1.5, delta=1e-4)
        again = self.run_sweep(text.replace('"degC"', '"K"').replace("camera.csv", "back.csv"))
        for a, b in zip(rows, again):
            self.assertAlmostEqual(float(b["intensity_w_sr"]) / float(a["intensity_w_sr"]), 1, delta=1e-6)
            self.assertAlmostEqual(float(b["temperature_bound_w_sr"]) / float(a["temperature_bound_w_sr"]), 1, delta=1e-3)
        # The same by the places that are written with them.
        by_place = text.replace('"degC"', '"K"').replace("camera.csv", "back.csv").replace('match = "index"', 'match = "centroid"\nmax_distance_m = 1e-6')
        for a, b in zip(rows, self.run_sweep(by_place)):
            self.assertAlmostEqual(float(b["intensity_w_sr"]) / float(a["intensity_w_sr"]), 1, delta=1e-6)
        one_hour = self.irsig("export", "x.sigdb", "--temperatures", "--time", "2025-06-21T15:00:00+02:00", "--out", "-")
        self.assertEqual(one_hour.stdout.count("\n"), FACETS + 1)

    def test_by_place_and_from_ply(self):
        by_index = self.run_sweep(SWEEP, field([[20 + 2 * f for f in range(FACETS)]]))
        self.irsig("model", "box", "--triangles", "12", "--out", "box.obj")
        vertices, faces = [], []
        for line in (self.path / "box.obj").read_text().splitlines():
            words = line.split()
            if words and words[0] == "v":
                vertices.append([float(x) for x in words[1:4]])
            if words and words[0] == "f":
                faces.append([int(w.split("/")[0]) - 1 for w in words[1:4]])
        self.assertEqual(len(faces), FACETS)
        rows = ["x,y,z,temperature"]
        for f in reversed(range(FACETS)):
            rows.append(",".join(str(sum(vertices[v][k] for v in faces[f]) / 3) for k in range(3)) + f",{20 + 2 * f}")
        by_place = SWEEP.replace('match = "index"', 'match = "centroid"\nmax_distance_m = 0.001')
        for a, b in zip(by_index, self.run_sweep(by_place, "\n".join(rows) + "\n")):
            self.assertEqual(a["intensity_w_sr"], b["intensity_w_sr"])
        ply = f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        ply += f"element face {FACETS}\nproperty list uchar int vertex_indices\nproperty float temperature\nend_header\n"
        ply += "".join(" ".join(map(str, v)) + "\n" for v in vertices)
        ply += "".join(f"3 {a} {b} {c} {20 + 2 * f}\n" for f, (a, b, c) in enumerate(faces))
        for text in (SWEEP, by_place):
            for a, b in zip(by_index, self.run_sweep(text.replace("camera.csv", "camera.ply"), ply, "camera.ply")):
                self.assertEqual(a["intensity_w_sr"], b["intensity_w_sr"])

    def test_places_are_in_the_coordinates_of_the_models_file(self):
        """Millimetres, the bow along -y, moved: centroids are those that the file itself has."""
        self.irsig("model", "box", "--triangles", "12", "--out", "box.obj")
        lines, vertices, rows = [], [], []
        for line in (self.path / "box.obj").read_text().splitlines():
            words = line.split()
            if words and words[0] == "v":
                x, y, z = map(float, words[1:4])
                vertices.append((1000 * y, -1000 * x, 1000 * z))
                line = "v %r %r %r" % vertices[-1]
            if words and words[0] == "f":
                corners = [vertices[int(w.split("/")[0]) - 1] for w in words[1:4]]
                rows.append(",".join(str(sum(c[k] for c in corners) / 3 + 3) for k in range(3)) + f",{20 + 2 * len(rows)}")
            lines.append(line)
        (self.path / "mm.obj").write_text("\n".join(lines) + "\n")
        text = SWEEP.replace('generate = "box"\ntriangles = 12', 'file = "mm.obj"\nunit_m = 0.001\nforward_axis = "-y"\nup_axis = "+z"\n'
                             'reference = "bbox_center"\noffset_m = [1, 2, 3]')
        by_index = self.run_sweep(text, field([[20 + 2 * f for f in range(FACETS)]]))
        by_place = text.replace('match = "index"', 'match = "centroid"\nmax_distance_m = 0.006')  # each is 5.2 mm beside
        table = "\n".join(["x,y,z,temperature", *reversed(rows)]) + "\n"
        for a, b in zip(by_index, self.run_sweep(by_place, table)):
            self.assertEqual(a["intensity_w_sr"], b["intensity_w_sr"])
        self.refused(by_place.replace("0.006", "0.005"), table, r"12 of 12 facets have no temperature .*within 0.005 m")

    def test_a_changed_file_is_computed_again(self):
        first = self.run_sweep(SWEEP, field(20))
        (self.path / "camera.csv").write_text(field(30))
        self.irsig("run", "sweep.toml", "--db", "x.sigdb", "--replace")
        second = list(csv.DictReader(io.StringIO(self.irsig("query", "x.sigdb", "--format", "csv").stdout)))
        self.assertGreater(float(second[0]["intensity_w_sr"]), 1.1 * float(first[0]["intensity_w_sr"]))
        db = sqlite3.connect(self.path / "x.sigdb")
        self.assertEqual(db.execute("SELECT count(*) FROM asset").fetchone()[0], 1)
        db.close()

    def test_what_is_refused(self):
        good = field(20)
        self.refused(SWEEP, good.replace("\n3,20", "\n3,2000000"), r"camera\.csv:5:1: temperature = 2e\+06")
        self.refused(SWEEP.replace('"degC"', '"K"'), good, r"camera\.csv:2:1: temperature = 20 is 20 K, expected 100 to 5000 K: is it in degC\?")
        self.refused(SWEEP, good.replace("\n3,20", ""), r'1 of 12 facets have no temperature \(the first: facet 3 of part "body"\)')
        self.refused(SWEEP, field([[20] * FACETS], ("2025-06-21T12:00:00Z",)), r"there are no temperatures at 2025-06-21T13:00:00Z")
        corners = "vertex,temperature\n" + "".join(f"{v},{4700 if v == 0 else -100}\n" for v in range(8))
        self.refused(SWEEP, corners, r"facet \d+ is [\d.]+ K \+- [\d.]+ K at 2025-06-21T12:00:00Z, which says nothing")
        self.refused(SWEEP, "facet,temperature\n0,20,1\n1,20,1\n", r"sweep\.toml:16:1: .*camera\.csv:2:\d+: 3 cells(.|\n)*sweep\.toml:16:1: .*camera\.csv:3:")
        self.refused(SWEEP.replace("camera.csv", "nosuch.csv"), good, r'temperature_field\[0\]\.file = "nosuch\.csv"')
        self.refused(SWEEP.replace("error_k = 0\n", ""), good, r"no error is stated")
        self.refused(SWEEP.replace('= "camera"\n\n[[band', '= "camra"\n\n[[band'), good, r'there is no \[\[temperature_field\]\] "camra"')
        self.refused(SWEEP.replace('unit = "degC"\n', ""), good, r"unit is missing")
        self.refused(SWEEP.replace('"index"', '"nearest"'), good, r'match = "nearest"')
        self.refused(SWEEP.replace('"index"', '"centroid"'), good, r"max_distance_m is missing")
        self.refused(SWEEP.replace("material =", "temperature_k = 300\nmaterial ="), good, r"the temperatures of all parts are stated")
        self.refused(SWEEP.replace('temperature_field = "camera"\n\n[[band', 'part_temperature_k = { body = 300 }\n\n[[band'), good, r"is named by no season")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
