"""What a user can get wrong at the front door: one clear message, the right exit code, nothing left behind.

usage: bad_input_test.py <irsig> <irsig-coordinator> <repository>
"""
import os, pathlib, socket, sqlite3, subprocess, sys, tempfile, unittest

IRSIG, COORDINATOR, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:4])
DISK = (ROOT / "jobs/examples/disk.toml").read_text()


def generated(model):
    """The disk example with another [model]."""
    start = DISK.index("[model]")
    end = DISK.index("\n[", start + 1)
    return DISK[:start] + "[model]\n" + model + DISK[end:]


def filed(name):
    return generated(f'file = "{name}"\nunit_m = 1\nforward_axis = "+x"\nup_axis = "+z"\n')


TRIANGLE = "o disk\nv 0 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n"


class BadInput(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def refused(self, sweep, *expected, exit_code=2, db="out.sigdb"):
        (self.path / "sweep.toml").write_text(sweep)
        before = sorted(p.name for p in self.path.iterdir())
        done = subprocess.run([IRSIG, "run", "sweep.toml", "--db", db], cwd=self.path, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, exit_code, done.stderr)
        for text in expected:
            self.assertIn(text, done.stderr)
        self.assertEqual(before, sorted(p.name for p in self.path.iterdir()), "something was left behind")

    def test_missing_model_file(self):
        self.refused(filed("nowhere.obj"), "sweep.toml:", "nowhere.obj")

    def test_empty_mesh(self):
        (self.path / "empty.obj").write_text("o disk\nv 0 0 0\n")
        self.refused(filed("empty.obj"), "sweep.toml:", "empty.obj")

    def test_nan_vertex(self):
        (self.path / "nan.obj").write_text(TRIANGLE.replace("v 0 1 0", "v 0 nan 0"))
        self.refused(filed("nan.obj"), "nan.obj:3:")

    def test_unknown_part(self):
        self.refused(DISK.replace('name = "disk"\nmaterial', 'name = "disc"\nmaterial'), "sweep.toml:", 'matches "disc"')

    def test_range_inside_the_target(self):
        import re
        self.refused(re.sub(r"(?m)^range_m = .*$", "range_m = 0.001", DISK), "sweep.toml:",
                     "inside the target's convex hull")

    def test_numbers_beyond_their_bounds(self):
        import re
        for wrong in ("1e18", "1e154", "0", "nan", "9007199254740993"):
            self.refused(re.sub(r"(?m)^range_m = .*$", f"range_m = {wrong}", DISK), "sweep.toml:", "viewpoints.range_m")
        # 1e9 times the radius of the sphere around the target is the most.
        far = re.sub(r"(?m)^range_m = .*$", "range_m = 1e7", generated('generate = "disk"\ntriangles = 1000\nradius_m = 0.005\n'))
        self.refused(far, "sweep.toml:", "more than 1e+09 times as far away")
        (self.path / "huge.obj").write_text(TRIANGLE.replace("v 0 1 0", "v 0 1e30 0"))
        self.refused(filed("huge.obj"), "sweep.toml:", "huge.obj: the mesh is 1e+30 m across", "is unit_m right?")

    def test_numbers_of_the_command_line_have_the_same_bounds(self):
        (self.path / "sweep.toml").write_text(DISK)
        good = self.run_sweep("sweep.toml")
        self.assertEqual(good.returncode, 0, good.stderr)
        air = ["show", "atmosphere", "--profile", "us_standard_1976", "--observer-height-m", "10", "--range-m", "1000"]
        for arguments, expected in (
            (["plan", "sweep.toml", "--relative-error", "nan"], "--relative-error: accuracy.relative_error = nan, expected a number from 1e-06 to 1"),
            (["plan", "sweep.toml", "--relative-error", "1e-9"], "--relative-error: accuracy.relative_error = 1e-09"),
            (["run", "sweep.toml", "--db", "x.sigdb", "--time-budget-s", "1e300"], "--time-budget-s: accuracy.time_budget_s = 1e+300"),
            (["plan", "sweep.toml", "--workers", "1000000"], "--workers"),
            (["query", "out.sigdb", "--range-m", "1e20"], "--range-m = 1e+20, expected a number from 0.001 to 1e+09"),
            (["query", "out.sigdb", "--range-m", "nan"], "--range-m = nan"),
            (["query", "out.sigdb", "--aspect", "1e999,0", "--nearest", "1"], "--aspect = inf, expected a number from -360 to 360"),
            (["query", "out.sigdb", "--aspect", "0,0", "--within", "nan"], "--within nan"),
            (["query", "out.sigdb", "--max-relative-error", "nan"], "--max-relative-error nan"),
            ([*air, "--aerosol", "rural", "--visibility-m", "1e9"], "--visibility-m = 1e+09, expected a number from 100 to 100000"),
            ([*air, "--aerosol", "none", "--co2-ppmv", "nan"], "--co2-ppmv = nan"),
        ):
            done = subprocess.run([IRSIG, *arguments], cwd=self.path, capture_output=True, text=True, timeout=120)
            self.assertEqual((done.returncode, done.stdout), (2, ""), arguments)
            self.assertIn(expected, done.stderr)
        self.assertFalse((self.path / "x.sigdb").exists())

    def test_contradicting_conditions(self):
        place = "[place]\nlatitude_deg = {}\nlongitude_deg = 0\nheading_deg = 0\n"
        winter = DISK.replace('name = "any"', 'name = "winter"') + place.format(50)
        self.refused(winter, "sweep.toml:", 'season[0].name = "winter"', "2025-06-21", "contradict")
        # The same place on the other side of the equator, where it is winter.
        (self.path / "south.toml").write_text(winter.replace("latitude_deg = 50", "latitude_deg = -50"))
        good = self.run_sweep("south.toml")
        self.assertEqual((good.returncode, "warning" in good.stderr), (0, False), good.stderr)

    def test_odd_conditions_are_said_once(self):
        odd = DISK.replace('name = "any"', 'name = "summer"').replace("2025-06-21", "2025-05-20")
        odd = odd.replace('time = ["12:00Z"]', 'time = ["12:00Z", "13:00Z"]')
        (self.path / "odd.toml").write_text(odd + "[place]\nlatitude_deg = 50\nlongitude_deg = 0\nheading_deg = 0\n")
        done = self.run_sweep("odd.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        warnings = [line for line in done.stderr.splitlines() if "warning" in line]
        self.assertEqual(len(warnings), 1, done.stderr)
        self.assertRegex(warnings[0], r'^odd\.toml:\d+:1: warning: season\[0\]\.name = "summer"')

    def run_sweep(self, name):
        return subprocess.run([IRSIG, "run", name, "--db", "out.sigdb", "--relative-error", "0.1"], cwd=self.path, capture_output=True, text=True, timeout=120)

    def test_atmosphere(self):
        air = DISK.replace('model = "vacuum"', 'model = "atmosphere"\nprofile = "us_standard_1976"\naerosol = "rural"\nvisibility_m = 23000\nprofile_file = "sonde.csv"')
        self.refused(air, "air.profile_file", "sonde.csv", "No such file")
        (self.path / "sonde.csv").write_text("height_m, pressure_hpa, temperature_c, dew_point_c\n0, 1013, 20, 25\n1000, 900, 10, 5\n")
        self.refused(air, "sonde.csv:2:14: 25: expected a dew point not above the air's temperature")
        (self.path / "sonde.csv").write_text("height_m, pressure_hpa, temperature_c, dew_point_c\n0, 1013, 20, 15\n1000, 900, 10, 5\n")
        self.refused(air, 'air.profile_file is stated beside profile, expected only one of', 'surroundings.kind = "none": expected one of "sea", "ground"')

    def test_zero_viewpoints(self):
        start = DISK.index("[viewpoints]")
        end = DISK.index("\n[", start + 1)
        self.refused(DISK[:start] + '[viewpoints]\nkind = "fibonacci"\ncount = 0\nrange_m = 1000\n' + DISK[end:], "sweep.toml:", "count")

    def test_overlapping_and_reversed_bands(self):
        band = '[[band]]\nname = "x"\nlambda_min_um = {}\nlambda_max_um = {}\nstep_um = 0.1\n'
        self.refused(DISK + band.format(4, 6), "sweep.toml:", "overlap")
        self.refused(DISK + band.format(9, 8), "sweep.toml:", "lambda")

    def test_database_that_is_none_and_newer_version(self):
        (self.path / "none.sigdb").write_text("this is no database, but a letter to the reader, long enough to be one")
        self.refused(DISK, "none.sigdb", db="none.sigdb")
        good = subprocess.run([IRSIG, "run", ROOT / "jobs/examples/disk.toml", "--db", "new.sigdb"], cwd=self.path, capture_output=True, text=True)
        self.assertEqual(good.returncode, 0, good.stderr)
        connection = sqlite3.connect(self.path / "new.sigdb")
        connection.execute("PRAGMA user_version = 999")
        connection.commit()
        connection.close()
        content = (self.path / "new.sigdb").read_bytes()
        self.refused(DISK, "new.sigdb", "format version 999", db="new.sigdb")
        self.assertEqual(content, (self.path / "new.sigdb").read_bytes())
        query = subprocess.run([IRSIG, "query", "new.sigdb"], cwd=self.path, capture_output=True, text=True)
        self.assertEqual(query.returncode, 2, query.stderr)

    def test_port_in_use(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            address = f"127.0.0.1:{taken.getsockname()[1]}"
            done = subprocess.run([COORDINATOR, "--db", "out.sigdb", "--listen", address, "--insecure-loopback"], cwd=self.path, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn(address, done.stderr)
        self.assertEqual([], list(self.path.glob("*.sigdb")))

    def refused_call(self, *arguments):
        """A call that must end by itself, without reading what has no end; what it said."""
        done = subprocess.run([IRSIG, *arguments], cwd=self.path, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2, (arguments, done.stderr))
        return done.stderr

    def test_files_that_are_no_files(self):
        os.mkfifo(self.path / "fifo")
        os.mkfifo(self.path / "fifo.obj")
        os.mkfifo(self.path / "fifo.csv")
        (self.path / "zero.obj").symlink_to("/dev/zero")
        sweeps = {"model": filed("fifo.obj"), "zero": filed("zero.obj"),
                  "material": DISK.replace("emissivity = ", 'emissivity_file = "fifo.csv" # '),
                  "weather": DISK.replace("[[season]]", '[[season]]\nmodtran_file = "fifo.csv"', 1)}
        self.assertEqual(len(set(sweeps.values()) - {DISK}), 4)
        for name, sweep in sweeps.items():
            (self.path / f"{name}.toml").write_text(sweep)
            with self.subTest(sweep=name):
                said = self.refused_call("run", f"{name}.toml", "--db", "out.sigdb")
                self.assertRegex(said, name + r"\.toml:\d+:\d+: .*is a (FIFO|device), expected a regular file")
        atmosphere = ("show", "atmosphere", "--profile", "tropical", "--aerosol", "none",
                      "--observer-height-m", "10", "--target-height-m", "10", "--range-m", "1000")
        for call in (("run", "fifo", "--db", "out.sigdb"), ("run", "/dev/zero", "--db", "out.sigdb"), ("plan", "fifo"),
                     ("accuracy", "fifo", "--out", "out"),
                     ("goniometer", "fifo", "--out", "out"), ("model", "check", "fifo.obj"), ("model", "check", "zero.obj"),
                     ("material", "check", "--sweep-file", "fifo"), ("material", "show", "fifo:paint"),
                     ("show", "precompute", "fifo"),
                     (*atmosphere, "--profile-file", "fifo.csv"), (*atmosphere, "--modtran", "fifo.csv"),
                     ("query", "fifo"), ("verify-effects", "fifo")):
            with self.subTest(call=call):
                self.assertRegex(self.refused_call(*call), "is (a FIFO, expected|a device, expected|not) a regular file")
        self.assertEqual([], list(self.path.glob("out*")))

    def test_model_with_a_sparse_accessor_without_indices(self):
        (self.path / "ship.gltf").write_text(
            '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],'
            '"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],'
            '"accessors":[{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1}}]}')
        self.refused(filed("ship.gltf"), "sweep.toml:12:1: ", "ship.gltf: ", "accessors[0].sparse: has no indices")
        self.assertIn("accessors[0].sparse: has no indices", self.refused_call("model", "check", "ship.gltf"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
