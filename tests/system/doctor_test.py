"""What `irsig doctor` finds in databases that were damaged one way each, and that it finds nothing in a sound one.

usage: doctor_test.py <irsig> <repository>
"""
import contextlib, json, pathlib, shutil, sqlite3, subprocess, sys, tempfile, unittest

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])


def irsig(*arguments):
    return subprocess.run([IRSIG, *arguments], capture_output=True, text=True, timeout=600)


class Doctor(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        sweep = (ROOT / "jobs/examples/quickstart.toml").read_text().replace("count = 24", "count = 4")
        (cls.path / "s.toml").write_text(sweep)
        cls.sound = cls.path / "sound.sigdb"
        done = irsig("run", cls.path / "s.toml", "--db", cls.sound, "--workers", "1")  # ids in the order of rows
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def findings(self, *statements, damaged=True):
        copy = self.path / "copy.sigdb"
        shutil.copy(self.sound, copy)
        with contextlib.closing(sqlite3.connect(copy)) as db:
            for statement in statements:
                db.execute(statement)
            db.commit()
        done = irsig("doctor", copy, "--json")
        self.assertEqual(done.returncode, 1 if damaged else 0, done.stdout + done.stderr)
        return [(f["kind"], f["finding"]) for f in json.loads(done.stdout)]

    def finds(self, statement, kind, text, damaged=True):
        found = self.findings(statement, damaged=damaged)
        self.assertTrue(any(k == kind and text in f for k, f in found), f"{statement}: {found}")

    def test_a_sound_database(self):
        self.assertEqual(self.findings(damaged=False), [])
        self.assertIn("nothing is damaged", irsig("doctor", self.sound).stdout)

    def test_damage(self):
        for statement, text in (
                ("DELETE FROM spectrum WHERE signature_id = 3", "spectra that cannot be read, or with what is no finite number: quickstart row 3"),
                ("UPDATE spectrum SET emitted_w_sr_um = x'0000' WHERE signature_id = 3", "spectra that cannot be read"),
                ("UPDATE spectrum SET path_transmittance = CAST(zeroblob(length(path_transmittance) - 4) || x'0000807f' AS BLOB) WHERE signature_id = 2",
                 "no finite number: quickstart row 2"),
                ("UPDATE signature SET intensity_w_sr = 1.01 * intensity_w_sr WHERE signature_id < 3", "2 signatures whose causes do not add up"),
                ("UPDATE signature SET projected_area_m2 = 9e999 WHERE signature_id = 1", "projected_area_m2: 1 signatures have no finite"),
                ("UPDATE spectrum SET emitted_w_sr_um = CAST(zeroblob(length(emitted_w_sr_um) - 4) || x'0000c07f' AS BLOB) WHERE signature_id = 2",
                 "no finite number: quickstart row 2"),
                ("UPDATE spectrum SET contrast_spectral_intensity_stderr_w_sr_um = CAST(x'0000807f' || substr(contrast_spectral_intensity_stderr_w_sr_um, 5)"
                 " AS BLOB) WHERE signature_id = 4", "no finite number: quickstart row 4"),
                ("UPDATE spectral_modes SET contrast_spectral_intensity_modes = x'000102' WHERE signature_id = 3", "spectra that cannot be read, or with what is no finite number: quickstart row 3"),
                ("UPDATE thumbnail SET png = x'00'", "images that are damaged: quickstart row 1, quickstart row 2"),
                ("UPDATE thumbnail SET png = CAST(substr(png, 1, 60) || x'ff' || substr(png, 62) AS BLOB) WHERE signature_id = 2", "damaged: quickstart row 2"),
                ("UPDATE thumbnail SET png = substr(png, 1, 20) WHERE signature_id = 3", "images that are damaged: quickstart row 3"),
                ("UPDATE thumbnail SET exr = substr(exr, 1, length(exr) / 2) WHERE signature_id = 4", "images that are damaged: quickstart row 4"),
                ("DELETE FROM signature WHERE signature_id = 5", "signatures for 24 rows"),
                ("DELETE FROM job WHERE job_id = 1", "refer to what is not there")):
            with self.subTest(statement):
                self.finds(statement, "damaged", text)

    def test_assets_are_hashed(self):
        self.finds("INSERT INTO asset (sha256, bytes) VALUES (printf('%064d', 0), x'61')", "damaged", "not those of their SHA-256")

    def test_a_torn_page(self):
        copy = self.path / "torn.sigdb"
        data = bytearray(self.sound.read_bytes())
        page = int.from_bytes(data[16:18], "big")
        data[page:3 * page] = b"\xff" * (2 * page)
        copy.write_bytes(data)
        done = irsig("doctor", copy)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("damaged", done.stdout)

    def test_what_is_missing_or_old_is_no_damage(self):
        self.finds("UPDATE job SET state = 3 WHERE job_id = 2", "missing", "1 of 4 jobs were given up", damaged=False)
        self.finds("UPDATE job SET state = 0 WHERE job_id = 2", "missing", "1 of 4 jobs are not done", damaged=False)
        self.finds("UPDATE provenance SET physics_version = 1", "old", "4 jobs of physics version 1, this program has", damaged=False)

    def test_what_is_no_database_is_refused(self):
        for path in (ROOT / "README.md", self.path / "none.sigdb"):
            self.assertEqual(irsig("doctor", path).returncode, 2)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
