"""Strangers who connect to a coordinator's port and do not go on: its memory is bounded, honest workers compute, the strangers are put out,
and those who come later are answered.

usage: half_open_test.py <bin folder> <repository> [strangers]      500
"""
import collections, os, pathlib, re, resource, select, socket, ssl, subprocess, sys, tempfile, time, unittest

BIN, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
STRANGERS = int(sys.argv[3]) if len(sys.argv) > 3 else 500
PATIENCE_S = 240
MOST_BYTES_EACH = 200_000  # of the coordinator's memory; 40 kB of those who say nothing, 80 kB of all three kinds on average
ONE_VIEW = "aspect = [ { azimuth_deg = 0, elevation_deg = 0 } ]"
SWEEP = (ROOT / "jobs/examples/disk.toml").read_text() \
    .replace("triangles = 100000", "triangles = 1000") \
    .replace("relative_error = 1e-4", "samples_per_replicate = 64") \
    .replace(ONE_VIEW, "aspect = [" + ", ".join(f"{{ azimuth_deg = {a}, elevation_deg = 0 }}" for a in range(30)) + "]")
for made in ("triangles = 1000\n", "samples_per_replicate = 64", "azimuth_deg = 29"):
    assert made in SWEEP, made


class HalfOpen(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        (cls.path / "sweep.toml").write_text(SWEEP)
        subprocess.run([BIN / "irsig", "ca", "init", cls.path / "ca"], check=True, stdout=subprocess.DEVNULL)
        for who, *what in (("coordinator", "--host=127.0.0.1"), ("user", "--role=submit"), ("worker", "--role=work")):
            subprocess.run([BIN / "irsig", "ca", "issue", cls.path / "ca", who, "--out", cls.path / "ca", *what], check=True,
                           stdout=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def files(self, who):
        return [f"--tls-cert={self.path}/ca/{who}.pem", f"--tls-key={self.path}/ca/{who}.key", f"--tls-ca={self.path}/ca/ca.pem"]

    def started(self, log, *command, **more):
        with open(self.path / log, "w") as errors:
            process = subprocess.Popen([str(c) for c in command], cwd=self.path, text=True, stderr=errors, **more)
        self.addCleanup(lambda: (process.kill(), process.communicate()))
        return process

    def listen(self, open_files):
        self.log = f"{self._testMethodName}.log"
        self.coordinator = self.started(
            self.log, BIN / "irsig-coordinator", "--db", f"{self._testMethodName}.sigdb", "--listen", "127.0.0.1:0", *self.files("coordinator"),
            stdout=subprocess.PIPE, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, open_files))
        self.address = re.search(r"listening on (\S+)", self.coordinator.stdout.readline())[1]
        host, port = self.address.rsplit(":", 1)
        self.place = host, int(port)

    def tell(self, *arguments):
        return subprocess.run([str(a) for a in (BIN / "irsig", *arguments, f"--coordinator={self.address}", *self.files("user"))], cwd=self.path,
                              capture_output=True, text=True, timeout=PATIENCE_S)

    def told(self, *arguments):
        done = self.tell(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def memory_bytes(self):
        return int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path(f"/proc/{self.coordinator.pid}/status").read_text())[1]) * 1024

    def until(self, what, seen):
        end = time.monotonic() + PATIENCE_S
        while not (value := seen()):
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.1)
        return value

    def silent(self):
        return socket.create_connection(self.place)

    def hello(self):
        """A client's first words, which take for ever: (socket, what is still to be said)."""
        incoming, outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
        words = ssl.create_default_context().wrap_bio(incoming, outgoing, server_hostname="127.0.0.1")
        with self.assertRaises(ssl.SSLWantReadError):
            words.do_handshake()
        return self.silent(), outgoing.read()

    def holder(self):
        """With a certificate, and nothing to say."""
        context = ssl.create_default_context(cafile=self.path / "ca/ca.pem")
        context.load_cert_chain(self.path / "ca/worker.pem", self.path / "ca/worker.key")
        context.set_alpn_protocols(["h2"])
        return context.wrap_socket(self.silent(), server_hostname="127.0.0.1")

    def are_put_out(self, strangers, slow=()):
        """All of them, while the slow ones go on, a byte at a time."""
        left, said = set(strangers), 1

        def out():
            nonlocal said
            said += 1
            for stranger, words in slow:
                if stranger in left:
                    try:
                        stranger.send(words[said:said + 1])
                    except OSError:
                        pass
            for stranger in select.select(list(left), [], [], 0)[0]:
                try:
                    gone = stranger.recv(10000) == b""
                except ssl.SSLWantReadError:
                    gone = False
                except OSError:
                    gone = True
                if gone:
                    left.discard(stranger)
                    stranger.close()
            return not left

        self.until("strangers are put out", out)

    def test_strangers_who_do_not_go_on(self):
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        self.assertGreater(hard, STRANGERS + 200)
        resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, STRANGERS + 200), hard))
        self.listen((256, hard))  # it raises its own limit
        worker = self.started("worker.log", BIN / "irsig-worker", f"--coordinator={self.address}", "--name=honest", *self.files("worker"))
        self.until("the worker is there", lambda: "honest" in self.told("status", "--by-worker", "--csv"))
        before = self.memory_bytes()
        silent = [self.silent() for _ in range(STRANGERS // 3)]
        slow = [self.hello() for _ in range(STRANGERS // 3)]
        for stranger, words in slow:
            stranger.send(words[:1])
        holders = [self.holder() for _ in range(STRANGERS - len(silent) - len(slow))]
        for stranger in holders:
            stranger.setblocking(False)
        # Honest ones meanwhile.
        self.told("submit", "sweep.toml")
        self.until("all is done", lambda: "\ndisk,30,30," in self.told("status", "--csv"))
        most = self.memory_bytes() - before
        self.are_put_out([*silent, *(stranger for stranger, _ in slow), *holders], slow)
        most = max(most, self.memory_bytes() - before)
        print(f"{STRANGERS} strangers: {most / 1e6:.1f} MB", file=sys.stderr)
        self.assertLess(most, MOST_BYTES_EACH * STRANGERS)
        self.until("their files are closed", lambda: len(os.listdir(f"/proc/{self.coordinator.pid}/fd")) < 60)
        # Who has said nothing for the time of a handshake is told in the log, in a few lines.
        lines = (self.path / self.log).read_text().splitlines()
        self.assertTrue(any("handshake" in line for line in lines), lines)
        # One of a kind a second, however long it takes here: "[2026-11-26 16:15:45.809] [coordinator] [warning] closed: ...".
        for (second, kind), count in collections.Counter((line[:20], line.split("] ")[3].split(":")[0]) for line in lines).items():
            self.assertLessEqual(count, 3, (second, kind))
        self.assertIn("honest", self.told("status", "--by-worker", "--csv"))
        worker.terminate()
        self.assertEqual(worker.wait(PATIENCE_S), 0)

    def test_more_strangers_than_files(self):
        self.listen((128, 128))
        worker = self.started("worker-2.log", BIN / "irsig-worker", f"--coordinator={self.address}", "--name=honest", *self.files("worker"))
        self.until("the worker is there", lambda: "honest" in self.told("status", "--by-worker", "--csv"))
        self.told("submit", "sweep.toml")
        strangers = [self.silent() for _ in range(200)]
        self.are_put_out(strangers)
        # The listener of gRPC itself never took a connection again after this.
        self.until("newcomers are answered", lambda: self.tell("status", "--csv").returncode == 0)
        self.until("the worker went on", lambda: "\ndisk,30,30," in self.told("status", "--csv"))
        worker.terminate()
        self.assertEqual(worker.wait(PATIENCE_S), 0)
        self.coordinator.terminate()
        self.assertEqual(self.coordinator.wait(PATIENCE_S), 0)
        self.assertLess(len((self.path / self.log).read_text().splitlines()), 60)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
