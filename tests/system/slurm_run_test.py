"""irsig run --launcher slurm on a cluster of Slurm on this machine: the same bits as a run on this machine, whatever is killed.

usage: slurm_run_test.py <bin folder> <repository> [viewpoints]      160 of them; ops/test-slurm.sh takes more
"""
import os, pathlib, shutil, signal, subprocess, sys, tempfile, time, unittest

from slurm_cluster import Cluster, missing

BIN, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
VIEWPOINTS = int(sys.argv[3]) if len(sys.argv) > 3 else 160
PATIENCE_S = 60 + VIEWPOINTS // 4
QUICKSTART = (ROOT / "jobs/examples/quickstart.toml").read_text()


class SlurmRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        assert not missing(), f"ops/setup.sh installs {missing()}"
        cls.path = pathlib.Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.path, ignore_errors=True)
        cls.cluster = Cluster(cls.path / "cluster", nodes=2)
        cls.addClassCleanup(cls.cluster.stop)
        cls.many = cls.path / "many.toml"
        cls.many.write_text(QUICKSTART.replace("count = 24", f"count = {VIEWPOINTS}").replace("relative_error = 0.01", "samples_per_replicate = 512"))

    def start(self, sweep, db, *options):
        return subprocess.Popen([BIN / "irsig", "run", sweep, "--db", db, "--launcher", "slurm", "--host", "127.0.0.1", *map(str, options)],
                                env=self.cluster.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def end(self, run, code=0):
        out, errors = run.communicate(timeout=PATIENCE_S)
        self.assertEqual(run.returncode, code, out + errors)
        return out + errors

    def digest(self, db):
        return subprocess.run([BIN / "irsig", "digest", db], capture_output=True, text=True, check=True).stdout

    def here(self, sweep):
        db = self.path / f"{sweep.stem}-here.sigdb"
        if not db.exists():
            subprocess.run([BIN / "irsig", "run", sweep, "--db", db], capture_output=True, check=True)
        return self.digest(db)

    def nothing_is_left(self, db):
        self.assertEqual([p.name for p in self.path.glob("irsig-scratch-*")], [])
        self.cluster.until(lambda: self.cluster.run("squeue", "-h").strip() == "", "an empty queue")
        self.assertTrue(db.exists())

    def jobs_done(self, db):
        import sqlite3
        try:
            with sqlite3.connect(f"file:{db}?mode=ro", uri=True, timeout=10) as sql:
                return sql.execute("SELECT count(*) FROM job JOIN job_state USING (state) WHERE name = 'done'").fetchone()[0]
        except sqlite3.OperationalError:
            return 0

    def until_done(self, db, jobs, run):
        end = time.monotonic() + PATIENCE_S
        while self.jobs_done(db) < jobs:
            self.assertIsNone(run.poll(), "it ended early")
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)

    def coordinator(self, db):
        (pid,) = [int(p.name) for p in pathlib.Path("/proc").glob("[0-9]*")
                  if (p / "cmdline").exists() and (words := self.words(p)) and words[0].endswith("irsig-coordinator") and str(db) in words]
        return pid

    @staticmethod
    def words(process):
        try:
            return (process / "cmdline").read_bytes().decode().split("\0")
        except OSError:
            return []

    def test_the_same_bits(self):
        for options in (("--workers", 3), ("--nodes", 2, "--time-limit", "0:10:00", "--partition", "main", "--slurm-option=--nice=5")):
            db = self.path / f"{options[0]}.sigdb"
            said = self.end(self.start(ROOT / "jobs/examples/quickstart.toml", db, *options))
            self.assertIn("24 of 24 jobs done", said)
            self.assertEqual(self.digest(db), self.here(ROOT / "jobs/examples/quickstart.toml"))
            self.nothing_is_left(db)
        # One each on two nodes, whole: as many workers as they have CPUs.
        import sqlite3
        with sqlite3.connect(f"file:{db}?mode=ro", uri=True) as sql:
            self.assertEqual(sql.execute("PRAGMA integrity_check").fetchone(), ("ok",))

    def test_a_node_and_the_coordinator_are_lost(self):
        db = self.path / "lost.sigdb"
        run = self.start(self.many, db, "--workers", 3)
        self.until_done(db, VIEWPOINTS // 8, run)
        self.cluster.kill_node(1)
        self.until_done(db, VIEWPOINTS // 4, run)
        os.kill(self.coordinator(db), signal.SIGKILL)
        self.until_done(db, VIEWPOINTS // 2, run)
        self.cluster.start_node(1)
        self.assertIn(f"{VIEWPOINTS} of {VIEWPOINTS} jobs done", self.end(run))
        self.assertEqual(self.digest(db), self.here(self.many))
        self.cluster.run("scontrol", "update", "NodeName=n1", "State=RESUME", check=False)

    def test_interrupted_and_resumed(self):
        db = self.path / "interrupted.sigdb"
        run = self.start(self.many, db, "--workers", 2)
        self.until_done(db, 3, run)
        run.send_signal(signal.SIGINT)
        self.assertIn("--resume", self.end(run, code=1))
        self.nothing_is_left(db)
        self.assertLess(self.jobs_done(db), VIEWPOINTS)
        self.end(self.start(self.many, db, "--workers", 2, "--resume"))
        self.assertEqual(self.digest(db), self.here(self.many))

    def test_workers_that_are_cancelled_are_handed_in_again(self):
        db = self.path / "cancelled.sigdb"
        run = self.start(self.many, db, "--workers", 2)
        self.until_done(db, 3, run)
        self.cluster.run("scancel", "--name=irsig")
        self.end(run)
        self.assertEqual(self.digest(db), self.here(self.many))

    def test_what_is_wrong_is_said(self):
        db = self.path / "wrong.sigdb"
        for options in (("--workers", 2, "--nodes", 2), ()):
            self.assertIn("expected --workers N", self.end(self.start(self.many, db, *options), code=2))
            self.assertFalse(db.exists())
        # What Slurm refuses, in its own words.
        for k, (option, said) in enumerate((("--partition=none", "partition"), ("--slurm-option=--no-such", "no-such"))):
            self.assertIn(said, self.end(self.start(self.many, self.path / f"wrong-{k}.sigdb", "--workers", 1, option), code=1))
        done = subprocess.run([BIN / "irsig", "run", self.many, "--db", db, "--nodes", "2"], capture_output=True, text=True)
        self.assertIn("belong to --launcher slurm", done.stderr)
        done = subprocess.run([BIN / "irsig", "run", self.many, "--db", db, "--launcher", "slurm", "--workers", "1"], capture_output=True, text=True,
                              env={**os.environ, "PATH": "/nonexistent"})
        self.assertIn("there is no sbatch here", done.stderr)
        self.assertEqual(done.returncode, 2)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
