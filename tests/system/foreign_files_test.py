"""Files as other programs write them, from the file to a number that follows from it by hand.

usage: foreign_files_test.py <irsig executable>
"""
import csv
import io
import json
import math
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest

IRSIG = pathlib.Path(sys.argv[1]).resolve()


def band_radiance(kelvins, low_um=8, high_um=12, steps=2000):
    """Planck's law [W/(m2 sr)], by the midpoint rule."""
    width = (high_um - low_um) / steps
    return sum(width * 1.191042972e8 / um ** 5 / (math.exp(14387.76877 / (um * kelvins)) - 1)
               for um in (low_um + (i + 0.5) * width for i in range(steps)))


# 2 m a side, each face with its own four corners: 24 vertices of 8 places, the upper ones at 400 K.
FACES = [[(-1, -1, -1), (-1, 1, -1), (1, 1, -1), (1, -1, -1)], [(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)],
         [(-1, -1, -1), (1, -1, -1), (1, -1, 1), (-1, -1, 1)], [(1, -1, -1), (1, 1, -1), (1, 1, 1), (1, -1, 1)],
         [(1, 1, -1), (-1, 1, -1), (-1, 1, 1), (1, 1, 1)], [(-1, 1, -1), (-1, -1, -1), (-1, -1, 1), (-1, 1, 1)]]

SEAM = """
time = ["12:00Z"]
[model]
file = "box.ply"
unit_m = 1
forward_axis = "+x"
up_axis = "+z"
[[part]]
name = "all"
rest = true
material = "blackbody"
[[temperature_field]]
name = "f"
file = "box.ply"
unit = "K"
match = "index"
error_k = 0.5
[[season]]
name = "any"
date = 2025-06-21
temperature_field = "f"
[[band]]
name = "b"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.1
[viewpoints]
kind = "ring"
count = 1
elevation_deg = [90]
range_m = 1000
[surroundings]
kind = "none"
sky_radiance_w_m2_sr_um = 0
lower_radiance_w_m2_sr_um = 0
[air]
model = "vacuum"
[transport]
sun = false
[output]
thumbnail_px = 0
"""

# A concrete box on the ground of Delhi in May; the column sky_w_m2 is there and holds 0.
COURTYARD = """
time = ["01:00Z", "07:00Z"]
[model]
generate = "box"
triangles = 12
length_m = 4
width_m = 4
height_m = 2
offset_m = [0, 0, 2]
[place]
latitude_deg = 28.6
longitude_deg = 77.1
height_m = 230
heading_deg = 0
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
solar_absorptance = 0.6
[[build_up]]
name = "wall"
layer = [{ solid = "concrete", thickness_m = 0.1 }]
inside = "adiabatic"
[[part]]
name = "box"
match = ["*"]
material = "paint"
build_up = "wall"
[[season]]
name = "any"
date = 2025-05-15
weather_file = "delhi.csv"
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 200
aspect = [ { azimuth_deg = 180, elevation_deg = 20 } ]
[surroundings]
kind = "ground"
ground_temperature_k = 310
ground_emissivity = 0.95
solar_albedo = 0.2
[air]
model = "atmosphere"
aerosol = "rural"
visibility_m = 23000
[transport]
sun = true
[heat]
[accuracy]
relative_error = 0.05
[output]
thumbnail_px = 0
"""
# By the hour from 0 UTC: air [C], direct and diffuse sunlight [W/m2].
DELHI = [(27.4, 0, 0), (28.7, 274, 18), (30.3, 470, 52), (32.1, 595, 83), (33.9, 684, 110), (35.7, 746, 130),
         (37.3, 784, 144), (38.6, 800, 150), (39.5, 793, 147), (39.9, 764, 137), (39.9, 712, 119), (39.5, 634, 94),
         (38.6, 525, 65), (37.3, 366, 31), (35.7, 0, 0), (33.9, 0, 0), (32.1, 0, 0), (30.3, 0, 0), (28.7, 0, 0),
         (27.4, 0, 0), (26.5, 0, 0), (26.1, 0, 0), (26.1, 0, 0), (26.5, 0, 0)]


class ForeignFiles(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)

    def irsig(self, *arguments, code=0):
        done = subprocess.run([IRSIG, *arguments], cwd=self.path, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def rows(self, text, name):
        (self.path / f"{name}.toml").write_text(text)
        self.irsig("run", f"{name}.toml", "--db", f"{name}.sigdb")
        return list(csv.DictReader(io.StringIO(self.irsig("query", f"{name}.sigdb", "--csv").stdout)))

    def write_van(self):
        """A van 4.8 m along x, 2.6 m along y and 2.8 m along z, on y = 0: glTF with its buffer in a file beside it."""
        corners = [(x, y, z) for x in (-2.4, 2.4) for y in (0, 2.6) for z in (-1.4, 1.4)]
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        buffer = b"".join(struct.pack("<3f", *c) for c in corners)
        buffer += b"".join(struct.pack("<6H", a, b, c, a, c, d) for a, b, c, d in quads)
        (self.path / "van.bin").write_bytes(buffer)
        (self.path / "van.gltf").write_text(json.dumps({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "van"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "buffers": [{"byteLength": 168, "uri": "van.bin"}],
            "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}]}))

    def test_a_van_whose_side_lies_along_x(self):
        self.write_van()
        self.irsig("init", "--model", "van.gltf", "--surroundings", "ground")
        text = (self.path / "van.toml").read_text()
        text = re.sub(r'(?s)\[\[band\]\]\nname = "mwir".*?(?=\[\[band\]\])', "", text)
        text = re.sub(r'(?m)^kind = "ring".*\ncount = 12.*\nelevation_deg = .*$',
                      'kind = "list"\naspect = [{ azimuth_deg = 0, elevation_deg = 5 }, { azimuth_deg = 90, elevation_deg = 5 }]', text)
        rise = math.radians(5)
        long_m2 = 4.8 * 2.6 * math.cos(rise) + 4.8 * 2.8 * math.sin(rise)
        short_m2 = 2.8 * 2.6 * math.cos(rise) + 4.8 * 2.8 * math.sin(rise)
        self.assertAlmostEqual(long_m2, 13.60, delta=0.005)
        # By the standard the bow is at +z: its long side, along x, is seen from the bow, its short one from starboard.
        # As its maker meant it the bow is at +x, and the two change places.
        for axis, of_azimuth in (("+z", {0: (488.2, long_m2), 90: (302.0, short_m2)}), ("+x", {0: (302.0, short_m2), 90: (488.2, long_m2)})):
            stated = re.sub(r'(?m)^forward_axis = "[^"]*"', f'forward_axis = "{axis}"', text)
            self.assertIn(f'forward_axis = "{axis}"', stated)
            rows = self.rows(stated, "van" + axis[1])
            self.assertEqual(len(rows), 2)
            for row in rows:
                w_sr, m2 = of_azimuth[int(float(row["aspect_azimuth_deg"]))]
                self.assertAlmostEqual(float(row["projected_area_m2"]) / m2, 1, delta=2e-3)  # 1 km away: its near faces are larger
                self.assertAlmostEqual(float(row["intensity_w_sr"]) / w_sr, 1, delta=0.01)

    def test_temperatures_of_vertices_at_a_seam(self):
        heads = {}
        for form in ("ascii", "binary_little_endian"):
            heads[form] = (f"ply\nformat {form} 1.0\nelement vertex 24\nproperty float x\nproperty float y\nproperty float z\n"
                           "property float temperature\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n")
        # The upper face is hot, and no other corner at the same places.
        vertices = [(*corner, 400 if number == 1 else 300) for number, face in enumerate(FACES) for corner in face]
        facets = [(4 * f, 4 * f + i, 4 * f + i + 1) for f in range(6) for i in (1, 2)]
        text = heads["ascii"] + "".join(" ".join(map(str, v)) + "\n" for v in vertices) + "".join(f"3 {a} {b} {c}\n" for a, b, c in facets)
        binary = heads["binary_little_endian"].encode() + b"".join(struct.pack("<4f", *v) for v in vertices)
        binary += b"".join(struct.pack("<B3i", 3, *f) for f in facets)
        for name, data in (("text", text.encode()), ("binary", binary)):
            (self.path / "box.ply").write_bytes(data)
            (row,) = self.rows(SEAM, name)
            # 4 m2 at 400 K, 1 m nearer than the 1000 m of the reference point.
            self.assertAlmostEqual(float(row["intensity_w_sr"]), 4 * band_radiance(400) * (1000 / 999) ** 2, delta=0.5)
            self.assertAlmostEqual(float(row["intensity_w_sr"]), 535.0, delta=2)

    def test_a_sky_of_zero_is_none(self):
        hours = [(f"2025-05-{14 + day}T{hour:02}:00:00Z", *DELHI[hour]) for day in range(3) for hour in range(24)]
        text = ("# radiation_interval_s: 3600\ntime, air_temperature_c, dew_point_c, pressure_hpa, wind_speed_m_s, wind_from_deg, "
                "direct_normal_w_m2, diffuse_horizontal_w_m2, sky_w_m2\n")
        text += "".join(f"{time}, {air}, 12.0, 987, 3, 260, {direct}, {diffuse}, 0\n" for time, air, direct, diffuse in hours)
        (self.path / "delhi.csv").write_text(text)
        (self.path / "delhi.toml").write_text(COURTYARD)
        said = self.irsig("run", "delhi.toml", "--db", "delhi.sigdb").stderr
        self.assertIn("which no sky has: taken as missing", said)
        shown = self.irsig("show", "temperatures", "delhi.sigdb", "--csv").stdout
        means = [float(row["mean_k"]) for row in csv.DictReader(io.StringIO(shown))]
        # As with a file without the column; with a sky of 0 W/m2 it is 289.6 and 301.6 K.
        self.assertEqual(len(means), 2)
        self.assertAlmostEqual(means[0], 302.6, delta=0.15)
        self.assertAlmostEqual(means[1], 314.9, delta=0.15)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
