"""Land in sweeps, at the front door: made-up terrain with an inset and five materials, and what is refused.

usage: land_test.py <irsig>
"""
import json, pathlib, re, sqlite3, struct, subprocess, sys, tempfile, unittest

IRSIG = pathlib.Path(sys.argv[1]).resolve()
LAYERS = {"asphalt": "asphalt", "bare_soil": "bare_soil_dry", "grass": "grass", "water": "sea_water", "wheat": "wheat"}

SWEEP = """time = ["12:00Z"]
[model]
generate = "box"
triangles = 100
[place]
latitude_deg = 48
longitude_deg = 11
height_m = 0
heading_deg = 90
[[part]]
name = "box"
material = "generic_grey_paint"
temperature_k = 300
[[season]]
name = "summer"
date = 2025-06-21
land_temperature_k = { asphalt = 310 }
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 1
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 0, elevation_deg = 20 } ]
[surroundings]
kind = "ground"
ground_temperature_k = 290
ground_emissivity = 0.95
[air]
model = "atmosphere"
aerosol = "none"
[transport]
sun = false
max_reflections = 1
[accuracy]
relative_error = 0.1
[output]
thumbnail_px = 0
[land]
heights = "maps/heights.asc"
"""


def asc(rows, west, south, step):
    """An ESRI ASCII grid of samples [row from the north][column] whose southwest one is at (west, south)."""
    return (f"ncols {len(rows[0])}\nnrows {len(rows)}\nxllcenter {west!r}\nyllcenter {south!r}\ncellsize {step!r}\n"
            "nodata_value -99999\n" + "".join(" ".join(map(repr, row)) + "\n" for row in rows))


def geotiff(rows, west, south, step):
    """The same as a GeoTIFF in degrees (EPSG 4326), of float32 in one strip, whose samples are points."""
    width, height = len(rows[0]), len(rows)
    pixels = b"".join(struct.pack(f"<{width}f", *row) for row in rows)
    north = south + step * (height - 1)
    keys = (1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 2, 2048, 0, 1, 4326)
    tags = [(256, "I", (width,)), (257, "I", (height,)), (258, "H", (32,)), (259, "H", (1,)), (262, "H", (1,)),
            (273, "I", (8,)), (277, "H", (1,)), (278, "I", (height,)), (279, "I", (len(pixels),)), (339, "H", (3,)),
            (33550, "d", (step, step, 0)), (33922, "d", (0, 0, 0, west, north, 0)), (34735, "H", keys)]
    directory = 8 + len(pixels)
    behind = directory + 2 + 12 * len(tags) + 4
    entries = extra = b""
    for tag, kind, values in tags:
        data = struct.pack(f"<{len(values)}{kind}", *values)
        if len(data) > 4:
            data, extra = struct.pack("<I", behind + len(extra)), extra + data
        entries += struct.pack("<HHI", tag, {"H": 3, "I": 4, "d": 12}[kind], len(values)) + data.ljust(4, b"\0")
    return (struct.pack("<2sHI", b"II", 42, directory) + pixels + struct.pack("<H", len(tags)) + entries +
            struct.pack("<I", 0) + extra)


def materials(*without_file):
    text = ""
    for layer, material in LAYERS.items():
        text += f'[[land.material]]\nmaterial = "{material}"\ntemperature_k = 295\n'
        if layer not in without_file:
            text += f'fraction_file = "maps/{layer}.asc"\n'
    return text


class Land(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = pathlib.Path(cls.folder.name)
        (cls.path / "maps").mkdir()
        for layer in ("heights", *LAYERS):
            cls.terrain(f"maps/{layer}.asc", "--map-layer", layer, "--width-m", "2000", "--spacing-m", "20")
        cls.terrain("maps/inset.asc", "--map-layer", "heights", "--width-m", "500", "--spacing-m", "5")

    @classmethod
    def terrain(cls, out, *options):
        subprocess.run([IRSIG, "model", "terrain", "--seed", "1", *options, "-o", out], cwd=cls.path, check=True,
                       capture_output=True)

    def irsig(self, *arguments, text, exit_code=0):
        (self.path / "s.toml").write_text(text)
        done = subprocess.run([IRSIG, *arguments], cwd=self.path, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, exit_code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done.stderr

    def refused(self, text, *expected):
        errors = self.irsig("plan", "s.toml", text=text, exit_code=2)
        for line in expected:
            self.assertIn(line, errors)

    def line(self, text, key):
        return text[:re.search(key, text).start()].count("\n") + 1

    def test_a_view_with_an_inset_and_five_materials(self):
        said = self.irsig("run", "s.toml", "--db", "land.db", "--workers", "1",
                          text=SWEEP + 'inset = "maps/inset.asc"\n' + materials("wheat"))
        self.assertNotIn("warning", said)
        with sqlite3.connect(self.path / "land.db") as database:
            # The sweep, its three kinds of maps (heights, inset, four fractions); no name of a folder.
            assets = [bytes(row[0]) for row in database.execute("SELECT bytes FROM asset")]
        for name in ("heights", "inset", "asphalt", "bare_soil", "grass", "water"):
            self.assertIn((self.path / f"maps/{name}.asc").read_bytes(), assets, name)
        self.assertFalse(any(b"maps/" in asset for asset in assets))

    def test_objects_are_computed_stored_and_seen(self):
        cube = [(x, y, z) for z in (0, 2) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        faces = ((4, 3, 2, 1), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8))
        (self.path / "cube.obj").write_text("".join("v %g %g %g\n" % p for p in cube) + "o cube\n" +
                                            "".join("f %d %d %d %d\n" % f for f in faces))
        (self.path / "places.csv").write_text("east_m,north_m,scale\n-40,2,10\n-30,-40,8\n")
        table = """[[land.material]]
material = "brick"
objects_only = true
temperature_k = 400
[[land.object]]
model = "cube.obj"
unit_m = 1
forward_axis = "+x"
up_axis = "+z"
material = "brick"
"""
        by_file = SWEEP + materials("wheat") + table + 'places_file = "places.csv"\n'
        by_hand = SWEEP + materials("wheat") + table + (
            "place = [{ east_m = -40, north_m = 2, scale = 10 }, { east_m = -30, north_m = -40, scale = 8 }]\n")
        rows = {}
        for name, text in (("bare", SWEEP + materials("wheat")), ("file", by_file), ("hand", by_hand)):
            self.irsig("run", "s.toml", "--db", f"{name}.db", "--workers", "1", text=text)
            with sqlite3.connect(self.path / f"{name}.db") as database:
                rows[name] = database.execute(
                    "SELECT intensity_w_sr, contrast_intensity_w_sr FROM signature").fetchall()
                assets = [bytes(row[0]) for row in database.execute("SELECT bytes FROM asset")]
                self.assertEqual((self.path / "cube.obj").read_bytes() in assets, name != "bare")
                self.assertEqual((self.path / "places.csv").read_bytes() in assets, name == "file")
        # How places are stated does not matter. Hot walls shine on the lid of the target.
        self.assertEqual(rows["file"], rows["hand"])
        self.assertGreater(rows["file"][0][0], rows["bare"][0][0])
        self.irsig("plot", "file.db", "--kind", "land", "--out", "objects.svg", text=by_file)
        self.assertIn("brick", (self.path / "objects.svg").read_text())

    def test_a_geotiff_is_the_map_that_it_holds(self):
        count, step = 41, 1 / 2048
        place = (11 - 20 * step, 48 - 20 * step, step)
        heights = [[0.25 * ((3 * i * i + 5 * j) % 16) for i in range(count)] for j in range(count)]
        grass = [[(0.0, 0.25, 1.0)[(i // 3 + j // 5) % 3] for i in range(count)] for j in range(count)]
        sweep = SWEEP.replace("land_temperature_k = { asphalt = 310 }\n", "")
        rows, said = {}, {}
        for ending, epsg, write in (("asc", "4326", lambda *m: asc(*m).encode()), ("tif", None, geotiff)):
            for name, samples in (("heights", heights), ("turf", grass)):
                (self.path / f"maps/degrees_{name}.{ending}").write_bytes(write(samples, *place))
            text = sweep.replace("maps/heights.asc", f"maps/degrees_heights.{ending}")
            text += f"epsg = {epsg}\n" if epsg else ""
            text += f'[[land.material]]\nmaterial = "grass"\ntemperature_k = 290\nfraction_file = "maps/degrees_turf.{ending}"\n'
            text += f"fraction_epsg = {epsg}\n" if epsg else ""
            text += '[[land.material]]\nmaterial = "wheat"\ntemperature_k = 305\n'
            said[ending] = self.irsig("run", "s.toml", "--db", f"{ending}.db", "--workers", "1", text=text)
            with sqlite3.connect(self.path / f"{ending}.db") as database:
                rows[ending] = database.execute("SELECT intensity_w_sr, contrast_intensity_w_sr, clutter_sigma_w_m2_sr"
                                                " FROM signature").fetchall()
        # Files are part of the seed: the same land seen with other random numbers.
        for a, b in zip(rows["asc"][0], rows["tif"][0]):
            self.assertAlmostEqual(a, b, delta=0.05 * abs(a))
        self.assertGreater(rows["tif"][0][2], 0)
        broken = geotiff(heights, *place)[:-40]
        (self.path / "maps/degrees_heights.tif").write_bytes(broken)
        errors = self.irsig("plan", "s.toml", text=text, exit_code=2)
        self.assertIn("s.toml:", errors)
        self.assertIn("degrees_heights.tif", errors)

    STATED = '[[land.material]]\nmaterial = "grass"\ntemperature_k = %g\n'
    EMISSIVITY = '[[material]]\nname = "turf"\nkind = "lambert"\nemissivity = %g\n'
    TURF = '[[land.material]]\nmaterial = "turf"\ntemperature_k = 310\n'
    COMPUTED = '[[land.material]]\nmaterial = "grass"\n[heat]\n'

    def row(self, name, text):
        """Contrast and apparent intensity of the first row, their errors, and what inputs contribute to them."""
        self.irsig("run", "s.toml", "--db", f"{name}.db", "--workers", "1", text=text)
        done = subprocess.run([IRSIG, "explain", f"{name}.db", "--row", "1", "--format", "json"], cwd=self.path,
                              capture_output=True, text=True, check=True)
        with sqlite3.connect(self.path / f"{name}.db") as database:
            database.row_factory = sqlite3.Row
            row = dict(database.execute("SELECT * FROM signature").fetchone())
        return row, {i["input"]: i for i in json.loads(done.stdout).get("inputs") or []}

    def assert_contributes(self, contribution, nominal, moved):
        """The contributions of an input to a row are the differences to the row that states it as moved."""
        for of in ("apparent_", "contrast_"):
            difference = moved[f"{of}intensity_w_sr"] - nominal[f"{of}intensity_w_sr"]
            error = sum(row[f"{of}intensity_stderr_w_sr"] for row in (nominal, moved))
            self.assertAlmostEqual(contribution[f"{of}contribution_w_sr"], difference,
                                   delta=3 * error + 0.02 * abs(difference), msg=of)
        return moved["contrast_intensity_w_sr"] - nominal["contrast_intensity_w_sr"]

    def test_uncertain_inputs_of_stated_land_reach_the_contrast(self):
        sweep = SWEEP.replace("land_temperature_k = { asphalt = 310 }\n", "").replace("= 0.1\n", "= 0.01\n")
        nominal, inputs = self.row("stated", sweep + self.STATED % 295 + "[uncertainty]\nland_temperature_k = 2\n")
        moved, _ = self.row("warmer", sweep + self.STATED % 297)
        change = self.assert_contributes(inputs["land_temperature_k"], nominal, moved)
        # Warmer land behind the target takes contrast away: 3 % of a background as bright as the target.
        self.assertLess(change, -0.02 * nominal["apparent_intensity_w_sr"])
        self.assertGreaterEqual(nominal["contrast_input_uncertainty_w_sr"], 0.99 * abs(
            inputs["land_temperature_k"]["contrast_contribution_w_sr"]))

        text = sweep + self.EMISSIVITY % 0.85 + self.TURF
        nominal, inputs = self.row("turf", text + "[uncertainty]\nland_emissivity = 0.1\n")
        moved, _ = self.row("blacker", sweep + self.EMISSIVITY % 0.95 + self.TURF)
        change = self.assert_contributes(inputs["land_emissivity"], nominal, moved)
        self.assertLess(change, -0.02 * nominal["apparent_intensity_w_sr"])

    def test_uncertain_inputs_of_computed_land_reach_the_contrast(self):
        def sweep(soil=0.8, weather=298):
            text = SWEEP.replace("land_temperature_k = { asphalt = 310 }", "day = { air_temperature_min_k = %g, "
                                 "air_temperature_max_k = %g, dew_point_k = 280 }" % (weather - 10, weather))
            text = text.replace("[transport]\n", "[weather]\npressure_pa = 101300\nwind_speed_m_s = 3\n"
                                "wind_from_deg = 270\n[transport]\n").replace("= 0.1\n", "= 0.01\n")
            text = text.replace("sun = false", "sun = true").replace("ground_emissivity", "solar_albedo = 0.2\n"
                                                                     "ground_emissivity")
            for name, share in (("grass", soil), ("generic_grey_paint", 0.5)):
                text += f'[[material]]\nname = "{name}"\nkind = "library"\nsolar_absorptance = {share}\n'
            return text + self.COMPUTED
        uncertain = "model_error = true\n[uncertainty]\nland_solar_absorptance = 0.1\nair_temperature_k = 1\n"
        nominal, inputs = self.row("computed", sweep() + uncertain)
        for name, moved in (("land_solar_absorptance", sweep(soil=0.9)), ("air_temperature_k", sweep(weather=299))):
            change = self.assert_contributes(inputs[name], nominal, self.row(name, moved)[0])
            self.assertLess(change, -0.005 * nominal["apparent_intensity_w_sr"], name)
        # 30 % of convection moves sunlit grass by about a kelvin; the box has a stated temperature.
        error = nominal["contrast_heat_model_error_w_sr"]
        self.assertTrue(0.005 < error / nominal["apparent_intensity_w_sr"] < 0.1, error)
        self.assertLess(nominal["heat_model_error_w_sr"], 0.2 * error)

    def test_an_input_of_land_that_the_sweep_lacks_is_refused(self):
        text = SWEEP.replace("land_temperature_k = { asphalt = 310 }\n", "") + self.STATED % 295
        for key in ("land_solar_absorptance", "land_conductivity_relative"):
            self.refused(text + f"[uncertainty]\n{key} = 0.1\n", f"uncertainty.{key} changes nothing", "[heat]")

    def test_what_is_wrong_with_objects_is_said_at_its_key(self):
        (self.path / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\no leaf\nf 1 2 3\n")
        (self.path / "wrong.csv").write_text("east_m,north_m\n1,2\n1,x\n")
        table = """[[land.object]]
model = "one.obj"
unit_m = 1
forward_axis = "+x"
up_axis = "+z"
"""
        text = SWEEP + materials("wheat") + table
        line = self.line(text, r"\[\[land.object\]\]")
        grass, near = 'material = "grass"\n', "place = [{ east_m = 20, north_m = 0 }]\n"
        self.refused(text.replace("one.obj", "none.obj") + grass + near,
                     f's.toml:{line + 1}:1: land.object[0].model = "none.obj": ')
        self.refused(text + 'material = "gras"\n' + near,
                     f's.toml:{line + 5}:1: land.object[0].material = "gras" is no [[land.material]], did you mean '
                     '"grass"?')
        self.refused(text + grass + 'places_file = "wrong.csv"\n',
                     f's.toml:{line + 6}:1: land.object[0].places_file: wrong.csv:3:3: north_m = "x", expected a number')
        self.refused(text + grass + "place = [{ east_m = 20000, north_m = 0 }]\n",
                     f"s.toml:{line + 6}:10: land.object[0].place[0]: the object at east_m = 20000, north_m = 0 stands "
                     "beyond the map of heights; move it, or use a larger map")

    def test_a_picture_of_a_database_and_of_a_sweep_file(self):
        text = SWEEP + materials("wheat")
        self.irsig("run", "s.toml", "--db", "picture.db", "--workers", "1", text=text)
        for source, out in (("picture.db", "a.svg"), ("s.toml", "b.svg")):
            self.irsig("plot", source, "--kind", "land", "--pixels", "100", "--out", out, text=text)
        svg = (self.path / "a.svg").read_text()
        self.assertEqual(svg, (self.path / "b.svg").read_text())
        for expected in (*LAYERS.values(), "East of the target in m", "m above the ellipsoid", "image/png"):
            self.assertIn(expected, svg)
        flat = SWEEP[:SWEEP.index("[land]")].replace("land_temperature_k = { asphalt = 310 }\n", "")
        errors = self.irsig("plot", "s.toml", "--kind", "land", "--out", "c.svg", text=flat, exit_code=2)
        self.assertIn("the sweep has no [land]", errors)

    def test_a_map_of_heights_is_checked(self):
        def checked(*arguments, exit_code=0):
            done = subprocess.run([IRSIG, "model", "check", *arguments], cwd=self.path, capture_output=True, text=True)
            self.assertEqual(done.returncode, exit_code, done.stderr)
            return done.stdout
        self.assertIn("nothing found", checked("maps/heights.asc"))
        # Row 3, column 2 is missing, row 2, column 3 stands alone, and heights are those of an airliner's path.
        rows = [[10000] * 5 for _ in range(4)]
        rows[2][1], rows[1][2] = -9, 12000
        (self.path / "odd.asc").write_text("ncols 5\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 20\nnodata_value -9\n"
                                           + "\n".join(" ".join(map(str, row)) for row in rows) + "\n")
        text = checked("odd.asc", exit_code=2)
        for line in ("5 x 4 samples, about 20 m apart, heights 10000 to 12000 m",
                     "error   missing heights: 1, the first in row 3, column 2",
                     "error   heights beyond all land (-440 to 8849 m); multiply them by 0.3048",
                     "warning spikes: 1, the first in row 2, column 3, with 12000 m"):
            self.assertIn(line, text)
        report = json.loads(checked("odd.asc", "--format", "json", exit_code=2))
        self.assertEqual(report["spikes"], {"count": 1, "first_row": 2, "first_column": 3})

    def test_one_material_without_a_map(self):
        self.irsig("plan", "s.toml", text=SWEEP + '[[land.material]]\nmaterial = "asphalt"\n')

    def test_a_place_of_another_height_is_a_warning(self):
        text = SWEEP.replace("height_m = 0\n", "height_m = 20\n") + materials("wheat")
        said = self.irsig("plan", "s.toml", text=text)
        self.assertRegex(said, r"s.toml:8:1: warning: place.height_m = 20.0, but the map's height at the target is "
                         r"-?\d.\d m above the ellipsoid: air and sky are those of 20.0 m; write height_m = ")

    def test_a_view_past_the_edge_of_the_map_is_a_warning(self):
        aspects = "aspect = [ { azimuth_deg = 0, elevation_deg = 60 }, { azimuth_deg = 30, elevation_deg = 2 } ]"
        text = SWEEP.replace("aspect = [ { azimuth_deg = 0, elevation_deg = 20 } ]", aspects) + materials()
        text = text.replace("height_m = 0\n", "height_m = 0\nabove_surface_m = 300\n")
        said = self.irsig("plan", "s.toml", text=text)
        self.assertRegex(said, r"s.toml:\d+:1: warning: 1 of 2 viewpoints look past the edge of the map, where the ground of "
                         r"\[surroundings\] goes on: that of azimuth 30, elevation 2 deg leaves it \d+ m behind the target; "
                         "use a map that reaches farther")
        self.assertNotIn("past the edge", self.irsig("plan", "s.toml", text=SWEEP + materials()))

    def test_a_cliff_at_the_edge_is_refused_where_it_is_seen_and_fades(self):
        aspect = "aspect = [ { azimuth_deg = 30, elevation_deg = 1 } ]"
        low = SWEEP.replace("aspect = [ { azimuth_deg = 0, elevation_deg = 20 } ]", aspect)
        low = low.replace("height_m = 0\n", "height_m = 0\nabove_surface_m = 100\n")
        said = self.irsig("plan", "s.toml", text=low + materials(), exit_code=2)
        self.assertRegex(said, r"s.toml:\d+:1: land.heights: 1 of 1 viewpoints see a cliff at the edge of the map: from azimuth "
                         r"30, elevation 1 deg, range 1000 m, the land ends \d+.\d m (above|below) the ground beyond, which .*; "
                         "use a map that reaches farther, or state land.edge_fade_m, a width over which")
        faded = low.replace('heights = "maps/heights.asc"\n', 'heights = "maps/heights.asc"\nedge_fade_m = 300\n')
        self.assertNotIn("cliff", self.irsig("plan", "s.toml", text=faded + materials()))
        wide = faded.replace("edge_fade_m = 300", "edge_fade_m = 99000")
        said = self.irsig("plan", "s.toml", text=wide + materials(), exit_code=2)
        self.assertRegex(said, r"s.toml:\d+:1: land.edge_fade_m: a fade over 99000 m reaches the target")

    def test_errors_have_a_place_and_a_remedy(self):
        all_files = SWEEP + materials()
        (self.path / "maps/half.asc").write_text((self.path / "maps/wheat.asc").read_text().replace(" 1 ", " 0.5 "))
        half = all_files.replace("maps/wheat.asc", "maps/half.asc")
        self.refused(half, f"s.toml:{self.line(half, 'fraction_file')}:1: land.material[0].fraction_file: the fractions "
                     "of all materials at row ", "expected 1 within 1/64; correct the maps, or leave out the file of one")
        self.irsig("plan", "s.toml", text=half.replace('fraction_file = "maps/half.asc"\n', ""))
        self.refused(all_files.replace("heights.asc", "hills.asc"),
                     f"s.toml:{self.line(SWEEP, 'heights =')}:1: land.heights = \"maps/hills.asc\": ")
        (self.path / "maps/words.asc").write_text("ncols 3\nnrows x\n")
        self.refused(all_files.replace("heights.asc", "words.asc"), f"s.toml:{self.line(SWEEP, 'heights =')}:1: "
                     "land.heights: words.asc:2:7: nrows needs a finite number")
        self.refused(all_files.replace("maps/heights.asc\"", "maps/heights.asc\"\nepsg = 32632"),
                     "land.heights: the map does not contain the target's place (latitude 48, longitude 11)",
                     "correct [place], or the coordinates' EPSG code, or use another map")
        self.refused(all_files.replace("heights.asc\"", "heights.asc\"\nwidth_m = 5000"),
                     "the map does not cover a square of 5000 m around the target")
        (self.path / "maps/broken.tif").write_bytes(b"II*\0" + bytes(20))
        self.refused(all_files.replace("heights.asc", "broken.tif"), "land.heights: broken.tif: ")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
