"""A farm over TLS that is disturbed at random for as long as its sweep lasts: processes killed and stopped, disks full and read-only, torn records.
What is stored in the end is what an undisturbed run stores; nothing is lost, nothing doubled, nobody is to blame.

usage: soak_test.py <bin folder> <repository> [faults [seed]]      12 and 1

The sweep grows before each fault, as its author adds viewpoints, so that there is work to disturb on any machine; nothing waits for seconds.
Faults that this machine does not allow are named and left out.
"""
import collections, contextlib, csv, io, os, pathlib, random, re, signal, socket, sqlite3, subprocess, sys, tempfile, time, unittest

import small_disk

BIN, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
FAULTS = int(sys.argv[3]) if len(sys.argv) > 3 else 12
SEED = int(sys.argv[4]) if len(sys.argv) > 4 else 1
PATIENCE_S = 300
WORKERS = ("a", "b", "c")
FIRST, MORE = 8, 8  # viewpoints at the beginning, and before each fault
TOTAL = FIRST + MORE * FAULTS
ONE_VIEW = "aspect = [ { azimuth_deg = 0, elevation_deg = 0 } ]"
SWEEP = (ROOT / "jobs/examples/disk.toml").read_text() \
    .replace("triangles = 100000", "triangles = 1000") \
    .replace("relative_error = 1e-4", "samples_per_replicate = 32768")
for made in ("triangles = 1000\n", "samples_per_replicate = 32768", ONE_VIEW):
    assert made in SWEEP, made


def sweep_of(viewpoints):
    return SWEEP.replace(ONE_VIEW, "aspect = [" + ", ".join(
        f"{{ azimuth_deg = {a * 80 / TOTAL}, elevation_deg = 0 }}" for a in range(viewpoints)) + "]")


def free_port():
    """Below those that the kernel gives to connections: it stays free while its coordinator is away."""
    for port in range(20000 + os.getpid() % 10000, 32768):
        with socket.socket() as tried:
            try:
                tried.bind(("127.0.0.1", port))
                return port
            except OSError:
                continue
    raise OSError("no free port")


class Soak(unittest.TestCase):
    # --- programs ---

    def run_program(self, *command, code=0):
        done = subprocess.run([str(c) for c in command], cwd=self.path, capture_output=True, text=True, timeout=PATIENCE_S)
        if code is not None:
            self.assertEqual(done.returncode, code, f"{command}: {done.stderr}\n{self.last_words()}")
        return done

    def started(self, name, *command):
        log = open(self.path / f"{name}.log", "a")
        process = subprocess.Popen([str(c) for c in command], cwd=self.path, text=True, stdout=subprocess.PIPE if name == "coordinator" else log,
                                   stderr=log, env={**os.environ, "TMPDIR": str(self.path)})
        log.close()
        self.processes.append(process)
        return process

    def last_words(self):
        return "\n".join(f"{log.name}: {line}" for log in sorted(self.path.glob("*.log")) for line in log.read_text().splitlines()[-12:])

    def until(self, what, seen, pause_s=0.1):
        """Whatever `seen` returns when it is true."""
        end = time.monotonic() + PATIENCE_S
        while not (value := seen()):
            self.assertLess(time.monotonic(), end, f"{what}\n{self.last_words()}")
            time.sleep(pause_s)
        return value

    def files(self, who):
        return [f"--tls-cert={self.path}/ca/{who}.pem", f"--tls-key={self.path}/ca/{who}.key", f"--tls-ca={self.path}/ca/ca.pem"]

    def start_coordinator(self):
        """One that is killed may hold the database for a moment yet."""
        def listens():
            self.coordinator = self.started("coordinator", BIN / "irsig-coordinator", "--db", self.db, "--listen", self.address, "--heartbeat-s=0.2",
                                            "--lost-after-s=1.5", "--audit-share=0", *self.files("coordinator"))
            return "listening on" in self.coordinator.stdout.readline()

        self.until("a coordinator listens", listens)
        self.hit.clear()  # losses are forgotten with their coordinator

    def kill(self, process):
        process.kill()
        process.communicate()

    def start_worker(self, name):
        self.workers[name] = self.started(name, BIN / "irsig-worker", f"--coordinator={self.address}", f"--name={name}", f"--spool={self.spool}",
                                          *self.files("worker"))

    def told(self, *more):
        done = self.run_program(BIN / "irsig", "status", "--csv", *more, f"--coordinator={self.address}", *self.files("user"), code=None)
        return list(csv.DictReader(io.StringIO(done.stdout))) if done.returncode == 0 else []

    def sweep_is(self):
        """Its jobs by what has become of them; nothing while the coordinator does not answer."""
        return {name: int(value) for name, value in rows[0].items() if name in ("jobs", "done", "failed", "workers")} if (rows := self.told()) else {}

    def crew(self):
        return {row["worker"]: row for row in self.told("--by-worker")}

    def all_are_there(self):
        return self.until("all workers are there", lambda: len(crew := self.crew()) == len(WORKERS) and crew)

    def computing(self):
        """A worker with a job that no worker was lost with: the third loss would give it up, as it should."""
        able = [name for name, row in self.crew().items() if row["job_key"] and row["job_key"] not in self.hit]
        if not able:
            return None
        name = self.draw.choice(sorted(able))
        return name, self.crew().get(name, {}).get("job_key")

    # --- the sweep ---

    def submit(self, code=0):
        return self.run_program(BIN / "irsig", "submit", "sweep.toml", f"--coordinator={self.address}", *self.files("user"), code=code)

    def grow(self):
        self.viewpoints += MORE
        self.assertLessEqual(self.viewpoints, TOTAL)
        (self.path / "sweep.toml").write_text(sweep_of(self.viewpoints))

    def nothing_to_do(self):
        now = self.sweep_is()
        return bool(now) and now["done"] == now["jobs"]

    def ends_of_itself(self):
        """A coordinator whose disk fails it; or it is killed, since it has nothing to write."""
        self.until("the coordinator ends, or has nothing to write", lambda: self.coordinator.poll() is not None or self.nothing_to_do())
        met = self.coordinator.poll() is not None
        self.kill(self.coordinator)
        self.assertEqual(self.coordinator.returncode, 1 if met else -signal.SIGKILL, self.last_words())
        return met

    # --- faults: each brings one about, sees that it is met, and ends it. False: there was nothing left to disturb ---

    def a_worker_is_killed(self):
        self.submit()
        victim = self.until("a worker computes", lambda: self.computing() or self.nothing_to_do() and ("", ""))
        if not victim[0]:
            return False
        self.hit.add(victim[1])
        self.kill(self.workers[victim[0]])
        self.start_worker(victim[0])
        return True

    def a_worker_is_stopped_beyond_its_lease(self):
        self.submit()
        self.all_are_there()
        name = self.draw.choice(WORKERS)
        self.workers[name].send_signal(signal.SIGSTOP)
        self.until(f"{name} is lost", lambda: (crew := self.crew()) and name not in crew)
        self.workers[name].send_signal(signal.SIGCONT)
        self.until(f"{name} is back", lambda: name in self.crew())
        return True

    def the_coordinator_is_killed(self):
        self.submit()
        met = not self.nothing_to_do()
        self.kill(self.coordinator)
        self.start_coordinator()
        return met

    def irsig_run_is_killed(self):
        """It takes the database over from the coordinator, and is killed in its work."""
        self.coordinator.terminate()
        self.assertEqual((self.coordinator.communicate(), self.coordinator.returncode)[1], 0, self.last_words())
        before = self.done_in_file()
        run = self.started("run", BIN / "irsig", "run", "sweep.toml", "--db", self.db, "--resume", "--workers", "2")
        self.until("irsig run computes", lambda: run.poll() is not None or self.done_in_file() > before, pause_s=0.02)
        met = run.poll() is None
        self.kill(run)
        self.start_coordinator()
        return met

    def done_in_file(self):
        try:
            with contextlib.closing(sqlite3.connect(f"file:{self.db}?mode=ro", uri=True, timeout=5)) as database:
                return database.execute("SELECT count(*) FROM job WHERE state = 2").fetchone()[0]
        except sqlite3.OperationalError:  # it is being opened
            return -1

    def irsig_submit_is_killed(self):
        client = self.started("submit", BIN / "irsig", "submit", "sweep.toml", f"--coordinator={self.address}", *self.files("user"))
        time.sleep(self.draw.random() * 0.1)  # somewhere in its life
        met = client.poll() is None
        self.kill(client)
        self.submit()
        return met

    def the_disk_is_full(self):
        self.disk.fill()
        # It waits for a coordinator, which may be gone before it is asked.
        client = self.started("submit", BIN / "irsig", "submit", "sweep.toml", f"--coordinator={self.address}", *self.files("user"))
        met = self.ends_of_itself()
        self.kill(client)
        self.disk.empty()
        self.start_coordinator()
        return met

    def the_disk_is_read_only(self):
        self.submit()
        self.assertEqual(self.disk.becomes_read_only(), "")
        met = self.ends_of_itself()
        self.until("the disk is writable", lambda: self.disk.becomes_writable() == "")
        self.start_coordinator()
        return met

    def waiting(self):
        return sorted(self.spool.glob("*.result"))

    def a_spooled_record_is_torn(self):
        self.submit()
        self.until("a worker computes", lambda: self.computing() or self.nothing_to_do())
        before = set(self.waiting())
        self.kill(self.coordinator)
        self.until("a result waits", lambda: set(self.waiting()) - before or self.all_miss_the_coordinator())
        for name in WORKERS:
            self.kill(self.workers[name])
        found = sorted(set(self.waiting()) - before)
        if found:
            torn = self.draw.choice(found)
            whole = torn.read_bytes()
            at = self.draw.randrange(len(whole))
            torn.write_bytes(whole[:at] if self.draw.random() < 0.5 else whole[:at] + bytes([whole[at] ^ 1 << self.draw.randrange(8)]) + whole[at + 1:])
        self.start_coordinator()
        for name in WORKERS:
            self.start_worker(name)
        return bool(found)

    def all_miss_the_coordinator(self):
        return all((self.path / f"{name}.log").stat().st_size > self.logged.get(name, 0) for name in WORKERS)

    def the_spools_disk_is_full(self):
        self.submit()
        self.spool_disk.fill()
        met = self.until("a worker computes", lambda: self.computing() or self.nothing_to_do() and ("", ""))[0]
        self.kill(self.coordinator)
        self.until("workers miss it", self.all_miss_the_coordinator)
        self.spool_disk.empty()
        self.start_coordinator()
        return bool(met)

    # --- all of it ---

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        self.processes, self.workers, self.hit, self.logged = [], {}, set(), {}
        self.draw = random.Random(SEED)
        mounts = small_disk.enter_namespace()
        self.disk = small_disk.SmallDisk(self.path / "disk", 64 + TOTAL // 10, ("ext4", "tmpfs") if mounts else ())
        self.spool_disk = small_disk.SmallDisk(self.path / "spool-disk", 32, ("tmpfs",) if mounts else ())
        for disk in (self.disk, self.spool_disk):
            self.addCleanup(disk.close)
        self.addCleanup(lambda: [self.kill(process) for process in self.processes if process.poll() is None])
        self.db, self.spool = self.disk.path / "far.sigdb", self.spool_disk.path / "spool"
        self.kinds = [self.a_worker_is_killed, self.a_worker_is_stopped_beyond_its_lease, self.the_coordinator_is_killed, self.irsig_run_is_killed,
                      self.irsig_submit_is_killed, self.a_spooled_record_is_torn]
        for disk, needed, fault in ((self.disk, ("ext4", "tmpfs"), self.the_disk_is_full), (self.disk, ("ext4",), self.the_disk_is_read_only),
                                    (self.spool_disk, ("tmpfs",), self.the_spools_disk_is_full)):
            if disk.kind in needed:
                self.kinds.append(fault)
            else:
                print(f"left out: {fault.__name__}: what it needs cannot be mounted here ({disk.why or 'no mount namespace'})", file=sys.stderr)
        print(f"the database is on {self.disk.kind}, the spool on {self.spool_disk.kind}; seed {SEED}", file=sys.stderr)

    def test_what_is_stored_is_what_an_undisturbed_run_stores(self):
        begun = time.monotonic()
        (self.path / "whole.toml").write_text(sweep_of(TOTAL))
        self.run_program(BIN / "irsig", "run", "whole.toml", "--db", "calm.sigdb", "--workers", "2")
        self.run_program(BIN / "irsig", "ca", "init", self.path / "ca")
        for who, *what in (("coordinator", "--host=127.0.0.1"), ("user", "--role=submit"), ("worker", "--role=work")):
            self.run_program(BIN / "irsig", "ca", "issue", self.path / "ca", who, "--out", self.path / "ca", *what)
        self.address = f"127.0.0.1:{free_port()}"
        self.viewpoints = FIRST
        (self.path / "sweep.toml").write_text(sweep_of(FIRST))
        self.start_coordinator()
        self.submit()
        for name in WORKERS:
            self.start_worker(name)

        done = collections.Counter()
        due = []
        for number in range(FAULTS):
            if not due:  # all kinds equally often, in an order that is drawn
                due = self.draw.sample(self.kinds, len(self.kinds))
            fault = due.pop()
            self.all_are_there()
            self.grow()
            self.logged = {name: (self.path / f"{name}.log").stat().st_size for name in WORKERS}
            met = fault()
            done[fault.__name__ if met else f"{fault.__name__}, when all was done"] += 1
            self.submit()
            print(f"{number + 1:4} of {FAULTS}  {time.monotonic() - begun:6.0f} s  {fault.__name__}{'' if met else ' (all was done)'}", file=sys.stderr, flush=True)

        ended = self.until("all is done", lambda: self.nothing_to_do() and self.sweep_is())
        self.all_are_there()
        self.assertEqual((ended["jobs"], ended["done"], ended["failed"]), (TOTAL, TOTAL, 0))
        # A result of the sweep as it was before it grew waits for a coordinator that has that; what is of this one is acknowledged.
        sweep = self.told()[0]["sweep_sha256"]
        self.until("nothing of this sweep waits", lambda: subprocess.run(["grep", "-rqs", sweep, self.spool]).returncode == 1)
        for name in WORKERS:
            self.workers[name].terminate()
            self.assertEqual(self.workers[name].wait(PATIENCE_S), 0, self.last_words())
        self.coordinator.terminate()
        self.assertEqual((self.coordinator.communicate(), self.coordinator.returncode)[1], 0, self.last_words())

        digests = [self.run_program(BIN / "irsig", "digest", db).stdout.split()[0] for db in (self.db, self.path / "calm.sigdb")]
        self.assertEqual(*digests)
        with contextlib.closing(sqlite3.connect(f"file:{self.db}?mode=ro", uri=True)) as database:
            rows, keys, jobs, aside = (database.execute(f"SELECT {what}").fetchone()[0] for what in (
                "count(*) FROM signature", "count(*) FROM (SELECT DISTINCT viewpoint_id, condition_id, band_id FROM signature)",
                "count(DISTINCT job_id) FROM signature", "count(*) FROM result_aside"))
        self.assertEqual((rows, keys, jobs, aside), (TOTAL, TOTAL, TOTAL, 0))
        self.assertIn("nothing is damaged, missing or old", self.run_program(BIN / "irsig", "doctor", self.db).stdout)
        self.assertGreaterEqual(sum(done[fault.__name__] for fault in self.kinds), FAULTS / 2, done)
        print(f"{FAULTS} faults, {TOTAL} jobs, {time.monotonic() - begun:.0f} s, digest {digests[0][:16]} equal; 0 lost, 0 doubled, 0 given up", file=sys.stderr)
        for what, count in sorted(done.items()):
            print(f"{count:6}  {what.replace('_', ' ')}", file=sys.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
