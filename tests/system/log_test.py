"""The logs of a farm: lines for people, or an object a line that programs join by job.

usage: log_test.py <irsig executable> <irsig-coordinator executable> <irsig-worker executable> <source folder>
"""
import collections
import contextlib
import json
import pathlib
import re
import sqlite3
import subprocess
import sys
import tempfile
import time
import unittest

IRSIG, COORDINATOR, WORKER, SOURCE = *sys.argv[1:4], pathlib.Path(sys.argv[4])
SWEEP = (SOURCE / "jobs/examples/quickstart.toml").read_text().replace("count = 24", "count = 3").replace(
    "triangles = 20000", "triangles = 2000").replace("relative_error = 0.01", "relative_error = 0.1")


class Logs(unittest.TestCase):
    def farm(self, *options, worker="first"):
        """The lines of a coordinator and of the worker that computes a sweep of three jobs."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            (path / "a.toml").write_text(SWEEP)
            address = f"unix:{path}/socket"
            command = [COORDINATOR, "--db", path / "s.sigdb", "--listen", address, *options]
            with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as coordinator:
                try:
                    while subprocess.run([IRSIG, "status", "--coordinator", address], capture_output=True).returncode:
                        self.assertIsNone(coordinator.poll())
                        time.sleep(0.05)
                    subprocess.run([IRSIG, "submit", path / "a.toml", "--coordinator", address], check=True, timeout=300,
                                   capture_output=True)
                    done = subprocess.run(
                        [WORKER, "--coordinator", address, "--name", worker, "--exit-when-finished", *options], check=True,
                        timeout=300, capture_output=True, text=True)
                finally:
                    coordinator.terminate()
                said = coordinator.communicate(timeout=60)[1]
            self.assertEqual(coordinator.returncode, 0, said)
            with contextlib.closing(sqlite3.connect(path / "s.sigdb")) as database:
                self.keys = [key for key, in database.execute("SELECT job_key FROM job")]
        return [text.split("\n")[:-1] for text in (said, done.stderr)]

    def test_objects_are_joined_by_job(self):
        coordinator, worker = self.farm("--log-format", "json", "--log-level", "debug")
        lines = [json.loads(line) for line in coordinator + worker]
        of_job = collections.defaultdict(list)
        for line in lines:
            self.assertRegex(line["time"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z$")
            self.assertIn(line["program"], ("coordinator", "worker"))
            self.assertIn(line["level"], ("debug", "info", "warning", "error"))
            self.assertLessEqual(line.keys(), {"time", "program", "level", "sweep", "job_key", "worker", "message"})
            of_job[line.get("job_key")].append((line["program"], line.get("worker"), line["message"]))
        self.assertIn(("coordinator", "first"), [about[:2] for about in of_job.pop(None)])  # registered
        self.assertEqual(sorted(of_job), sorted(self.keys))
        for key, about in of_job.items():
            self.assertEqual([a for a in about if a[0] == "coordinator"],
                             [("coordinator", "first", "leased"), ("coordinator", "first", "stored")])
            self.assertTrue(any(a[0] == "worker" and re.fullmatch(r"computed in \d+\.\d{3} s", a[2]) for a in about), about)

    def test_lines_for_people(self):
        coordinator, _ = self.farm("--log-level", "debug")
        for key in self.keys:
            self.assertEqual(sum(f"job {key[:12]}, worker first: stored" in line for line in coordinator), 1, coordinator)

    def test_what_is_not_asked_for_is_not_said(self):
        (submitted,), worker = self.farm()
        self.assertRegex(submitted, r"\[info\] sweep quickstart: 3 jobs, 3 to compute")
        self.assertEqual(worker, [])
        self.assertEqual(self.farm("--log-format", "json", "--log-level", "error"), [[], []])

    def test_a_name_ends_no_line(self):
        for worker in ('"}{"level": "error', "50%v %n {} \\", "größer\u2028"):
            lines = self.farm("--log-format", "json", "--log-level", "debug", worker=worker)[0]
            self.assertEqual({json.loads(line).get("worker") for line in lines} - {None}, {worker}, lines)

    def test_unknown_names(self):
        for option in (("--log-format", "xml"), ("--log-level", "verbose")):
            for program in (COORDINATOR, WORKER):
                where = ["--db", "/nonexistent/x"] if program == COORDINATOR else ["--coordinator", "unix:/nonexistent/x"]
                done = subprocess.run([program, *where, *option], capture_output=True, text=True)
                self.assertEqual(done.returncode, 2)
                self.assertIn(f'{option[0]}: "{option[1]}", expected ', done.stderr)


    def test_rules_that_are_no_numbers(self):
        """Every comparison with them is false: a worker that dies would never be lost."""
        with tempfile.TemporaryDirectory() as folder:
            for option in ("--heartbeat-s", "--lost-after-s", "--audit-share"):
                done = subprocess.run([COORDINATOR, "--db", f"{folder}/s.sigdb", "--listen", f"unix:{folder}/socket", option, "nan"],
                                      capture_output=True, text=True, timeout=60)
                self.assertEqual(done.returncode, 2, option + done.stderr)
                self.assertIn(option, done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
