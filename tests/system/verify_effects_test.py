"""irsig verify-effects: the small matrix, rows of a sweep, and what is refused.

usage: verify_effects_test.py <irsig executable> <source folder>
"""
import csv
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

IRSIG, SOURCE = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2])

SWEEP = (SOURCE / "jobs/examples/quickstart.toml").read_text().replace("count = 24", "count = 7").replace(
    "triangles = 20000", "triangles = 2000")
HARD = ["hot spot seen", "hot spot in a mirror", "glint", "deep cavity", "thermal crossover", "low sun", "before the sky"]


def irsig(*arguments, code=0):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=500)
    assert done.returncode == code, f"{arguments}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout if code == 0 else done.stderr


class VerifyEffects(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)

    def sweep(self, text=SWEEP, name="small.toml"):
        path = self.path / name
        path.write_text(text)
        return path

    def test_small_matrix(self):
        table = self.path / "matrix.csv"
        said = irsig("verify-effects", "--matrix", "--small", "--reference-paths", 10, "--values", table)
        self.assertIn(": 0 cells out of bound", said)
        self.assertRegex(said, "^not seen here, ")
        cells = int(re.search(r"^(\d+) cells", said, re.M)[1])
        self.assertGreaterEqual(cells, 16)
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        names = {row["cell"] for row in rows}
        self.assertEqual(len(names), cells)
        for hard in HARD:
            self.assertIn(hard, names)
        self.assertEqual(len(rows), cells * 2 * 3)
        left_out = 0
        for row in rows:
            with self.subTest(row=row):
                number = {k: float(v) for k, v in row.items() if re.search(r"_w_sr$|^of_", k)}
                allowed = (number["omitted_bound_w_sr"] + 4 * number["paired_stderr_w_sr"]
                           + number["rounding_w_sr"])
                self.assertLessEqual(abs(number["difference_w_sr"]), allowed)
                # What was left out is part of the stored error, as a bias that lies anywhere within its bound.
                self.assertLessEqual(number["omitted_bound_w_sr"], 1.7321 * number["numerical_error_w_sr"] * (1 + 1e-9))
                if number["omitted_bound_w_sr"] == 0:
                    self.assertLessEqual(abs(number["difference_w_sr"]), number["rounding_w_sr"])
                left_out += row["left_out"] != "-"
        self.assertGreater(left_out, 0, "nothing is ever left out")
        beyond_2 = sum(float(row["of_numerical_error"]) > 2 for row in rows)
        self.assertLessEqual(beyond_2, 0.08 * len(rows))
        self.assertLess(max(float(row["of_numerical_error"]) for row in rows), 5)

    def test_sweep(self):
        said = irsig("verify-effects", self.sweep(), "--views", 2)
        self.assertRegex(said.splitlines()[0], r"^not seen here, .*tables of materials.*`irsig selftest --search`")
        # Three conditions, two bands; three quantities.
        self.assertRegex(said, r"(?m)^2 views, 12 rows, 36 values: 0 out of bound")
        one = irsig("verify-effects", self.sweep(), "--row", 42)
        self.assertRegex(one, r"(?m)^1 views, 1 rows, 3 values: 0 out of bound")
        exact = irsig("verify-effects", self.sweep(), "--views", 1, "--relative-error", 0.003, "--reference-paths", 4)
        self.assertIn("relative error 0.003", exact)
        self.assertRegex(exact, r"(?m)^against the reference: 18 values")

    def test_refused(self):
        for arguments, message in (
                ([], "expected a sweep file, or --matrix"),
                ([self.sweep(), "--matrix"], "expected a sweep file, or --matrix"),
                ([self.sweep(), "--small"], "need --matrix"),
                ([self.sweep(), "--each-effect"], "need --matrix"),
                ([self.sweep(), "--row", 43], "rows 1 to 42"),
                ([self.sweep(SWEEP.replace("relative_error = 0.01", "target_paths = 1000"), "counted.toml")],
                 "asks for no relative error")):
            with self.subTest(arguments=arguments):
                self.assertIn(message, irsig("verify-effects", *arguments, code=2))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
