"""A database and its journal: read through links, killed, copied in part, closed by another SQLite program, with two hard links.

usage: whole_file_test.py <irsig> <repository>
"""
import contextlib, csv, io, os, pathlib, re, shutil, signal, sqlite3, subprocess, sys, tempfile, time, unittest

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
sys.path.insert(0, str(ROOT / "python"))
import irsig as module  # noqa: E402

QUICKSTART = (ROOT / "jobs/examples/quickstart.toml").read_text()


def irsig(*arguments):
    return subprocess.run([IRSIG, *arguments], capture_output=True, text=True, timeout=600)


def count(path, statement="SELECT count(*) FROM signature"):
    """By SQLite alone, as the file's real name has it; 0 while there is no such table."""
    try:
        with contextlib.closing(sqlite3.connect(f"file:{path.resolve()}?mode=ro", uri=True)) as db:
            return db.execute(statement).fetchone()[0]
    except sqlite3.OperationalError:
        return 0


def in_session(leader):
    """The processes of a session that have not ended, its leader last."""
    found = []
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            state, _, _, session = (folder / "stat").read_text().rpartition(") ")[2].split()[:4]
            if int(session) == leader and state not in "ZX":
                found.append(int(folder.name))
    return sorted(found, reverse=True)


class WholeFile(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        self.file = self.path / "a.sigdb"

    def tearDown(self):
        self.folder.cleanup()

    def sweep(self, viewpoints, name="quickstart"):
        path = self.path / f"{name}.toml"
        text = QUICKSTART.replace("count = 24", f"count = {viewpoints}").replace('name = "quickstart"', f'name = "{name}"')
        path.write_text(re.sub("relative_error = .*", "relative_error = 0.1", text))
        return path

    def start(self, viewpoints=2000):
        """A run that nobody waits for: it ends by kill()."""
        log = (self.path / "log").open("w")
        self.addCleanup(log.close)
        run = subprocess.Popen([IRSIG, "run", self.sweep(viewpoints), "--db", self.file, "--workers", "1"], stdout=log, stderr=log,
                               start_new_session=True, env=os.environ | {"TMPDIR": str(self.path)})
        self.addCleanup(self.kill, run)
        while not self.file.exists() or count(self.file) < 60:
            self.assertIsNone(run.poll(), (self.path / "log").read_text())
            time.sleep(0.02)
        return run

    @staticmethod
    def kill(run):
        """The run and what it started. A coordinator left alive would end gently, and fold its journal in."""
        if run.poll() is not None:
            return
        for process in in_session(run.pid):
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        run.wait()
        while in_session(run.pid):
            time.sleep(0.01)

    def killed(self):
        run = self.start()
        self.kill(run)
        self.assertTrue(pathlib.Path(f"{self.file}-wal").exists())

    def rows(self, path):
        done = irsig("query", path, "--csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        return len(list(csv.reader(io.StringIO(done.stdout)))) - 1

    def refused(self, path, *words):
        out = self.path / "out"
        for command in (("query", path), ("digest", path), ("doctor", path), ("export", path, "--out", out), ("slice", path, "--out", out),
                        ("merge", path, "--out", out), ("report", path), ("serve", path, "--port", "0"), ("show", "temperatures", path),
                        ("run", self.sweep(4), "--db", path, "--resume")):
            done = irsig(*command)
            self.assertEqual(done.returncode, 2, f"{command}: {done.stdout[:300]}{done.stderr}")
            for word in words:
                self.assertIn(word, done.stderr, command)
            self.assertFalse(out.exists(), command)
        with self.assertRaisesRegex(module.Error, "doctor --accept"):
            module.open(path)

    def links(self):
        elsewhere = self.path / "elsewhere"
        elsewhere.mkdir()
        (elsewhere / "link.sigdb").symlink_to(self.file)
        (elsewhere / "folder").symlink_to(self.path)
        return elsewhere / "link.sigdb", elsewhere / "folder" / "a.sigdb"

    def test_links_to_what_is_written(self):
        run = self.start()
        for link in self.links():
            for _ in range(3):
                before, read, after = count(self.file), self.rows(link), count(self.file)
                self.assertLessEqual(before, read)
                self.assertLessEqual(read, after)
                with module.open(link) as db:
                    self.assertGreaterEqual(len(db.query()), after)
        self.assertIsNone(run.poll(), "it was written all the time")

    def test_links_and_copies_of_what_was_killed(self):
        self.killed()
        rows, digest = count(self.file), irsig("digest", self.file).stdout.split()[0]
        for link in self.links():
            self.assertEqual(self.rows(link), rows)
            self.assertEqual(irsig("digest", link).stdout.split()[0], digest)
            self.assertIn("jobs are not done", irsig("doctor", link).stdout)
            with module.open(link) as db:
                self.assertEqual(len(db.query()), rows)
            for command in ("slice", "merge"):
                out = self.path / f"{command}.sigdb"
                self.assertEqual(irsig(command, link, "--out", out).returncode, 0)
                self.assertEqual(self.rows(out), rows)
                out.unlink()
        copy = self.path / "copy.sigdb"
        shutil.copy(self.file, copy)
        self.refused(copy, "its header says that a journal belongs to it", str(copy), "irsig doctor --accept")
        # A program that only reads leaves an empty journal beside it.
        with contextlib.closing(sqlite3.connect(f"file:{copy}?mode=ro", uri=True)) as db:
            db.execute("SELECT count(*) FROM signature").fetchone()
        self.assertEqual(pathlib.Path(f"{copy}-wal").stat().st_size, 0)
        self.refused(copy, "is missing or empty")
        shutil.copy(f"{self.file}-wal", f"{copy}-wal")
        self.assertEqual(self.rows(copy), rows)

    def test_killed_and_closed_by_another_program(self):
        self.killed()
        rows, digest = count(self.file), irsig("digest", self.file).stdout
        with contextlib.closing(sqlite3.connect(self.file)) as db:
            self.assertEqual(db.execute("SELECT count(*) FROM signature").fetchone()[0], rows)
        self.assertFalse(pathlib.Path(f"{self.file}-wal").exists())
        self.refused(self.file, "another SQLite program closed it after a kill")
        accepted = irsig("doctor", "--accept", self.file)
        self.assertEqual(accepted.returncode, 0, accepted.stderr)
        self.assertIn(f"is one plain file now; what it holds is the database: 1 sweep, {rows} rows", accepted.stderr)
        done = count(self.file, "SELECT count(*) FROM job WHERE state = 2")
        self.assertRegex(accepted.stdout, re.escape(f"{2000 - done} of 2000 jobs are not done") + r".*\(jobs \d+ to 1999\)")
        self.assertEqual(irsig("digest", self.file).stdout, digest)
        self.assertEqual(self.rows(self.file), rows)
        again = irsig("doctor", "--accept", self.file)
        self.assertIn("nothing to accept", again.stderr)

    def test_two_runs_by_two_hard_links(self):
        self.assertEqual(irsig("run", self.sweep(4), "--db", self.file).returncode, 0)
        other = self.path / "b.sigdb"
        os.link(self.file, other)
        digest = irsig("digest", self.file).stdout.split()[0]
        for name in (self.file, other):
            self.assertEqual(irsig("digest", name).stdout.split()[0], digest)
            done = irsig("run", self.sweep(5, "second"), "--db", name)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn("has 2 hard links", done.stderr)
            self.assertIn("-samefile", done.stderr)
        self.assertEqual(irsig("digest", self.file).stdout.split()[0], digest)
        other.unlink()
        # One that is made while the file is written.
        run = subprocess.Popen([IRSIG, "run", self.sweep(2000, "third"), "--db", self.file, "--workers", "1"], stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL, start_new_session=True, env=os.environ | {"TMPDIR": str(self.path)})
        self.addCleanup(self.kill, run)
        while count(self.file) < 60:
            self.assertIsNone(run.poll())
            time.sleep(0.02)
        os.link(self.file, other)
        self.refused(other, "it has 2 hard links")
        self.kill(run)
        self.refused(other, "it has 2 hard links")
        self.assertGreaterEqual(self.rows(self.file), 60)
        other.unlink()
        self.assertEqual(irsig("doctor", "--accept", self.file).returncode, 0)

    def test_a_backup_by_python(self):
        self.killed()
        rows = count(self.file)
        copy = self.path / "copy.sigdb"
        with contextlib.closing(sqlite3.connect(f"file:{self.file}?mode=ro", uri=True)) as db, contextlib.closing(sqlite3.connect(copy)) as to:
            db.backup(to)
            to.execute("PRAGMA journal_mode = DELETE")  # as schema/README.md has it
        self.assertEqual(self.rows(copy), rows)
        vacuumed = self.path / "vacuumed.sigdb"
        with contextlib.closing(sqlite3.connect(f"file:{self.file}?mode=ro", uri=True)) as db:
            db.execute(f"VACUUM INTO '{vacuumed}'")
        self.assertEqual(self.rows(vacuumed), rows)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
