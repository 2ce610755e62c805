"""Runs that are killed while a job computes what uncertain inputs change of temperatures: resumed, they leave the database of a run
that nobody disturbed.

usage: heat_kill_test.py <irsig>
"""
import os, pathlib, signal, sqlite3, subprocess, sys, tempfile, time, unittest

IRSIG = pathlib.Path(sys.argv[1]).resolve()
PATIENCE_S = 240  # for what ends by itself, on however busy a machine
# Two seasons: two jobs of temperatures, and two of what four inputs change of them.
SWEEP = """
name = "shed"
time = ["06:00Z", "12:00Z"]
[model]
generate = "box"
triangles = 600
draft_m = 0
[place]
latitude_deg = 45
longitude_deg = 10
heading_deg = 20
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
solar_absorptance = 0.7
[[build_up]]
name = "wall"
layer = [{ solid = "steel", thickness_m = 0.005 }]
inside = "air"
inside_temperature_k = 293
inside_h_w_m2_k = 5
[[part]]
name = "body"
rest = true
material = "paint"
build_up = "wall"
[heat]
step_minutes = 4
[uncertainty]
air_temperature_k = 1
wind_speed_m_s = 0.5
inside_temperature_k = 2
solar_absorptance = 0.05
[weather]
pressure_pa = 101300
wind_speed_m_s = 3
wind_from_deg = 240
[[season]]
name = "June"
date = 2025-06-21
day = { air_temperature_min_k = 285, air_temperature_max_k = 295, dew_point_k = 280 }
[[season]]
name = "March"
date = 2025-03-21
day = { air_temperature_min_k = 275, air_temperature_max_k = 285, dew_point_k = 270 }
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 30, elevation_deg = 20 } ]
[surroundings]
kind = "ground"
ground_temperature_k = 284
ground_emissivity = 0.95
solar_albedo = 0.2
[air]
model = "atmosphere"
aerosol = "rural"
visibility_m = 23000
[transport]
sun = true
[accuracy]
samples_per_replicate = 64
[output]
thumbnail_px = 0
"""


class HeatKill(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        (self.path / "s.toml").write_text(SWEEP)

    def tearDown(self):
        self.folder.cleanup()

    def start(self, db, workers, *more):
        run = subprocess.Popen([IRSIG, "run", "s.toml", "--db", db, "--workers", str(workers), *more], cwd=self.path,
                               env={**os.environ, "TMPDIR": str(self.path)}, text=True, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, start_new_session=True)
        self.addCleanup(lambda: run.poll() is None and os.killpg(run.pid, signal.SIGKILL))
        return run

    def finish(self, run):
        err = run.communicate(timeout=PATIENCE_S)[1]
        self.assertEqual(run.returncode, 0, err)

    def digest(self, db):
        done = subprocess.run([IRSIG, "digest", db], cwd=self.path, capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.split()[0]

    # Of the jobs of changes, (how many are leased, how many are done).
    def jobs_of_changes(self, db):
        path = self.path / db
        if not path.exists():
            return 0, 0
        try:
            with sqlite3.connect(f"file:{path}?mode=ro", uri=True, timeout=5) as connection:
                states = [row[0] for row in connection.execute(
                    "SELECT state FROM job JOIN heat_job USING (job_id) WHERE heat_index >= 2")]
        except sqlite3.OperationalError:  # no tables yet
            return 0, 0
        return states.count(1), states.count(2)

    # Killed as soon as a job of changes is leased and no more than so many are done; whether it was before they all were.
    def killed_in_a_change(self, run, db, done_at_least):
        end = time.monotonic() + PATIENCE_S
        while run.poll() is None and time.monotonic() < end:
            leased, done = self.jobs_of_changes(db)
            if leased > 0 and done >= done_at_least:
                break
            time.sleep(0.01)
        if run.poll() is not None:
            return False
        os.killpg(run.pid, signal.SIGKILL)
        run.communicate(timeout=PATIENCE_S)
        return self.jobs_of_changes(db)[1] < 2

    def test_a_killed_run_goes_on_to_the_same_digest(self):
        self.finish(self.start("calm.sigdb", 1))
        digest = self.digest("calm.sigdb")
        self.assertEqual(self.jobs_of_changes("calm.sigdb"), (0, 2))
        for workers in (1, 2):
            db, hits = f"{workers}.sigdb", 0
            for done_at_least in (0, 0, 1):  # once more in what was resumed; with the other one's result there
                hits += self.killed_in_a_change(
                    self.start(db, workers, *(["--resume"] if hits or (self.path / db).exists() else [])), db, done_at_least)
            self.assertGreaterEqual(hits, 1, "no job of changes was met while it was computed")
            self.finish(self.start(db, workers, "--resume"))
            self.assertEqual(self.digest(db), digest, f"{workers} workers")
            self.assertEqual(self.jobs_of_changes(db), (0, 2))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
