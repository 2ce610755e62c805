"""irsig show atmosphere, sky and sun: the air by itself, and a sweep's.

usage: cli_atmosphere_test.py <irsig executable> <source folder>
"""
import csv
import io
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

IRSIG = str(pathlib.Path(sys.argv[1]).resolve())
EXAMPLES = pathlib.Path(sys.argv[2]).resolve() / "jobs/examples"

AIR = ("--profile", "midlatitude_summer", "--aerosol", "rural", "--visibility-m", "23000")
SEA = ("--observer-m", "20", "--target-m", "10", "--range-m", "5000")


def irsig(*arguments, exit_code=0):
    done = subprocess.run([IRSIG, "show", *map(str, arguments)], capture_output=True, text=True, timeout=300)
    if done.returncode != exit_code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout if exit_code == 0 else done.stdout + done.stderr


def rows(text):
    return [{k: float(v) for k, v in r.items() if v} for r in csv.DictReader(io.StringIO(text))]


def at(table, wavenumber_cm1):
    return next(r for r in table if r["wavenumber_cm1"] == wavenumber_cm1)


def planck(lambda_um, temperature_k):
    return 1.191042972e8 / lambda_um ** 5 / math.expm1(14387.76877 / (lambda_um * temperature_k))


class Atmosphere(unittest.TestCase):
    def test_path(self):
        table = rows(irsig("atmosphere", *AIR, *SEA))
        self.assertEqual(len(table), 275)
        self.assertEqual([r["lambda_um"] for r in table], sorted(r["lambda_um"] for r in table))
        for r in table:
            self.assertTrue(0 <= r["transmittance"] <= 1)
            self.assertAlmostEqual(r["lambda_um"] * r["wavenumber_cm1"], 1e4, places=3)
            self.assertAlmostEqual(r["path_radiance_w_m2_sr_um"],
                                   r["thermal_radiance_w_m2_sr_um"] + r["scattered_radiance_w_m2_sr_um"], places=7)
            self.assertGreaterEqual(r["model_error_transmittance"], 0)
        # 4.26 um is black after 5 km, and as warm as the air (294.1 K); the windows are open.
        black = at(table, 2345)
        self.assertLess(black["transmittance"], 1e-6)
        self.assertAlmostEqual(black["path_radiance_w_m2_sr_um"] / planck(black["lambda_um"], 294.1), 1, delta=0.01)
        self.assertTrue(0.2 < at(table, 905)["transmittance"] < 0.6)

    def test_weather_sun_and_surroundings_change_it(self):
        clear = at(rows(irsig("atmosphere", *AIR, *SEA)), 2555)
        surface = ("--pressure-pa", 101325, "--air-temperature-k", 288.15)
        dry = at(rows(irsig("atmosphere", *AIR, *SEA, *surface, "--humidity", 10)), 905)
        humid = at(rows(irsig("atmosphere", *AIR, *SEA, *surface, "--humidity", 95)), 905)
        self.assertGreater(dry["transmittance"], humid["transmittance"] + 0.1)
        sunny = at(rows(irsig("atmosphere", *AIR, *SEA, "--sun-zenith-deg", 50, "--sun-from-path-deg", 20)), 2555)
        self.assertGreater(sunny["scattered_radiance_w_m2_sr_um"], clear["scattered_radiance_w_m2_sr_um"] + 0.001)
        self.assertEqual(clear["thermal_radiance_w_m2_sr_um"], sunny["thermal_radiance_w_m2_sr_um"])
        around, none = (at(rows(irsig("atmosphere", *AIR, *SEA, "--surroundings-temperature-k", k)), 905) for k in (290, 0))
        self.assertGreater(around["scattered_radiance_w_m2_sr_um"], 0.01)
        self.assertEqual(none["scattered_radiance_w_m2_sr_um"], 0)

    def test_fog_is_as_warm_as_its_air(self):
        # As a run has it: particles scatter the fog's own light, which is as warm as the air within it.
        fog = ("--profile", "us_standard_1976", "--aerosol", "advection_fog", "--visibility-m", 300)
        path = at(rows(irsig("atmosphere", *fog, "--observer-m", 10, "--target-m", 10, "--range-m", 2000)), 905)
        up = at(rows(irsig("sky", *fog, "--altitude-m", 10, "--zenith-deg", 80)), 905)
        warm = planck(path["lambda_um"], 288.1)
        self.assertAlmostEqual(path["path_radiance_w_m2_sr_um"] / warm, 1, delta=0.02)
        self.assertAlmostEqual(up["sky_radiance_w_m2_sr_um"] / warm, 1, delta=0.03)
        text = irsig("atmosphere", *fog, *SEA, "--surroundings-temperature-k", 0, exit_code=2)
        self.assertIn("--surroundings-temperature-k has no meaning in fog", text)

    def test_band_limits(self):
        table = rows(irsig("atmosphere", *AIR, *SEA, "--lambda-min-um", 8, "--lambda-max-um", 12))
        self.assertTrue(all(8 <= r["lambda_um"] <= 12 for r in table))
        self.assertEqual(len(table), 42)

    def test_another_codes_output_beside_it(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "other.csv"
            file.write_text("# observer_height_m: 20\n# target_height_m: 10\n# range_m: 5000\n"
                            "wavenumber_cm1,transmittance\n1000,0.4\n1010,0.4\n1020,0.5\n")
            table = rows(irsig("atmosphere", *AIR, *SEA, "--modtran", file))
            self.assertAlmostEqual(at(table, 1005)["imported_transmittance"], 0.4)
            self.assertAlmostEqual(at(table, 1015)["imported_transmittance"], 0.45)
            self.assertNotIn("imported_transmittance", at(table, 905))
            text = irsig("atmosphere", *AIR, "--observer-m", 20, "--target-m", 10, "--range-m", 8000, "--modtran", file,
                         exit_code=2)
            self.assertIn("no line of sight from 20 m to 10 m over 8000 m; it covers 20 m to 10 m over 5000 m", text)
            file.write_text("# observer_height_m: 20\nwavenumber_cm1,transmittance\n1000,1.5\n")
            text = irsig("atmosphere", *AIR, *SEA, "--modtran", file, exit_code=2)
            self.assertIn('other.csv:2:1: no line "# target_height_m: ..."', text)

    def test_drawing(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "path.svg"
            self.assertEqual(irsig("atmosphere", *AIR, *SEA, "--out", file), "")
            text = " ".join(xml.etree.ElementTree.parse(file).getroot().itertext())
            for expected in ("5 km from 20 m to 10 m", "midlatitude_summer, aerosol rural 23 km", "Transmittance",
                             "Path radiance"):
                self.assertIn(expected, text)
            irsig("sky", *AIR, "--altitude-m", 10, "--zenith-deg", "0,80", "--out", file)
            text = " ".join(xml.etree.ElementTree.parse(file).getroot().itertext())
            self.assertIn("80\u00b0", text)

    def test_errors_say_what_is_expected(self):
        for arguments, expected in (
                (("atmosphere", "--aerosol", "none", *SEA), "show atmosphere: --profile is missing (or --sweep-file), expected one of tropical"),
                (("atmosphere", "--profile", "arctic", "--aerosol", "none", *SEA), "--profile arctic: expected one of"),
                (("atmosphere", "--profile", "tropical", *SEA), "--aerosol is missing, expected one of"),
                (("atmosphere", "--profile", "tropical", "--aerosol", "rural", *SEA), "--aerosol rural needs --visibility-m"),
                (("atmosphere", "--profile", "tropical", "--aerosol", "navy_maritime", *SEA), "needs --wind-speed-m-s"),
                (("atmosphere", *AIR, "--observer-m", 20, "--range-m", 5000), "--target-height-m is missing"),
                (("atmosphere", *AIR, *SEA, "--level"), "--level has one height"),
                (("atmosphere", *AIR, *SEA, "--air-temperature-k", 290), "together"),
                (("atmosphere", *AIR, *SEA, "--air-temperature-k", 290, "--humidity", 140, "--pressure-pa", 1e5),
                 "relative_humidity_percent 140: expected 0 to 100"),
                (("atmosphere", *AIR, *SEA, "--sun-zenith-deg", 30), "belong together"),
                (("atmosphere", *AIR, *SEA, "--lambda-min-um", 16, "--lambda-max-um", 17), "covers 2.94 to 15.4 um"),
                (("atmosphere", *AIR, "--observer-m", 20, "--target-m", 10, "--range-m", 60000), "the Earth hides"),
                (("sky", *AIR, "--altitude-m", 10, "--zenith-deg", 190), "--zenith-deg 190: expected 0 to 180"),
                (("sun", "--latitude-deg", 25, "--longitude-deg", 130, "--altitude-m", 0, "--time", "noon"), "noon")):
            with self.subTest(expected=expected):
                self.assertIn(expected, irsig(*arguments, exit_code=2))

    def test_thick_haze_is_flagged(self):
        # Denser haze and fog, whose light is computed as often as it is scattered, are not.
        for aerosol, visibility_m, flagged in (("rural", "5000", True), ("rural", "1000", False),
                                               ("advection_fog", "200", False)):
            done = subprocess.run([IRSIG, "show", "atmosphere", "--profile", "us_standard_1976", "--aerosol", aerosol,
                                   "--visibility-m", visibility_m, *SEA], capture_output=True, text=True, timeout=300)
            self.assertEqual(done.returncode, 0)
            self.assertEqual("scattering optical depth" in done.stderr, flagged, (aerosol, visibility_m))


class Sky(unittest.TestCase):
    def test_directions(self):
        table = rows(irsig("sky", *AIR, "--altitude-m", 10, "--zenith-deg", "0,60,85", "--azimuth-deg", "0,180",
                           "--sun-zenith-deg", 50, "--sun-azimuth-deg", 180, "--lambda-min-um", 3.5, "--lambda-max-um", 11.1))
        sky = {(r["zenith_deg"], r["azimuth_deg"]): r for r in table if r["wavenumber_cm1"] == 905}
        self.assertEqual(len(sky), 6)
        thermal = [sky[z, 0]["thermal_radiance_w_m2_sr_um"] for z in (0, 60, 85)]
        self.assertEqual(thermal, sorted(thermal), "the sky is warmer towards the horizon")
        # Particles scatter forwards: brighter on the sun's side.
        blue = {(r["zenith_deg"], r["azimuth_deg"]): r for r in table if r["wavenumber_cm1"] == 2555}
        self.assertGreater(blue[60, 180]["scattered_radiance_w_m2_sr_um"],
                           1.5 * blue[60, 0]["scattered_radiance_w_m2_sr_um"])


class Sun(unittest.TestCase):
    PLACE = ("--latitude-deg", 25, "--longitude-deg", 130, "--altitude-m", 0)

    def test_position_alone(self):
        (sun,) = rows(irsig("sun", *self.PLACE, "--time", "2025-12-21T10:30:00+09:00"))
        self.assertEqual(set(sun), {"sun_azimuth_deg", "sun_zenith_deg", "sun_distance_au"})
        self.assertAlmostEqual(sun["sun_zenith_deg"], 55.1, places=1)

    def test_direct_light_through_the_air(self):
        table = rows(irsig("sun", *self.PLACE, "--time", "2025-06-21T12:00:00+09:00", *AIR))
        self.assertEqual(len(table), 275)
        for r in table:
            self.assertTrue(0 <= r["sun_irradiance_w_m2_um"] <= r["sun_irradiance_in_space_w_m2_um"])
        window = at(table, 2555)
        self.assertTrue(0.6 < window["sun_irradiance_w_m2_um"] / window["sun_irradiance_in_space_w_m2_um"] < 0.95)

    def test_none_at_night(self):
        table = rows(irsig("sun", *self.PLACE, "--time", "2025-06-21T00:30:00+09:00", *AIR))
        self.assertTrue(all(r["sun_irradiance_w_m2_um"] == 0 for r in table))


def temperature_k(table, name):
    """Of the black body with the table's radiance."""
    def radiance(of):
        return sum(of(r) * 1e5 / r["wavenumber_cm1"] ** 2 for r in table)
    low, high = 150, 400
    while high - low > 1e-6:
        middle = (low + high) / 2
        if radiance(lambda r: planck(r["lambda_um"], middle)) < radiance(lambda r: r[name]):
            low = middle
        else:
            high = middle
    return low


class Cloud(unittest.TestCase):
    STRATUS = ("--cloud-type", "stratus")
    SUN = ("--sun-zenith-deg", 50, "--sun-azimuth-deg", 20)

    def sky(self, cover, *more):
        return rows(irsig("sky", *AIR, "--altitude-m", 1, "--zenith-deg", "0,70", *self.STRATUS, "--cloud-cover", cover, *more))

    def test_overcast_sky_is_as_warm_as_its_base(self):
        # The base, 330 m, has 292.7 K; the clear zenith has 241.5 K.
        window = ("--lambda-min-um", 8, "--lambda-max-um", 12)
        clear, overcast = ([r for r in self.sky(cover, *window) if r["zenith_deg"] == 0] for cover in (0, 1))
        self.assertAlmostEqual(temperature_k(overcast, "sky_radiance_w_m2_sr_um"), 292.7, delta=0.3)
        self.assertAlmostEqual(temperature_k(clear, "sky_radiance_w_m2_sr_um"), 241.5, delta=1)

    def test_light_is_linear_in_the_cover(self):
        for sun in ((), self.SUN):
            clear, part, overcast = (self.sky(cover, *sun) for cover in (0, 0.3, 1))
            for name in ("transmittance", "thermal_radiance_w_m2_sr_um", "scattered_radiance_w_m2_sr_um",
                         "sky_radiance_w_m2_sr_um"):
                for a, b, c in zip(clear, part, overcast):
                    self.assertAlmostEqual(b[name], 0.7 * a[name] + 0.3 * c[name], delta=1e-9 * abs(b[name]))
            # The sky is one of both.
            error = "model_error_sky_radiance_w_m2_sr_um"
            for a, b, c in zip(clear, part, overcast):
                apart = 0.21 ** 0.5 * abs(c["sky_radiance_w_m2_sr_um"] - a["sky_radiance_w_m2_sr_um"])
                self.assertAlmostEqual(b[error], math.hypot(0.7 * a[error] + 0.3 * c[error], apart), delta=1e-9 * b[error])

    def test_no_cover_changes_nothing(self):
        sun = ("--latitude-deg", 25, "--longitude-deg", 130, "--altitude-m", 0, "--time", "2025-06-21T12:00:00+09:00")
        for arguments in (("sky", *AIR, "--altitude-m", 1, "--zenith-deg", "0,80,100", *self.SUN),
                          ("atmosphere", *AIR, *SEA, "--sun-zenith-deg", 50, "--sun-from-path-deg", 20), ("sun", *AIR, *sun),
                          ("sky", *AIR, "--altitude-m", 1, "--zenith-deg", 0, "--svg")):
            self.assertEqual(irsig(*arguments), irsig(*arguments, *self.STRATUS, "--cloud-cover", 0))

    def test_thin_cloud_is_next_to_clear(self):
        clear, thin = (rows(irsig("sky", *AIR, "--altitude-m", 1, "--zenith-deg", "0,80", *cloud)) for cloud in
                       ((), ("--cloud-type", "cirrus", "--cloud-cover", 1, "--cloud-water-path-g-m2", 1e-9,
                             "--cloud-base-m", 10000, "--cloud-top-m", 10001)))
        for a, b in zip(clear, thin):
            for name in ("sky_radiance_w_m2_sr_um", "transmittance"):
                self.assertAlmostEqual(a[name], b[name], delta=1e-4 * a[name] + 1e-12)

    def test_path_inside_a_cloud(self):
        for height in (("--target-m", 500), ("--level",)):
            path = at(rows(irsig("atmosphere", *AIR, "--observer-m", 500, *height, "--range-m", 1000, *self.STRATUS,
                                 "--cloud-cover", 1)), 955)
            self.assertLess(path["transmittance"], 1e-14)
            self.assertAlmostEqual(temperature_k([path], "path_radiance_w_m2_sr_um"), 291.9, delta=1)
        # Below its base a path is next to that in clear air.
        clear, below = (at(rows(irsig("atmosphere", *AIR, *SEA, *cloud)), 955) for cloud in
                        ((), (*self.STRATUS, "--cloud-cover", 1)))
        self.assertAlmostEqual(below["transmittance"], clear["transmittance"], delta=1e-6)
        self.assertGreater(below["scattered_radiance_w_m2_sr_um"], clear["scattered_radiance_w_m2_sr_um"])

    def test_sunlight(self):
        noon = ("sun", *AIR, "--latitude-deg", 25, "--longitude-deg", 130, "--altitude-m", 0, "--time",
                "2025-06-21T12:00:00+09:00")
        clear, half, overcast, cirrus = (
            at(rows(irsig(*noon, *cloud)), 2605)["sun_irradiance_w_m2_um"] for cloud in
            ((), (*self.STRATUS, "--cloud-cover", 0.5), (*self.STRATUS, "--cloud-cover", 1),
             ("--cloud-type", "cirrus", "--cloud-cover", 1)))
        self.assertLess(overcast, 0.01 * clear)
        self.assertAlmostEqual(half, 0.5 * clear + 0.5 * overcast, delta=1e-9 * half)
        self.assertTrue(0.3 * clear < cirrus < 0.95 * clear)

    def test_cloud_of_a_sweep(self):
        winter = 'name = "winter"\n'
        text = (EXAMPLES / "frigate.toml").read_text()
        self.assertEqual(text.count(winter), 1)
        with tempfile.TemporaryDirectory() as folder:
            def sky(cloud):
                file = pathlib.Path(folder) / "cloud.toml"
                file.write_text(text.replace(winter, winter + cloud))
                return [r for r in rows(irsig("sky", "--sweep-file", file, "--season", "winter", "--altitude-m", 2, "--zenith-deg", 0))
                        if 8 <= r["lambda_um"] <= 12]
            clear = sky("")
            half, overcast = (sky(f'cloud_type = "stratus"\ncloud_cover = {c}\n') for c in (0.5, 1))
            name = "sky_radiance_w_m2_sr_um"
            self.assertGreater(temperature_k(overcast, name), temperature_k(clear, name) + 20)
            for a, b, c in zip(clear, half, overcast):
                self.assertAlmostEqual(b[name], 0.5 * (a[name] + c[name]), delta=1e-9 * b[name])
            gas = subprocess.run([IRSIG, "show", "gas", "--temperature-k", "650", "--co2", "0.07", "--range-m", "1000",
                                  "--sweep-file", "cloud.toml", "--season", "winter"], cwd=folder, capture_output=True, text=True,
                                 timeout=300)
            self.assertEqual(gas.returncode, 0)
            self.assertIn("hot gas is seen through clear air; the cloud of cloud.toml, winter, stratus cover 1 is left out",
                          gas.stderr)

    def test_stored_rows_have_it(self):
        with tempfile.TemporaryDirectory() as folder:
            def run(*arguments):
                done = subprocess.run([IRSIG, *arguments], cwd=folder, capture_output=True, text=True, timeout=300)
                self.assertEqual(done.returncode, 0, done.stderr)
                return done.stdout
            run("model", "frigate", "--triangles", "2000", "--out", "ship.obj")
            run("init", "--model", "ship.obj", "--place", "54.3,10.1", "--out", "ship.toml")
            sweep = pathlib.Path(folder) / "ship.toml"
            text = sweep.read_text().replace("count = 12", "count = 1").replace("step_um = 0.1", "step_um = 0.11")
            sweep.write_text(text + '\n[[season.cloud]]\ntype = "stratus"\ncover = 0.5\n')
            run("run", "ship.toml", "--db", "ship.sigdb", "--relative-error", "0.1")
            self.assertIn("\ncloud: stratus covers 0.5 of the sky, 330 to 1000 m above the surface, 200 g/m2 of water",
                          run("explain", "ship.sigdb", "--row", "1"))
            for chosen in (("--row", "2"), ("--season", "summer", "--band", "lwir")):
                run("plot", "ship.sigdb", "--kind", "sky", *chosen, "--pixels", "64", "--out", "sky.svg")
                words = " ".join(xml.etree.ElementTree.parse(pathlib.Path(folder) / "sky.svg").getroot().itertext())
                for expected in ("Sky of ship, summer", "lwir (8 to 12", "stratus cover 0.5", "Apparent temperature in K", "+ sun"):
                    self.assertIn(expected, words)

    def test_errors(self):
        sky = ("sky", *AIR, "--altitude-m", 1, "--zenith-deg", 0)
        for arguments, expected in (
                (("--cloud-type", "stratus"), "--cloud-cover is missing"),
                (("--cloud-cover", 1), '--cloud-type is missing, expected a type ("stratus", "cumulus", "cirrus" ...), or all of '
                                         'the layer: also --cloud-base-m, --cloud-top-m'),
                ((*self.STRATUS, "--cloud-cover", 80), "--cloud-cover = 80, expected a number from 0 to 1"),
                (("--cloud-type", "stratos", "--cloud-cover", 1), '--cloud-type = "stratos": did you mean "stratus"?'),
                ((*self.STRATUS, "--cloud-cover", 1, "--cloud-base-m", 900, "--cloud-top-m", 200),
                 "--cloud-top-m: the layer's top, 200 m, is below its base, 900 m; expected --cloud-top-m of at least 901 m"),
                (("--cloud-type", "cirrus", "--cloud-cover", 1, "--cloud-effective-radius-um", 5),
                 "outside the table of ice crystals")):
            with self.subTest(expected=expected):
                self.assertIn(expected, irsig(*sky, *arguments, exit_code=2))
        self.assertIn("--cloud-cover contradicts --sweep-file", irsig(
            "sky", "--sweep-file", EXAMPLES / "frigate.toml", "--season", "winter", "--altitude-m", 1, "--zenith-deg", 0,
            "--cloud-cover", 1, exit_code=2))


class Sweep(unittest.TestCase):
    """The seasons of frigate.toml, whose air is the embedded atmosphere."""

    FRIGATE = ("--sweep-file", EXAMPLES / "frigate.toml")

    def test_seasons_differ(self):
        winter, summer = (at(rows(irsig("atmosphere", *self.FRIGATE, "--season", season, *SEA)), 905)
                          for season in ("winter", "summer"))
        self.assertGreater(winter["transmittance"], summer["transmittance"] + 0.05)

    def test_sun_of_its_place_and_time(self):
        sun = at(rows(irsig("sun", *self.FRIGATE, "--season", "winter")), 2555)
        self.assertTrue(50 < sun["sun_zenith_deg"] < 60)
        evening = at(rows(irsig("sun", *self.FRIGATE, "--season", "winter", "--time", "2025-12-21T17:00:00+09:00")), 2555)
        self.assertGreater(evening["sun_zenith_deg"], 80)

    def test_errors(self):
        for arguments, expected in (
                (("atmosphere", *self.FRIGATE, *SEA), "--season is missing, expected one of winter | "),
                (("atmosphere", *self.FRIGATE, "--season", "monsoon", *SEA), "--season monsoon: expected one of winter"),
                (("atmosphere", *self.FRIGATE, "--season", "winter", "--co2-ppmv", 400, *SEA),
                 "--co2-ppmv contradicts --sweep-file"),
                (("atmosphere", *AIR, "--season", "winter", *SEA), "--season belongs to --sweep-file"),
                (("atmosphere", "--sweep-file", EXAMPLES / "disk.toml", *SEA), 'expected "atmosphere"')):
            with self.subTest(expected=expected):
                self.assertIn(expected, irsig(*arguments, exit_code=2))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
