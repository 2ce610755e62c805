"""--format and --out are the same in every command, and what they give holds what was asked.

usage: output_test.py <irsig executable> <irsig-coordinator executable> <source folder>
"""
import contextlib
import csv
import io
import json
import pathlib
import sqlite3
import subprocess
import sys
import tempfile
import time
import unittest

IRSIG, COORDINATOR, SOURCE = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
WORKER = pathlib.Path(IRSIG).with_name("irsig-worker")
SWEEP = (SOURCE / "jobs/examples/quickstart.toml").read_text().replace("count = 24", "count = 3").replace(
    "triangles = 20000", "triangles = 2000").replace("relative_error = 0.01", "relative_error = 0.1")


class Output(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)
        (cls.path / "a.toml").write_text(SWEEP)
        cls.irsig("run", "a.toml", "--db", "a.sigdb", "--plan")

    @classmethod
    def irsig(cls, *arguments, code=0):
        done = subprocess.run([IRSIG, *map(str, arguments)], cwd=cls.path, capture_output=True, text=True, timeout=300)
        assert done.returncode == code, f"{arguments}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
        return done.stdout

    def test_one_table_in_every_format(self):
        commands = [["query", "a.sigdb"], ["report", "a.sigdb"], ["plan", "a.toml"], ["material", "list"],
                    ["material", "show", "aluminium"], ["material", "check", "blackbody"], ["show", "effects"],
                    ["show", "planck", "--temperature-k", "300", "--lambda-um", "10"],
                    ["show", "sun", "--latitude-deg", "50", "--longitude-deg", "0", "--altitude-m", "0", "--time",
                     "2025-06-21T12:00:00Z"]]
        for command in commands:
            with self.subTest(" ".join(command)):
                if command[0] == "plan":
                    # Times are of each pilot's own: only what is counted is compared.
                    keep = ("sweep", "rows", "jobs", "relative_error", "viewpoints")
                else:
                    keep = None
                rows = json.loads(self.irsig(*command, "--json"))
                self.assertGreater(len(rows), 0)
                table = list(csv.DictReader(io.StringIO(self.irsig(*command, "--format", "csv"))))
                self.assertEqual(len(table), len(rows))
                self.assertEqual(list(table[0]), list(rows[0]))
                for a, b in zip(table, rows):
                    for key, value in b.items():
                        if keep and key not in keep:
                            continue
                        said = "" if value is None else str(value).lower() if isinstance(value, bool) else value
                        self.assertEqual(type(said)(a[key]), said, key)
                out = self.path / "out.csv"
                self.irsig(*command, "--out", out)  # the name says how
                if not keep:
                    self.assertEqual(out.read_text(), self.irsig(*command, "--csv", "--out", "-"))
                text = self.irsig(*command, "--format", "table")
                self.assertNotEqual(text[:1], "[")
                self.assertNotIn(",".join(rows[0]), text)

    def test_pictures_and_models_to_standard_output(self):
        spectrum = ["plot", "a.sigdb", "--kind", "spectrum", "--row", 2]
        self.irsig(*spectrum, "--out", "a.svg")
        self.assertEqual((self.path / "a.svg").read_text(), self.irsig(*spectrum, "--out", "-"))
        self.irsig("model", "box", "--triangles", 12, "--out", "box.obj")
        self.assertEqual((self.path / "box.obj").read_text(), self.irsig("model", "box", "--triangles", 12, "--out", "-"))
        self.irsig("export", "a.sigdb", "--out", "a.csv")
        self.assertEqual((self.path / "a.csv").read_text(), self.irsig("export", "a.sigdb", "--out", "-"))
        self.irsig("export", "a.sigdb", "--out", "a.nc")
        self.assertEqual((self.path / "a.nc").read_bytes()[1:4], b"HDF")

    def test_report_as_json_agrees_with_the_rows(self):
        report, = json.loads(self.irsig("report", "a.sigdb", "--json"))
        rows = json.loads(self.irsig("query", "a.sigdb", "--json"))
        self.assertEqual((report["sweep"], report["jobs"], report["predicted_jobs"], report["rows"]),
                         ("quickstart", 3, 3, len(rows)))
        for reason in ("accuracy_reached", "accuracy_not_reached", "floor_reached", "sample_limit", "fixed_samples"):
            self.assertEqual(report[reason + "_rows"], sum(r["stop_reason"] == reason for r in rows), reason)
        worst = max(r["numerical_error_w_sr"] / r["intensity_w_sr"] for r in rows)
        self.assertAlmostEqual(report["relative_error_largest"], worst, 12)
        shares = [v for k, v in report.items() if k.startswith("error_share_")]
        self.assertAlmostEqual(sum(shares), 1, 9)

    def test_status_as_json(self):
        address = f"unix:{self.path}/socket"
        with subprocess.Popen([COORDINATOR, "--db", self.path / "s.sigdb", "--listen", address],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as coordinator:
            try:
                while subprocess.run([IRSIG, "status", "--coordinator", address], capture_output=True).returncode:
                    self.assertIsNone(coordinator.poll())
                    time.sleep(0.05)
                self.irsig("submit", "a.toml", "--coordinator", address)
                sweep, = json.loads(self.irsig("status", "--coordinator", address, "--json"))
                with subprocess.Popen([IRSIG, "status", "--follow", "--coordinator", address], stdout=subprocess.PIPE,
                                      stderr=subprocess.PIPE, text=True) as follower:
                    first = follower.stderr.readline()
                    subprocess.run([WORKER, "--coordinator", address, "--exit-when-finished"], check=True, timeout=300,
                                   stderr=subprocess.DEVNULL)
                    table, _ = follower.communicate(timeout=300)
                self.assertEqual((follower.returncode, first), (0, "quickstart: jobs 0/3  0 workers\n"))
                self.assertEqual(table.splitlines()[1].split()[:3], ["quickstart", "3", "3"])
            finally:
                coordinator.terminate()
        self.assertEqual((sweep["sweep"], sweep["jobs"], sweep["done"], sweep["workers"]), ("quickstart", 3, 0, 0))

    def test_an_instruction_set_that_all_machines_have(self):
        with self.assertRaises(AssertionError):
            self.irsig("run", "a.toml", "--db", "isa.sigdb", "--isa", "avx")
        self.irsig("run", "a.toml", "--db", "isa.sigdb", "--isa", "sse4.2")
        rows = [json.loads(self.irsig("query", name, "--json")) for name in ("a.sigdb", "isa.sigdb")]
        self.assertEqual(len(rows[0]), len(rows[1]))
        with contextlib.closing(sqlite3.connect(self.path / "isa.sigdb")) as database:
            (of,), = database.execute("SELECT DISTINCT determinism_class FROM provenance")
        self.assertIn("/sse4.2/", of)
        # Other last bits at most.
        for a, b in zip(*(sorted(r, key=lambda row: row["row"]) for r in rows)):
            self.assertAlmostEqual(a["intensity_w_sr"] / b["intensity_w_sr"], 1, 4)

    def test_sizes_are_said_and_a_changed_sweep_says_what_it_replaces(self):
        def said(name, *more, code=0):
            done = subprocess.run([IRSIG, "run", name, "--db", "c.sigdb", *more], cwd=self.path, capture_output=True,
                                  text=True, timeout=300)
            self.assertEqual(done.returncode, code, done.stderr)
            return done.stderr
        first = said("a.toml")
        self.assertIn("3 viewpoints x 3 conditions x 2 bands = 18 rows, 122 wavelengths, database about", first)
        self.assertNotIn("replaced", first)
        (self.path / "changed.toml").write_text(SWEEP.replace("count = 3", "count = 4"))
        # The viewpoints of four are others than those of three.
        changed = 'the sweep "quickstart" has changed: 18 of its 18 stored rows '
        self.assertIn(changed + "would be replaced: add --replace", said("changed.toml", code=2))
        self.assertNotIn("to compute", said("a.toml"))  # nothing is lost
        self.assertIn(changed + "will be replaced", said("changed.toml", "--replace"))
        (self.path / "large.toml").write_text(SWEEP.replace("count = 3", "count = 900000"))
        self.assertIn("--yes", said("large.toml", code=2))
        size = (self.path / "c.sigdb").stat().st_size
        about = float(said("changed.toml").split("database about ")[1].split()[0])
        self.assertTrue(0.5 < about * 1e6 / size < 2 or about > 100, (about, size))

    def test_the_shell_completes_what_there_is(self):
        script = self.path / "try.sh"
        script.write_text(f'source <("{IRSIG}" completion bash)\n' + """
        t() { COMP_WORDS=("$@"); COMP_CWORD=$(($#-1)); COMPREPLY=(); _irsig; echo "${COMPREPLY[*]}"; }
        t irsig que
        t irsig model ch
        t irsig query x --fo
        t irsig query x --format ""
        t irsig plot x --kind m
        t irsig show sky --aer
        t irsig run a.to
        """)
        done = subprocess.run(["bash", script], cwd=self.path, capture_output=True, text=True)
        self.assertEqual((done.stdout.splitlines(), done.stderr),
                         (["query", "check", "--format", "text csv json table", "map", "--aerosol", "a.toml"], ""))
        self.assertIn("bashcompinit", self.irsig("completion", "zsh"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
