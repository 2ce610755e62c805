"""Nothing is lost at the door: runs that start at once, readers that stay, files that cannot be opened.

usage: door_test.py <irsig> <irsig-coordinator> <repository> [rounds]
"""
import os, pathlib, resource, signal, socket, sqlite3, subprocess, sys, tempfile, threading, time, unittest

IRSIG, COORDINATOR, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:4])
ROUNDS = int(sys.argv[4]) if len(sys.argv) > 4 else 40
PATIENCE_S = 240  # for what ends by itself, on however busy a machine

# Eight viewpoints of a disk, a few milliseconds each.
SWEEP = (ROOT / "jobs/examples/disk.toml").read_text() \
    .replace("triangles = 100000", "triangles = 1000") \
    .replace("aspect = [ { azimuth_deg = 0, elevation_deg = 0 } ]",
             "aspect = [" + ", ".join(f"{{ azimuth_deg = {a}, elevation_deg = 0 }}" for a in range(8)) + "]") \
    .replace("relative_error = 1e-4", "samples_per_replicate = 64")
for made in ("triangles = 1000\n", "azimuth_deg = 7", "samples_per_replicate = 64"):
    assert made in SWEEP, made


class Door(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        (self.path / "sweep.toml").write_text(SWEEP)
        self.scratch = self.path / "scratch"
        self.scratch.mkdir()
        self.db = self.path / "out.sigdb"
        self.environment = {**os.environ, "TMPDIR": str(self.scratch)}

    def tearDown(self):
        self.folder.cleanup()

    def start(self, *arguments, program=IRSIG, **more):
        process = subprocess.Popen([program, *map(str, arguments)], cwd=self.path, env=self.environment, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more)
        self.addCleanup(lambda: process.poll() is None and process.kill())  # of a test that failed
        return process

    def run_sweep(self, *arguments, **more):
        run = self.start("run", "sweep.toml", "--db", self.db, *arguments, **more)
        out, err = run.communicate(timeout=PATIENCE_S)
        return run.returncode, out, err

    def rows(self):
        done = subprocess.run([IRSIG, "query", self.db, "--format", "csv"], capture_output=True, text=True,
                              timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        return len(done.stdout.splitlines()) - 1

    def beside(self):
        return sorted(p.name for p in self.path.iterdir() if p.name.startswith("out.sigdb"))

    # --- several runs at once ---

    def round(self, starts, plan, kill):
        runs = [self.start("run", "sweep.toml", "--db", self.db, *(["--plan"] if plan else []))
                for _ in range(starts)]
        if kill is not None:
            time.sleep(kill)
            runs[0].kill()
        ended = [(r.communicate(timeout=PATIENCE_S), r.returncode) for r in runs]
        for number, ((_, err), code) in enumerate(ended):
            if kill is not None and number == 0:
                continue
            # The winner, one that found the winner's rows complete, or one that is told why not.
            refused = "another irsig is writing" in err or "add --resume" in err
            self.assertTrue(code == 0 or (code == 1 and refused) or (code == 2 and refused), (code, err))
        if kill is None:
            self.assertTrue(any(code == 0 for _, code in ended), ended)
        else:
            # The killed one's coordinator may still be at its end: it lets go of the database by itself.
            deadline = time.monotonic() + PATIENCE_S
            while True:
                code, _, err = self.run_sweep(*(["--resume"] if self.db.exists() else []))
                gone = "no such database to resume" in err
                if code == 0 or not ("another irsig is writing" in err or gone) or time.monotonic() > deadline:
                    break
            self.assertEqual(code, 0, err)
        self.assertEqual(self.rows(), 8)
        # Who comes last folds the journal in; a run's own lock goes with it.
        self.assertEqual(self.beside(), ["out.sigdb"])
        self.db.unlink()

    def test_runs_that_start_at_once(self):
        for number in range(ROUNDS):
            with self.subTest(round=number):
                self.round(starts=2 + number % 2, plan=number % 4 == 3,
                           kill=None if number % 5 else 0.02 * (number % 11))
        # What the killed ones left is removed by the next run, and that removes its own.
        self.assertEqual(self.run_sweep()[0], 0)
        self.assertEqual(sorted(p.name for p in self.scratch.iterdir()), [])

    def test_a_refused_sweep_leaves_nothing_and_a_used_database_stays(self):
        (self.path / "sweep.toml").write_text(SWEEP.replace('name = "disk"\nmaterial', 'name = "disc"\nmaterial'))
        self.assertEqual(self.run_sweep()[0], 2)
        self.assertEqual(self.beside(), [])
        self.assertEqual(self.run_sweep("--resume")[0], 2)
        self.assertEqual(self.beside(), [])
        coordinator = self.start("--db", self.db, "--listen", "127.0.0.1:0", "--insecure-loopback", program=COORDINATOR)
        coordinator.stdout.readline()
        coordinator.terminate()
        self.assertEqual(coordinator.communicate(timeout=PATIENCE_S) and coordinator.returncode, 0)
        self.assertEqual(self.beside(), ["out.sigdb"], "a coordinator's database is not a run's to remove")
        # Empty as it is, it is not for another process to remove: that one did not make it.
        other = self.start("--db", self.db, "--listen", "127.0.0.1:0", "--insecure-loopback", "--remove-unused", program=COORDINATOR)
        other.stdout.readline()
        other.terminate()
        self.assertEqual(other.communicate(timeout=PATIENCE_S) and other.returncode, 0)
        self.assertEqual(self.beside(), ["out.sigdb"])

    def test_a_link_to_a_database_that_is_not_there_yet(self):
        (self.path / "elsewhere").mkdir()
        real = self.path / "elsewhere" / "real.sigdb"
        self.db.symlink_to(real)
        coordinator = self.start("--db", self.db, "--listen", "127.0.0.1:0", "--insecure-loopback", "--remove-unused", program=COORDINATOR)
        coordinator.stdout.readline()
        self.assertTrue(real.exists())
        self.assertEqual(self.run_sweep()[0], 1, "one writer, whatever name it was opened by")
        coordinator.terminate()
        coordinator.communicate(timeout=PATIENCE_S)
        self.assertEqual(sorted(p.name for p in real.parent.iterdir()), [])
        self.assertTrue(self.db.is_symlink())
        self.assertEqual(self.run_sweep()[0], 0)
        self.assertEqual(sorted(p.name for p in real.parent.iterdir()), ["real.sigdb"])

    def test_a_folder_of_somebody_else_is_left_alone(self):
        for name, content in (("irsig-scratch-abcdef", "mine"), ("irsig-scratch-longername", "in-use")):
            (self.scratch / name).mkdir()
            (self.scratch / name / content).write_text("precious")
        self.assertEqual(self.run_sweep()[0], 0)
        self.assertEqual(sorted(str(p.relative_to(self.scratch)) for p in self.scratch.rglob("*") if p.is_file()),
                         ["irsig-scratch-abcdef/mine", "irsig-scratch-longername/in-use"])

    # --- what the coordinator cannot open ---

    def refused_at_once(self, *words, **more):
        """`irsig run` passes the reason on, with clients knocking at the address meanwhile."""
        code, out, err = self.run_sweep(**more)
        self.assertEqual(code, 1, err)
        for word in words:
            self.assertIn(word, err)
        self.assertNotIn("did not answer", err)
        # The same with a client that waits at the door before it could open.
        address = self.path / "knock"
        coordinator = self.start("--db", self.db, "--listen", f"unix:{address}", program=COORDINATOR, **more)
        stop = threading.Event()

        def knock():
            while not stop.is_set():
                subprocess.run([IRSIG, "status", "--coordinator", f"unix:{address}"], capture_output=True)

        client = threading.Thread(target=knock)
        client.start()
        try:
            _, err = coordinator.communicate(timeout=PATIENCE_S)
        finally:
            stop.set()
            client.join()
        self.assertEqual(coordinator.returncode, 1, err)
        for word in words:
            self.assertIn(word, err)

    def test_a_reader_in_a_query_at_the_start(self):
        self.assertEqual(self.run_sweep()[0], 0)
        (self.path / "sweep.toml").write_text(SWEEP.replace("samples_per_replicate = 64", "samples_per_replicate = 65"))
        reader = sqlite3.connect(self.db, isolation_level=None)
        reader.execute("BEGIN")
        reader.execute("SELECT count(*) FROM signature").fetchall()
        try:
            self.refused_at_once("another program is reading it")
        finally:
            reader.close()
        self.assertEqual(self.rows(), 8)

    def test_a_damaged_journal(self):
        self.assertEqual(self.run_sweep()[0], 0)
        (self.path / "sweep.toml").write_text(SWEEP.replace("samples_per_replicate = 64", "samples_per_replicate = 65"))
        (self.path / "out.sigdb-wal").mkdir()
        self.refused_at_once("out.sigdb")
        (self.path / "out.sigdb-wal").rmdir()
        self.assertEqual(self.rows(), 8)

    def test_a_full_disk_at_the_start(self):
        def full():  # writing beyond the first kilobytes of any file fails
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))

        self.refused_at_once("out.sigdb", preexec_fn=full)
        self.assertEqual(self.beside(), [])

    def test_a_file_at_its_limit_is_a_full_disk(self):
        # The kernel sends SIGXFSZ where `ulimit -f` ends: the run ends with the reason instead, and --resume computes the rest.
        calm = self.path / "calm.sigdb"
        done = self.start("run", "sweep.toml", "--db", calm)
        done.communicate(timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 0)
        whole = calm.stat().st_size
        kilobytes = -(-whole // 4096) * 4
        stopped = 0
        for fraction in (0.7, 0.8, 0.9):  # a new database takes most of it
            limit = int(kilobytes * fraction) * 1024
            code, _, err = self.run_sweep(preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY)))
            self.assertEqual(code, 1, err)
            self.assertIn("(ulimit -f)", err)
            self.assertNotIn("killed by signal", err)
            stopped += self.db.exists()
            code, _, err = self.run_sweep(*(["--resume"] if self.db.exists() else []))
            self.assertEqual(code, 0, err)
            self.assertEqual(self.rows(), 8)
            digests = [subprocess.run([IRSIG, "digest", db], capture_output=True, text=True, timeout=PATIENCE_S).stdout.split()[0]
                       for db in (calm, self.db)]
            self.assertEqual(*digests)
            self.assertEqual(self.beside(), ["out.sigdb"])
            self.db.unlink()
        self.assertGreater(stopped, 0)

    def test_a_lock_file_that_is_a_link_or_a_pipe(self):
        precious = self.path / "precious"
        lock = self.path / "out.sigdb-lock"
        for make in (lambda: lock.symlink_to(precious), lambda: os.mkfifo(lock), lambda: lock.mkdir()):
            make()
            code, _, err = self.run_sweep()
            self.assertEqual(code, 2, err)
            self.assertIn("out.sigdb-lock", err)
            self.assertFalse(precious.exists())
            lock.rmdir() if lock.is_dir() and not lock.is_symlink() else lock.unlink()

    def test_a_coordinator_ends_whatever_waits(self):
        address = self.path / "socket"
        coordinator = self.start("--db", self.db, "--listen", f"unix:{address}", program=COORDINATOR)
        coordinator.stdout.readline()
        held = [socket.socket(socket.AF_UNIX) for _ in range(8)]  # connected, silent or talking nonsense
        for number, client in enumerate(held):
            client.connect(str(address))
            client.send(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" if number % 2 else b"\0")
        before = time.monotonic()
        coordinator.terminate()
        coordinator.communicate(timeout=PATIENCE_S)
        self.assertEqual(coordinator.returncode, 0)
        print(f"a coordinator with silent clients ended after {time.monotonic() - before:.1f} s", file=sys.stderr)
        for client in held:
            client.close()

    # --- who reads while it ends ---

    def test_a_reader_that_stays_to_the_end(self):
        # A killed coordinator leaves the database with its journal: a reader may stay in it from then on.
        coordinator = self.start("--db", self.db, "--listen", f"unix:{self.path}/socket", program=COORDINATOR)
        coordinator.stdout.readline()
        sent = subprocess.run([IRSIG, "submit", "sweep.toml", "--coordinator", f"unix:{self.path}/socket"],
                              cwd=self.path, capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(sent.returncode, 0, sent.stderr)
        coordinator.kill()
        coordinator.communicate()
        reader = sqlite3.connect(self.db, isolation_level=None)
        reader.execute("BEGIN")
        reader.execute("SELECT count(*) FROM signature").fetchall()
        code, out, err = self.run_sweep("--resume", "--plan")
        self.assertEqual(code, 0, err)
        self.assertIn("warning: ", err)
        self.assertIn("out.sigdb-wal", err)
        self.assertIn("8 of 8 jobs done", out)
        self.assertEqual(self.rows(), 8, "complete, with its journal beside it")
        reader.close()  # the last one: SQLite folds the journal in, and nobody can tell that from a copy without it
        code, _, err = self.run_sweep()
        self.assertEqual(code, 2)
        self.assertIn("irsig doctor --accept", err)
        accepted = subprocess.run([IRSIG, "doctor", "--accept", self.db], capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(accepted.returncode, 0, accepted.stdout + accepted.stderr)
        self.assertEqual(self.run_sweep()[0], 0)
        self.assertEqual(self.beside(), ["out.sigdb"])
        self.assertEqual(self.rows(), 8)
        report = subprocess.run([IRSIG, "report", self.db], capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertIn("predicted", report.stdout, "the run's prediction is stored")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
