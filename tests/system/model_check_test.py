"""irsig model check: the exit code, the report and the repaired copy, as a user who prepares a model sees them.

usage: model_check_test.py <irsig executable>
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

IRSIG = str(pathlib.Path(sys.argv[1]).resolve())


class ModelCheck(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        self.model("box", "--triangles", 12, "--out", "box.obj")
        lines = (self.path / "box.obj").read_text().splitlines()
        self.head = [line for line in lines if not line.startswith("f ")]
        self.facets = [line for line in lines if line.startswith("f ")]
        self.assertEqual(len(self.facets), 12)

    def model(self, *arguments, exit_code=0):
        done = subprocess.run([IRSIG, "model", *map(str, arguments)], cwd=self.path, capture_output=True, text=True,
                              timeout=120)
        self.assertEqual(done.returncode, exit_code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def write(self, name, facets):
        (self.path / name).write_text("\n".join(self.head + facets) + "\n")

    def found(self, *arguments, exit_code):
        """The report as JSON, its findings by name."""
        report = json.loads(self.model("check", *arguments, "--json", exit_code=exit_code).stdout)
        self.assertEqual(report["errors"], exit_code == 2)
        return report, {f["fault"]: f for f in report["findings"]}

    def test_nothing_is_wrong_with_a_box(self):
        text = self.model("check", "box.obj").stdout
        self.assertIn("box.obj: 12 facets, 8 vertices, 1 shells (1 closed), 2 x 1 x 0.5 m", text)
        self.assertIn("nothing found", text)
        report, findings = self.found("box.obj", exit_code=0)
        self.assertEqual((report["facets"], report["closed_shells"], report["size_m"]), (12, 1, [2, 1, 0.5]))
        self.assertEqual(findings, {})

    def test_a_hole_is_an_error_unless_sheets_are_meant(self):
        self.write("hole.obj", self.facets[:-1])
        text = self.model("check", "hole.obj", exit_code=2).stdout
        self.assertIn("error   open_edges: 3\n", text)
        self.assertEqual(text.count("          facet "), 3, text)
        _, findings = self.found("hole.obj", exit_code=2)
        self.assertEqual((findings["open_edges"]["count"], findings["open_edges"]["severity"]), (3, "error"))
        self.assertEqual(len(findings["open_edges"]["first"]), 3)
        _, findings = self.found("hole.obj", "--places", 1, exit_code=2)
        self.assertEqual(len(findings["open_edges"]["first"]), 1)
        _, findings = self.found("hole.obj", "--open-surfaces", exit_code=0)
        self.assertEqual(findings["open_edges"]["severity"], "warning")

    def turned(self, facet):
        _, a, b, c = facet.split()
        return f"f {a} {c} {b}"

    def test_facets_inside_out_and_against_their_neighbours(self):
        self.write("inside_out.obj", [self.turned(f) for f in self.facets])
        _, findings = self.found("inside_out.obj", exit_code=2)
        self.assertEqual(set(findings), {"inside_out_shells"})
        self.write("one.obj", [self.turned(self.facets[0])] + self.facets[1:])
        _, findings = self.found("one.obj", exit_code=2)
        self.assertIn("inconsistent_facets", findings)

    def test_repair_writes_a_copy_and_reports_on_it(self):
        self.write("bad.obj", [self.turned(self.facets[0])] + self.facets[1:] + [self.facets[5], "f 1 1 2"])
        before = (self.path / "bad.obj").read_bytes()
        _, findings = self.found("bad.obj", exit_code=2)
        for fault in ("duplicate_facets", "zero_area_facets"):
            self.assertIn(fault, findings)
        done = self.model("check", "bad.obj", "--repair", "good.obj")
        self.assertIn("good.obj: 12 facets, 8 vertices, 1 shells (1 closed)", done.stdout)
        self.assertIn("nothing found", done.stdout)
        for what in ("1 facets without area dropped", "1 duplicate facets dropped", "1 facets turned",
                     "written to good.obj"):
            self.assertIn(what, done.stderr)
        self.assertEqual(before, (self.path / "bad.obj").read_bytes())
        self.found("good.obj", exit_code=0)

    def test_repair_closes_no_hole_and_says_so(self):
        self.write("hole.obj", self.facets[:-1])
        done = self.model("check", "hole.obj", "--repair", "still.obj", exit_code=2)
        self.assertIn("error   open_edges: 3", done.stdout)
        self.assertIn("there was nothing to do", done.stderr)

    def test_a_unit_that_cannot_be_meant(self):
        report, findings = self.found("box.obj", "--unit-m", 0.001, exit_code=0)
        self.assertEqual(report["size_m"], [0.002, 0.001, 0.0005])
        self.assertEqual(findings["suspicious_unit"]["severity"], "warning")

    def test_what_is_no_model_is_wrong_input(self):
        self.assertIn("nowhere.obj: No such file", self.model("check", "nowhere.obj", exit_code=2).stderr)
        (self.path / "nan.obj").write_text("v 0 0 0\nv 0 nan 0\nv 0 0 1\nf 1 2 3\n")
        done = self.model("check", "nan.obj", "--repair", "never.obj", exit_code=2)
        self.assertIn("nan.obj:2:", done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertFalse((self.path / "never.obj").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
