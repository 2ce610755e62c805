"""irsig.py against `irsig query` on the same database; the examples of docs/reference/python.md; what is refused.

usage: python_test.py <irsig> <repository>
"""
import csv, doctest, io, os, pathlib, shutil, sqlite3, subprocess, sys, tempfile, unittest

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
sys.path.insert(0, str(ROOT / "python"))
import irsig  # noqa: E402


def run(*arguments, cwd=None):
    done = subprocess.run([IRSIG, *arguments], cwd=cwd, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    return done.stdout


class Python(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name)
        cls.file = cls.path / "quickstart.sigdb"
        run("run", ROOT / "jobs/examples/quickstart.toml", "--db", cls.file)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def table(self, *arguments):
        rows = list(csv.DictReader(io.StringIO(run("query", self.file, "--csv", *arguments))))
        return [{name.split(" ")[0]: value for name, value in row.items()} for row in rows]

    def change(self, *statements):
        copy = self.path / "changed.sigdb"
        shutil.copy(self.file, copy)
        db = sqlite3.connect(copy)
        for statement in statements:
            db.execute(statement)
        db.commit()
        db.close()
        return copy

    def test_numbers_are_those_of_query(self):
        with irsig.open(self.file) as db:
            ours, theirs = db.query(), self.table()
            self.assertEqual(len(ours), len(theirs))
            for name in ("intensity_w_sr", "numerical_error_w_sr", "contrast_intensity_w_sr", "projected_area_m2", "range_m"):
                for value, row in zip(ours[name], theirs):
                    self.assertAlmostEqual(value, float(row[name]), delta=1e-5 * abs(value))

    def test_nearest_viewpoint_is_that_of_query(self):
        with irsig.open(self.file) as db:
            for azimuth, elevation in ((0, 0), (90, 10), (200, 45), (359, 89), (-30, 20)):
                ours = db.query(aspect=(azimuth, elevation), band="mwir", season="summer")
                theirs = self.table("--aspect", f"{azimuth % 360},{elevation}", "--nearest", "1", "--band", "mwir", "--season", "summer")
                self.assertEqual(len(ours), 1)
                self.assertAlmostEqual(ours["aspect_azimuth_deg"][0], float(theirs[0]["aspect_azimuth_deg"]), places=3)

    def test_a_cube_has_every_row_in_its_place(self):
        with irsig.open(self.file) as db:
            rows = db.query()
            cube = rows.to_xarray()
            spectra = rows.spectra()
            for i in range(0, len(rows), 7):
                at = cube.sel(season=rows["season"][i], band=rows["band"][i]).isel(time_of_day=0)
                at = at.isel(viewpoint=int(((at.aspect_azimuth_deg == rows["aspect_azimuth_deg"][i])
                                            & (at.aspect_elevation_deg == rows["aspect_elevation_deg"][i])).values.argmax()))
                self.assertEqual(float(at.intensity_w_sr), rows["intensity_w_sr"][i])
                self.assertEqual(str(at.time_utc.values)[:19] + "Z", rows["time_utc"][i])
                spectrum = at.spectral_intensity_w_sr_um.dropna("bin")
                self.assertEqual(list(spectrum.lambda_um.values), list(spectra[i][0]))
                self.assertEqual(list(spectrum.values), list(spectra[i][1]))

    def test_a_cube_has_what_netcdf_has(self):
        exported = self.path / "whole.nc"
        run("export", self.file, "--out", exported)
        import numpy
        import xarray
        with irsig.open(self.file) as db, xarray.open_dataset(exported) as theirs:
            cube = db.query().to_xarray()
            self.assertEqual(list(cube.viewpoint.values), list(range(24)))
            self.assertEqual(set(cube.part.values), set(theirs.part.values))
            order = [int(numpy.flatnonzero(numpy.isclose(theirs.aspect_azimuth_deg.values, azimuth))[0])
                     for azimuth in cube.aspect_azimuth_deg.values]
            same = theirs.isel(viewpoint=order)
            names = [name for name in theirs.data_vars if "bin" in theirs[name].dims and "viewpoint" in theirs[name].dims]
            self.assertIn("apparent_spectral_intensity_w_sr_um", names)
            for name in [*names, "part_intensity_w_sr", "part_intensity_stderr_w_sr"]:
                axes = [d for d in ("season", "time_of_day", "band", "viewpoint", "part", "mode", "bin") if d in cube[name].dims]
                ours, other = cube[name].transpose(*axes), same[name].transpose(*axes)
                other = other.sel(season=ours.season.values, band=ours.band.values)
                if "part" in axes:
                    other = other.sel(part=ours.part.values)
                numpy.testing.assert_allclose(ours.values, other.values, rtol=1e-6, atol=1e-12, err_msg=name)

    def test_the_words_of_the_command_line_choose_rows(self):
        import datetime
        import numpy
        with irsig.open(self.file) as db:
            for time in ("2025-06-21T10:30:00+09:00", "2025-06-21T01:30:00Z", numpy.datetime64("2025-06-21T01:30"),
                         datetime.datetime(2025, 6, 21, 1, 30), [datetime.datetime(2025, 6, 21, 1, 30, tzinfo=datetime.timezone.utc)]):
                self.assertEqual(set(db.query(time=time)["season"]), {"summer"})
            for options, words in (({"nearest": 3}, ("--nearest", "3")), ({"within": 40}, ("--within", "40"))):
                ours = db.query(aspect=(90, 10), band="mwir", **options)
                theirs = self.table("--aspect", "90,10", "--band", "mwir", *words)
                self.assertEqual(sorted(ours["row"]), sorted(float(row["row"]) for row in theirs))
            self.assertEqual(list(db.query(row=7)["row"]), [7])
            stored = float(db.query()["range_m"][0])
            self.assertEqual(len(db.query(at_range_m=stored)), len(db.query(range_m=[stored])))

    def test_a_cube_of_one_season_is_chosen_by_date(self):
        exported = self.path / "summer.nc"
        run("export", self.file, "--season", "summer", "--out", exported)
        import numpy
        import xarray
        with irsig.open(self.file) as db, xarray.open_dataset(exported) as theirs:
            cube = db.query(season="summer").to_xarray()
            self.assertEqual(cube.intensity_w_sr.dims, ("season", "time", "band", "viewpoint"))
            self.assertTrue((cube.time.values == theirs.time.values).all())
            self.assertEqual(list(cube.time_of_day.values), list(theirs.time_of_day.values))
            chosen = cube.sel(time="2025-06-21T01:30", season="summer", band="lwir")
            same = db.query().to_xarray().sel(season="summer", band="lwir")
            self.assertTrue(numpy.array_equal(numpy.ravel(chosen.intensity_w_sr), numpy.ravel(same.intensity_w_sr)))

    def test_spectra_add_up_to_what_is_in_the_band(self):
        with irsig.open(self.file) as db:
            rows = db.query(band="lwir")
            for (lambda_um, values), total in zip(rows.spectra(), rows["intensity_w_sr"]):
                width = lambda_um[1] - lambda_um[0]
                self.assertAlmostEqual(sum(values) * width / total, 1, delta=0.03)  # half bins stick out on both sides

    def test_rows_that_are_being_replaced_are_left_out(self):
        whole = len(irsig.open(self.file).query())
        changed = self.change("UPDATE condition SET superseded = 1 WHERE season = 'summer'")
        with irsig.open(changed) as db:
            self.assertNotIn("summer", db.seasons)
            superseded = sum(row["superseded"] for row in db.sql("SELECT superseded FROM signature_view"))
            self.assertEqual(len(db.query()), whole - superseded)
            self.assertEqual(superseded, whole / 3)

    def test_what_is_missing_is_not_a_number(self):
        changed = self.change("DELETE FROM spectrum WHERE signature_id = 1", "UPDATE signature SET plume_w_sr = 2.0 WHERE signature_id <> 1",
                              "DELETE FROM thumbnail WHERE signature_id = 1")
        with irsig.open(changed) as db:
            rows = db.query()
            first = list(rows["signature_id"]).index(1)
            self.assertEqual([i for i, plume in enumerate(rows["plume_w_sr"]) if plume != plume], [first])
            self.assertEqual([len(part) for part in rows.spectra()[first]], [0, 0])
            self.assertIsNone(rows.thumbnails()[first])
            rows.to_xarray()

    def test_what_is_wrong_is_said(self):
        text = self.path / "text.sigdb"
        text.write_text("no database")
        empty = self.path / "empty.sigdb"
        sqlite3.connect(empty).execute("CREATE TABLE t (x)").connection.commit()
        files = {}
        for name, statement in (("modes", "UPDATE spectral_modes SET spectral_intensity_modes = x'000000'"),
                                ("mode length", "UPDATE spectral_modes SET spectral_intensity_modes = x'0000'"),
                                ("bytes", "UPDATE spectrum SET spectral_intensity_w_sr_um = x'00000000ff'")):
            files[name] = self.path / f"{name}.sigdb"
            shutil.move(self.change(statement + " WHERE signature_id = (SELECT signature_id FROM signature_view WHERE row = 3)"), files[name])
        older = self.path / "older.sigdb"
        shutil.move(self.change("PRAGMA user_version = 19"), older)
        damaged = self.change("UPDATE spectrum SET spectral_intensity_w_sr_um = x'00000000' WHERE signature_id = 1")
        newer = self.path / "newer.sigdb"
        shutil.copy(self.file, newer)
        connection = sqlite3.connect(newer)
        connection.execute("PRAGMA user_version = 999")
        connection.close()
        with irsig.open(self.file) as db:
            for call, expected in (
                    (lambda: irsig.open(self.path / "none.sigdb"), "there is no such file"),
                    (lambda: irsig.open(text), "not a database"),
                    (lambda: irsig.open(empty), "this is no signature database"),
                    (lambda: irsig.open(newer), "its format is 999"),
                    (lambda: irsig.open(older), "its format is 19, this irsig.py reads 29"),
                    (lambda: irsig.open(damaged).query().spectra(), "1 values at"),
                    (lambda: irsig.open(files["modes"]).query().modes(), "row 3 of quickstart: its spectral_intensity_modes are no list"),
                    (lambda: irsig.open(files["modes"]).query().to_xarray(), "row 3 of quickstart"),
                    (lambda: irsig.open(files["mode length"]).query().modes(), "row 3 of quickstart: its spectral_intensity_modes are 1 values at"),
                    (lambda: irsig.open(files["bytes"]).query().spectra(), "row 3 of quickstart: its spectral_intensity_w_sr_um are no list"),
                    (lambda: db.query(aspect=(float("nan"), 3)), "aspect: .nan, 3., expected an azimuth from -360 to 360"),
                    (lambda: db.query(aspect=(90, 95)), "aspect: .90, 95., expected an azimuth .* elevation from -90 to 90"),
                    (lambda: db.query(aspect=(90, float("inf"))), "aspect: .90, inf."),
                    (lambda: db.query(aspect=(400, 0)), "aspect: .400, 0."),
                    (lambda: db.query(aspect=90), "aspect: 90, expected two numbers"),
                    (lambda: db.query(time="noon"), "time: 'noon', expected RFC 3339"),
                    (lambda: db.query(time="2025-06-22T01:30Z"), 'time_utc: there is no "2025-06-22T01:30:00Z", expected 20'),
                    (lambda: db.query(range_m=7), "range_m: there is no 7, expected .*; `irsig export --range-m 7`"),
                    (lambda: db.query(within=7), "expected aspect="),
                    (lambda: db.query(aspect=(0, -89), within=0.01), "no viewpoint lies within 0.01 degrees"),
                    (lambda: db.query(aspect=(0, 9), nearest=0), "nearest: 0, expected"),
                    (lambda: db.query(aspect=("north", 3)), "expected two numbers"),
                    (lambda: db.query(season="autumn"), 'there is no "autumn", expected spring'),
                    (lambda: db.query(range_m=1), "range_m: there is no 1, expected 5000"),
                    (lambda: db.query()["intensity"], 'there is no quantity "intensity"'),
                    (lambda: db.query().spectra("intensity_w_sr"), "there is no spectrum")):
                with self.assertRaisesRegex(irsig.Error, expected):
                    call()

    def test_it_knows_the_format_that_is_written(self):
        self.assertEqual(irsig.open(self.file).format, irsig.FORMAT)

    def test_the_documentation_is_what_it_does(self):
        before = pathlib.Path.cwd()
        os.chdir(self.path)
        try:
            failed, tried = doctest.testfile(str(ROOT / "docs/reference/python.md"), module_relative=False, optionflags=doctest.ELLIPSIS)
        finally:
            os.chdir(before)
        self.assertEqual(failed, 0)
        self.assertGreater(tried, 12)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
