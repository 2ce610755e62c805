"""What irsig serve endures: hostile, slow and long requests, databases that vanish, its own start and end.

usage: serve_limits_test.py <irsig executable> <source folder>
"""
import http.client
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import sqlite3
import subprocess
import sys
import time
import unittest
import urllib.parse

from serve_case import IRSIG, SOURCE, ServeCase
from serve_fixture import Server, irsig


class ServeLimits(ServeCase):
    def test_hostile_requests(self):
        for target, code, words in [(t, 404, "no such") for t in (
                "/../../etc/passwd", "/www/../serve.cpp", "/www/%2e%2e/serve.cpp", "/www/..%2fserve.cpp", "/www/", "/file/",
                "/file/../answers.cpp", "//etc/passwd", "/api", "/api/map/", "/%00", "/www/main.js%00.html", "/favicon.ico",
                "/+www/main.js")] + [("/%", 400, "hexadecimal"), ("/api/map?a=%zz", 400, "hexadecimal")]:
            status, headers, body = self.server.request(target)
            self.assertEqual(status, code, target)
            self.assertIn(words, json.loads(body)["error"])
            self.assertNotIn(b"root:", body)
        for method in ("POST", "PUT", "DELETE", "PATCH", "OPTIONS"):
            status, headers, body = self.server.request("/api/contents", method=method, body=b"x" * 100)
            self.assertEqual(status, 405, method)
            self.assertEqual(headers["Allow"], "GET, HEAD")
        for host in ("example.org", f"example.org:{self.server.port}", "localhost.example.org", "127.0.0.1.example.org", "", "10.0.0.1",
                     "localhost:x", "[::1", "[localhost]", "::1"):
            status, _, body = self.server.request("/api/contents", headers={"Host": host})
            self.assertIn(status, (400, 403), host)
            self.assertNotIn(b"quickstart", body)
        for host in ("localhost", "LOCALHOST:1", f"127.0.0.1:{self.server.port}", "127.1.2.3", "[::1]:80"):
            self.assertEqual(self.server.request("/api/contents", headers={"Host": host})[0], 200, host)
        self.assertEqual(self.server.request("/api/map?season=" + "x" * 20000)[0], 414)
        self.assertEqual(self.server.request("/api/contents", headers={"X-Long": "y" * 60000})[0], 200)
        self.assertEqual(self.server.request("/api/contents", headers={"X-Long": "y" * 70000})[0], 431)
        root = self.server.root.encode()
        for raw in (b"GET " + root + b"/ HTTP/1.1\r\nHost: localhost\r\nHost: example.org\r\n\r\n", b"GET " + root + b"/api/contents HTTP/1.1\r\n\r\n",
                    b"\x00\x01\x02\r\n\r\n", b"GET\r\n\r\n", b"GET " + root + b"/ HTTP/9.9\r\n\r\n"):
            answer = self.raw(raw)
            self.assertRegex(answer, rb"^HTTP/1.1 (400|403) ", raw)
            self.assertIn(b"\r\nContent-Security-Policy: ", answer, raw)

    def raw(self, sent, server=None):
        server = server or self.server
        with socket.create_connection((server.host, server.port), timeout=60) as connection:
            connection.sendall(sent)
            return connection.makefile("rb").read()

    def test_nothing_is_told_without_the_secret(self):
        root = self.server.root
        other = Server(IRSIG, self.db)
        self.addCleanup(other.end)
        self.assertNotEqual(other.root, root)
        wrong = [root[:-1] + ("0" if root[-1] != "0" else "1"), root[:-1], root + "0", root.upper() if root != root.upper() else "/x", "",
                 other.root, "/" + root, root + "/..", "/%" + format(ord(root[1]), "x") + root[2:], "http://localhost" + root]
        for place in wrong:
            for target in ("/", "/api/contents", "/www/main.js", "/file/rows.csv", "/accuracy", ""):
                if place + target in (root + "/../", root + "/../api/contents", root + "/../www/main.js", root + "/../file/rows.csv",
                                      root + "/../accuracy", root + "/.."):
                    continue  # below the secret, where there is no such page
                for method in ("GET", "POST"):
                    connection = http.client.HTTPConnection(self.server.host, self.server.port, timeout=60)
                    connection.request(method, place + target)
                    reply = connection.getresponse()
                    body = reply.read()
                    connection.close()
                    self.assertEqual(reply.status, 403, (place, target))
                    self.assertLess(len(body), 100)
        self.assertEqual(self.server.request("/..")[0], 404)

    # Every kind of range that a server may get wrong: beyond the end, from the end, empty, many, overflowing, malformed.
    RANGES = ["bytes=0-0", "bytes=0-9", "bytes=0-99999999", "bytes=5-100000", "bytes=100000-100100", "bytes=100000000000-", "bytes=9-1", "bytes=-5",
              "bytes=-0", "bytes=-99999999999", "bytes=9223372036854775807-", "bytes=18446744073709551615-", "bytes=18446744073709551616-",
              "bytes=0-18446744073709551616", "bytes=0-0,2-4", "bytes=" + ",".join(["0-"] * 2000), "bytes=" + ",".join(["0-9999999"] * 600),
              "bytes = 0 - 5", "bytes=a-b", "bytes=", "cats=0-1", "bytes=0-1\r\nRange: bytes=0-99999"]

    def test_ranges_are_ignored(self):
        """No answer, of any route, status or method, has a byte that is not its body."""
        chosen = urllib.parse.urlencode(self.selection())
        row = "sweep=quickstart&row=3"
        root = self.server.root
        requests = [f"GET {root}{t} HTTP/1.1\r\nHost: localhost\r\n" for t in (
            "/", "/www/style.css", "/api/contents", "/api/progress", f"/api/map?{chosen}", f"/api/cut?{chosen}", f"/api/left_out?{chosen}",
            f"/api/row?{row}", f"/api/spectrum?{row}", f"/api/thumbnail.png?{row}", f"/api/image.json?{row}",
            f"/api/image.exr?{row}", f"/api/silhouette.json?{row}", f"/file/rows.csv?{chosen}", f"/file/row.csv?{row}",
            "/nothing", "/api/row", "/%", "/api/map?" + "x" * 9000)] + [
            f"GET {root}/ HTTP/1.1\r\nHost: example.org\r\n", f"GET / HTTP/1.1\r\nHost: localhost\r\n",
            f"POST {root}/ HTTP/1.1\r\nHost: localhost\r\n", f"HEAD {root}/ HTTP/1.1\r\nHost: localhost\r\n",
            f"GET {root}/ HTTP/9.9\r\n", "GET\r\n", f"GET {root}/ HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999\r\n"]
        for head in requests:
            whole = self.raw((head + "\r\n").encode())
            for kind in self.RANGES:
                self.assertEqual(self.raw(f"{head}Range: {kind}\r\n\r\n".encode()), whole, (head, kind[:60]))
            self.assertNotIn(b"Content-Range", whole)
            head_of_reply, _, body = whole.partition(b"\r\n\r\n")
            stated = int(re.search(rb"Content-Length: (\d+)", head_of_reply)[1])
            self.assertEqual(len(body), 0 if head.startswith("HEAD") else stated, head)

    def memory_bytes(self, server, which):
        return int(re.search(rf"{which}:\s+(\d+)", pathlib.Path(f"/proc/{server.process.pid}/status").read_text())[1]) * 1024

    def test_slow_and_long_requests(self):
        """More slow connections than are kept hold nobody up, cost no memory, and are put out."""
        server = Server(IRSIG, self.db)
        self.addCleanup(server.end)
        server.json("/api/contents")
        before = self.memory_bytes(server, "VmHWM")
        head = f"GET {server.root}/ HTTP/1.1\r\nHost: localhost\r\nX: ".encode()
        slow = []
        for k in range(400):
            slow.append(socket.create_connection((server.host, server.port), timeout=60))
            slow[-1].sendall(head[:k % len(head)])
        for _ in range(3):
            self.assertEqual(len(server.json("/api/contents")["database"]), 1)
        # A browser's six connections at once, and what is slow goes on being slow.
        six = [socket.create_connection((server.host, server.port), timeout=60) for _ in range(6)]
        for one in six:
            one.sendall(head + b"a\r\n\r\n")
        for one in six:
            self.assertTrue(one.makefile("rb").read().startswith(b"HTTP/1.1 200 "))
            one.close()
        self.assertLess(len(os.listdir(f"/proc/{server.process.pid}/fd")), 300)
        # The oldest were ended to let others in; the others when their time is over, however they drip.
        left = set(slow)
        while left:
            for one in list(left):
                try:
                    one.send(b"a")
                except OSError:
                    left.discard(one)
                    one.close()
            time.sleep(0.2)
        for piece, ends in ((b"a" * 65536, b" 431 "), (b"X: aaaaaaaaaaaaaaaa\r\n" * 4096, b" 431 ")):
            for start in (head, b"GET /" + b"a" * 100):
                with socket.create_connection((server.host, server.port), timeout=60) as endless:
                    answer = b""
                    try:
                        endless.sendall(start)
                        for _ in range(400):
                            endless.sendall(piece)
                    except OSError:
                        pass
                    try:
                        answer = endless.recv(1000)
                    except OSError:
                        pass
                    self.assertTrue(answer == b"" or ends in answer or b" 400 " in answer, answer[:100])
        self.assertLess(self.memory_bytes(server, "VmHWM") - before, 50e6)
        self.assertEqual(len(server.json("/api/contents")["database"]), 1)

    def test_damaged_and_vanished(self):
        victim = self.path / "victim.sigdb"
        shutil.copy(self.db, victim)
        server = Server(IRSIG, victim, self.db)
        self.addCleanup(server.end)
        png = sqlite3.connect(victim).execute("SELECT png FROM thumbnail JOIN signature_view USING (signature_id) WHERE row = 3").fetchone()[0]
        middle = len(png) // 2
        for bad, words in ((png[:middle] + bytes([png[middle] ^ 1]) + png[middle + 1:], "checksum"), (png[:-20], "longer than what is there"),
                           (b"<svg onload=alert(1)>", "does not begin as a PNG"), (png + b"x", "after its end")):
            with sqlite3.connect(victim) as db:
                db.execute("UPDATE thumbnail SET png = ? WHERE signature_id IN (SELECT signature_id FROM signature_view WHERE row = 3)", (bad,))
            db.close()
            said = server.json("/api/thumbnail.png", 409, sweep="quickstart", row=3)["error"]
            self.assertIn("the stored image of row 3 is damaged", said)
            self.assertIn(words, said)
        with sqlite3.connect(victim) as db:
            db.execute("DELETE FROM thumbnail")
        db.close()
        self.assertIn("without image", server.json("/api/thumbnail.png", 404, sweep="quickstart", row=3)["error"])
        with sqlite3.connect(victim) as db:
            db.execute("PRAGMA user_version = 9999")
        db.close()
        self.assertIn("9999", server.json("/api/row", 503, sweep="quickstart", row=3)["error"])
        self.assertIn("9999", server.json("/api/contents")["database"][0]["error"])
        victim.write_bytes(b"SQLite format 3\x00" + b"\xff" * 5000)
        self.assertIn("error", server.json("/api/map", 503, **self.selection()))
        victim.unlink()
        self.assertIn("no such file", server.json("/api/map", 503, **self.selection())["error"])
        first, second = server.json("/api/contents")["database"]
        self.assertIn("no such file", first["error"])
        self.assertEqual(len(second["sweep"]), 1)  # the other one is still shown

    def test_starting_and_ending(self):
        for arguments, words in (([self.path / "none.sigdb"], "none.sigdb"), ([SOURCE / "README.md"], "README.md"),
                                 ([self.db, "--address", "example.org"], "expected an IP address"),
                                 ([self.db, "--port", "70000"], "65535"), ([self.db, "--port", "-1"], "65535"), ([], "required")):
            self.assertIn(words, irsig(IRSIG, "serve", *arguments, code=2), arguments)
        taken = irsig(IRSIG, "serve", self.db, "--port", self.server.port, code=1)
        self.assertIn("already in use", taken)
        for how in (signal.SIGINT, signal.SIGTERM):
            server = Server(IRSIG, self.db)
            self.assertEqual(server.host, "127.0.0.1")
            idle = socket.create_connection((server.host, server.port))
            code, errors = server.end(how)
            idle.close()
            self.assertEqual(code, 0, errors)
            self.assertNotIn("warning", errors)
            with self.assertRaises(OSError):
                server.json("/api/contents")
        server = Server(IRSIG, self.db, "--address", "0.0.0.0")
        self.assertEqual(server.request("/api/contents", headers={"Host": "10.1.2.3:80"})[0], 200)
        self.assertEqual(server.request("/api/contents", headers={"Host": "example.org"})[0], 403)
        self.assertIn("nothing is encrypted", server.end()[1])

    def test_while_a_sweep_runs(self):
        """Rows appear while a coordinator writes; reading never fails, and the writer ends well."""
        running = self.path / "running.sigdb"
        text = (self.path / "small.toml").read_text().replace("count = 24", "count = 60").replace("triangles = 2000", "triangles = 20000")
        (self.path / "running.toml").write_text(text)
        run = subprocess.Popen([IRSIG, "run", "running.toml", "--db", str(running)], cwd=self.path, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True)
        self.addCleanup(run.wait)
        self.addCleanup(run.kill)
        while not running.exists() or not running.with_name("running.sigdb-wal").exists():
            self.assertIsNone(run.poll(), "the run ended before it began")
            time.sleep(0.02)
        seen, server = set(), None
        while run.poll() is None:
            try:
                server = server or Server(IRSIG, running)
            except AssertionError:  # it has no tables yet
                continue
            database = server.json("/api/progress")["database"][0]
            for sweep in database.get("sweep", []):
                seen.add(sweep["done"])
                self.assertLessEqual(sweep["done"] + sweep["leased"], 60)
            server.request("/api/contents")
            time.sleep(0.02)
        self.assertEqual(run.wait(), 0, run.stderr.read())
        run.stderr.close()
        database = server.json("/api/progress")["database"][0]
        self.assertEqual((database["sweep"][0]["done"], database["writing"]), (60, False))
        self.assertGreaterEqual(len(seen), 3, seen)
        self.assertEqual(server.json("/api/contents")["database"][0]["sweep"][0]["rows"], 60 * 12)
        server.end()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
