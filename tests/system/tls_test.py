"""A farm over TLS: coordinator, worker and commands with certificates; what is refused says why.

usage: tls_test.py <irsig> <irsig-coordinator> <irsig-worker> <repository>

Ports of the loopback interface only.
"""
import os, pathlib, re, subprocess, sys, tempfile, unittest

IRSIG, COORDINATOR, WORKER, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:5])
PATIENCE_S = 240
SWEEP = (ROOT / "jobs/examples/disk.toml").read_text() \
    .replace("triangles = 100000", "triangles = 1000") \
    .replace("relative_error = 1e-4", "samples_per_replicate = 64")
for made in ("triangles = 1000\n", "samples_per_replicate = 64"):
    assert made in SWEEP, made


class Tls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        for farm in ("farm", "other"):
            subprocess.run([ROOT / "ops/farm-certificates.sh", cls.path / farm, "127.0.0.1", "localhost"], check=True)
        (cls.path / "sweep.toml").write_text(SWEEP)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def files(self, who, farm="farm"):
        folder = self.path / farm
        return [f"--tls-cert={folder / who}.pem", f"--tls-key={folder / who}.key", f"--tls-ca={folder}/ca.pem"]

    def run_program(self, *arguments):
        return subprocess.run([str(a) for a in arguments], cwd=self.path, capture_output=True, text=True,
                              timeout=PATIENCE_S)

    def listen(self, *arguments):
        process = subprocess.Popen([COORDINATOR, "--db", self.path / f"{self._testMethodName}.sigdb", "--listen",
                                    "127.0.0.1:0", *arguments], cwd=self.path, text=True, stdout=subprocess.PIPE,
                                   stderr=subprocess.DEVNULL)
        self.addCleanup(lambda: (process.kill(), process.wait(), process.stdout.close()))
        return process, re.search(r"listening on (\S+)", process.stdout.readline())[1]

    def test_a_sweep_is_computed(self):
        coordinator, address = self.listen(*self.files("coordinator"))
        for there in (address, address.replace("127.0.0.1", "localhost")):
            reach = [f"--coordinator={there}", *self.files("client")]
            submitted = self.run_program(IRSIG, "submit", "sweep.toml", *reach)
            self.assertEqual(submitted.returncode, 0, submitted.stderr)
            worked = self.run_program(WORKER, "--exit-when-finished", *reach)
            self.assertEqual(worked.returncode, 0, worked.stderr)
            status = self.run_program(IRSIG, "status", "--format", "csv", *reach)
            self.assertEqual(status.returncode, 0, status.stderr)
            self.assertEqual(status.stdout.splitlines()[1].split(",")[:3], ["disk", "1", "1"])
        # Without a certificate, and with one of another farm: at once, with the reason.
        for more, why in (([], "speaks TLS only"), (self.files("client", "other"), "shows a certificate")):
            for program in ([IRSIG, "status"], [IRSIG, "submit", "sweep.toml"], [IRSIG, "cancel", "disk"], [WORKER]):
                refused = self.run_program(*program, f"--coordinator={address}", *more)
                self.assertNotEqual(refused.returncode, 0, program)
                self.assertIn(why, refused.stderr)
        coordinator.terminate()
        self.assertEqual(coordinator.wait(timeout=PATIENCE_S), 0)

    def test_other_machines_only_with_tls(self):
        for program in ([COORDINATOR, "--db", "never.sigdb", "--listen=192.0.2.7:0"],
                        [COORDINATOR, "--db", "never.sigdb", "--listen=0.0.0.0:0"],
                        [WORKER, "--coordinator=192.0.2.7:5"], [IRSIG, "status", "--coordinator=farm.example:5"]):
            refused = self.run_program(*program)
            self.assertEqual(refused.returncode, 2, refused.stderr)
            for said in ("not a loopback address", "--tls-cert", "--insecure-network"):
                self.assertIn(said, refused.stderr)
        self.assertFalse((self.path / "never.sigdb").exists())
        # Asked for, it is tried; of a loopback port the option changes nothing.
        _, address = self.listen("--insecure-network")
        asked = self.run_program(IRSIG, "status", f"--coordinator={address}", "--insecure-network")
        self.assertEqual(asked.returncode, 0, asked.stderr)

    def test_a_key_that_others_may_read(self):
        key = self.path / "farm/client.key"
        os.chmod(key, 0o644)
        self.addCleanup(os.chmod, key, 0o600)
        refused = self.run_program(IRSIG, "status", "--coordinator=127.0.0.1:1", *self.files("client"))
        self.assertEqual(refused.returncode, 2, refused.stderr)
        self.assertIn("client.key: a private key that others may use (mode 0644)", refused.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
