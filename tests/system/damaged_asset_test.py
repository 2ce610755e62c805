"""One bit of a stored file, or of computed temperatures, is another one: nobody prints numbers of it, and a run mends it.

usage: damaged_asset_test.py <irsig> <repository>
"""
import contextlib, pathlib, sqlite3, subprocess, sys, tempfile, unittest

import heat_test, temperature_field_test

IRSIG = pathlib.Path(sys.argv[1]).resolve()


class DamagedAsset(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)

    def irsig(self, *arguments):
        return subprocess.run([IRSIG, *arguments], cwd=self.path, capture_output=True, text=True, timeout=300)

    def done(self, *arguments):
        done = self.irsig(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout + done.stderr

    def compute(self, text):
        """The digest and the temperatures of all facets."""
        (self.path / "s.toml").write_text(text)
        self.done("run", "s.toml", "--db", "a.sigdb")
        return self.done("digest", "a.sigdb"), self.temperatures()

    def temperatures(self):
        self.done("export", "a.sigdb", "--temperatures", "--out", "t.csv")
        text = (self.path / "t.csv").read_text()
        (self.path / "t.csv").unlink()
        return text

    def flip(self):
        """A bit in the middle of the one asset."""
        with contextlib.closing(sqlite3.connect(self.path / "a.sigdb")) as db:
            (rowid, size), = db.execute("SELECT rowid, length(bytes) FROM asset").fetchall()
            with db.blobopen("asset", "bytes", rowid) as blob:
                blob.seek(size // 2)
                byte = blob.read(1)[0]
                blob.seek(size // 2)
                blob.write(bytes([byte ^ 1]))
            db.commit()

    def refused(self, what):
        for command in (("export", "a.sigdb", "--temperatures", "--out", "t.csv"), ("slice", "a.sigdb", "--out", "t.sigdb"),
                        ("merge", "a.sigdb", "--out", "t.sigdb")):
            done = self.irsig(*command)
            self.assertNotEqual(done.returncode, 0, command)
            self.assertIn("its bytes have another SHA-256", done.stderr, command)
            self.assertIn(what, done.stderr, command)
            self.assertIn("--resume", done.stderr, command)
            self.assertFalse((self.path / "t.csv").exists() or (self.path / "t.sigdb").exists())
        doctor = self.irsig("doctor", "a.sigdb")
        self.assertEqual(doctor.returncode, 1)
        self.assertIn(what, doctor.stdout)
        self.assertIn("--resume", doctor.stdout)
        self.done("query", "a.sigdb")  # rows are not made of it again

    def test_computed_temperatures(self):
        digest, temperatures = self.compute(heat_test.sweep())
        self.flip()
        self.refused('(temperatures computed for the season "a" of the sweep "heat")')
        again = self.irsig("run", "s.toml", "--db", "a.sigdb")
        self.assertEqual(again.returncode, 2, again.stderr)
        self.assertIn("1 of 2 jobs done: add --resume", again.stderr)
        self.assertIn("2 of 2 jobs done", self.done("run", "s.toml", "--db", "a.sigdb", "--resume"))
        self.assertEqual((self.done("digest", "a.sigdb"), self.temperatures()), (digest, temperatures))
        self.assertIn("nothing is damaged", self.done("doctor", "a.sigdb"))

    def test_a_stored_file(self):
        (self.path / "camera.csv").write_text(temperature_field_test.field(20))
        digest, temperatures = self.compute(temperature_field_test.SWEEP)
        self.flip()
        self.refused('(a file of the sweep "box")')
        self.assertIn("is stored again", self.done("run", "s.toml", "--db", "a.sigdb", "--resume"))
        self.assertEqual((self.done("digest", "a.sigdb"), self.temperatures()), (digest, temperatures))
        self.assertIn("nothing is damaged", self.done("doctor", "a.sigdb"))
        self.assertIn("complete already", self.done("run", "s.toml", "--db", "a.sigdb", "--resume"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
