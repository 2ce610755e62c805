"""A slice of a database is a database: what `irsig slice` writes, what reads it, and how it is completed again.

usage: slice_test.py <irsig> <repository>
"""
import csv, io, json, os, pathlib, re, subprocess, sys, tempfile, unittest, urllib.request

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])


def irsig(*arguments):
    return subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=300)


def rows(database, *options):
    done = irsig("query", database, "--csv", "--causes", *options)
    assert done.returncode == 0, done.stderr
    out = {}
    for row in csv.DictReader(io.StringIO(done.stdout)):
        del row["row"]  # its place in the database
        out[row["season"], row["band"], row["aspect_azimuth_deg"], row["aspect_elevation_deg"]] = row
    return out


class Slice(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        cls.sweep = cls.path / "s.toml"
        cls.sweep.write_text((ROOT / "jobs/examples/quickstart.toml").read_text().replace("count = 24", "count = 4"))
        cls.whole = cls.path / "whole.sigdb"
        done = irsig("run", cls.sweep, "--db", cls.whole, "--workers", "2")
        assert done.returncode == 0, done.stderr
        cls.digest = irsig("digest", cls.whole).stdout

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def slice(self, name, *options):
        out = self.path / name
        done = irsig("slice", self.whole, "--out", out, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(irsig("digest", out).stdout, done.stdout)
        doctor = irsig("doctor", out)
        self.assertIn("nothing is damaged, missing or old", doctor.stdout, doctor.stderr)
        return out

    def test_every_reader_takes_it(self):
        out = self.slice("part.sigdb", "--season", "winter", "--band", "lwir")
        self.assertEqual(rows(out), rows(self.whole, "--season", "winter", "--band", "lwir"))
        self.assertEqual(len(rows(out)), 4)
        there = rows(out, "--range-m", "20000")
        self.assertEqual(there, rows(self.whole, "--season", "winter", "--band", "lwir", "--range-m", "20000"))
        explained = irsig("explain", out, "--row", "1").stdout
        self.assertIn("sliced from whole.sigdb: 4 of 24 rows, --season winter --band lwir; sweep ", explained)
        self.assertIn("sliced from whole.sigdb", irsig("report", out).stdout)
        self.assertEqual(json.loads(irsig("explain", out, "--row", "1", "--json").stdout)["slices"][0]["rows"], 4)
        for name in ("part.csv", "part.nc", "part.sli"):
            self.assertEqual(irsig("export", out, "--out", self.path / name).returncode, 0, name)
        self.assertEqual(irsig("query", out, "--row", "1", "--thumbnail", self.path / "t.png").returncode, 0)
        bands = irsig("bands", out, "--detector", ROOT / "jobs/examples/detectors/hgcdte.toml")
        self.assertEqual(bands.returncode, 0, bands.stderr)

    def test_the_page_starts_on_it(self):
        out = self.slice("page.sigdb", "--season", "summer")
        page = subprocess.Popen([IRSIG, "serve", out, "--port", "0"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            address = re.search(r"http://[^\s]+", page.stdout.readline()).group()
            with urllib.request.urlopen(address, timeout=30) as reply:
                self.assertEqual(reply.status, 200)
        finally:
            page.terminate()
            page.wait(30)
            page.stdout.close()

    def test_of_everything_it_is_the_same(self):
        out = self.path / "all.sigdb"
        self.assertEqual(irsig("slice", self.whole, "--out", out).stdout, self.digest)
        said = irsig("slice", self.whole, "--out", self.path / "said.sigdb", "--source-digest", "--aspect", "0,10", "--nearest", "1").stdout
        self.assertEqual(said.splitlines()[0], "of " + self.digest.strip())

    def test_its_sweep_completes_it(self):
        out = self.slice("again.sigdb", "--aspect", "0,10", "--nearest", "2")
        done = irsig("run", self.sweep, "--db", out, "--workers", "1", "--resume")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(irsig("digest", out).stdout, self.digest)
        self.assertNotIn("sliced", irsig("report", out).stdout)

    def test_a_time_budget_is_refused(self):
        text = re.sub(r"(?m)^relative_error = .*$", "time_budget_s = 5", self.sweep.read_text())
        self.assertIn("time_budget_s", text)
        sweep, whole, out = (self.path / n for n in ("t.toml", "t.sigdb", "t-part.sigdb"))
        sweep.write_text(text)
        self.assertEqual(irsig("run", sweep, "--db", whole, "--workers", "1").returncode, 0)
        self.assertEqual(irsig("slice", whole, "--out", out, "--season", "winter").returncode, 0)
        done = irsig("run", sweep, "--db", out, "--workers", "1", "--resume")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, r"samples_per_replicate = \d+ instead of time_budget_s")
        self.assertIn("sliced", irsig("report", out).stdout)  # as it was

    def test_several_seasons(self):
        out = self.path / "two.sigdb"
        self.assertEqual(irsig("slice", self.whole, "--out", out, "--season", "winter", "--season", "summer").returncode, 0)
        self.assertIn("--season winter --season summer", irsig("report", out).stdout)
        for asked in (["--season", "summer"], ["--season", "winter"], []):
            wanted = asked or ["--season", "summer", "--season", "winter"]
            self.assertEqual(rows(out, *asked), rows(self.whole, *wanted))
        self.assertEqual(len(rows(out)), 16)
        self.assertEqual(irsig("query", out, "--season", "spring").returncode, 2)
        out.unlink()

    def test_bad_input(self):
        before = sorted(os.listdir(self.path))
        for options, text in ((["--season", "summer", "--season", "autumn"],
                               'no season "autumn" in this database; there is: spring, summer, winter'),
                              (["--season", "autumn"], 'no season "autumn" in this database; there is: spring, summer, winter'),
                              (["--row", "25"], "no row 25"),
                              (["--aspect", "0,10", "--interpolate"], "computed signatures only"),
                              (["--nearest", "2"], "--aspect")):
            done = irsig("slice", self.whole, "--out", self.path / "x.sigdb", *options)
            self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
            self.assertIn(text, done.stderr)
        done = irsig("slice", self.whole, "--out", self.whole)
        self.assertEqual(done.returncode, 2)
        self.assertIn("exists already", done.stderr)
        self.assertEqual(irsig("slice", self.sweep, "--out", self.path / "x.sigdb").returncode, 2)
        self.assertEqual(sorted(os.listdir(self.path)), before)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
