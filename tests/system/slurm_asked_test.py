"""What irsig run asks of Slurm: no more workers than there are jobs, and a word as soon as they vanish. Programs of the test's own stand in
for Slurm's: sbatch keeps what it was asked, squeue shows an empty queue.

usage: slurm_asked_test.py <irsig> <repository>
"""
import os, pathlib, subprocess, sys, tempfile, time, unittest

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])


class SlurmAsked(unittest.TestCase):
    def test_workers_and_vanished_jobs(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            for name, text in (("sbatch", f'echo "$@" >> {path}/asked; echo 42'), ("squeue", "true"), ("scancel", "true")):
                (path / name).write_text(f"#!/bin/sh\n{text}\n")
                (path / name).chmod(0o755)
            sweep = path / "few.toml"
            sweep.write_text((ROOT / "jobs/examples/quickstart.toml").read_text().replace("count = 24", "count = 3"))
            environment = {**os.environ, "PATH": f"{path}:{os.environ['PATH']}"}
            errors = path / "errors"
            with open(errors, "w") as stream:
                run = subprocess.Popen([IRSIG, "run", sweep, "--db", path / "few.sigdb", "--launcher", "slurm", "--workers", "2000",
                                        "--host", "127.0.0.1"], env=environment, stdout=subprocess.DEVNULL, stderr=stream)
            try:
                end = time.monotonic() + 60
                while "has left the queue" not in errors.read_text():
                    self.assertIsNone(run.poll(), errors.read_text())
                    self.assertLess(time.monotonic(), end, errors.read_text())
                    time.sleep(0.1)
            finally:
                run.terminate()
                run.wait(60)
            said = errors.read_text()
            self.assertIn("3 jobs: 3 workers are asked for in place of 2000", said)
            self.assertIn("Slurm's job 42 has left the queue with work still to do, it is handed in again: they wrote nothing; do the nodes see", said)
            self.assertIn("--array=1-3 ", (path / "asked").read_text())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
