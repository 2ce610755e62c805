"""A day of conditions in one file: the same numbers as one sweep an hour, from paths traced once.

usage: conditions_test.py <irsig>
"""
import pathlib, sqlite3, subprocess, sys, tempfile, unittest

IRSIG = pathlib.Path(sys.argv[1]).resolve()
TARGET = """
[model]
generate = "box"
triangles = 12
[place]
latitude_deg = 45
longitude_deg = 0
heading_deg = 0
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
[[part]]
name = "box"
material = "paint"
[[band]]
name = "mwir"
lambda_min_um = 3.5
lambda_max_um = 5
step_um = 0.1
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 30, elevation_deg = 20 }, { azimuth_deg = 200, elevation_deg = 5 } ]
[surroundings]
kind = "sea"
sea_temperature_k = 288
[air]
model = "atmosphere"
aerosol = "maritime"
visibility_m = 23000
[transport]
sun = true
[accuracy]
samples_per_replicate = 64
[output]
thumbnail_px = 0
"""
WEATHER = """
[weather]
relative_humidity_percent = 70
pressure_pa = 101300
wind_speed_m_s = 5
"""
DATES = {"winter": "2025-12-21", "spring": "2025-03-20", "summer": "2025-06-21"}
AIR_K = {"winter": 279, "spring": 284, "summer": 291}


def season(name):
    return f'[[season]]\nname = "{name}"\ndate = {DATES[name]}\n'


def air_k(name, hour):
    return AIR_K[name] + 4 - abs(hour - 14) * 0.5


def part_k(name, hour):
    return AIR_K[name] + 15 - abs(hour - 13)


class Conditions(unittest.TestCase):
    def run_sweep(self, folder, name, text, **files):
        for file, content in files.items():
            (folder / f"{file}.csv").write_text(content)
        (folder / f"{name}.toml").write_text(f'name = "{name}"\n' + text)
        done = subprocess.run([IRSIG, "run", f"{name}.toml", "--db", f"{name}.sigdb"], cwd=folder,
                              capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, 0, done.stderr)
        db = sqlite3.connect(folder / f"{name}.sigdb")
        rows = {(season, time, view): values for season, time, view, *values in db.execute(
            """SELECT season, time_utc, aspect_azimuth_deg, intensity_w_sr, intensity_stderr_w_sr, apparent_intensity_w_sr,
                      contrast_intensity_w_sr, numerical_error_w_sr, target_depth_bound_w_sr FROM signature_view""")}
        paths, rays = db.execute("SELECT sum(target_paths), sum(rays) FROM provenance").fetchone()
        db.close()
        return rows, paths, rays

    def test_24_hours_of_three_seasons(self):
        table = "season, time, air_temperature_k, part_temperature_k.box\n"
        for name in DATES:
            for hour in range(24):
                table += f"{name}, {hour:02}:00Z, {air_k(name, hour)}, {part_k(name, hour)}\n"
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            day, paths, rays = self.run_sweep(
                path, "day", 'condition_file = "hours.csv"\n' + TARGET + WEATHER + "".join(map(season, DATES)),
                hours=table)
            self.assertEqual(len(day), 2 * 72)
            for name, hour in (("winter", 0), ("spring", 9), ("summer", 12), ("summer", 23)):
                alone, paths_alone, rays_alone = self.run_sweep(
                    path, f"{name}{hour}", f'time = ["{hour:02}:00Z"]\n' + TARGET + season(name) +
                    f"air_temperature_k = {air_k(name, hour)}\nrelative_humidity_percent = 70\n"
                    f"pressure_pa = 101300\nwind_speed_m_s = 5\npart_temperature_k = {{ box = {part_k(name, hour)} }}\n")
                self.assertEqual(len(alone), 2)
                for key, values in alone.items():
                    # A view has one horizon, the mean of its weathers'; suns share their samples with each other.
                    self.assertIn(key, day)
                    delta = 1e-5 if hour in (0, 23) else 5 * values[1] / values[0]
                    self.assertAlmostEqual(day[key][0] / values[0], 1, delta=delta)
                self.assertEqual(paths, paths_alone, "primary paths are traced once for all hours")
                self.assertLess(rays, 40 * rays_alone)

    def test_hours_without_weather_are_the_same_bits(self):
        """Nothing that the conditions of a view share: no sun, no horizon of the air."""
        target = TARGET.replace('model = "atmosphere"\naerosol = "maritime"\nvisibility_m = 23000', 'model = "vacuum"')
        target = target.replace("sea_temperature_k = 288", "sea_temperature_k = 288\nsea_emissivity = 0.95\n"
                                "sky_temperature_k = 250").replace("sun = true", "sun = false")
        head = '[[season]]\nname = "spring"\ndate = 2025-03-20\n'
        table = "time,part_temperature_k.box,sky_temperature_k\n"
        hours = {f"{hour:02}:00Z": (part_k("spring", hour), 240 + hour) for hour in range(24)}
        for time, (box_k, sky_k) in hours.items():
            table += f"{time},{box_k},{sky_k}\n"
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            day, paths, rays = self.run_sweep(path, "day", 'condition_file = "t.csv"\n' + target + head, t=table)
            self.assertEqual(len(day), 48)
            for time in ("00:00Z", "13:00Z"):
                box_k, sky_k = hours[time]
                alone, paths_alone, rays_alone = self.run_sweep(
                    path, "h" + time[:2], f'time = ["{time}"]\n' + target + head +
                    f"part_temperature_k = {{ box = {box_k} }}\nsurroundings = {{ sky_temperature_k = {sky_k} }}\n")
                self.assertEqual({key: day[key] for key in alone}, alone)
                self.assertEqual((paths, rays), (paths_alone, rays_alone), "rays are traced once for all hours")

    def test_oddities_are_stored_as_they_were_written(self):
        """condition[2] is what people know, not the season that it is written out as."""
        table = "season,time,air_temperature_k,part_temperature_k.box\n"
        table += "spring,10:00Z,288,290\nspring,11:00Z,288,291\nspring,12:00Z,288,255\n"
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            self.run_sweep(path, "odd", 'condition_file = "t.csv"\n' + TARGET + WEATHER + season("spring"), t=table)
            db = sqlite3.connect(path / "odd.sigdb")
            warnings = {time: text for time, text in db.execute("SELECT time_utc, warning FROM condition")}
            db.close()
            odd = [time for time, text in warnings.items() if "colder" in text]
            self.assertEqual(odd, ["2025-03-20T12:00:00Z"], warnings)
            self.assertIn("condition[2].part_temperature_k.box = 255", warnings[odd[0]])

    def test_varied_weather(self):
        with tempfile.TemporaryDirectory() as folder:
            rows, _, _ = self.run_sweep(
                pathlib.Path(folder), "vary", 'time = ["12:00Z"]\n' + TARGET + WEATHER + season("summer") +
                "air_temperature_k = 291\npart_temperature_k = { box = 300 }\n"
                '[vary]\ncombine = "zip"\nwind_speed_m_s = [2, 10]\nvisibility_m = [50000, 2000]\n')
            names = {season for season, _, _ in rows}
            self.assertEqual(names, {"summer, wind_speed_m_s = 2, visibility_m = 50000",
                                     "summer, wind_speed_m_s = 10, visibility_m = 2000"})
            clear, hazy = (rows[(name, "2025-06-21T12:00:00Z", 30)] for name in sorted(names, reverse=True))
            self.assertNotEqual(clear[2], hazy[2], "another air")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
