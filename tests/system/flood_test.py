"""Clients that ask for far more than they take (CVE-2023-44487, CVE-2023-33953, CVE-2024-27316 and their kin), on the Unix socket, on a port
and over TLS: each is put out at once, the coordinator's memory stays, and an honest worker computes meanwhile.

usage: flood_test.py <bin folder> <repository> [streams]      20000
"""
import pathlib, re, socket, ssl, struct, subprocess, sys, tempfile, threading, time, unittest

BIN, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
STREAMS = int(sys.argv[3]) if len(sys.argv) > 3 else 20_000
PATIENCE_S = 240
MOST_BYTES = 60_000_000  # more than before, worker and all; gRPC 1.51 alone takes 18 kB for each of the streams
ONE_VIEW = "aspect = [ { azimuth_deg = 0, elevation_deg = 0 } ]"
SWEEP = (ROOT / "jobs/examples/disk.toml").read_text() \
    .replace("triangles = 100000", "triangles = 1000") \
    .replace("relative_error = 1e-4", "samples_per_replicate = 64") \
    .replace(ONE_VIEW, "aspect = [" + ", ".join(f"{{ azimuth_deg = {a}, elevation_deg = 0 }}" for a in range(30)) + "]")
for made in ("triangles = 1000\n", "samples_per_replicate = 64", "azimuth_deg = 29"):
    assert made in SWEEP, made

# HTTP/2 as a client speaks it, no more of it than a flood needs (RFC 9113 and 7541).
DATA, HEADERS, RST_STREAM, SETTINGS, CONTINUATION = 0, 1, 3, 4, 9
END_STREAM, END_HEADERS = 1, 4
PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"


def frame(kind, flags, stream, payload=b""):
    return struct.pack(">I", len(payload))[1:] + bytes([kind, flags]) + struct.pack(">I", stream) + payload


def field(name, value, first=b"\x40"):
    return first + b"".join(bytes([len(text)]) + text for text in (name, value))


# Status, in full and from the table that it has filled.
ASK = b"\x83\x86" + field(b":path", b"/irsig.schema.Farm/Status") + field(b":authority", b"x") + field(b"content-type", b"application/grpc") \
    + field(b"te", b"trailers")
ASK_AGAIN = b"\x83\x86" + bytes([0x80 | n for n in (65, 64, 63, 62)])


def calls(and_then):
    for number in range(STREAMS):
        stream = 2 * number + 1
        yield frame(HEADERS, END_HEADERS, stream, ASK_AGAIN if number else ASK) + and_then(stream)


def rapid_reset():
    return calls(lambda stream: frame(DATA, END_STREAM, stream, bytes(5)) + frame(RST_STREAM, 0, stream, b"\0\0\0\x08"))


def streams_left_open():
    return calls(lambda stream: b"")


def a_string_in_pieces():
    """A header of 16 MB, a byte at a time: each piece is copied with all that came before."""
    yield frame(HEADERS, 0, 1, b"\x83\x86\x00\x01x\x7f\x81\xa4\xe8\x07")
    for _ in range(STREAMS):
        yield frame(CONTINUATION, 0, 1, b"a")


def headers_without_end():
    yield frame(HEADERS, 0, 1, ASK)
    for number in range(STREAMS // 10):
        yield frame(CONTINUATION, 0, 1, b"".join(field(b"x%d" % (10 * number + i), b"a" * 100, b"\x00") for i in range(10)))


FLOODS = {rapid_reset: "streams", streams_left_open: "streams at once", a_string_in_pieces: "header block", headers_without_end: "header block"}


class Flood(unittest.TestCase):
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

    def told(self, *arguments):
        done = subprocess.run([str(a) for a in (BIN / "irsig", *arguments, f"--coordinator={self.address}", *self.network("user"))], cwd=self.path,
                              capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def until(self, what, seen):
        end = time.monotonic() + PATIENCE_S
        while not seen():
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.1)

    def most_bytes(self):
        return int(re.search(r"VmHWM:\s+(\d+)", pathlib.Path(f"/proc/{self.coordinator.pid}/status").read_text())[1]) * 1024

    def connection(self):
        if self.address.startswith("unix:"):
            client = socket.socket(socket.AF_UNIX)
            client.connect(str(self.path / self.address.removeprefix("unix:")))
        else:
            host, port = self.address.rsplit(":", 1)
            client = socket.create_connection((host, int(port)))
        if self.network == self.files:
            context = ssl.create_default_context(cafile=self.path / "ca/ca.pem")
            context.load_cert_chain(self.path / "ca/user.pem", self.path / "ca/user.key")
            context.set_alpn_protocols(["h2"])
            client = context.wrap_socket(client, server_hostname="127.0.0.1")
        client.settimeout(PATIENCE_S)
        return client

    def is_put_out(self, flood):
        client = self.connection()
        self.addCleanup(client.close)
        if not isinstance(client, ssl.SSLSocket):  # or the server's answers would stop it first
            def listen():
                try:
                    while client.recv(1 << 16):
                        pass
                except OSError:
                    pass
            threading.Thread(target=listen, daemon=True).start()
        pieces = flood()
        try:
            client.sendall(PREFACE + frame(SETTINGS, 0, 0))  # whose limits it does not acknowledge
            while batch := b"".join(piece for _, piece in zip(range(500), pieces)):
                client.sendall(batch)
            while client.recv(1 << 16):
                pass
        except OSError:
            return True
        return False

    def flooded(self, listen, network):
        self.network = network
        self.coordinator = self.started(f"{self._testMethodName}.log", BIN / "irsig-coordinator", "--db", f"{self._testMethodName}.sigdb", "--listen",
                                        listen, *network("coordinator"), stdout=subprocess.PIPE)
        self.address = re.search(r"listening on (\S+)", self.coordinator.stdout.readline())[1]
        worker = self.started("worker.log", BIN / "irsig-worker", f"--coordinator={self.address}", "--name=honest", *network("worker"))
        self.until("the worker is there", lambda: "honest" in self.told("status", "--by-worker", "--csv"))
        before = self.most_bytes()
        self.told("submit", "sweep.toml")
        for flood in FLOODS:
            self.is_put_out(flood)
            self.assertLess(self.most_bytes() - before, MOST_BYTES, flood.__name__)
            time.sleep(1)  # one such line a second is logged
        self.until("all is done", lambda: "\ndisk,30,30," in self.told("status", "--csv"))
        print(f"{listen}: {(self.most_bytes() - before) / 1e6:.1f} MB", file=sys.stderr)
        self.assertIn("honest", self.told("status", "--by-worker", "--csv"))
        worker.terminate()
        self.assertEqual(worker.wait(PATIENCE_S), 0)
        self.coordinator.terminate()
        self.assertEqual(self.coordinator.wait(PATIENCE_S), 0)
        log = (self.path / f"{self._testMethodName}.log").read_text()
        lines = [line for line in log.splitlines() if "closed: a connection from " in line]
        self.assertEqual(len(lines), len(FLOODS), log)
        for line, why in zip(lines, FLOODS.values()):
            self.assertIn(why, line)
        return lines

    def test_on_the_unix_socket(self):
        self.flooded("unix:socket", lambda who: [])

    def test_on_a_port(self):
        self.flooded("127.0.0.1:0", lambda who: ["--insecure-loopback"])

    def test_over_tls(self):
        for line in self.flooded("127.0.0.1:0", self.files):
            self.assertRegex(line, r'from 127\.0\.0\.1:\d+, "user" \(certificate [0-9a-f]+\): ')


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
