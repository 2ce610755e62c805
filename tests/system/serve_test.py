"""irsig serve: every answer equals what the command line prints; wrong questions get words.

usage: serve_test.py <irsig executable> <source folder>
"""
import contextlib
import csv
import http.client
import io
import json
import pathlib
import re
import shlex
import shutil
import sqlite3
import subprocess
import sys
import time
import unittest
import urllib.parse

from serve_case import IRSIG, SOURCE, ServeCase
from serve_fixture import FEW, LAYERED, LAYERS, Server, empty_database, irsig, small_sweep

sys.path.insert(0, str(SOURCE / "python"))
import irsig as irsig_py  # noqa: E402

DETECTOR = SOURCE / "jobs/examples/detectors/insb.toml"
QUANTITIES = {
    "intensity": ("intensity_w_sr", "numerical_error_w_sr"),
    "apparent_intensity": ("apparent_intensity_w_sr", "apparent_numerical_error_w_sr"),
    "contrast_intensity": ("contrast_intensity_w_sr", "contrast_numerical_error_w_sr"),
    "background_radiance": ("background_radiance_w_m2_sr", "background_radiance_stderr_w_m2_sr"),
}

# As many aspects as can be had in seconds.
MANY = """name = "many"
time = ["12:00Z"]
season = [{ name = "any", date = 2025-06-21 }]
band = [{ name = "lwir", lambda_min_um = 8, lambda_max_um = 12, step_um = 1 }]
model = { generate = "sphere", triangles = 100 }
material = [{ name = "paint", kind = "lambert", emissivity = 0.9 }]
part = [{ name = "sphere", material = "paint", temperature_k = 300 }]
viewpoints = { kind = "fibonacci", count = 1001, range_m = 1000 }
surroundings = { kind = "none", sky_radiance_w_m2_sr_um = 0, lower_radiance_w_m2_sr_um = 0 }
air = { model = "vacuum" }
transport = { sun = false, max_reflections = 0 }
accuracy = { samples_per_replicate = 64 }
"""


def printed(command):
    """What a command that the page shows prints; its program is the one under test."""
    words = shlex.split(command)
    assert words[0] == "irsig", command
    return irsig(IRSIG, *words[1:])


def table(text):
    return list(csv.DictReader(io.StringIO(text)))


class Serve(ServeCase):
    def test_contents_are_the_sweep(self):
        first, second = self.contents["database"]
        self.assertEqual((first["name"], second["name"]), (self.db.name, self.other.name))
        (sweep,) = first["sweep"]
        rows = table(irsig(IRSIG, "query", self.db, "--format", "csv"))
        self.assertEqual(sweep["rows"], len(rows))
        self.assertEqual(sweep["whole_rows"], len(rows))
        self.assertEqual({(c["season"], c["time_utc"]) for c in sweep["condition"]}, {(r["season"], r["time_utc"]) for r in rows})
        self.assertEqual(len(sweep["condition"]), 6)
        self.assertEqual([(b["name"], b["lambda_min_um"]) for b in sweep["band"]], [("mwir", 3), ("lwir", 8)])
        self.assertEqual(sweep["range_m"], [5000])
        self.assertTrue(sweep["thumbnails"])

    def test_map_is_the_query(self):
        for quantity, (value, error) in QUANTITIES.items():
            shown = self.server.json("/api/map", quantity=quantity, **self.selection())
            rows = table(printed(shown["command"]))
            self.assertEqual(len(rows), 24)
            self.assertEqual(shown["row"], [int(r["row"]) for r in rows])
            for column, name in (("azimuth_deg", "aspect_azimuth_deg"), ("elevation_deg", "aspect_elevation_deg"),
                                 ("value", value), ("error", error)):
                self.assertEqual(shown[column], [float(r[name]) for r in rows], (quantity, column))

    def test_left_out_is_the_plan(self):
        for quantity in ("intensity", "contrast_intensity"):
            shown = self.server.json("/api/left_out", quantity=quantity, **self.selection(season="summer", time=self.time_of("summer"), band="lwir"))
            command = shlex.split(shown["command"])
            self.assertEqual(command[-2:], ["--left-out", "left_out.csv"])
            irsig(IRSIG, *command[1:])
            rows = [r for r in table((self.path / "left_out.csv").read_text())
                    if (r["season"], r["time_utc"], r["band"]) == ("summer", self.time_of("summer"), "lwir")]
            self.assertGreater(len(rows), 10)
            for column in ("interpolated", "error", "relative_deviation"):
                self.assertEqual(shown[column], [float(r[column]) for r in rows], (quantity, column))
            aspect = {r["row"]: (r["aspect_azimuth_deg"], r["aspect_elevation_deg"]) for r in table(irsig(IRSIG, "query", self.db, "--format", "csv"))}
            self.assertEqual([aspect[str(row)] for row in shown["row"]], [(r["aspect_azimuth_deg"], r["aspect_elevation_deg"]) for r in rows])

    def test_many_aspects_are_left_to_the_command_line(self):
        many = self.path / "many.sigdb"
        (self.path / "many.toml").write_text(MANY)
        irsig(IRSIG, "run", self.path / "many.toml", "--db", many)
        server = Server(IRSIG, many)
        self.addCleanup(server.end)
        (sweep,) = server.json("/api/contents")["database"][0]["sweep"]
        chosen = {"sweep": "many", "season": "any", "time": sweep["condition"][0]["time_utc"], "band": "lwir", "at_range_m": 1000}
        said = server.json("/api/left_out", 409, **chosen)["error"]
        self.assertIn("1001 aspects are too many for a page (1000 at most): irsig plan --refine", said)
        self.assertEqual(len(server.json("/api/map", **chosen)["row"]), 1001)
        # Windows of a band at another range are of some of them, alike all around a sphere.
        drawn = "400 of 1001 rows, drawn at random, which is not in the margins: the command takes all"
        some, all_of_them = (server.json("/api/bands", nei_w_m2=1e-9, **chosen, **asked) for asked in ({"range_m": 2000}, {}))
        self.assertEqual((some["rows"], drawn in some["notes"]), (400, True))
        self.assertEqual((all_of_them["rows"], drawn in all_of_them["notes"]), (1001, False))
        whole = table(printed(some["command"]))
        for one, other in zip(some["best"]["merit"], (float(row["merit"]) for row in whole), strict=True):
            self.assertAlmostEqual(one / other, 1, delta=0.01)
            self.assertNotEqual(one, other)

    def time_of(self, season):
        return next(c["time_utc"] for c in self.contents["database"][0]["sweep"][0]["condition"] if c["season"] == season)

    def test_who_shares_viewpoints(self):
        few, empty = self.path / "few.sigdb", self.path / "empty.sigdb"
        small_sweep(IRSIG, SOURCE, self.path / "few.toml", few, FEW)
        empty_database(IRSIG, empty)
        server = Server(IRSIG, self.db, few, f"./{self.other.name}", empty)
        self.addCleanup(server.end)
        contents = server.json("/api/contents")
        self.assertEqual([[[(s["db"], s["sweep"]) for s in sweep["shares"]] for sweep in d["sweep"]] for d in contents["database"]],
                         [[[(0, "quickstart"), (2, "quickstart")]], [[(1, "quickstart")]], [[(0, "quickstart"), (2, "quickstart")]], []])
        # What a page says has no options of a command.
        chosen = self.selection(db=1)
        self.assertEqual(server.json("/api/cut", 400, **chosen)["error"],
                         "no elevation is covered by viewpoints all around the target: choose one below")
        self.assertIn("name one with --elevation", irsig(IRSIG, "plot", few, "--kind", "polar", "--out", "-", code=2))
        self.assertIn("no viewpoint is surrounded", server.json("/api/left_out", 409, **chosen)["error"])
        self.assertIn("no aspect in common", server.json("/api/compare", 404, **self.selection(), **{f"b_{k}": v for k, v in chosen.items()})["error"])
        self.assertEqual(server.json("/api/progress")["database"][3]["sweep"], [])

    def test_cut_is_the_plot(self):
        for elevation in (None, 20, 33.5):
            asked = self.selection(quantity="intensity", **({} if elevation is None else {"elevation_deg": elevation}))
            shown = self.server.json("/api/cut", **asked)
            self.assertTrue(shown["interpolated"])
            rows = table(printed(shown["command"]))
            for part, kind in (("point", "interpolated"), ("mark", "near")):
                of_kind = [r for r in rows if r["kind"] == kind]
                self.assertEqual(shown[part]["azimuth_deg"], [float(r["aspect_azimuth_deg"]) for r in of_kind])
                self.assertEqual(shown[part]["value"], [float(r["intensity_w_sr"]) for r in of_kind])
                self.assertEqual(shown[part]["error"], [float(r["numerical_error_w_sr"]) for r in of_kind])
            self.assertEqual(len(shown["point"]["value"]), 180)
            if elevation:
                self.assertEqual(shown["elevation_deg"], elevation)
                # The same as between viewpoints by the query, but for the kernel, which that chooses by the place.
                (one,) = json.loads(irsig(IRSIG, "query", self.db, "--season", asked["season"], "--time", asked["time"], "--band",
                                          asked["band"], "--aspect", f"90,{elevation}", "--interpolate", "--format", "json"))
                k = shown["point"]["azimuth_deg"].index(90)
                self.assertLess(abs(one["intensity_w_sr"] - shown["point"]["value"][k]),
                                2 * (one["numerical_error_w_sr"] + shown["point"]["error"][k]))

    def test_row_is_the_query(self):
        for extra in ({}, {"range_m": 10000}):
            for quantity, (value, error) in QUANTITIES.items():
                shown = self.server.json("/api/row", sweep="quickstart", row=17, quantity=quantity, **extra)
                (row,) = json.loads(printed(shown["command"]))
                self.assertEqual(shown["signature"], [row])
                self.assertEqual(row["range_m"], extra.get("range_m", 5000))
                self.assertEqual(shown["value"], row[value])
                self.assertEqual(shown["numerical_error"], row[error])
                explained = json.loads(printed(shown["explain_command"]))
                self.assertEqual(shown["explained"], explained)
                self.check_budget(shown, explained, quantity, extra)

    def check_budget(self, shown, explained, quantity, extra):
        parts = shown["budget"]["part"]
        if quantity == "background_radiance":
            self.assertEqual(parts, [])
            return
        self.assertAlmostEqual(sum(p["share"] for p in parts), 1, delta=1e-9)
        whole = sum(p["error"] ** 2 for p in parts if not p["bound"]) + sum(p["error"] for p in parts if p["bound"]) ** 2 / 3
        self.assertAlmostEqual(whole ** 0.5 / shown["numerical_error"], 1, delta=1e-6)
        if not extra:
            stated = {p["name"]: p["error_w_sr"] for p in explained["error_budget"] if p["quantity"] == quantity}
            self.assertEqual({p["name"]: p["error"] for p in parts}, stated)
            self.assertGreater(sum(p["error"] for p in parts if p["bound"]), 0)

    def test_spectrum_is_the_query(self):
        for extra in ({}, {"range_m": 20000}):
            shown = self.server.json("/api/spectrum", sweep="quickstart", row=18, quantity="apparent_intensity", **extra)
            rows = table(printed(shown["command"]))
            self.assertEqual(len(rows), 81)
            for name, column in (("lambda_um", "lambda_um"), ("value", "apparent_spectral_intensity_w_sr_um"),
                                 ("value_stderr", "apparent_spectral_intensity_stderr_w_sr_um"),
                                 ("spectral_sky_reflected_w_sr_um", "spectral_sky_reflected_w_sr_um")):
                self.assertEqual(shown[name], [float(r[column]) for r in rows], name)

    def test_bands_are_those_of_the_command(self):
        server = Server(IRSIG, self.db, "--detector", DETECTOR)
        self.addCleanup(server.end)
        self.assertEqual(server.json("/api/contents")["detector"], ["InSb, f/2"])
        one = self.selection()
        for asked in ({}, {"range_m": 20000}, {"nei_w_m2": 1e-7, "merit": "worst"}, {"detector": 0, "merit": "percentile", "percentile": 30, "over": "conditions"},
                      {"merit": "above", "threshold": 100}):
            shown = server.json("/api/bands", **one, **asked)
            rows = table(printed(shown["command"]))
            for mine, theirs in (("lambda_min_um", "lambda_min_um"), ("merit", "merit"), ("total_error", "total_error"), ("best", "best"), ("as_good", "as_good")):
                self.assertEqual(shown["best"][mine], [float(r[theirs]) for r in rows], (asked, mine))
            self.assertEqual(shown["rows"], 24 * (6 if "over" in asked else 1))
            window = shown["window"]
            whole = table(server.request("/file/bands.csv?" + urllib.parse.urlencode({**one, **asked}))[2].decode())
            self.assertEqual([(window["edge_um"][a], window["edge_um"][b], m) for a, b, m in zip(window["first"], window["last"], window["merit"])],
                             [(float(r["lambda_min_um"]), float(r["lambda_max_um"]), float(r["merit"])) for r in whole])
            self.assertEqual(max(window["merit"]), shown["best"]["merit"][0])
        self.assertTrue(server.request("/file/bands.svg?" + urllib.parse.urlencode(one))[2].startswith(b"<svg"))
        for wrong, said in (({"detector": 1}, "this page has 1"), ({"merit": "best"}, "expected mean, percentile"), ({"merit": "range"}, "expected mean, percentile"), ({"range_m": 10}, "lengths of the target"), ({"percentile": 0}, "percentile"),
                            ({"nei_w_m2": "nan"}, "nei_w_m2"), ({"over": "all"}, "over"), ({"row": 3}, "no such parameter")):
            self.assertIn(said, server.json("/api/bands", code=400, **one, **wrong)["error"])
        # What the detector sees nothing of.
        self.assertIn("outside the stored band", server.json("/api/bands", code=400, **{**one, "band": "lwir"}, detector=0)["error"])

    def test_bands_in_clutter_are_those_of_the_command(self):
        one = self.selection()
        self.assertFalse(self.server.json("/api/contents")["database"][0]["sweep"][0]["clutter"])
        self.assertIn("has no clutter", self.server.json("/api/bands", code=400, **one, clutter=1)["error"])
        land = pathlib.Path(self.db).parent / "land.sigdb"
        shutil.copy(self.db, land)
        with contextlib.closing(sqlite3.connect(land)) as sql:
            names = [n for (n,) in sql.execute("SELECT name FROM pragma_table_info('signature') WHERE name LIKE 'clutter%' OR name = 'visible_fraction'")]
            sql.execute("UPDATE signature SET " + ", ".join(f"{n} = 1" for n in names))
            sql.execute("UPDATE signature SET clutter_patch_sigma_stderr_w_m2_sr = 0.1")
            # As uncertain as the target is bright.
            sql.execute("INSERT INTO clutter SELECT signature_id, spectral_intensity_w_sr_um, x'' FROM spectrum")
            sql.commit()
        server = Server(IRSIG, land)
        self.addCleanup(server.end)
        self.assertTrue(server.json("/api/contents")["database"][0]["sweep"][0]["clutter"])
        for asked in ({"clutter": 1}, {"clutter": 0}):
            shown = server.json("/api/bands", **one, **asked)
            self.assertEqual("--clutter" in shown["command"], asked["clutter"] == 1)
            self.assertEqual("SCNR" in shown["title"], asked["clutter"] == 1)
            self.assertEqual(shown["best"]["merit"], [float(r["merit"]) for r in table(printed(shown["command"]))])
        self.assertIn("expected 0 or 1", server.json("/api/bands", code=400, **one, clutter="yes")["error"])

    def test_compare(self):
        # Two databases: every aspect is five numerical errors brighter, and the errors of both add up.
        here = self.selection()
        there = {f"b_{k}": v for k, v in self.selection(db=1).items()}
        shown = self.server.json("/api/compare", quantity="intensity", **here, **there)
        a, b = (table(printed(c)) for c in shown["command"].splitlines())
        self.assertEqual(shown["a"], [float(r["intensity_w_sr"]) for r in a])
        self.assertEqual(shown["b"], [float(r["intensity_w_sr"]) for r in b])
        self.assertEqual((shown["only_in_a"], shown["only_in_b"]), (0, 0))
        for k, row in enumerate(a):
            error, stderr = float(row["numerical_error_w_sr"]), float(row["intensity_stderr_w_sr"])
            self.assertAlmostEqual(shown["difference"][k] / error, 5, delta=1e-6)
            # Standard errors as independent, everything else as if it had one sign.
            rest = max(0.0, error ** 2 - stderr ** 2) ** 0.5
            expected = (2 * stderr ** 2 + (2 * rest) ** 2) ** 0.5
            self.assertAlmostEqual(shown["difference_error"][k] / expected, 1, delta=1e-9)
            self.assertAlmostEqual(shown["sigmas"][k] * expected / shown["difference"][k], 1, delta=1e-9)
        same = self.server.json("/api/compare", quantity="intensity", **here, **{f"b_{k}": v for k, v in here.items()})
        self.assertEqual(set(same["sigmas"]), {0})
        saved = table(self.file("compare.csv", **here, **there).decode())
        self.assertEqual([float(r["difference_sigmas"]) for r in saved], shown["sigmas"])

    def file(self, name, **parameters):
        status, headers, body = self.server.request(f"/file/{name}?" + urllib.parse.urlencode(parameters))
        self.assertEqual(status, 200, body[:300])
        self.assertEqual(headers["Content-Disposition"], f'attachment; filename="{name}"')
        return body

    def test_files_are_those_of_the_command_line(self):
        chosen = self.selection()
        filters = ["--sweep", chosen["sweep"], "--season", chosen["season"], "--time", chosen["time"], "--band", chosen["band"]]
        self.assertEqual(self.file("rows.csv", **chosen).decode(), irsig(IRSIG, "query", self.db, *filters, "--format", "csv"))
        self.assertEqual(self.file("row.csv", sweep="quickstart", row=5).decode(),
                         irsig(IRSIG, "query", self.db, "--row", 5, "--causes", "--format", "csv"))
        self.assertEqual(self.file("spectrum.csv", sweep="quickstart", row=5).decode(),
                         irsig(IRSIG, "query", self.db, "--row", 5, "--causes", "--spectrum", "--format", "csv"))
        self.assertEqual(self.file("map.svg", **chosen).decode(), irsig(IRSIG, "plot", self.db, "--kind", "map", *filters, "--out", "-"))
        self.assertEqual(self.file("cut.svg", elevation_deg=25, **chosen).decode(),
                         irsig(IRSIG, "plot", self.db, "--kind", "polar", "--elevation", 25, *filters, "--out", "-"))
        self.assertEqual(self.file("cut.csv", elevation_deg=25, **chosen).decode(),
                         irsig(IRSIG, "plot", self.db, "--kind", "polar", "--elevation", 25, *filters, "--format", "csv", "--out", "-"))
        self.assertEqual(self.file("spectrum.svg", sweep="quickstart", row=5).decode(),
                         irsig(IRSIG, "plot", self.db, "--kind", "spectrum", "--row", 5, "--out", "-"))
        status, _, body = self.server.request("/file/spectrum.svg?sweep=quickstart&row=5&range_m=9000")
        self.assertEqual((status, b"CSV" in body), (400, True))

    def test_thumbnail(self):
        status, headers, body = self.server.request("/api/thumbnail.png?sweep=quickstart&row=3")
        self.assertEqual((status, headers["Content-Type"]), (200, "image/png"))
        irsig(IRSIG, "query", self.db, "--row", 3, "--thumbnail", self.path / "own.png")
        self.assertEqual(body, (self.path / "own.png").read_bytes())
        self.assertEqual(self.file("image.png", sweep="quickstart", row=3), body)
        command = shlex.split(self.server.json("/api/row", sweep="quickstart", row=3)["image_command"])
        irsig(IRSIG, *command[1:])
        self.assertEqual((self.path / "row-3.png").read_bytes(), body)

    def test_image(self):
        """Size, layers, stored bytes and silhouette of an image; what is not there, and what is damaged, in words."""
        db = self.path / "layered.sigdb"
        small_sweep(IRSIG, SOURCE, self.path / "layered.toml", db, LAYERED)
        server = Server(IRSIG, db, self.db)
        self.addCleanup(server.end)
        row = {"sweep": "quickstart", "row": 3}

        def stored(sql):
            with contextlib.closing(sqlite3.connect(db)) as connection:
                return connection.execute(sql + " WHERE signature_id = (SELECT signature_id FROM signature_view WHERE row = 3)").fetchall()

        said = server.json("/api/image.json", **row)
        self.assertEqual([tuple(said[n] for n in ("width_px", "height_px", "pixel_rad", "error_relative"))],
                         stored("SELECT width_px, height_px, pixel_rad, error_relative FROM thumbnail"))
        self.assertEqual((said["stderr"], said["gas"], said["plain_band_um"]), (True, False, [3, 5]))
        self.assertEqual([layer["name"] for layer in said["layer"]], LAYERS)
        self.assertEqual([layer["name"] for layer in said["layer"] if layer["stderr"]],
                         ["emitted", "sun", "sky", "surface", "parts", "hidden", "at_sensor"])
        self.assertEqual((said["counts"], said["no_counts"]), ([], ""))
        self.assertEqual({layer["unit"] for layer in said["layer"]}, {"W/(m2 sr)", "K", "m", "1"})
        printed(next(layer["command"] for layer in said["layer"] if layer["name"] == "sun"))
        self.assertTrue((self.path / "row-3-sun.svg").read_text().startswith("<svg"))
        blobs = {(name, column): blob for column in ("exr", "stderr_exr")
                 for name, blob in stored(f"SELECT '', {column} FROM thumbnail") + stored(f"SELECT name, {column} FROM image_layer")}
        for (name, column), blob in blobs.items():
            asked = {**row, **({"layer": name} if name else {}), **({"stderr": 1} if column == "stderr_exr" else {})}
            status, headers, body = server.request("/api/image.exr?" + urllib.parse.urlencode(asked))
            if not blob:
                self.assertEqual((status, f"no standard errors of layer {name}" in json.loads(body)["error"]), (404, True))
                continue
            self.assertEqual((status, headers["Content-Type"], body), (200, "image/x-exr", blob), asked)
            self.assertEqual(server.request("/file/image.exr?" + urllib.parse.urlencode(asked))[2], blob)
        # The silhouette: runs of pixels with equal counts.
        seen = server.json("/api/silhouette.json", **row)
        with irsig_py.open(db) as database:
            (parts,) = database.query(row=3).silhouettes()
        self.assertEqual([part["name"] for part in seen["part"]], list(parts))
        for part in seen["part"]:
            counts, at = [0] * (seen["width_px"] * seen["height_px"]), 0
            for skip, length, count in zip(*[iter(part["run"])] * 3, strict=True):
                counts[at + skip:at + skip + length] = [count] * length
                at += skip + length
            self.assertEqual(counts, (parts[part["name"]].ravel() * seen["pixel_samples"]).tolist(), part["name"])

        def refused(code, words, path="/api/image.exr", **parameters):
            self.assertIn(words, server.json(path, code, **{**row, **parameters})["error"])

        refused(400, "expected one of counts, emitted, sun, sky", layer="x' OR 1=1 --")
        refused(400, 'layer = "Sun"', layer="Sun")
        refused(404, "has no counts: its sweep has no [imager]", layer="counts")
        refused(400, "expected 0 or 1", stderr="yes")
        refused(400, "expected a whole number", row="1e3")
        refused(400, "there is no such parameter here", png=1)
        refused(400, "there is no such parameter here", "/api/image.json", layer="sun")
        refused(400, "there is no such parameter here", "/api/silhouette.json", stderr=1)
        refused(404, "the last one is", row=9999)
        refused(404, "has no layer sun: it has none; the sweep asks for them with [image] layers", db=1, layer="sun")

        def change(sql, *values):
            with contextlib.closing(sqlite3.connect(db)) as connection, connection:
                connection.execute(sql, values)

        exr = blobs["", "exr"]
        for table, more, asked, what in (("thumbnail", "", {}, "the file of the image"), ("image_layer", " WHERE name = 'sun'", {"layer": "sun"}, "the file of layer sun")):
            for bad, words in ((b"<svg onload=alert(1)>", "is no OpenEXR file"), (exr[:-20], "is cut off"), (exr[:200], "has a damaged header"),
                               (exr.replace(b"compression\0compression\0\x01\0\0\0\x01", b"compression\0compression\0\x01\0\0\0\x63"), "is compressed in no known way"),
                               (exr + bytes(10 ** 6), "bytes, its pixels take"), (b"", "is no OpenEXR file")):
                change(f"UPDATE {table} SET exr = ?{more}", bad)
                refused(409, f"the stored image of row 3 is damaged: {what} {words}" if not words.startswith("bytes") else words, **asked)
        change("UPDATE image_layer SET stderr_exr = ? WHERE name = 'at_sensor'", b"x")
        refused(409, "the standard errors of layer at_sensor is no OpenEXR file", layer="at_sensor", stderr=1)
        change("UPDATE part_pixels SET samples = zeroblob(9)")
        refused(409, "the stored image of row 3 is damaged: the silhouette has a part with damaged samples", "/api/silhouette.json")
        change("DELETE FROM image_layer")
        change("DELETE FROM thumbnail")
        for path in ("/api/image.exr", "/api/image.json", "/api/silhouette.json"):
            refused(404, "without image", path)

    def test_progress(self):
        database = self.server.json("/api/progress")["database"][0]
        self.assertFalse(database["writing"])
        (sweep,) = database["sweep"]
        self.assertEqual((sweep["jobs"], sweep["done"], sweep["leased"], sweep["failed"]), (24, 24, 0, 0))

    def test_workers_of_a_coordinator(self):
        address = f"unix:{self.path}/farm"
        farm = subprocess.Popen([pathlib.Path(IRSIG).with_name("irsig-coordinator"), "--db", self.path / "farm.sigdb", "--listen", address],
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(farm.communicate)
        self.addCleanup(farm.kill)
        self.assertIn("listening", farm.stdout.readline())
        worker = subprocess.Popen([pathlib.Path(IRSIG).with_name("irsig-worker"), "--coordinator", address, "--name", "<b>ann"],
                                  stderr=subprocess.DEVNULL)
        self.addCleanup(worker.wait)
        self.addCleanup(worker.kill)
        server = Server(IRSIG, self.db, "--coordinator", address)
        self.addCleanup(server.end)
        while not (answer := server.json("/api/progress")["farm"])["worker"]:
            self.assertIsNone(worker.poll())
            time.sleep(0.05)
        (ann,) = answer["worker"]
        self.assertEqual((answer["workers"], ann["name"], ann["state"], ann["job_key"]), (1, "<b>ann", "idle", ""))
        (said,) = json.loads(irsig(IRSIG, "status", "--by-worker", "--coordinator", address, "--json"))
        self.assertEqual((said["worker"], said["memory_bytes"]), (ann["name"], ann["memory_bytes"]))
        farm.kill()
        farm.wait()
        answer = server.json("/api/progress")
        self.assertNotIn("farm", answer)
        self.assertIn(address, answer["farm_error"])
        self.assertEqual(answer["database"][0]["sweep"][0]["done"], 24)
        self.assertNotIn("farm", self.server.json("/api/progress"))
        self.assertIn("expected", irsig(IRSIG, "serve", self.db, "--coordinator", "nowhere", code=2))

    def test_accuracy_page(self):
        page = self.path / "accuracy.html"
        page.write_text("<!DOCTYPE html><title>costs</title><style>p{color:red}</style><p>a point<script>alert(1)</script>")
        server = Server(IRSIG, self.db, "--accuracy", page)
        self.addCleanup(server.end)
        self.assertTrue(server.json("/api/contents")["accuracy_page"])
        connection = http.client.HTTPConnection(server.host, server.port, timeout=60)
        connection.request("GET", server.root + "/accuracy")
        reply = connection.getresponse()
        self.assertEqual((reply.status, reply.getheader("Content-Type"), reply.read().decode()), (200, "text/html; charset=utf-8", page.read_text()))
        (policy,) = [value for name, value in reply.getheaders() if name == "Content-Security-Policy"]
        self.assertTrue(policy.startswith("default-src 'none'; style-src 'unsafe-inline';"), policy)
        connection.close()
        self.assertFalse(self.server.json("/api/contents")["accuracy_page"])
        self.assertIn("--accuracy FILE", self.server.json("/accuracy", code=404)["error"])
        self.assertIn("none.html", irsig(IRSIG, "serve", self.db, "--accuracy", self.path / "none.html", code=2))

    def test_the_page_itself(self):
        for target, type_ in (("/", "text/html"), ("/?season=winter", "text/html"), ("/www/main.js", "text/javascript"),
                              ("/www/style.css", "text/css"), ("/www/icon.svg", "image/svg+xml")):
            status, headers, body = self.server.request(target)
            self.assertEqual(status, 200, target)
            self.assertTrue(headers["Content-Type"].startswith(type_))
            self.assertIn("default-src 'self'", headers["Content-Security-Policy"])
            self.assertIn("frame-ancestors 'none'", headers["Content-Security-Policy"])
            self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertEqual(headers["Cross-Origin-Resource-Policy"], "same-origin")
            again, head, none = self.server.request(target, method="HEAD")
            self.assertEqual((again, head["Content-Length"], none), (200, str(len(body)), b""))
        # Nothing in what is sent names another origin.
        for name in (SOURCE / "serve/www").iterdir():
            for link in re.findall(r"(?:https?:)?//[\w.-]+\.\w+[^\s\"']*", name.read_text()):
                self.assertIn("w3.org", link, name)

    def test_wrong_questions(self):
        chosen = self.selection()
        row = {"sweep": "quickstart", "row": 3}

        def refused(path, code, words, **parameters):
            self.assertIn(words, self.server.json(path, code, **parameters)["error"])

        refused("/api/row", 404, "the last one is 288", **{**row, "row": 99999})
        refused("/api/row", 400, "expected a whole number", **{**row, "row": "1e3"})
        refused("/api/row", 400, "expected a whole number", **{**row, "row": "-1"})
        refused("/api/row", 400, "expected a whole number", **{**row, "row": "99999999999999999999999"})
        refused("/api/row", 400, "parameter row: it is missing", sweep="quickstart")
        refused("/api/row", 400, "expected more than 0 m", **row, range_m=0)
        refused("/api/row", 400, "expected a number", **row, range_m="nan")
        refused("/api/row", 400, "20 lengths", **row, range_m=100)
        refused("/api/row", 400, "is too far: expected from 20 lengths of the target to 1e+09 m", **row, range_m=1e300)
        refused("/api/row", 400, "no quantity", **row, quantity="brightness")
        refused("/api/row", 400, "databases are numbered 0 to 1", **row, db=2)
        refused("/api/row", 400, "there is no such parameter here", **row, colour="red")
        refused("/api/row", 404, "no sweep", **{**row, "sweep": "x' OR 1=1 --"})
        refused("/api/map", 404, 'no season "autumn"', **{**chosen, "season": "autumn"})
        refused("/api/map", 404, 'no band', **{**chosen, "band": "\x00\x1b[2J"})
        refused("/api/map", 404, "no viewpoint at 7000 m", **{**chosen, "at_range_m": 7000})
        refused("/api/map", 400, "parameter season: it is missing", **{k: v for k, v in chosen.items() if k != "season"})
        refused("/api/map", 400, "there is no such parameter here", **chosen, row=1)
        refused("/api/cut", 400, "expected between -90 and 90", **chosen, elevation_deg=90)
        refused("/api/cut", 400, "cannot draw elevation -60", **chosen, elevation_deg=-60)
        refused("/api/compare", 400, "b_sweep: it is missing", **chosen)
        refused("/api/contents", 400, "there is no such parameter here", x=1)
        self.assertIn("given twice", json.loads(self.server.request("/api/row?row=1&row=2&sweep=quickstart")[2])["error"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
