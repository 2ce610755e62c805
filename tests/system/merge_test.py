"""A sweep computed in shards, each into a database of its own, and what `irsig merge` makes of them: the undivided sweep.

usage: merge_test.py <irsig> <repository>
"""
import csv, io, os, pathlib, re, shutil, sqlite3, subprocess, sys, tempfile, time, unittest

import readme_digest

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
# Two days whose temperatures are computed, two bands, images, profiles, an uncertain input; seven views: shards of 3, 2 and 2.
SWEEP = """
name = "walls"
time = ["00:00Z", "12:00Z"]
[model]
generate = "box"
triangles = 48
draft_m = 0
[place]
latitude_deg = 45
longitude_deg = 10
heading_deg = 0
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
solar_absorptance = 0.7
[[build_up]]
name = "wall"
layer = [{ solid = "steel", thickness_m = 0.005 }]
inside = "adiabatic"
[[part]]
name = "body"
rest = true
material = "paint"
build_up = "wall"
[heat]
rays = 32
step_minutes = 30
[uncertainty]
ground_temperature_k = 2
[weather]
pressure_pa = 101300
wind_speed_m_s = 3
wind_from_deg = 240
[[season]]
name = "june"
date = 2025-06-21
day = { air_temperature_min_k = 285, air_temperature_max_k = 295, dew_point_k = 280 }
[[season]]
name = "december"
date = 2025-12-21
day = { air_temperature_min_k = 268, air_temperature_max_k = 275, dew_point_k = 265 }
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[[band]]
name = "mwir"
lambda_min_um = 3.4
lambda_max_um = 5
step_um = 0.2
[viewpoints]
kind = "fibonacci"
count = 7
range_m = 1000
[surroundings]
kind = "ground"
ground_temperature_k = 288
ground_emissivity = 0.95
solar_albedo = 0.2
[air]
model = "atmosphere"
aerosol = "rural"
visibility_m = 23000
[transport]
sun = true
[accuracy]
samples_per_replicate = 16
[output]
thumbnail_px = 16
"""


def irsig(*arguments):
    return subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=300)


class Merge(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        cls.sweep = cls.path / "walls.toml"
        cls.sweep.write_text(SWEEP)
        cls.whole = cls.path / "whole.sigdb"
        cls.shard = [cls.path / f"s{k}.sigdb" for k in (1, 2, 3)]
        done = irsig("run", cls.sweep, "--db", cls.whole, "--workers", "2")
        assert done.returncode == 0, done.stderr
        cls.digest = irsig("digest", cls.whole).stdout
        for k in (1, 2):
            done = irsig("run", cls.sweep, "--db", cls.shard[k - 1], "--workers", "1", "--shard", f"{k}/3")
            assert done.returncode == 0, done.stderr
            cls.said = done
        # The third is killed on its way, and gone on with.
        run = subprocess.Popen([IRSIG, "run", cls.sweep, "--db", cls.shard[2], "--workers", "1", "--shard", "3/3"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while run.poll() is None and not (cls.shard[2].exists() and cls.done(cls.shard[2]) > 0):
            time.sleep(0.02)
        run.kill()
        run.wait()
        for _ in range(300):  # its coordinator ends, too
            done = irsig("run", cls.sweep, "--db", cls.shard[2], "--workers", "1", "--shard", "3/3", "--resume")
            if "another irsig is writing" not in done.stderr:
                break
            time.sleep(0.1)
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @staticmethod
    def done(database):
        try:
            with sqlite3.connect(f"file:{database}?mode=ro", uri=True) as db:
                return db.execute("SELECT count(*) FROM job WHERE state = 2").fetchone()[0]
        except sqlite3.Error:
            return 0

    def merge(self, name, *sources):
        out = self.path / name
        done = irsig("merge", *sources, "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(irsig("digest", out).stdout, done.stdout)
        return out, done

    def refused(self, text, *arguments, code=2):
        before = sorted(os.listdir(self.path))
        done = irsig(*arguments)
        self.assertEqual((done.returncode, done.stdout), (code, ""), done.stderr)
        self.assertIn(text, done.stderr)
        self.assertEqual(sorted(os.listdir(self.path)), before)

    def test_of_all_shards_is_the_undivided_run(self):
        self.assertIn("irsig: 2 of 7 viewpoints x 4 conditions x 2 bands = 16 rows", self.said.stderr)
        a, b, c = self.shard
        out, said = self.merge("all.sigdb", b, c, a)
        self.assertEqual(said.stdout, self.digest)
        self.assertIn("walls: 56 rows, ", said.stderr)
        self.assertIn("nothing is damaged, missing or old", irsig("doctor", out).stdout)
        self.assertEqual(os.stat(out).st_mode & 0o777, 0o600)
        two, said = self.merge("two.sigdb", c, a)
        self.assertIn("goes on with it", said.stderr)
        self.assertEqual(self.merge("nested.sigdb", b, two, b, c)[1].stdout, self.digest)
        # Nothing of it is computed again.
        self.assertIn("complete already", irsig("run", self.sweep, "--db", out, "--resume").stdout)
        # A shard is no damage, and says what it is.
        self.assertIn("nothing is damaged, missing or old", irsig("doctor", b).stdout)
        self.assertRegex(irsig("report", b).stdout, r"shard 2/3 of the sweep [0-9a-f]{64}: 2 of 7 viewpoints")
        self.assertNotIn("shard", irsig("report", out).stdout)

    def test_what_is_missing_is_computed_later(self):
        out, _ = self.merge("missing.sigdb", self.shard[2], self.shard[0])
        self.refused("add --resume", "run", self.sweep, "--db", out)
        copy = self.path / "vacuumed.sigdb"  # as schema/README.md says
        with sqlite3.connect(f"file:{out}?mode=ro", uri=True) as db:
            db.execute("VACUUM INTO ?", (str(copy),))
        db.close()
        for database in (out, copy):
            done = irsig("run", self.sweep, "--db", database, "--workers", "1", "--resume")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("irsig: 2 of ", done.stderr)
            self.assertEqual(irsig("digest", database).stdout, self.digest)

    def test_a_row_of_a_shard_is_that_row_of_the_whole(self):
        def row(database):
            line = next(csv.DictReader(io.StringIO(irsig("query", database, "--csv", "--row", "9", "--causes").stdout)))
            del line["seconds"]
            return line
        self.assertEqual(row(self.shard[1]), row(self.whole))

    def test_the_digest_is_what_the_readme_of_the_schema_defines(self):
        self.assertEqual(self.digest.split()[0], readme_digest.digest(self.whole))

    def test_the_readme_of_the_schema_names_the_format_of_new_files(self):
        with sqlite3.connect(self.whole) as db:
            number = str(db.execute("PRAGMA user_version").fetchone()[0])
        self.assertEqual(re.findall(r"(?:database,|number of the) format:? (\d+)", (ROOT / "schema/README.md").read_text()), [number] * 2)

    # The statements of schema/README.md.
    def test_attached_shards_answer_together(self):
        recipe = re.search(r"## Queries over shards.*?```sql\n(.*?)```", (ROOT / "schema/README.md").read_text(), re.S).group(1)
        for k in (1, 2, 3):
            recipe = recipe.replace(f"shard{k}.sigdb", str(self.shard[k - 1]))
        db = sqlite3.connect("file:?mode=memory", uri=True)
        db.executescript(recipe)
        columns = "row, season, time_utc, band, aspect_azimuth_deg, intensity_w_sr, numerical_error_w_sr, job_key"
        with sqlite3.connect(self.whole) as whole:
            expected = whole.execute(f"SELECT {columns} FROM signature_view ORDER BY row").fetchall()
        self.assertEqual(len(expected), 56)
        self.assertEqual(db.execute(f"SELECT {columns} FROM shard_row ORDER BY row").fetchall(), expected)
        self.assertEqual(db.execute("SELECT max(intensity_w_sr) FROM shard_row WHERE band = 'lwir'").fetchone()[0],
                         max(e[5] for e in expected if e[3] == "lwir"))
        db.close()

    def test_conflicts_leave_nothing(self):
        copy = self.path / "copy.sigdb"
        shutil.copy(self.shard[1], copy)
        try:
            with sqlite3.connect(copy) as db:
                db.execute("UPDATE signature SET intensity_w_sr = intensity_w_sr * (1 + 1e-15) WHERE signature_id = 1")
            db.close()
            out = self.path / "x.sigdb"
            for sources in ((self.whole, copy), (copy, self.shard[1])):
                self.refused("`signature` is not the same in ", "merge", *sources, "--out", out)
                self.refused(f"{sources[0]} and in {sources[1]}", "merge", *sources, "--out", out)
            with sqlite3.connect(copy) as db:
                db.execute("UPDATE provenance SET determinism_class = 'another'")
            db.close()
            self.refused("and another in ", "merge", self.shard[0], copy, "--out", out)
            with sqlite3.connect(copy) as db:
                db.execute("CREATE TRIGGER t AFTER INSERT ON asset BEGIN DELETE FROM sweep; END")
            db.close()
            self.refused("trigger", "merge", self.shard[0], copy, "--out", out)
            with sqlite3.connect(copy) as db:
                db.execute("DROP TRIGGER t")
                db.execute("PRAGMA user_version = 16")
            db.close()
            self.refused("has format version 16", "merge", self.shard[0], copy, "--out", out)
        finally:
            copy.unlink()

    def test_another_sweep_of_the_name(self):
        other = self.path / "other.toml"
        other.write_text(SWEEP.replace("samples_per_replicate = 16", "samples_per_replicate = 32"))
        database = self.path / "other.sigdb"
        done = irsig("run", other, "--db", database, "--workers", "1", "--shard", "7/7")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.refused("has the definition ", "merge", self.shard[0], database, "--out", self.path / "x.sigdb")
        other.write_text(SWEEP.replace('name = "walls"', 'name = "boxes"'))
        boxes = self.path / "boxes.sigdb"
        self.assertEqual(irsig("run", other, "--db", boxes, "--workers", "1", "--shard", "7/7").returncode, 0)
        out, _ = self.merge("side.sigdb", boxes, self.shard[0])
        self.assertIn("boxes", irsig("report", out).stdout)
        self.assertIn("walls", irsig("report", out).stdout)

    def test_bad_input(self):
        for shard in ("0/3", "4/3", "a/b", "3", "-1/2"):
            self.refused("expected K/N", "run", self.sweep, "--db", self.path / "x.sigdb", f"--shard={shard}")
            self.refused("expected K/N", "plan", self.sweep, f"--shard={shard}")
        self.refused("has 7 viewpoints, expected at most as many shards", "run", self.sweep, "--db", self.path / "x.sigdb", "--shard", "1/8")
        self.refused("time_budget_s", "run", self.sweep, "--db", self.path / "x.sigdb", "--shard", "1/3", "--time-budget-s", "5")
        for database in (self.whole, self.shard[1]):
            self.refused("has no place", "run", self.sweep, "--db", database, "--shard", "1/3")
            self.assertNotIn("will be replaced", irsig("run", self.sweep, "--db", database, "--shard", "1/3", "--resume").stderr)
        self.refused("exists already", "merge", self.shard[0], "--out", self.whole)
        self.refused("no such file", "merge", self.shard[0], self.path / "absent.sigdb", "--out", self.path / "x.sigdb", code=2)
        self.refused("is not a signature database", "merge", self.sweep, "--out", self.path / "x.sigdb")
        sliced = self.path / "slice.sigdb"
        self.assertEqual(irsig("slice", self.whole, "--season", "june", "--out", sliced).returncode, 0)
        self.refused("holds a slice", "merge", sliced, self.shard[0], "--out", self.path / "x.sigdb")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
