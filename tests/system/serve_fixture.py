"""A server of the page for tests: starts `irsig serve`, speaks HTTP to it, ends it."""
import http.client
import json
import os
import pathlib
import re
import signal
import subprocess
import urllib.parse


def irsig(program, *arguments, code=0):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == code, f"{arguments}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout if code == 0 else done.stderr


class Server:
    def __init__(self, program, *arguments, cwd=None, command="serve"):
        self.process = subprocess.Popen([program, command, *map(str, arguments), "--port", "0"], cwd=cwd, text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.url = self.process.stdout.readline().strip()
        if not re.fullmatch(r"http://\S+:\d+/[0-9a-f]{32}/", self.url):
            self.process.kill()
            raise AssertionError(f"no address: {self.url!r} {self.process.communicate()}")
        where = urllib.parse.urlsplit(self.url)
        self.host, self.port, self.root = where.hostname, where.port, where.path.rstrip("/")

    def request(self, target, method="GET", headers=None, body=None):
        """(status, headers, bytes) of one request below the secret; target is sent as it is, a link of the page or a path."""
        connection = http.client.HTTPConnection(self.host, self.port, timeout=60)
        connection.putrequest(method, self.root + (target if target.startswith("/") else "/" + target), skip_host=headers is not None and "Host" in headers)
        for name, value in (headers or {}).items():
            connection.putheader(name, value)
        if body is not None:
            connection.putheader("Content-Length", str(len(body)))
        connection.endheaders(body)
        reply = connection.getresponse()
        out = reply.status, dict(reply.getheaders()), reply.read()
        connection.close()
        return out

    def json(self, path, code=200, **parameters):
        status, headers, body = self.request(path + ("?" + urllib.parse.urlencode(parameters) if parameters else ""))
        assert status == code, f"{path} {parameters}: {status} {body[:500]}"
        assert headers["Content-Type"].startswith("application/json"), headers
        return json.loads(body)

    def end(self, with_signal=signal.SIGTERM):
        """Its exit code and what it wrote to standard error."""
        if self.process.poll() is None:
            os.kill(self.process.pid, with_signal)
        if self.process.stdout.closed:  # ended before
            return self.process.returncode, ""
        _, errors = self.process.communicate(timeout=30)
        return self.process.returncode, errors


def small_sweep(program, source, sweep_file, database, changes={}):
    """The quickstart at two hours of each season, small and coarse: 24 viewpoints, 6 conditions, 2 bands. changes: of its text."""
    text = (source / "jobs/examples/quickstart.toml").read_text()
    for old, new in (("triangles = 20000", "triangles = 2000"), ('time = ["10:30+09:00"]', 'time = ["10:30+09:00", "22:30+09:00"]')):
        assert old in text, old
        text = text.replace(old, new)
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    sweep_file.write_text(text)
    irsig(program, "run", sweep_file, "--db", database)


FEW = {'kind = "fibonacci"\ncount = 24': 'kind = "grid"\nazimuth_deg = [0, 40, 80]\nelevation_deg = [10, 30]'}  # all on one side
LAYERS = ["emitted", "sun", "sky", "surface", "parts", "path", "background", "hidden", "at_sensor", "temperature", "range", "normal_x", "normal_y", "normal_z", "sunlit"]
# Six viewpoints, whose images have every layer.
LAYERED = {"count = 24": "count = 6", "[accuracy]\n": f"[image]\npixels = [96, 48]\nlayers = {json.dumps(LAYERS)}\n\n[accuracy]\n"}
POLAR = {'name = "winter"': 'name = "polar"'}


def empty_database(program, database):
    """What a coordinator leaves that nobody has asked for anything."""
    farm = subprocess.Popen([pathlib.Path(program).with_name("irsig-coordinator"), "--db", database, "--listen", f"unix:{database}-farm"],
                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert "listening" in farm.stdout.readline()
    farm.terminate()
    farm.communicate()
