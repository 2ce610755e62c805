"""Temperatures computed from the weather, at the front door: the rare, the tiny and the hidden, calm and storm, sheets and seas; what
changes nothing; what is computed once; and what is refused.

usage: heat_test.py <irsig> <repository>
"""
import csv, io, json, pathlib, subprocess, sys, tempfile, unittest

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
SWEEP = """
name = "heat"
time = TIME
[model]
MODEL
[place]
latitude_deg = LATITUDE
longitude_deg = 10
heading_deg = HEADING
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
ABSORPTANCE
[[build_up]]
name = "wall"
layer = LAYER
INSIDE
[[part]]
name = "body"
rest = true
material = "paint"
BUILD_UP
[heat]
HEAT
[weather]
pressure_pa = 101300
wind_speed_m_s = WIND
wind_from_deg = FROM
[[season]]
name = "a"
date = DATE
day = { air_temperature_min_k = COLDEST, air_temperature_max_k = WARMEST, dew_point_k = DEW }
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
range_m = RANGE
aspect = [ { azimuth_deg = 30, elevation_deg = 20 } ]
[surroundings]
SURROUNDINGS
[air]
model = "atmosphere"
aerosol = "rural"
visibility_m = 23000
[transport]
sun = true
[accuracy]
ACCURACY
[output]
thumbnail_px = 0
"""
STATED = {"TIME": '["00:00Z", "09:00Z", "12:00Z", "18:00Z"]', "LATITUDE": "45", "DATE": "2025-06-21", "HEADING": "0",
          "MODEL": 'generate = "box"\ntriangles = 48\ndraft_m = 0', "LAYER": '[{ solid = "steel", thickness_m = 0.005 }]',
          "INSIDE": 'inside = "adiabatic"', "BUILD_UP": 'build_up = "wall"', "HEAT": "", "WIND": "3", "FROM": "240",
          "COLDEST": "285", "WARMEST": "295", "DEW": "280", "RANGE": "1000", "ACCURACY": "relative_error = 0.02",
          "ABSORPTANCE": "solar_absorptance = 0.7",
          "SURROUNDINGS": 'kind = "ground"\nground_temperature_k = 288\nground_emissivity = 0.95\nsolar_albedo = 0.2'}


def sweep(**changes):
    text = SWEEP
    for key, value in (STATED | changes).items():
        text = text.replace(key, value)
    return text


class Heat(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def irsig(self, *arguments):
        return subprocess.run([IRSIG, *arguments], cwd=self.path, capture_output=True, text=True, timeout=300)

    def run_it(self, text, db="a.sigdb", *arguments):
        (self.path / "s.toml").write_text(text)
        done = self.irsig("run", "s.toml", "--db", db, "--replace", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout + done.stderr

    def table(self, *arguments):
        done = self.irsig(*arguments, "--csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        return list(csv.DictReader(io.StringIO(done.stdout)))

    # [time] (coldest, hottest, error)
    def temperatures(self, **changes):
        db = f"{len(list(self.path.glob('*.sigdb')))}.sigdb"
        self.run_it(sweep(**changes), db)
        rows = self.table("show", "temperatures", db)
        column = {name.split(" ")[0]: name for name in rows[0]}
        return [tuple(float(row[column[key]]) for key in ("coldest_k", "hottest_k", "error_k")) for row in rows]

    def test_what_is_wet_or_green_is_cooler_by_day(self):
        soil = '[{ thickness_m = 0.3, conductivity_w_m_k = 1.2, density_kg_m3 = 1800, specific_heat_j_kg_k = 1400 }]'
        noon = {}
        for name, water in {"dry": "", "moist": "surface_moisture = 0.3", "wet": "surface_moisture = 1",
                            "green": "canopy = { leaf_area_index = 3, stomatal_resistance_s_m = 100 }"}.items():
            noon[name] = self.temperatures(LAYER=soil, INSIDE='inside = "adiabatic"\n' + water, TIME='["12:00Z"]')[0][1]
        self.assertLess(noon["moist"], noon["dry"] - 2)
        self.assertLess(noon["wet"], noon["moist"] - 2)
        self.assertLess(noon["green"], noon["dry"] - 2)
        self.assertGreater(noon["green"], noon["wet"])

    def test_the_model_of_heat_has_an_error_of_its_own(self):
        wet = dict(INSIDE='inside = "adiabatic"\nsurface_moisture = 0.5', TIME='["12:00Z"]', ACCURACY="target_paths = 20000")
        self.run_it(sweep(**wet), "a.sigdb")
        self.run_it(sweep(HEAT="model_error = true", **wet), "b.sigdb")
        rows = [list(csv.DictReader(io.StringIO(self.irsig("query", db, "--format", "csv").stdout)))
                for db in ("a.sigdb", "b.sigdb")]
        without, having = rows[0][0], rows[1][0]
        self.assertEqual(without["heat_model_error_w_sr"], "")
        self.assertEqual(having["input_uncertainty_w_sr"], "")
        error = float(having["heat_model_error_w_sr"])
        self.assertGreater(error, 0.002 * float(having["intensity_w_sr"]))
        self.assertLess(error, 0.2 * float(having["intensity_w_sr"]))
        self.assertIn("surface_moisture", having["dominant_inputs"])
        self.assertIn("heat model, one sigma", self.irsig("explain", "b.sigdb", "--row", "1").stdout)
        for db in ("a", "b"):
            done = self.irsig("export", f"{db}.sigdb", "--temperatures", "--out", f"{db}.csv")
            self.assertEqual(done.returncode, 0, done.stderr)
        of_facet = [float(r["temperature_model_error_k"]) for r in csv.DictReader((self.path / "b.csv").open())
                    if r["temperature_model_error_k"] not in ("", "nan")]
        self.assertGreater(len(of_facet), 30)
        self.assertGreater(max(of_facet), 0.5)
        self.assertLess(max(of_facet), 10)
        self.assertNotIn("temperature_model_error_k", (self.path / "a.csv").read_text())

    def test_the_predicted_size_has_the_temperatures(self):
        times = ", ".join(f'"{h:02}:00Z"' for h in range(24))
        said = self.run_it(sweep(TIME=f"[{times}]", MODEL='generate = "box"\ntriangles = 12000\ndraft_m = 0',
                                 HEAT='rays = 16\nstep_minutes = 60', ACCURACY="samples_per_replicate = 64"))
        about = float(said.split("database about ")[1].split(" MB")[0])
        self.assertLess(abs(about * 1e6 / (self.path / "a.sigdb").stat().st_size - 1), 0.3, said)

    def refused(self, text, *expected):
        (self.path / "wrong.toml").write_text(text)
        done = self.irsig("run", "wrong.toml", "--db", "wrong.sigdb")
        self.assertEqual(done.returncode, 2, done.stderr)
        for line in expected:
            self.assertIn(line, done.stderr)
        self.assertFalse((self.path / "wrong.sigdb").exists(), "something was left behind")

    def test_size_is_no_matter(self):
        plain = self.temperatures()
        for model in ("length_m = 0.004\nwidth_m = 0.002\nheight_m = 0.001", "length_m = 800\nwidth_m = 400\nheight_m = 200"):
            other = self.temperatures(MODEL=f'generate = "box"\ntriangles = 48\n{model}\ndraft_m = 0', RANGE="20000")
            for a, b in zip(plain, other, strict=True):
                self.assertAlmostEqual(a[0], b[0], delta=1e-3)
                self.assertAlmostEqual(a[1], b[1], delta=1e-3)

    def test_the_world_turned_by_right_angles(self):
        # A square box knows no north; sun and wind do, and they stay.
        square = {"MODEL": 'generate = "box"\ntriangles = 48\nlength_m = 2\nwidth_m = 2\nheight_m = 1\ndraft_m = 0'}
        north, east = self.temperatures(**square), self.temperatures(**square, HEADING="90")
        for a, b in zip(north, east, strict=True):
            self.assertAlmostEqual(a[0], b[0], delta=max(0.02, a[2]))
            self.assertAlmostEqual(a[1], b[1], delta=max(0.02, a[2]))

    def with_file(self, rows, interval_s, times, step_minutes):
        """[time][facet] temperatures and errors of a sweep whose weather is a file."""
        (self.path / "weather.csv").write_text(
            f"# radiation_interval_s: {interval_s}\ntime,air_temperature_k,dew_point_k,pressure_pa,wind_speed_m_s,wind_from_deg,direct_normal_w_m2,"
            "diffuse_horizontal_w_m2,sky_w_m2\n" + "".join(f"{time},290,280,101300,{wind},0,{direct},100,320\n" for time, wind, direct in rows))
        text = sweep(TIME=json.dumps(times), HEAT=f"step_minutes = {step_minutes}", LAYER='[{ solid = "steel", thickness_m = 0.003 }]')
        weather = text[text.index("[weather]"):text.index("[[season]]")]
        day = next(line for line in text.splitlines() if line.startswith("day = "))
        text = text.replace(weather, '[weather]\nweather_file = "weather.csv"\n').replace(day, "")
        self.run_it(text, f"file{step_minutes}.sigdb")
        done = self.irsig("export", f"file{step_minutes}.sigdb", "--temperatures", "--out", "all.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = list(csv.DictReader(io.StringIO((self.path / "all.csv").read_text())))
        return [(float(r["temperature"]), float(r["error"])) for r in rows if r["temperature"] != "nan"]

    def agree(self, some, others):
        self.assertEqual(len(some), len(others))
        for (a, error_a), (b, error_b) in zip(some, others):
            self.assertLess(abs(a - b), 3 * (error_a + error_b))
        return max(abs(a - b) for (a, _), (b, _) in zip(some, others))

    def test_records_closer_together_than_steps(self):
        """Wind that comes and goes every five minutes is not the wind of every second record."""
        gusts = [(f"2025-06-{20 + m // 1440}T{m // 60 % 24:02}:{m % 60:02}:00Z", 12 * (m // 5 % 2), 0) for m in range(0, 2885, 5)]
        times = ["11:00Z", "12:00Z", "14:00Z"]
        coarse = self.with_file(gusts, 0, times, 10)
        self.assertLess(self.agree(coarse, self.with_file(gusts, 0, times, 2.5)), 0.5)

    def test_a_jump_just_before_a_wanted_time(self):
        """Half a minute after the sun has gone a sheet has cooled for half a minute, not as if it were going for ten."""
        days = [(f"2025-06-{20 + hour // 24}T{hour % 24:02}:00:00Z", 3, 800 * (hour % 2) * (6 < hour % 24 < 18)) for hour in range(49)]
        times = ["12:00:30Z", "13:00:20Z"]
        coarse = self.with_file(days, 3600, times, 10)
        self.assertLess(self.agree(coarse, self.with_file(days, 3600, times, 0.5)), 0.5)

    def test_facets_that_cross_the_water(self):
        text = sweep(MODEL='generate = "box"\ntriangles = 12\nlength_m = 40\nwidth_m = 8\nheight_m = 6\ndraft_m = 5', DATE="2025-06-21",
                     SURROUNDINGS='kind = "sea"\nsea_temperature_k = 285\nsolar_albedo = 0.06')
        # What of them rises out of the water has its own temperature, as with facets a tenth as large.
        self.assertNotIn("whose middle", self.run_it(text))
        self.run_it(text.replace("[heat]\n", "[heat]\nelement_size_m = 2\n"), "fine.sigdb")
        # Numbers and places are those of the facets that were cut: the water is 5 m above the lowest of them.
        self.assertEqual(self.irsig("export", "a.sigdb", "--temperatures", "--time", "2025-06-21T12:00Z", "--out", "a.csv").returncode, 0)
        with open(self.path / "a.csv") as file:
            facets = list(csv.DictReader(file))
        self.assertEqual([int(f["facet"]) for f in facets], list(range(len(facets))))
        self.assertGreater(len(facets), 12)
        heights = sorted(float(f["z"]) for f in facets)
        self.assertGreater(heights[-1] - heights[0], 5.9)
        ours, fine = (self.table("query", db) for db in ("a.sigdb", "fine.sigdb"))
        for a, b in zip(ours, fine, strict=True):
            for quantity in ("intensity_w_sr", "contrast_intensity_w_sr"):
                self.assertAlmostEqual(float(a[quantity]), float(b[quantity]), delta=0.04 * float(b["intensity_w_sr"]))

    def test_a_wall_kept_at_a_temperature_has_it(self):
        kept = self.temperatures(INSIDE='inside = "temperature"\ninside_temperature_k = 310', LAYER='[{ solid = "copper", thickness_m = 0.001 }]')
        for coldest, hottest, _ in kept:
            self.assertAlmostEqual(coldest, 310, delta=0.01)
            self.assertAlmostEqual(hottest, 310, delta=0.01)

    def test_a_wall_kept_by_a_schedule(self):
        text = """inside = "temperature"
inside_between = "steps"
inside_schedule = [{ time = "06:30+01:00", temperature_k = 330 }, { time = "18:30+01:00", temperature_k = 300 }]"""
        day = {"LAYER": '[{ solid = "copper", thickness_m = 0.001 }]', "HEAT": "rays = 32\nstep_minutes = 20",
               "TIME": '["05:25Z", "05:35Z", "17:25Z", "17:35Z"]', "ACCURACY": "samples_per_replicate = 64"}
        self.run_it(sweep(INSIDE=text, **day))
        rows = self.table("show", "temperatures", "a.sigdb")
        mean = next(name for name in rows[0] if name.startswith("mean_k"))
        for row, expected in zip(rows, (300, 330, 330, 300), strict=True):
            self.assertAlmostEqual(float(row[mean]), expected, delta=0.02)
        # The same in UTC: nothing is left to do.
        said = self.run_it(sweep(INSIDE=text.replace("06:30+01:00", "05:30Z").replace("18:30+01:00", "17:30Z"), **day))
        self.assertNotIn("temperatures 0 of 1", said, "computed again")
        drawn = self.irsig("plot", "a.sigdb", "--kind", "hours", "--aspect", "30,20", "--out", "hours.csv")
        self.assertEqual(drawn.returncode, 0, drawn.stderr)
        with open(self.path / "hours.csv") as file:
            behind = [(row["time_utc"][11:16], float(row["inside_temperature_k"])) for row in csv.DictReader(file) if row["build_up"]]
        self.assertEqual(behind, [("05:25", 300), ("05:30", 300), ("05:30", 330), ("17:30", 330), ("17:30", 300), ("17:35", 300)])

    def test_hard_weather_and_walls(self):
        night = {"DATE": "2025-12-21", "COLDEST": "238", "WARMEST": "242", "DEW": "235", "LATITUDE": "85",
                 "SURROUNDINGS": 'kind = "ground"\nground_temperature_k = 240\nground_emissivity = 0.95\nsolar_albedo = 0.8'}
        cases = {
            "polar night": (night, 225, 242),
            "calm polar night": (night | {"WIND": "0"}, 210, 242),
            "storm": ({"WIND": "20"}, 284, 310),
            "foil": ({"LAYER": '[{ solid = "aluminium", thickness_m = 1e-5 }]'}, 279, 330),
            "paint on concrete": ({"LAYER": '[{ solid = "epoxy", thickness_m = 1e-6 }, { solid = "concrete", thickness_m = 1 }]'}, 285, 318),
            "insulation": ({"LAYER": "[{ thickness_m = 0.1, conductivity_w_m_k = 0, density_kg_m3 = 100, specific_heat_j_kg_k = 1000 }]"}, 279, 330),
            "red hot": ({"INSIDE": 'inside = "temperature"\ninside_temperature_k = 1500'}, 1465, 1480),
            "sheet": ({"MODEL": 'generate = "disk"\ntriangles = 24\noffset_m = [0, 0, 3]', "INSIDE": 'inside = "open"',
                       "BUILD_UP": 'build_up = "wall"\ntwo_sided = true'}, 279, 320),
            "half in the sea": ({"MODEL": 'generate = "box"\ntriangles = 48\ndraft_m = 0.25',
                                 "SURROUNDINGS": 'kind = "sea"\nsea_temperature_k = 288', "WIND": "5"}, 280, 325),
            "in the ground": ({"MODEL": 'generate = "box"\ntriangles = 48\ndraft_m = 0.49'}, 279, 330),
        }
        for name, (changes, least, most) in cases.items():
            with self.subTest(name):
                for coldest, hottest, error in self.temperatures(**changes):
                    self.assertGreater(coldest, least)
                    self.assertLess(hottest, most)
                    self.assertLess(error, 3)

    def test_temperatures_are_computed_once_and_can_be_read_again(self):
        fixed = "samples_per_replicate = 256"
        self.run_it(sweep(ACCURACY=fixed))
        first = self.table("show", "temperatures", "a.sigdb")
        rows = self.table("query", "a.sigdb")
        # Another accuracy: other views of the same temperatures.
        said = self.run_it(sweep(ACCURACY="samples_per_replicate = 128"))
        self.assertNotIn("temperatures 0 of 1", said, "computed again")
        self.assertEqual(first, self.table("show", "temperatures", "a.sigdb"))
        # The same by way of a file.
        done = self.irsig("export", "a.sigdb", "--temperatures", "--out", "t.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        # Each hour has its own, in the table of parts and by facet.
        by_time = {}
        with open(self.path / "t.csv") as file:
            for row in csv.DictReader(file):
                by_time.setdefault(row["time"], []).append(float(row["temperature"]))
        time_key, coldest_key, hottest_key = (next(k for k in first[0] if k.startswith(n)) for n in ("time", "coldest", "hottest"))
        self.assertEqual(len(by_time), len(first))
        for row in first:
            self.assertAlmostEqual(min(by_time[row[time_key]]), float(row[coldest_key]), places=3)
            self.assertAlmostEqual(max(by_time[row[time_key]]), float(row[hottest_key]), places=3)
        text = sweep(ACCURACY=fixed, BUILD_UP="", HEAT="").replace("[heat]\n", "")
        text = text.replace('day = {', 'temperature_field = "file"\nday = {').replace("wind_from_deg = 240\n", "")
        text = text.replace("solar_albedo = 0.2", "")
        start, end = text.index("[[build_up]]"), text.index("[[part]]")
        text = text[:start] + '[[temperature_field]]\nname = "file"\nfile = "t.csv"\nunit = "K"\nmatch = "index"\n' + text[end:]
        self.run_it(text, "b.sigdb")
        again = self.table("query", "b.sigdb")
        self.assertEqual(len(rows), len(again))
        for a, b in zip(rows, again, strict=True):
            for column in a:
                if column.startswith("intensity"):
                    self.assertAlmostEqual(float(a[column]) / float(b[column]), 1, delta=1e-6)

    # A roof on a floor: sheets that see each other, the sky and the ground.
    CORNER = {"MODEL": 'file = "corner.obj"\nunit_m = 1\nforward_axis = "+x"\nup_axis = "+z"', "INSIDE": 'inside = "open"',
              "BUILD_UP": 'build_up = "wall"\ntwo_sided = true', "TIME": '["00:00Z", "12:00Z"]'}

    def corner(self, db, effects="", **changes):
        (self.path / "corner.obj").write_text("g body\n" + "".join(f"v {x} {y} {z}\n" for x, y, z in (
            (0, 0, 1), (4, 0, 1), (4, 4, 1), (0, 4, 1), (0, 0, 4), (0, 4, 4))) + "f 1 2 3\nf 1 3 4\nf 1 4 6\nf 1 6 5\n")
        self.run_it(sweep(**(self.CORNER | changes)) + effects, db)
        rows = []
        for row in (1, 2):
            done = self.irsig("explain", db, "--row", str(row), "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            rows.append(json.loads(done.stdout))
        return rows

    def test_an_effect_that_is_left_out_is_within_its_bound(self):
        everything = self.corner("all.sigdb")
        digest = self.irsig("digest", "all.sigdb").stdout.split()[0]
        self.corner("none.sigdb", "[effects]\nwithout = []\n")
        self.assertEqual(self.irsig("digest", "none.sigdb").stdout.split()[0], digest)
        for name, differs, times in (("heat_exchange", 0, 16), ("heat_diffuse_sun", 1, 5)):
            rows = self.corner(f"{name}.sigdb", f'[effects]\nwithout = ["{name}"]\n')
            for number, (all_on, one_off) in enumerate(zip(everything, rows, strict=True)):
                a, b = all_on["signature"][0], one_off["signature"][0]
                ledger = {e["effect"]: e for e in one_off["effects"]}
                other = {"heat_exchange": "heat_diffuse_sun", "heat_diffuse_sun": "heat_exchange"}[name]
                self.assertEqual((ledger[name]["state"], ledger[other]["state"]), ("off", "on"))
                self.assertEqual({e["effect"]: e["state"] for e in all_on["effects"]}[name], "on")
                bound, change = ledger[name]["bound_w_sr"], abs(a["intensity_w_sr"] - b["intensity_w_sr"])
                errors = a["numerical_error_w_sr"] * 1.8
                self.assertLess(change, bound + errors, (name, number))
                self.assertLess(bound, one_off["signature"][0]["numerical_error_w_sr"] * 1.8, (name, number))
                if number == differs:  # of exchange in the clear night, of diffuse sunlight at noon
                    self.assertGreater(times * change, bound, (name, change, bound))
            text = self.irsig("explain", f"{name}.sigdb", "--row", "1").stdout
            self.assertRegex(text, name + r" +off: with it, facets would be warmer or colder by [0-9.]+ K at most, which is in")
        (self.path / "heat_exchange.toml").write_text(sweep(**self.CORNER) + '[effects]\nwithout = ["heat_exchange"]\n')
        plan = self.irsig("plan", "heat_exchange.toml")
        self.assertEqual(plan.returncode, 0, plan.stderr)
        self.assertRegex(plan.stdout, r"heat_exchange +0 +[1-9]")

    def test_the_predicted_jobs_are_those_that_there_are(self):
        self.corner("planned.sigdb")
        done = self.irsig("run", "s.toml", "--db", "again.sigdb", "--plan")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(self.irsig("report", "again.sigdb").stdout, r"(?m)^ *jobs +1 +1 +1\.00")

    # A plate of 4 m2 in steady air; a CSV file of records, each an hour, and what it is seen as.
    def weather_run(self, records, layer, weather, mesh, season, view, accuracy, interval=3600, longitude=0, emissivity=0.93, ground=0.95, range_m=500):
        (self.path / "w.csv").write_text(
            f"# radiation_interval_s: {interval}\ntime,air_temperature_k,dew_point_k,pressure_pa,wind_speed_m_s,wind_from_deg,"
            "direct_normal_w_m2,diffuse_horizontal_w_m2,sky_w_m2\n" + "".join(f"{time},{weather},0,0,{sky}\n" for time, sky in records))
        (self.path / "p.obj").write_text(mesh)
        text = sweep(MODEL='file = "p.obj"\nunit_m = 1\nforward_axis = "+x"\nup_axis = "+z"\naccepted_backface_fraction = 1',
                     LATITUDE="45", LAYER=layer, HEAT='history = "days"\nhistory_days = 1', ACCURACY=accuracy,
                     ABSORPTANCE=f"solar_absorptance = 0.5\nthermal_emissivity = {emissivity}", RANGE=str(range_m),
                     SURROUNDINGS=f'kind = "ground"\nground_emissivity = {ground}\nsolar_albedo = 0.2')
        text = text.replace("emissivity = 0.9\n", "emissivity = 1.0\n", 1).replace("longitude_deg = 10", f"longitude_deg = {longitude}")
        text = text.replace("azimuth_deg = 30, elevation_deg = 20", view)
        begin, end = text.index("[weather]"), text.index("[[band]]")
        text = text[:begin] + season + text[end:]
        text = text.replace('[[band]]\nname = "lwir"', '[[band]]\nname = "mwir"\nlambda_min_um = 3.5\nlambda_max_um = 5\nstep_um = 0.5\n[[band]]\nname = "lwir"')
        text = text[text.index("[model]"):]
        said = self.run_it('name = "heat"\n' + text)
        done = self.irsig("query", "a.sigdb", "--format", "csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        return said, list(csv.DictReader(io.StringIO(done.stdout)))

    PLATE = "v 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\ng body\nf 1 2 3\nf 1 3 4\n"

    def within(self, row, true, relative):
        value, error = float(row["intensity_w_sr"]), float(row["numerical_error_w_sr"])
        self.assertLess(abs(value - true), 3 * error, row["time_utc"] + " " + row["band"])
        self.assertLess(abs(value - true), relative * true, row["time_utc"] + " " + row["band"])

    def test_a_sky_that_jumps_at_a_record_does_so_on_either_side(self):
        # Rationale: means over hours jump at full hours, when everybody asks. Thin sheets under a sky that falls by 95 W/m2, or rises by 110, at 12 h were
        # 12 % too dark or 18 % too bright there, with 1 % stated. Source: CVODE, with Planck's law integrated over the band.
        season = ('[[season]]\nname = "s"\ndate = 2025-06-21\nweather_file = "w.csv"\nsurroundings = { ground_temperature_k = 289.0 }\n' +
                  "".join(f'[[condition]]\nseason = "s"\ntime = "2025-06-21T{h}:00:00Z"\n' for h in (11, 12, 13)))
        hours = [f"2025-06-{20 + h // 24:02}T{h % 24:02}:00:00Z" for h in range(60)]
        for density, heat, wind, before, after, mwir, lwir in ((2700, 900, 2, 365, 270, 4.270, 121.94), (7850, 460, 1, 260, 370, 2.584, None)):
            with self.subTest(density=density):
                _, rows = self.weather_run([(t, before if i <= 36 else after) for i, t in enumerate(hours)],
                    f"[{{ thickness_m = 0.0005, conductivity_w_m_k = 50, density_kg_m3 = {density}, specific_heat_j_kg_k = {heat} }}]",
                    f"288.0,282.0,101325.0,{wind},270", self.PLATE, season, "azimuth_deg = 0, elevation_deg = 90", "relative_error = 0.01\nabsolute_error_k = 0")
                at_noon = {row["band"]: row for row in rows if "T12" in row["time_utc"]}
                self.within(at_noon["mwir"], mwir, 0.01)
                if lwir:
                    self.within(at_noon["lwir"], lwir, 0.005)

    def test_a_lone_triangle_knows_its_sky(self):
        # Rationale: shares of the sky by 256 rays, and by 128, agreed by luck: 274.510 K +- 0.00001 K and 1.53893 W/sr +- 0.00032.
        # Source: the balance of a plate with (1 + cos t) / 2 of the sky: 274.540 K, 1.54089 W/sr.
        season = ('[[season]]\nname = "s"\ndate = 2025-06-21\nweather_file = "w.csv"\nsurroundings = { ground_temperature_k = 276.60384509562886 }\n'
                  '[[condition]]\nseason = "s"\ntime = "2025-06-21T12:00:00Z"\n')
        hours = [f"2025-06-{20 + h // 24:02}T{h % 24:02}:00:00Z" for h in range(52)]
        mesh = ("v -1.3001447 0.634259173 5.68963131\nv 0.487472625 -0.560428409 5.68963131\nv 0.812672071 -0.0738307639 3.62073737\n"
                "g body\nf 1 2 3\n")
        _, rows = self.weather_run([(t, 223.735200) for t in hours],
            "[{ thickness_m = 0.001, conductivity_w_m_k = 50, density_kg_m3 = 7850, specific_heat_j_kg_k = 460 }]",
            "280.966681,274.966681,101325.0,4.583548,199.7237", mesh, season, "azimuth_deg = 303.755315, elevation_deg = 15.795495",
            "relative_error = 0.0002\nabsolute_error_k = 0", interval=0, longitude=5, emissivity=0.95, ground=0.9, range_m=3000)
        temperature = self.table("show", "temperatures", "a.sigdb")[0]
        column = {name.split(" ")[0]: name for name in temperature}
        self.assertAlmostEqual(float(temperature[column["mean_k"]]), 274.540, delta=0.001)
        row = next(row for row in rows if row["band"] == "mwir")
        self.assertAlmostEqual(float(row["intensity_w_sr"]), 1.54089, delta=5e-4)

    def test_facets_that_nobody_sees_are_left_out(self):
        # Rationale: a ship of overlapping solids has facets inside others. One of them had a temperature of 287 K +- 295 K, and every view failed.
        # Expected: the rows of the one body that is seen, a warning, and exports that know the facets as well as their part.
        box = lambda size, first, name: "".join(f"v {x} {y} {z}\n" for x in (-size, size) for y in (-size, size) for z in (4 - size, 4 + size)) + \
            f"g {name}\n" + "".join("f " + " ".join(str(first + i) for i in face) + "\n" for face in (
                (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)))
        (self.path / "p.obj").write_text(box(1, 1, "outer") + box(0.5, 9, "inner"))
        model = 'file = "p.obj"\nunit_m = 1\nforward_axis = "+x"\nup_axis = "+z"'
        said = self.run_it(sweep(MODEL=model, HEAT="rays = 64"), "two.sigdb")
        self.assertIn("facets stand inside other bodies (the first: facet 12 of part \"body\")", said)
        (self.path / "p.obj").write_text(box(1, 1, "outer"))
        self.run_it(sweep(MODEL=model, HEAT="rays = 64"), "one.sigdb")
        rows = [list(csv.DictReader(io.StringIO(self.irsig("query", db, "--format", "csv").stdout))) for db in ("two.sigdb", "one.sigdb")]
        for two, one in zip(*rows, strict=True):
            self.assertLess(abs(float(two["intensity_w_sr"]) - float(one["intensity_w_sr"])),
                            2 * (float(two["numerical_error_w_sr"]) + float(one["numerical_error_w_sr"])))
            self.assertLess(float(two["numerical_error_w_sr"]), 2 * float(one["numerical_error_w_sr"]) + 0.02 * float(one["intensity_w_sr"]))
        done = self.irsig("export", "two.sigdb", "--temperatures", "--out", "t.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        with (self.path / "t.csv").open() as file:
            table = list(csv.DictReader(file))
        outer = [float(row["temperature"]) for row in table if int(row["facet"]) < 12 and row["time"] == table[0]["time"]]
        inside = [row for row in table if int(row["facet"]) >= 12 and row["time"] == table[0]["time"]]
        self.assertTrue(inside)
        for row in inside:
            self.assertGreater(float(row["error"]), (max(outer) - min(outer)) / 2)

    def test_elements_of_overlapping_solids(self):
        # Rationale: bodies of a ship overlap, and element_size_m cuts them without regard to each other: elements deep inside another body, which
        # no ray leaves, once had a temperature of 287 K +- 295 K and failed every view. Expected: rows as those of the same ship whose house ends
        # at the deck, within their errors. Source: the same surface by another mesh.
        def solid(low, high, first, name, sides):
            corner = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
            face = {"aft": (0, 1, 3, 2), "fore": (4, 6, 7, 5), "starboard": (0, 4, 5, 1), "port": (2, 3, 7, 6), "keel": (0, 2, 6, 4), "top": (1, 5, 7, 3)}
            return "".join("v %g %g %g\n" % at for at in corner) + f"g {name}\n" + "".join(
                "f " + " ".join(str(first + i) for i in face[side]) + "\n" for side in sides)
        every = ("aft", "fore", "starboard", "port", "keel", "top")
        model = 'file = "p.obj"\nunit_m = 1\nforward_axis = "+x"\nup_axis = "+z"'
        rows = []
        for db, low_m, sides in (("overlapping.sigdb", 0.4, every), ("clean.sigdb", 1.6, every[:4] + every[5:])):
            (self.path / "p.obj").write_text(solid((-2.5, -1.2, 0), (2.5, 1.2, 1.6), 1, "hull", every) +
                                             solid((-1, -0.8, low_m), (1, 0.8, 3), 9, "house", sides))
            said = self.run_it(sweep(MODEL=model, HEAT="element_size_m = 0.9\nrays = 32", TIME='["09:00Z"]'), db)
            self.assertIn("facets stand inside other bodies", said)  # of the deck, in either
            rows.append(list(csv.DictReader(io.StringIO(self.irsig("query", db, "--format", "csv").stdout)))[0])
        overlapping, clean = ({key: float(row[key]) for key in ("intensity_w_sr", "numerical_error_w_sr")} for row in rows)
        self.assertLess(abs(overlapping["intensity_w_sr"] - clean["intensity_w_sr"]),
                        2 * (overlapping["numerical_error_w_sr"] + clean["numerical_error_w_sr"]))
        self.assertLess(overlapping["numerical_error_w_sr"], 2 * clean["numerical_error_w_sr"])

    def test_what_is_taken_for_something_else_is_said(self):
        (self.path / "s.toml").write_text(sweep(TIME='["12:00Z", "23:50Z"]').replace("step_um = 0.5", "step_um = 3"))
        said = self.irsig("plan", "s.toml").stderr
        # Solar midnight is 40 minutes before that of Greenwich.
        self.assertRegex(said, r"s.toml:\d+:1: warning: season\[0\].day: 2025-06-21T23:50:00Z is not within 2025-06-21 at the place")
        self.assertRegex(said, r"s.toml:\d+:1: warning: band\[0\].step_um = 3 does not divide 4 um: 4 is taken")

    def test_what_is_refused(self):
        self.refused(sweep(ABSORPTANCE=""), "has no solar_absorptance")
        self.refused(sweep(LAYER='[{ solid = "steel", thickness_m = 0 }]'), "thickness_m = 0, expected a number from 1e-09 to 100")
        self.refused(sweep(LAYER='[{ thickness_m = 1, conductivity_w_m_k = 1, density_kg_m3 = -3, specific_heat_j_kg_k = 1 }]'),
                     "density_kg_m3 = -3")
        self.refused(sweep(BUILD_UP=""), "wrong.toml")
        self.refused(sweep(LAYER='[{ solid = "steel", thickness_m = 300 }]'), "thickness_m = 300, expected", "is it in mm? 300 mm are 0.3 m")
        self.refused(sweep(BUILD_UP='build_up = "wall"\ntemperature_k = 300'), "part[0].build_up stands beside temperature_k, which would be taken")
        steel = '[{ thickness_m = 1e-30, conductivity_w_m_k = 1e-10, density_kg_m3 = 7850, specific_heat_j_kg_k = 460 }]'
        self.refused(sweep(LAYER=steel), "thickness_m = 1e-30, expected", "conductivity_w_m_k = 1e-10, expected a number from 1e-09 to 1e+12")
        self.refused(sweep(LAYER='[{ solid = "steel", thickness_m = 0.5 }]', INSIDE='inside = "heat_flux"\ninside_heat_flux_w_m2 = 1e7'),
                     "wrong.toml:21:1: build_up[0].inside_heat_flux_w_m2 = 1e+07 across layers of", "K, expected at most 20000")
        (self.path / "cold.toml").write_text(sweep(INSIDE='inside = "heat_flux"\ninside_heat_flux_w_m2 = -1e6'))
        cold = self.irsig("run", "cold.toml", "--db", "cold.sigdb")
        self.assertEqual(cold.returncode, 1)
        self.assertRegex(cold.stderr, 'part "body" would be at -[0-9.]+ K at 2025-06-2.*build_up "wall"')
        self.refused(sweep(INSIDE='inside = "open"'), "expected two_sided = true")
        self.refused(sweep(INSIDE='inside = "temperature"\ninside_schedule = [{ time = "06:00", temperature_k = 20 }]'),
                     'wrong.toml:21:22: build_up[0].inside_schedule[0].time = "06:00" has no offset',
                     "wrong.toml:21:38: build_up[0].inside_schedule[0].temperature_k = 20, expected a number from 100 to 5000",
                     "20 C are 293.15 K")
        self.refused(sweep(HEAT="element_size_m = 0.01", MODEL='generate = "box"\ntriangles = 48\nlength_m = 500\ndraft_m = 0'),
                     "heat.element_size_m", "m large")
        (self.path / "huge.obj").write_text("g body\nv 0 0 0\nv 20 0 0\nv 0 20 -5\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
        huge = 'file = "huge.obj"\nunit_m = 1000\nforward_axis = "+x"\nup_axis = "+z"\noffset_m = [0, 0, 5001]'
        self.refused(sweep(HEAT="element_size_m = 2", MODEL=huge), "heat.element_size_m", "is model.unit_m = 1000 right?")
        self.refused(sweep().replace("wind_from_deg = 240\n", ""), "wind_from_deg")
        self.refused(sweep().replace("sun = true", "sun = false"), "transport.sun = false, but [heat]")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
