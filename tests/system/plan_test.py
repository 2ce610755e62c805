"""irsig plan -> run -> report on small sweeps. No time is compared: only counts, sizes and what is said.

usage: plan_test.py <irsig executable> <source folder>
"""
import csv
import io
import json
import os
import pathlib
import re
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
import unittest

IRSIG, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])

SWEEP = (SOURCE / "jobs/examples/quickstart.toml").read_text().replace("count = 24", "count = 7").replace(
    "triangles = 20000", "triangles = 2000")
CAVITY = (SOURCE / "jobs/examples/cavity.toml").read_text().replace(
    "../models/boxes.obj", str(SOURCE / "jobs/models/boxes.obj")).replace(
    "source_radiance_temperature_stderr_k = 0.002", "source_radiance_temperature_stderr_k = 0.02")


def irsig(*arguments, code=0):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == code, f"{arguments}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout if code == 0 else done.stderr


class Plan(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        self.sweep = self.path / "small.toml"
        self.sweep.write_text(SWEEP)
        self.db = self.path / "small.sigdb"

    def line(self, text, what):
        """The three numbers' texts of one line of the comparison."""
        found = re.search(rf"^ *{re.escape(what)} +(\S.*)$", text, re.M)
        self.assertTrue(found, f"no {what!r} in\n{text}")
        return re.split(r"\s{2,}", found[1].strip())

    def prediction(self):
        with sqlite3.connect(f"file:{self.db}?mode=ro", uri=True) as connection:
            connection.row_factory = sqlite3.Row
            return [dict(row) for row in connection.execute("SELECT * FROM prediction")]

    def test_a_pilot_that_takes_long_says_how_far_it_has_come(self):
        """288 conditions were minutes of silence. Here the pilot's worker stands still for a while."""
        plan = subprocess.Popen([IRSIG, "plan", self.sweep], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        worker = None
        while worker is None and plan.poll() is None:
            for child in pathlib.Path(f"/proc/{plan.pid}/task/{plan.pid}/children").read_text().split():
                if "irsig-worker" in pathlib.Path(f"/proc/{child}/cmdline").read_text():
                    worker = int(child)
        self.assertIsNotNone(worker, "the plan ended before it was met")
        os.kill(worker, signal.SIGSTOP)
        time.sleep(3)
        os.kill(worker, signal.SIGCONT)
        out, said = plan.communicate(timeout=300)
        self.assertEqual(plan.returncode, 0, said)
        self.assertRegex(said, r"(?m)^pilot: \d+ of \d+ jobs computed, \d+ s$")
        self.assertNotIn("pilot: ", out)

    def test_viewpoints_that_interpolation_lacks(self):
        """The lines go into the sweep file as they are; only their viewpoints are computed, and then no more are needed than a few."""
        self.sweep.write_text(SWEEP.replace("count = 7", "count = 24").replace("relative_error = 0.01", "samples_per_replicate = 128"))
        irsig("run", self.sweep, "--db", self.db)
        refine = ["plan", "--refine", self.db, "--interpolation-error", 0.04]
        lines = irsig(*refine, "--left-out", self.path / "left.csv")
        count = lines.count("[[viewpoints.aspect]]")
        self.assertTrue(5 < count < 150, lines)
        self.assertEqual(len(csv.DictReader(io.StringIO(irsig(*refine, "--format", "csv"))).__iter__().__next__()), 6)
        left = list(csv.DictReader(io.StringIO((self.path / "left.csv").read_text())))
        self.assertEqual({(r["season"], r["band"]) for r in left}, {(s, b) for s in ("winter", "spring", "summer") for b in ("mwir", "lwir")})
        for r in left:
            self.assertAlmostEqual(float(r["relative_deviation"]), abs(float(r["interpolated"]) / float(r["value"]) - 1), delta=1e-9)
        # At the end of [viewpoints].
        text = self.sweep.read_text()
        at = text.index("\n[", text.index("[viewpoints]") + 1)
        self.sweep.write_text(text[:at] + "\n" + lines + text[at:])
        with sqlite3.connect(self.db) as connection:
            before = dict(connection.execute("SELECT job_key, count(*) FROM signature_view GROUP BY job_key"))
        irsig("run", self.sweep, "--db", self.db)
        with sqlite3.connect(self.db) as connection:
            after = dict(connection.execute("SELECT job_key, count(*) FROM signature_view GROUP BY job_key"))
        self.assertEqual(len(after), 24 + count)
        self.assertLessEqual(before.items(), after.items())
        self.assertLess(irsig(*refine).count("[[viewpoints.aspect]]"), count / 2)
        for arguments, said in ((["plan"], "SWEEP is missing, or --refine DB"), (["plan", self.sweep, "--refine", self.db], "no SWEEP with it"),
                                ([*refine[:4], 0], "--interpolation-error 0"), ([*refine, "--at-range-m", 7], "no viewpoint at 7 m"),
                                ([*refine, "--left-out", "left.svg"], "ends in .csv"), (["plan", self.sweep, "--most", 4], "--most requires --refine")):
            self.assertIn(said, irsig(*arguments, code=2))

    def test_plan_run_report(self):
        plan = irsig("plan", self.sweep, "--workers", 2, "--db", self.db)
        self.assertIn("7 viewpoints x 3 conditions x 2 bands = 42 rows, in 7 jobs", plan)
        table = re.findall(r"^ +([\d.]+) % +(\d+) +.+ ([\d.]+) %", plan, re.M)
        self.assertEqual([float(error) for error, *_ in table], [10, 3, 1, 0.3, 0.1, 0.03], plan)
        samples = [int(count) for _, count, _ in table]
        self.assertEqual(samples, sorted(samples), plan)
        self.assertGreater(samples[-1], 4 * samples[0], plan)
        # The ledger: one line for each effect, every row of the pilot in it.
        ledger = re.findall(r"(?m)^(\w+) +(\d+) +(\d+) +(\d+) +(?:[\d.e+-]+ %|-) ", plan)
        self.assertEqual(len(ledger), 19, plan)
        for name, *counts in ledger:
            self.assertIn(sum(map(int, counts)), (30, 42), name)
        (stored,) = self.prediction()
        self.assertEqual((stored["jobs"], stored["workers"]), (7, 2))
        self.assertIn(stored["pilot_viewpoints"], (5, 7))  # all, if the first five scatter
        self.assertGreater(stored["cpu_s"], 0)
        self.assertEqual(irsig("report", self.db), "")

        irsig("run", self.sweep, "--db", self.db, "--workers", 2)
        report = irsig("report", self.db)
        self.assertIn("quickstart: 7 of 7 jobs done, 42 rows, ", report)
        self.assertEqual(self.line(report, "jobs"), ["7", "7", "1.00"])
        # Sizes do not depend on the machine's load.
        self.assertAlmostEqual(stored["database_bytes"] / self.db.stat().st_size, 1, delta=0.15)
        self.assertIn("relative error asked: 1 %", report)
        self.assertRegex(report, r"stopped by:.* accuracy_reached \d+")
        shares = [float(share) for share in re.findall(r"(?:sampling|undersampling, estimate|truncation|quadrature|undersampling|spectral_basis|direction_interpolation|omitted|temperature|plume) (\S+) %",
                                                       report)]
        self.assertIn(len(shares), range(2, 9))  # those that are not 0
        self.assertAlmostEqual(sum(shares), 100, delta=1)
        self.assertIn("guarded events: back faces ", report)
        self.assertIn("warnings: none", report)

    def test_a_pilot_leaves_nothing_behind_and_changes_no_result(self):
        irsig("run", self.sweep, "--db", self.db, "--plan")
        self.assertEqual(len(self.prediction()), 1)
        again = subprocess.run([IRSIG, "run", self.sweep, "--db", self.db, "--plan"], capture_output=True, text=True, timeout=300)
        self.assertIn("nothing is predicted here", again.stderr)
        other = self.path / "other.sigdb"
        irsig("run", self.sweep, "--db", other)
        self.assertEqual(irsig("digest", other), irsig("digest", self.db))
        self.assertIn("no prediction", irsig("report", other))
        self.assertNotIn("no prediction", irsig("report", self.db))
        self.assertEqual(sorted(p.name for p in self.path.iterdir()), ["other.sigdb", "small.sigdb", "small.toml"])

    def test_a_prediction_is_for_the_accuracy_that_it_was_made_for(self):
        irsig("plan", self.sweep, "--relative-error", 0.05, "--db", self.db)
        irsig("run", self.sweep, "--db", self.db)
        self.assertIn("no prediction", irsig("report", self.db))

    def test_says_what_keeps_a_target_out_of_reach(self):
        self.sweep.write_text(SWEEP.replace("relative_error = 0.01", "relative_error = 0.01\nmax_samples_per_replicate = 2048"))
        plan = irsig("plan", self.sweep)
        self.assertRegex(plan, r"(?m)^ +0.03 % .*max_samples_per_replicate = 2048 keeps ")
        self.assertNotRegex(plan, r"(?m)^ +10 % .*keeps ")
        # It ends with what decides, and with the key; where every row reaches its accuracy it does not.
        missed = irsig("plan", self.sweep, "--relative-error", 0.0003)
        last = missed.splitlines()[-1]
        self.assertRegex(last, r"^\d+ rows? would not reach 0\.03 %: scatter of the samples \(sampling\); raise \[accuracy\] max_samples_per_replicate$")
        self.assertNotIn("would not reach", irsig("plan", self.sweep, "--relative-error", 0.1))
        (row, *_) = json.loads(irsig("plan", self.sweep, "--relative-error", 0.0003, "--format", "json"))
        self.assertEqual(row["limiting_bound"], "sampling")

    def test_effects_are_those_of_the_accuracy_asked(self):
        """Soot reflects so little that 5 % has room for all of it, and 0.01 % has not."""
        soot = re.sub(r'material = "\w+"', 'material = "soot"', SWEEP).replace("sun = true", "sun = false")
        soot = soot.replace("relative_error = 0.01", "relative_error = 0.01\nabsolute_error_k = 0")
        at = soot.index("[[part]]")
        self.sweep.write_text(soot[:at] + '[[material]]\nname = "soot"\nkind = "lambert"\nemissivity = 0.99999\n\n' + soot[at:])
        coarse = irsig("plan", self.sweep, "--relative-error", 0.05)
        self.assertRegex(coarse, r"(?m)^sky_reflected +0 +(30|42) +0 +[\d.]+ % .*has room for its bound \((30|42)\)$")
        self.assertRegex(coarse, r"(?m)^direct_sun +0 +0 +(30|42) ")
        fine = irsig("plan", self.sweep, "--relative-error", 1e-4)
        self.assertRegex(fine, r"(?m)^sky_reflected +(30|42) +0 +0 ")
        forced = irsig("plan", self.sweep, "--relative-error", 0.05, "--effects", "all")
        self.assertRegex(forced, r"(?m)^sky_reflected +(30|42) +0 +0 .*forced: the user's word \((30|42)\)$")

    def test_profiles_are_predicted(self):
        self.sweep.write_text(CAVITY)
        plan = irsig("plan", self.sweep, "--db", self.db)
        self.assertIn("1 viewpoint x 1 condition x 1 band = 1 row, in 1 job", plan)
        with_profiles = self.prediction()[0]
        bare = CAVITY[:CAVITY.index("# One point at mid width")]
        self.sweep.write_text(bare)
        irsig("plan", self.sweep, "--db", self.db)
        without = [p for p in self.prediction() if p["sweep_sha256"] != with_profiles["sweep_sha256"]][0]
        # 12 points of at least 8704 samples against one view of 2176: not a matter of the clock's noise.
        self.assertGreater(with_profiles["cpu_s"], 3 * without["cpu_s"])

    def test_given_counts(self):
        self.sweep.write_text(SWEEP.replace("relative_error = 0.01", "samples_per_replicate = 512"))
        plan = irsig("plan", self.sweep, "--db", self.db)
        self.assertIn("512 samples in each of 32 replicates", plan)
        self.assertIn("ask with --relative-error", plan)
        irsig("run", self.sweep, "--db", self.db)
        report = irsig("report", self.db)
        self.assertIn("no relative error was asked for", report)
        self.assertRegex(report, r"stopped by: fixed_samples 42")

    def test_wrong_input(self):
        self.assertIn("small.toml", irsig("plan", self.path / "no" / "small.toml", code=2))
        self.assertIn("nothing.sigdb", irsig("report", self.path / "nothing.sigdb", code=2))
        irsig("plan", self.sweep, "--workers", 0, code=2)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
