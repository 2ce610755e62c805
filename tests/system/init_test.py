"""From a mesh to a result: the sweep file that `irsig init` writes, and where the target floats.

usage: init_test.py <irsig>
"""
import json, math, pathlib, re, sqlite3, struct, subprocess, sys, tempfile, unittest

IRSIG = pathlib.Path(sys.argv[1]).resolve()
SOURCE = pathlib.Path(__file__).resolve().parents[2]
LENGTH, BEAM, DEPTH = 150, 18, 12


def hull(groups_of_deck=58):
    """A closed hull with its keel at z = 0, of two flanks, a deck of many groups and a funnel above it."""
    stations = 58
    vertices, groups = [], {}

    def half_width(x, z):
        return BEAM / 2 * max(1 - (2 * x / LENGTH) ** 4, 0) * (z / DEPTH)

    index = {}
    for side in (-1, 1):
        for i in range(stations + 1):
            for z in (0, DEPTH / 2, DEPTH):
                x = -LENGTH / 2 + LENGTH * i / stations
                index[side, i, z] = len(vertices) + 1
                vertices.append((x, side * half_width(x, z), z))
    for i in range(stations):
        for side in (-1, 1):
            for low, high in ((0, DEPTH / 2), (DEPTH / 2, DEPTH)):
                quad = [index[side, i, low], index[side, i + 1, low], index[side, i + 1, high], index[side, i, high]]
                groups.setdefault("port" if side > 0 else "starboard", []).append(quad if side < 0 else quad[::-1])
        groups.setdefault(f"deck{i % groups_of_deck}", []).append(
            [index[-1, i, DEPTH], index[-1, i + 1, DEPTH], index[1, i + 1, DEPTH], index[1, i, DEPTH]])
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    for name, quads in groups.items():
        lines.append(f"o {name}")
        lines += ["f " + " ".join(map(str, quad)) for quad in quads]
    return "\n".join(lines) + "\n"


def one_view(text):
    """The sweep file with one viewpoint: a pilot of more takes ten seconds."""
    for many, one in (("elevation_deg = [5, 30]", "elevation_deg = [5]"), ("count = 12", "count = 1")):
        assert many in text, many
        text = text.replace(many, one)
    return text


class Init(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        (self.path / "ship.obj").write_text(hull())

    def tearDown(self):
        self.folder.cleanup()

    def irsig(self, *arguments, exit_code=0):
        done = subprocess.run([IRSIG, *map(str, arguments)], cwd=self.path, capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, exit_code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def area_m2(self, text, name):
        """Projected area from starboard at half a degree."""
        text = text.replace("elevation_deg = [5, 30]", "elevation_deg = [0.5]").replace("count = 12", "count = 4")
        (self.path / f"{name}.toml").write_text(text)
        said = self.irsig("run", f"{name}.toml", "--db", f"{name}.sigdb")
        db = sqlite3.connect(self.path / f"{name}.sigdb")
        rows = db.execute("SELECT projected_area_m2 FROM signature_view WHERE abs(aspect_azimuth_deg - 90) < 1").fetchall()
        db.close()
        return rows[0][0], said

    def test_the_file_runs_as_it_is(self):
        said = self.irsig("init", "--model", "ship.obj", "--place", "54.3,10.1")
        self.assertIn("stands on the sea with its lowest point at the waterline: draft_m", said)
        text = (self.path / "ship.toml").read_text()
        self.assertIn("The model has 60 groups", text)
        self.assertIn("rest = true", text)
        keel, said = self.area_m2(text, "keel")
        self.assertIn("draft_m", said)
        floating, said = self.area_m2(text.replace("# draft_m = 5 ", "draft_m = 5.5 "), "floating")
        self.assertNotIn("warning: model", said)
        # Seen from the side: a rectangle, of which the draft is under water.
        self.assertAlmostEqual(keel / (LENGTH * DEPTH), 1, delta=0.03)
        self.assertAlmostEqual(floating / (LENGTH * (DEPTH - 5.5)), 1, delta=0.05)
        # Moved up again by as much.
        moved, _ = self.area_m2(text.replace("# draft_m = 5 ", "draft_m = 5.5\noffset_m = [0, 0, 5.5]  "), "moved")
        self.assertAlmostEqual(moved / keel, 1, delta=1e-3)

    def test_parts_by_group(self):
        (self.path / "two.obj").write_text(hull(1))
        self.irsig("init", "--model", "two.obj", "--season", "winter", "--out", "two.toml")
        text = (self.path / "two.toml").read_text()
        for name in ("port", "starboard", "deck0"):
            self.assertIn(f'name = "{name}"', text)
        self.assertNotIn("rest = true", text)
        # One of them by name, the others as the rest.
        rest = text[:text.index("[[part]]")] + ('[[part]]\nname = "deck"\nmatch = ["deck*"]\nmaterial = "aluminium"\n'
                                                'temperature_k = 300\n[[part]]\nname = "flanks"\nrest = true\n'
                                                'material = "generic_grey_paint"\ntemperature_k = 290\n\n'
                                                ) + text[text.index("[[season]]"):]
        (self.path / "rest.toml").write_text(one_view(rest))
        self.irsig("plan", "rest.toml")

    def test_a_year_of_weather(self):
        """A season for each month, temperatures from the weather, and a guess for what is hot by its name."""
        (self.path / "two.obj").write_text(hull(1).replace("o deck0", "o funnel"))
        year = ("--weather", SOURCE / "jobs/examples/weather/denver_year.epw")
        self.irsig("init", "--model", "two.obj", *year, "--months", "1,7", "--hours", "0,12", "--surroundings", "ground")
        text = (self.path / "two.toml").read_text()
        for line in ('time = ["00:00-07:00", "12:00-07:00"]', "latitude_deg = 39.83", "longitude_deg = -104.65", "height_m = 1650",
                     'name = "january"', 'name = "july"', "[heat]"):
            self.assertIn(line, text)
        self.assertEqual(text.count("[[season]]"), 2)
        self.assertRegex(text, r'name = "funnel"\nmaterial = .*\ntemperature_k = 400 .*hot by its name: a guess, check it')
        self.assertEqual(text.count("temperature_k = 400"), 1)
        (self.path / "two.toml").write_text(one_view(text))
        self.irsig("run", "two.toml", "--db", "two.sigdb", "--relative-error", "0.1")
        db = sqlite3.connect(self.path / "two.sigdb")
        warm = dict(db.execute("SELECT season || substr(time_utc, 12, 2), mean_k FROM computed_temperature_view WHERE part = 'port'"))
        db.close()
        self.assertEqual(set(warm), {"january07", "january19", "july07", "july19"})
        self.assertGreater(warm["july19"], warm["july07"] + 5)
        self.assertGreater(warm["july07"], warm["january07"] + 5)
        # All months, and places and hours of one's own.
        self.irsig("init", "--model", "two.obj", *year, "--place", "39.9,-104.7", "--out", "all.toml", "--surroundings", "ground")
        text = (self.path / "all.toml").read_text()
        self.assertEqual(text.count("[[season]]"), 12)
        self.assertIn("latitude_deg = 39.9\n", text)
        for arguments, said in ((("--months", "1"), "--months: expected --weather FILE beside it"),
                                (("--months", "0-3", *year), "--months 0-3: expected numbers from 1 to 12"),
                                (("--hours", "24"), "--hours 24: expected numbers from 0 to 23"),
                                (("--weather", "none.epw"), "--weather none.epw: No such file"),
                                (("--weather", "two.obj"), "two.obj")):
            self.assertIn(said, self.irsig("init", "--model", "two.obj", "--force", *arguments, exit_code=2), arguments)

    def glb(self, name, text):
        """A box 4.8 m along x, 2.6 m along y and 2.8 m along z, on y = 0, in the glTF container."""
        corners = [(x, y, z) for x in (-2.4, 2.4) for y in (0, 2.6) for z in (-1.4, 1.4)]
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        buffer = b"".join(struct.pack("<3f", *c) for c in corners)
        buffer += b"".join(struct.pack("<6H", a, b, c, a, c, d) for a, b, c, d in quads)
        text = text.encode().replace(b" ", b"")
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I", len(text)) + b"JSON" + text + struct.pack("<I", len(buffer)) + b"BIN\0" + buffer
        (self.path / name).write_bytes(b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks)

    def test_what_a_format_states_is_the_default(self):
        self.glb("van.glb", """{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, "name": "van"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "buffers": [{"byteLength": 168}],
            "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]}""")
        self.irsig("init", "--model", "van.glb", "--surroundings", "ground")
        text = (self.path / "van.toml").read_text()
        self.assertIn('forward_axis = "+z"          # the file\'s axis that points to the bow: from the glTF 2.0', text)
        self.assertIn('up_axis = "+y"', text)
        # A sweep file may leave to the format what the format states.
        for key in ("unit_m", "forward_axis", "up_axis"):
            text = re.sub(rf"(?m)^{key} = .*\n", "", text, count=1)
        checked = json.loads(self.irsig("model", "check", "van.glb", "--json"))
        self.assertEqual((checked["frame"]["unit_m"], checked["frame"]["forward_axis"], checked["frame"]["up_axis"]), (1, "+z", "+y"))
        self.assertEqual(checked["frame"]["up_from"], "from the glTF 2.0 standard")
        # Seen from the bow at 5 degrees: its side of 4.8 x 2.6 m and its roof.
        rise = math.radians(5)
        area = 4.8 * 2.6 * math.cos(rise) + 4.8 * 2.8 * math.sin(rise)
        text = text.replace("elevation_deg = [5, 30]", "elevation_deg = [5]").replace("count = 12", "count = 2")
        (self.path / "bow.toml").write_text(text)
        self.irsig("run", "bow.toml", "--db", "bow.sigdb")
        db = sqlite3.connect(self.path / "bow.sigdb")
        rows = db.execute("SELECT projected_area_m2, intensity_w_sr FROM signature_view WHERE band = 'lwir' "
                          "AND aspect_azimuth_deg = 0").fetchall()
        db.close()
        self.assertAlmostEqual(rows[0][0] / area, 1, delta=0.002)  # from 1 km its near faces are larger

    def test_a_file_that_run_refuses_is_not_written(self):
        box = hull(1).replace("o starboard", "o Cabin").replace("o port", "g Wheel\nusemtl Cabin")
        (self.path / "named.obj").write_text(box)
        self.irsig("init", "--model", "named.obj")  # "Cabin" names all three groups
        text = (self.path / "named.toml").read_text()
        self.assertEqual((text.count("[[part]]"), text.count("rest = true")), (3, 1))
        (self.path / "odd.obj").write_bytes(hull(1).encode().replace(b"o port", b"o a*b\tc\xff").replace(b"o starboard", b"o =1+1"))
        self.irsig("init", "--model", "odd.obj")
        # A place that no sweep file may have.
        said = self.irsig("init", "--model", "odd.obj", "--place", "95,10", "--out", "pole.toml", exit_code=2)
        self.assertIn("pole.toml is not written, since `irsig run` would refuse it", said)
        self.assertFalse((self.path / "pole.toml").exists())

    def test_what_is_odd_about_a_model_is_said(self):
        text = self.irsig("init", "--model", "ship.obj", "--out", "-")
        for change, said in (
                (("unit_m = 1 ", "unit_m = 1000 "), "is unit_m = 1000 right?"),
                (("unit_m = 1 ", "unit_m = 0.0001 "), "is unit_m = 0.0001 right?"),
                (('forward_axis = "+x"', 'forward_axis = "+y"'), "is it turned? forward_axis"),
                (('forward_axis = "+x"          # the file\'s axis that points to the bow: assumed\nup_axis = "+z"',
                  'forward_axis = "+z"\nup_axis = "+x"'), "does it stand on end? up_axis"),
                (("# draft_m = 5 ", "draft_m = 11.5 "), "% of the model's area lie below the waterline"),
                (("# draft_m = 5 ", "# "), "stands on the sea"),
                (("relative_humidity_percent = 70", "relative_humidity_percent = 0.7"), "is it a fraction? 70 %"),
                (("temperature_k = 297", "temperature_k = 24"), "is it in degrees Celsius? 24 C are 297.15 K"),
                (('reference = "origin"', 'reference = "origin"\noffset_m = [400, 0, 0]'),
                 "model.offset_m: moves the target by 400 m")):
            self.assertIn(change[0], text)
            (self.path / "odd.toml").write_text(one_view(text.replace(*change).replace("range_m = 5000", "range_m = 500000")))
            plan = subprocess.run([IRSIG, "plan", "odd.toml"], cwd=self.path, capture_output=True, text=True, timeout=600)
            self.assertIn(said, plan.stderr + plan.stdout, change)

    def test_wrong_inputs(self):
        self.irsig("init", "--model", "ship.obj")
        text = (self.path / "ship.toml").read_text()
        for arguments, said in (
                (("init", "--model", "ship.obj"), "the file exists, expected a new one or --force"),
                (("init", "--model", "none.obj"), "none.obj"),
                (("init", "--model", "ship.obj", "--place", "54N", "--force"), "expected LAT,LON in degrees"),
                (("init", "--model", "ship.obj", "--season", "monsoon", "--force"), "winter, spring, summer or autumn"),
                (("init", "--model", "ship.obj", "--up-axis", "+x", "--force"), "perpendicular"),
                (("init",), "--model is required"),
                (("qurey", "x.sigdb"), 'unknown command "qurey", did you mean "query"?'),
                (("nosuch", "--help"), 'unknown command "nosuch", expected one of "init", "run"'),
                (("material", "lst"), 'unknown command "lst", did you mean "list"?'),
                (("query", "x.sigdb", "--formt", "csv"), '--formt: did you mean "--format"?')):
            self.assertIn(said, self.irsig(*arguments, exit_code=2), arguments)
        for change, said in (
                (("rest = true", 'rest = true\nmatch = ["deck*"]'), "does not apply to the part that takes the rest"),
                (("# draft_m = 5 ", "offset_m = [1, 2]  # "), "has 2 numbers, expected three: forward, to starboard, up"),
                (("[[season]]", '[[part]]\nname = "more"\nrest = true\nmaterial = "blackbody"\ntemperature_k = 300\n\n'
                                "[[season]]"), 'part "target" takes the rest already'),
                (("# draft_m = 5 ", "draft_m = 1e9  # "), "model.draft_m = 1e+09, expected a number"),
                (("[transport]", "[transport]\nvisibility_m = 5000"),
                 'unknown key "visibility_m" in transport, it is a key of [[season]], [air]'),
                (("sun = true", "sun = true\nsea_temperature_k = 290"), "it is a key of [season.surroundings]"),
                (("sea_temperature_k = 291", "sea_temperature_k = 18"), "is it in degrees Celsius? 18 C are 291.15 K"),
                (("temperature_k = 297", "temperature_k = -3"), "is it in C? -3 C are 270.15 K"),
                (("lambda_max_um = 5\n", "lambda_max_um = 5000\n"), "is it in nm? 5000 nm are 5 um"),
                (("date = 2025-07-15", 'date = "2025/07/15"'), "expected a date of the calendar: 2025-12-21")):
            self.assertIn(change[0], text)
            (self.path / "wrong.toml").write_text(text.replace(*change))
            self.assertIn(said, self.irsig("plan", "wrong.toml", exit_code=2), change)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
