"""A farm on two machines over a bad link: 5 % of packets lost, 5 % doubled, delayed so that they overtake each other, and cut, both ways and one way
alone. What is stored is what one machine computes; nothing is lost, nothing doubled, nobody is to blame.

usage: link_test.py <bin folder> <repository> [viewpoints [cuts]]      40 and 3

Exit code 77 (skipped) where network namespaces cannot be made.
"""
import csv, io, pathlib, re, subprocess, sys, tempfile, time, unittest

import two_machines
from two_machines import at

BIN, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
VIEWPOINTS = int(sys.argv[3]) if len(sys.argv) > 3 else 40
CUTS = int(sys.argv[4]) if len(sys.argv) > 4 else 3
PATIENCE_S = 300
WORKERS = 2
HERE, THERE = "10.77.31.1", "10.77.31.2"
BAD = {"loss": 0.05, "doubled": 0.05, "delay_s": 0.003, "jitter_s": 0.01}
SWEEP = (ROOT / "jobs/examples/disk.toml").read_text() \
    .replace("triangles = 100000", "triangles = 1000") \
    .replace("relative_error = 1e-4", "samples_per_replicate = 64") \
    .replace("aspect = [ { azimuth_deg = 0, elevation_deg = 0 } ]",
             "aspect = [" + ", ".join(f"{{ azimuth_deg = {a * 80 / VIEWPOINTS}, elevation_deg = 0 }}" for a in range(VIEWPOINTS)) + "]")
for made in ("triangles = 1000\n", "samples_per_replicate = 64", "azimuth_deg = 0.0"):
    assert made in SWEEP, made


class Link(unittest.TestCase):
    def run_program(self, *command, **more):
        done = subprocess.run([str(c) for c in command], cwd=self.path, capture_output=True, text=True, timeout=PATIENCE_S, **more)
        self.assertEqual(done.returncode, 0, f"{command}: {done.stderr}")
        return done.stdout

    def started(self, *command, **more):
        process = subprocess.Popen([str(c) for c in command], cwd=self.path, text=True, **more)
        self.addCleanup(lambda: (process.kill(), process.communicate()))
        return process

    def files(self, who):
        return [f"--tls-cert={self.path}/ca/{who}.pem", f"--tls-key={self.path}/ca/{who}.key", f"--tls-ca={self.path}/ca/ca.pem"]

    def status(self):
        """Jobs done and workers, as the coordinator's own machine sees them."""
        told = self.run_program(*at(self.here, BIN / "irsig", "status", "--csv", f"--coordinator={self.address}"), *self.files("user"))
        sweep, = csv.DictReader(io.StringIO(told))
        return {name: int(sweep[name]) for name in ("jobs", "done", "failed", "workers")}

    def until(self, what, seen):
        end = time.monotonic() + PATIENCE_S
        while not seen(now := self.status()):
            self.assertLess(time.monotonic(), end, f"{what}: {now}")
            for worker in self.workers:
                self.assertIn(worker.poll(), (None, 0), what)
            time.sleep(0.1)
        return now

    def test_what_is_stored_is_what_one_machine_computes(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        (self.path / "sweep.toml").write_text(SWEEP)
        self.run_program(BIN / "irsig", "ca", "init", self.path / "ca")
        for who, *what in (("coordinator", f"--host={HERE}"), ("user", "--role=submit"), ("worker", "--role=work")):
            self.run_program(BIN / "irsig", "ca", "issue", self.path / "ca", who, "--out", self.path / "ca", *what)
        self.here, self.there = (self.enterContext(two_machines.machine(f"{self.path.name}-{side}")) for side in "ab")
        link = self.enterContext(two_machines.BadLink(self.here, HERE + "/24", self.there, THERE + "/24"))

        coordinator = self.started(*at(self.here, BIN / "irsig-coordinator"), "--db", "far.sigdb", "--listen", f"{HERE}:0",
                                   "--heartbeat-s=0.2", "--lost-after-s=1.5", "--audit-share=0", *self.files("coordinator"), stdout=subprocess.PIPE)
        self.address = re.search(r"listening on (\S+)", coordinator.stdout.readline())[1]
        self.run_program(*at(self.here, BIN / "irsig", "submit", "sweep.toml", f"--coordinator={self.address}"), *self.files("user"))
        link.becomes(BAD)
        self.workers = [self.started(*at(self.there, BIN / "irsig-worker", f"--coordinator={self.address}", "--exit-when-finished",
                                         f"--name=far-{i}", f"--spool={self.path}/spool"), *self.files("worker"))
                        for i in range(WORKERS)]
        # Both ways; then acknowledgements do not arrive; then results do not.
        cut = {"loss": 1.0}
        ways = [(cut, cut), (cut, BAD), (BAD, cut)]
        cuts = 0
        for k in range(CUTS):
            done = self.status()["done"]
            aim = VIEWPOINTS * (k + 1) // (CUTS + 2)
            self.until("jobs are done", lambda now: now["done"] >= max(aim, done + 1))
            link.becomes(*ways[k % len(ways)])
            self.until("the workers are lost", lambda now: now["workers"] == 0)
            link.becomes(BAD)
            cuts += self.status()["done"] < VIEWPOINTS
        self.until("all is done", lambda now: now["done"] == VIEWPOINTS)
        carried = link.becomes({})
        for worker in self.workers:
            self.assertEqual(worker.wait(PATIENCE_S), 0)
        self.assertEqual(self.status()["failed"], 0)
        coordinator.terminate()
        self.assertEqual(coordinator.wait(PATIENCE_S), 0)
        self.assertEqual(list((self.path / "spool").glob("*/*")) if (self.path / "spool").exists() else [], [], "results that wait")

        self.run_program(BIN / "irsig", "run", "sweep.toml", "--db", "near.sigdb", "--workers", "1")
        digests = [self.run_program(BIN / "irsig", "digest", f"{name}.sigdb") for name in ("far", "near")]
        self.assertEqual(digests[0], digests[1])
        self.run_program(BIN / "irsig", "doctor", "far.sigdb")
        # The faults took place.
        self.assertEqual(cuts, CUTS, "the sweep was over before the last cut")
        self.assertGreater(min(carried["lost"], carried["doubled"]), 10, carried)
        print(f"{VIEWPOINTS} jobs, {CUTS} cuts; packets: {carried}", file=sys.stderr)


if __name__ == "__main__":
    if reason := two_machines.why_not():
        print(f"skipped: {reason}")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
