"""Every numerical error of a row is what the row's own columns say.

usage: error_budget_test.py <irsig> <repository>
"""
import math, pathlib, re, sqlite3, subprocess, sys, tempfile, unittest

IRSIG, ROOT = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
COMMON = "truncation_bound_w_sr + quadrature_bound_w_sr + undersampling_bound_w_sr + direction_interpolation_bound_w_sr"
ERRORS = {  # numerical error: standard error, sum of bounds; the basis is contained in the quadrature
    "numerical_error_w_sr": ("intensity_stderr_w_sr", f"{COMMON} + omitted_bound_w_sr + temperature_bound_w_sr"),
    "apparent_numerical_error_w_sr":
        ("apparent_intensity_stderr_w_sr", f"{COMMON} + apparent_omitted_bound_w_sr + target_depth_bound_w_sr + apparent_temperature_bound_w_sr"),
    "contrast_numerical_error_w_sr":
        ("contrast_intensity_stderr_w_sr", f"{COMMON} + contrast_omitted_bound_w_sr + target_depth_bound_w_sr"
                                            " + background_bound_w_sr + apparent_temperature_bound_w_sr"),
}


class ErrorBudget(unittest.TestCase):
    def check(self, text):
        """Rows, and how many of them have each bound."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            (path / "sweep.toml").write_text(text)
            done = subprocess.run([IRSIG, "run", "sweep.toml", "--db", "x.sigdb"], cwd=path, capture_output=True,
                                  text=True, timeout=600)
            self.assertEqual(done.returncode, 0, done.stderr)
            db = sqlite3.connect(path / "x.sigdb")
            for error, (stderr, bounds) in ERRORS.items():
                unseen = error.replace("numerical_error", "undersampling_stderr")
                rows = db.execute(f"SELECT {error}, {stderr}, {unseen}, {bounds} FROM signature_view").fetchall()
                self.assertGreater(len(rows), 0)
                for stated, sampled, missed, bound in rows:
                    self.assertGreater(missed, 0)
                    again = math.sqrt(sampled**2 + missed**2 + bound**2 / 3)
                    self.assertLessEqual(abs(stated - again), 1e-12 * again, (error, stated, again))
            counted = {column: db.execute(f"SELECT count(*) FROM signature WHERE {column} > 0").fetchone()[0]
                       for column in ("truncation_bound_w_sr", "undersampling_bound_w_sr", "direction_interpolation_bound_w_sr",
                                      "omitted_bound_w_sr", "target_depth_bound_w_sr", "background_bound_w_sr")}
            explained = subprocess.run([IRSIG, "explain", "x.sigdb", "--row", "1"], cwd=path, capture_output=True,
                                       text=True, timeout=600)
            self.assertEqual(explained.returncode, 0, explained.stderr)
            db.close()
            return counted, explained.stdout

    def test_a_ship_in_real_air(self):
        text = (ROOT / "jobs/examples/frigate.toml").read_text()
        text = re.sub("count = 191", "count = 5", text).replace("relative_error = 0.002", "relative_error = 0.1")
        counted, explained = self.check(text)
        for column, rows in counted.items():
            if column != "truncation_bound_w_sr":
                self.assertGreater(rows, 0, f"no row has a {column}: the sum was not tried")
        apparent = explained[explained.index("apparent intensity"):]
        self.assertIn("depth bound", apparent, "the error of the apparent intensity is accounted for")

    def test_paths_that_are_cut_off(self):
        text = (ROOT / "jobs/examples/quickstart.toml").read_text()
        text = re.sub(r"max_reflections = \d+", "max_reflections = 1", text)
        self.assertIn("max_reflections = 1", text)
        counted, _ = self.check(text + '\n[effects]\nmode = "all"\n')
        self.assertGreater(counted["truncation_bound_w_sr"], 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
