"""A farm over TLS: coordinator, worker and commands with certificates; what is refused says why.

usage: tls_test.py <irsig> <irsig-coordinator> <irsig-worker> <repository>

Ports of the loopback interface only.
"""
import os, pathlib, re, signal, subprocess, sys, tempfile, time, unittest

IRSIG, COORDINATOR, WORKER, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:5])
PATIENCE_S = 240
SWEEP = (ROOT / "jobs/examples/disk.toml").read_text() \
    .replace("triangles = 100000", "triangles = 1000") \
    .replace("relative_error = 1e-4", "samples_per_replicate = 64")
for made in ("triangles = 1000\n", "samples_per_replicate = 64"):
    assert made in SWEEP, made
ONE_VIEW = "aspect = [ { azimuth_deg = 0, elevation_deg = 0 } ]"
assert ONE_VIEW in SWEEP
VIEWS = SWEEP.replace(ONE_VIEW, "aspect = [" + ", ".join(f"{{ azimuth_deg = {a}, elevation_deg = 0 }}" for a in range(6)) + "]")


class Tls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        for farm in ("farm", "other"):
            folder = cls.path / farm
            subprocess.run([IRSIG, "ca", "init", folder], check=True)
            for name, *what in (("coordinator", "--host=127.0.0.1", "--host=localhost"), ("user", "--role=submit"),
                                ("worker", "--role=work"), ("reader", "--role=read")):
                subprocess.run([IRSIG, "ca", "issue", folder, name, "--out", folder, *what], check=True)
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
                                   stderr=subprocess.PIPE)
        self.addCleanup(lambda: (process.kill(), process.wait(), process.stdout.close(), process.stderr.close()))
        return process, re.search(r"listening on (\S+)", process.stdout.readline())[1]

    def test_a_sweep_is_computed(self):
        coordinator, address = self.listen(*self.files("coordinator"), "--tls-crl", self.path / "farm/crl.pem")
        for there in (address, address.replace("127.0.0.1", "localhost")):
            reach = f"--coordinator={there}"
            submitted = self.run_program(IRSIG, "submit", "sweep.toml", reach, *self.files("user"))
            self.assertEqual(submitted.returncode, 0, submitted.stderr)
            worked = self.run_program(WORKER, "--exit-when-finished", reach, *self.files("worker"))
            self.assertEqual(worked.returncode, 0, worked.stderr)
            status = self.run_program(IRSIG, "status", "--format", "csv", reach, *self.files("reader"))
            self.assertEqual(status.returncode, 0, status.stderr)
            self.assertEqual(status.stdout.splitlines()[1].split(",")[:3], ["disk", "1", "1"])
        # Without a certificate, and with one of another farm: at once, with the reason.
        for more, why in ((["--insecure-loopback"], "speaks TLS only"), (self.files("user", "other"), "shows a certificate")):
            for program in ([IRSIG, "status"], [IRSIG, "submit", "sweep.toml"], [IRSIG, "cancel", "disk"], [WORKER]):
                refused = self.run_program(*program, f"--coordinator={address}", *more)
                self.assertNotEqual(refused.returncode, 0, program)
                self.assertIn(why, refused.stderr)
        # With one of this farm, and the wrong role.
        for who, program in (("reader", [IRSIG, "submit", "sweep.toml"]), ("worker", [IRSIG, "status"]),
                             ("reader", [IRSIG, "cancel", "disk"]), ("user", [WORKER])):
            refused = self.run_program(*program, f"--coordinator={address}", *self.files(who))
            self.assertEqual(refused.returncode, 2, refused.stderr)
            self.assertIn(f'the certificate "{who}" has', refused.stderr)
        # Revoked while the coordinator runs.
        crl = self.path / "farm/crl.pem"
        revoked = self.run_program(IRSIG, "ca", "revoke", self.path / "farm", "reader")
        self.assertEqual(revoked.returncode, 0, revoked.stderr)
        self.assertIn(f"1 certificate revoked; {crl}", revoked.stdout)
        until = time.monotonic() + PATIENCE_S
        while (asked := self.run_program(IRSIG, "status", f"--coordinator={address}", *self.files("reader"))).returncode == 0:
            self.assertLess(time.monotonic(), until)
        self.assertIn('"reader" was revoked', asked.stderr)
        listed = self.run_program(IRSIG, "ca", "list", self.path / "farm", "--csv").stdout.splitlines()
        self.assertEqual([line.split(",")[0] for line in listed], ["name", "coordinator", "reader", "user", "worker"])
        self.assertIn(",revoked,", listed[2])
        coordinator.terminate()
        _, log = coordinator.communicate(timeout=PATIENCE_S)
        self.assertEqual(coordinator.returncode, 0)
        for line in ('refused: Submit by "reader" (certificate ', 'refused: Register by "user" (certificate ',
                     "refused: a TLS handshake"):
            self.assertIn(line, log)

    def test_what_an_authority_refuses(self):
        for arguments, why in ((("issue", "farm", "../x", "--role=read"), 'name "../x"'),
                               (("issue", "farm", "x", "--role=admin"), 'role "admin", expected submit, work or read'),
                               (("issue", "farm", "x", "--host=*.example"), 'host "*.example"'),
                               (("issue", "farm", "x"), "--host"),
                               (("issue", "nowhere", "x", "--role=read"), "nowhere/ca.pem"),
                               (("revoke", "farm", "nobody"), '"nobody" is neither name nor serial'),
                               (("list", "nowhere"), "nowhere/ca.pem")):
            refused = self.run_program(IRSIG, "ca", *arguments)
            self.assertEqual(refused.returncode, 2, refused.stderr)
            self.assertIn(why, refused.stderr)
        again = self.run_program(IRSIG, "ca", "init", "farm")
        self.assertEqual(again.returncode, 1, again.stderr)
        self.assertIn("is there already", again.stderr)

    def test_other_machines_only_with_tls(self):
        for program in ([COORDINATOR, "--db", "never.sigdb", "--listen=192.0.2.7:0"],
                        [COORDINATOR, "--db", "never.sigdb", "--listen=0.0.0.0:0"],
                        [WORKER, "--coordinator=192.0.2.7:5"], [IRSIG, "status", "--coordinator=farm.example:5"]):
            refused = self.run_program(*program)
            self.assertEqual(refused.returncode, 2, refused.stderr)
            for said in ("not a loopback address", "--tls-cert", "--insecure-network"):
                self.assertIn(said, refused.stderr)
        self.assertFalse((self.path / "never.sigdb").exists())
        # Of this machine, too.
        for program in ([COORDINATOR, "--db", "never.sigdb", "--listen=127.0.0.1:0"], [WORKER, "--coordinator=localhost:5"],
                        [IRSIG, "status", "--coordinator=[::1]:5"]):
            refused = self.run_program(*program)
            self.assertEqual(refused.returncode, 2, refused.stderr)
            self.assertIn("--insecure-loopback", refused.stderr)
        self.assertFalse((self.path / "never.sigdb").exists())
        # Asked for, it is tried.
        _, address = self.listen("--insecure-loopback")
        asked = self.run_program(IRSIG, "status", f"--coordinator={address}", "--insecure-loopback")
        self.assertEqual(asked.returncode, 0, asked.stderr)

    def test_a_coordinator_that_is_slow_is_waited_for(self):
        coordinator, address = self.listen(*self.files("coordinator"))
        for _ in range(3):
            coordinator.send_signal(signal.SIGSTOP)
            asked = subprocess.Popen([str(a) for a in (IRSIG, "status", f"--coordinator={address}", *self.files("reader"))],
                                     stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            time.sleep(1.5)
            coordinator.send_signal(signal.SIGCONT)
            _, said = asked.communicate(timeout=PATIENCE_S)
            self.assertEqual(asked.returncode, 0, said)

    def test_a_coordinator_listens_beside_its_database(self):
        process = subprocess.Popen([COORDINATOR, "--db", "beside.sigdb"], cwd=self.path, text=True, stdout=subprocess.PIPE)
        self.addCleanup(lambda: (process.kill(), process.wait(), process.stdout.close()))
        self.assertIn("listening on unix:beside.sigdb-farm", process.stdout.readline())
        self.assertEqual((self.path / "beside.sigdb-farm").stat().st_mode & 0o777, 0o600)
        reach = "--coordinator=unix:beside.sigdb-farm"
        workers = [subprocess.Popen([WORKER, reach, "--name", name], cwd=self.path, stderr=subprocess.DEVNULL)
                   for name in ("first", "second")]
        for worker in workers:
            self.addCleanup(lambda w=worker: (w.kill(), w.wait()))
        rows = self.wait_for(["--by-worker", "--csv", reach], lambda out: out.count(",idle,") == 2).splitlines()
        self.assertEqual(rows[0], "worker,host,state,job_s,memory_bytes,reason,job_key,determinism_class")
        self.assertEqual(sorted(row.split(",")[0] for row in rows[1:]), ["first", "second"])
        self.assertGreater(float(rows[1].split(",")[4]), 1e8)

    def test_two_workers_compute_the_same_bits(self):
        (self.path / "views.toml").write_text(VIEWS)
        process = subprocess.Popen([COORDINATOR, "--db", "audited.sigdb", "--audit-share=1"], cwd=self.path, text=True,
                                   stdout=subprocess.PIPE)
        self.addCleanup(lambda: (process.kill(), process.wait(), process.stdout.close()))
        process.stdout.readline()
        reach = "--coordinator=unix:audited.sigdb-farm"
        workers = [subprocess.Popen([WORKER, reach], cwd=self.path, stderr=subprocess.DEVNULL) for _ in range(2)]
        for worker in workers:
            self.addCleanup(lambda w=worker: (w.kill(), w.wait()))
        self.wait_for(["--by-worker", "--csv", reach], lambda out: out.count(",idle,") == 2)
        submitted = self.run_program(IRSIG, "submit", "views.toml", reach)
        self.assertEqual(submitted.returncode, 0, submitted.stderr)
        told = self.wait_for([reach], lambda out: "; 6 jobs computed by two workers" in out)
        self.assertIn("2 workers, ", told)
        for never in ("other results", "set aside", "warning"):
            self.assertNotIn(never, told)

    def wait_for(self, arguments, wanted):
        until = time.monotonic() + PATIENCE_S
        while True:
            asked = self.run_program(IRSIG, "status", *arguments)
            self.assertEqual(asked.returncode, 0, asked.stderr)
            if wanted(asked.stdout):
                return asked.stdout
            self.assertLess(time.monotonic(), until, asked.stdout)
            time.sleep(0.05)

    def test_other_machines_only_where_it_is_said(self):
        _, address = self.listen("--insecure-network")
        asked = self.run_program(IRSIG, "status", f"--coordinator={address}", "--insecure-network")
        self.assertEqual(asked.returncode, 0, asked.stderr)

    def test_a_key_that_others_may_read(self):
        key = self.path / "farm/user.key"
        os.chmod(key, 0o644)
        self.addCleanup(os.chmod, key, 0o600)
        refused = self.run_program(IRSIG, "status", "--coordinator=127.0.0.1:1", *self.files("user"))
        self.assertEqual(refused.returncode, 2, refused.stderr)
        self.assertIn("user.key: a private key that others may use (mode 0644)", refused.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
