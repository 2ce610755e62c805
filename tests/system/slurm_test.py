"""ops/slurm/farm.sh under programs that stand for Slurm's: what it computes, and how it ends.

usage: slurm_test.py <bin folder> <repository>

sbatch runs the script here, srun two copies of its program; loopback ports only.
"""
import os, pathlib, signal, subprocess, sys, tempfile, time, unittest

BIN, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
PATIENCE_S = 240
SWEEP = (ROOT / "jobs/examples/disk.toml").read_text() \
    .replace("triangles = 100000", "triangles = 1000") \
    .replace("aspect = [ { azimuth_deg = 0, elevation_deg = 0 } ]",
             "aspect = [" + ", ".join(f"{{ azimuth_deg = {a}, elevation_deg = 0 }}" for a in range(8)) + "]") \
    .replace("relative_error = 1e-4", "samples_per_replicate = 64")
for made in ("triangles = 1000\n", "azimuth_deg = 7", "samples_per_replicate = 64"):
    assert made in SWEEP, made

# Of sbatch what the script sees of it: a copy elsewhere, and its environment.
SBATCH = """#!/bin/bash
copy=$(mktemp); cp "$1" "$copy"; shift
export SLURM_JOB_ID=1 SLURM_SUBMIT_DIR="$PWD" SLURMD_NODENAME=127.0.0.1
exec bash "$copy" "$@"
"""
TWO_TASKS = """#!/bin/bash
while [[ $1 == -* ]]; do shift; done
"$@" & first=$!
"$@" & wait $! && wait $first
"""
# Workers that were asked to end before they had begun.
NO_TASK = """#!/bin/bash
exit 0
"""
# Forwards what it is sent, as srun does, to tasks that end then.
UNTIL_TERM = """#!/bin/bash
trap 'echo asked > "$SLURM_SUBMIT_DIR/asked"; exit 0' TERM
touch "$SLURM_SUBMIT_DIR/started"
while :; do sleep 0.05; done
"""


class Slurm(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        (self.path / "sweep.toml").write_text(SWEEP)
        (self.path / "build/release").mkdir(parents=True)
        (self.path / "build/release/bin").symlink_to(BIN)
        (self.path / "ops").symlink_to(ROOT / "ops")
        (self.path / "slurm").mkdir()
        self.stand_in("sbatch", SBATCH)

    def tearDown(self):
        self.folder.cleanup()

    def stand_in(self, name, text):
        program = self.path / "slurm" / name
        program.write_text(text)
        program.chmod(0o755)

    def start(self, *arguments):
        environment = {**os.environ, "PATH": f"{self.path}/slurm:{os.environ['PATH']}", "TMPDIR": str(self.path)}
        process = subprocess.Popen(["sbatch", "ops/slurm/farm.sh", *arguments], cwd=self.path, env=environment,
                                   text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(lambda: process.poll() is None and process.kill())
        return process

    def farm(self, *arguments):
        process = self.start(*arguments)
        out, err = process.communicate(timeout=PATIENCE_S)
        return process.returncode, out, err

    def digest(self, database):
        return subprocess.run([BIN / "irsig", "digest", self.path / database], capture_output=True, text=True,
                              check=True, timeout=PATIENCE_S).stdout

    def check_ended(self, database):
        """Nothing but the database is left, and it is one plain file."""
        left = {p.name for p in self.path.iterdir()} - {"sweep.toml", "build", "ops", "slurm", "asked", "started"}
        self.assertEqual({name for name in left if not name.startswith("tmp.")},
                         {database, f"{database}-lock"} & left)
        self.assertIn(database, left)
        for process in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            try:
                self.assertNotIn(str(self.path).encode(), process.read_bytes())
            except OSError:
                pass  # it has ended meanwhile

    def test_a_sweep_is_computed_and_an_ended_one_goes_on(self):
        self.stand_in("srun", TWO_TASKS)
        code, out, err = self.farm("sweep.toml", "whole.sigdb")
        self.assertEqual(code, 0, err)
        self.assertIn("8 jobs, 8 to compute", out)
        self.check_ended("whole.sigdb")
        (self.path / "whole.sigdb").rename(self.path / "slurm/whole.sigdb")
        for lock in self.path.glob("whole*"):
            lock.unlink()
        # The time limit came first; the same command goes on, to the same bits.
        self.stand_in("srun", NO_TASK)
        code, out, err = self.farm("sweep.toml", "part.sigdb")
        self.assertEqual(code, 1, err)
        self.assertIn("8 jobs are not done; the same command goes on", err)
        self.check_ended("part.sigdb")
        self.stand_in("srun", TWO_TASKS)
        code, out, err = self.farm("sweep.toml", "part.sigdb")
        self.assertEqual(code, 0, err)
        self.assertEqual(self.digest("part.sigdb"), self.digest("slurm/whole.sigdb"))

    def test_sigterm_ends_all_of_it(self):
        self.stand_in("srun", UNTIL_TERM)
        process = self.start("sweep.toml", "out.sigdb")
        until = time.monotonic() + PATIENCE_S
        while not (self.path / "started").exists():
            self.assertIsNone(process.poll())
            self.assertLess(time.monotonic(), until)
            time.sleep(0.05)
        process.send_signal(signal.SIGTERM)
        _, err = process.communicate(timeout=PATIENCE_S)
        self.assertEqual(process.returncode, 1, err)
        self.assertIn("8 jobs are not done", err)
        self.assertEqual((self.path / "asked").read_text(), "asked\n")
        self.check_ended("out.sigdb")

    def test_what_cannot_begin_ends_with_its_reason(self):
        self.stand_in("srun", TWO_TASKS)
        for arguments, code, why in ((["sweep.toml"], 2, "usage: sbatch"),
                                     (["none.toml", "out.sigdb"], 2, "none.toml"),
                                     (["sweep.toml", "no/such/folder.sigdb"], 1, "no/such")):
            ended, _, err = self.farm(*arguments)
            self.assertEqual(ended, code, err)
            self.assertIn(why, err)
            self.assertEqual(list(self.path.glob(".irsig-farm*")), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
