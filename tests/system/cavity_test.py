"""The cavity example through irsig run, small: what it prints, stores, exports and repeats.

usage: cavity_test.py <irsig executable> <source folder>
"""
import csv
import io
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree

IRSIG, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
EXAMPLE = (SOURCE / "jobs/examples/cavity.toml").read_text()


def small(text, stderr_k):
    """The example with its mesh by absolute path and profiles to `stderr_k`."""
    text = text.replace("../models/boxes.obj", str(SOURCE / "jobs/models/boxes.obj"))
    changed = text.replace("source_radiance_temperature_stderr_k = 0.002", f"source_radiance_temperature_stderr_k = {stderr_k}")
    assert changed != text
    return changed


# Several jobs: three viewpoints, two seasons.
SEVERAL = small(EXAMPLE, 0.02).replace('name = "cavity"', 'name = "several"').replace(
    "[[band]]", '[[season]]\nname = "warm"\ndate = 2006-08-02\n[season.surroundings]\nsky_temperature_k = 280\n\n[[band]]', 1
).replace("[surroundings]", "".join(f"[[viewpoints.aspect]]\nazimuth_deg = 180\nelevation_deg = {e}\n" for e in (50, 55))
          + "\n[surroundings]", 1)


def irsig(*arguments, code=0):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == code, f"{arguments}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


class Cavity(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        (cls.path / "cavity.toml").write_text(small(EXAMPLE, 0.02))
        cls.db = cls.path / "cavity.sigdb"
        cls.printed = irsig("run", cls.path / "cavity.toml", "--db", cls.db)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def table(self):
        """Apparent temperatures as printed: {profile: {N: kelvin}}."""
        lines = self.printed.splitlines()
        start = next(i for i, line in enumerate(lines) if line.startswith("  profile ") and "N=0" in line)
        numbers = [int(n) for n in re.findall(r"N=(\d+)", lines[start])]
        out = {}
        for line in lines[start + 1:]:
            found = re.fullmatch(r"  (\S.*?)((?:\s+[\d.]+){%d})" % len(numbers), line)
            if not found:
                break
            out[found[1]] = dict(zip(numbers, map(float, found[2].split())))
        return out

    def test_prints_the_figure(self):
        table = self.table()
        self.assertEqual(len(table), 12)
        # tests/physics/values/box_cavity.csv; 0.1 K is five standard errors.
        for profile, n, kelvin in [
                ("specular, depth 1", 0, 298.124), ("specular, depth 1", 1, 305.584), ("specular, depth 1", 3, 305.778),
                ("specular, depth 2", 2, 305.767), ("specular, depth 3", 1, 304.988), ("specular, depth 3", 8, 305.800),
                ("diffuse, depth 1", 0, 298.260), ("diffuse, depth 1", 1, 304.452), ("diffuse, depth 2", 8, 304.914),
                ("specular, depth 1, mean", 1, 305.577), ("diffuse, depth 2, mean", 2, 304.815)]:
            self.assertAlmostEqual(table[profile][n], kelvin, delta=0.1, msg=f"{profile} N={n}")
        for temperatures in table.values():
            in_order = [temperatures[n] for n in sorted(temperatures)]
            self.assertEqual(in_order, sorted(in_order))  # every reflection adds
            self.assertLess(in_order[-1], 306)

    def test_puts_the_paper_beside_it_and_says_why(self):
        _, found, beside = self.printed.partition("Beside what is published")
        self.assertTrue(found, self.printed)
        row = re.search(r"specular, depth 3 +3 +306 +(305\.\d+) \+- (0\.\d+) +(-0\.\d+) K", beside)
        self.assertTrue(row, beside)
        self.assertAlmostEqual(float(row[1]) - 306, float(row[3]), delta=0.0011)
        self.assertAlmostEqual(float(row[3]), -0.206, delta=0.1)
        self.assertEqual(beside.count("agrees"), 2)
        self.assertIn("Figure 4", beside)
        self.assertIn("Why: it is never reached.", beside)
        self.assertTrue(self.printed.rstrip().endswith("whole kelvins."), self.printed)

    def test_prints_it_again_from_the_database(self):
        beside = self.printed[self.printed.index("cavity: any"):]
        self.assertEqual(irsig("profile", self.db), beside)
        again = irsig("run", self.path / "cavity.toml", "--db", self.db)
        self.assertIn("complete already", again)
        self.assertTrue(again.endswith(beside))

    def test_csv_and_svg(self):
        rows = list(csv.DictReader(io.StringIO(irsig("profile", self.db, "--csv"))))
        self.assertEqual(len(rows), 12 * 10)
        for row in rows:
            self.assertLess(float(row["source_radiance_temperature_stderr_k"]), 0.03)
            self.assertAlmostEqual(float(row["target_fraction"]), 1, delta=1e-5)
            self.assertEqual(row["radiance_w_m2_sr"], row["apparent_radiance_w_m2_sr"])  # in vacuum
            self.assertGreater(int(row["samples"]), 0)
        out = self.path / "cavity.svg"
        irsig("profile", self.db, "--svg", "--out", out)
        text = "".join(xml.etree.ElementTree.parse(out).getroot().itertext())
        self.assertIn("Number of reflections", text)
        one = list(csv.DictReader(io.StringIO(irsig("profile", self.db, "--csv", "--profile-name", "diffuse, depth 2"))))
        self.assertEqual({row["profile"] for row in one}, {"diffuse, depth 2"})

    def test_what_is_wrong_is_said(self):
        done = subprocess.run([IRSIG, "profile", str(self.db), "--profile-name", "nothing"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("no profile matches; there are:", done.stderr)

    def test_a_new_published_number_computes_nothing(self):
        sweep = self.path / "edited.toml"
        sweep.write_text(small(EXAMPLE, 0.02).replace("source_radiance_temperature_k = 306\nsource", "source_radiance_temperature_k = 305\nsource"))
        db = self.path / "edited.sigdb"
        db.write_bytes(self.db.read_bytes())
        again = irsig("run", sweep, "--db", db)
        self.assertRegex(again, r"specular, depth 3 +3 +305 +305\.")
        before = list(csv.DictReader(io.StringIO(irsig("profile", self.db, "--csv"))))
        self.assertEqual(list(csv.DictReader(io.StringIO(irsig("profile", db, "--csv")))), before)


class Repeatable(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        (self.path / "several.toml").write_text(SEVERAL)

    def tearDown(self):
        self.folder.cleanup()

    def run_into(self, name, *arguments):
        irsig("run", self.path / "several.toml", "--db", self.path / name, *arguments)
        return irsig("digest", self.path / name)

    def test_same_digest_with_other_workers_and_after_an_interruption(self):
        one = self.run_into("one.sigdb", "--workers", 1)
        self.assertEqual(self.run_into("two.sigdb", "--workers", 2), one)
        rows = list(csv.DictReader(io.StringIO(irsig("profile", self.path / "one.sigdb", "--csv"))))
        self.assertEqual(len(rows), 3 * 2 * 12 * 10)

        database = self.path / "cut.sigdb"
        process = subprocess.Popen([IRSIG, "run", str(self.path / "several.toml"), "--db", str(database), "--workers", "1"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        first_done = False
        while process.poll() is None and not first_done:
            time.sleep(0.02)
            seen = subprocess.run([IRSIG, "profile", str(database), "--csv"], capture_output=True, text=True)
            first_done = seen.returncode == 0
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        process.communicate(timeout=120)
        irsig("run", self.path / "several.toml", "--db", database, "--workers", "1",
              *(["--resume"] if process.returncode == 1 else []))
        self.assertEqual(irsig("digest", database), one)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
