"""Hot gas in sweeps, at the front door: a slab of known emission, a funnel's exhaust in the wind, a file; what is refused.

usage: plume_test.py <irsig> <repository>
"""
import pathlib, re, sqlite3, subprocess, sys, tempfile, unittest

IRSIG, ROOT = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
COLUMN = (ROOT / "jobs/examples/plume_column.toml").read_text()
FRIGATE = (ROOT / "jobs/examples/frigate_plume.toml").read_text()
COLUMNS = ("plume_w_sr", "apparent_plume_w_sr", "contrast_plume_w_sr", "plume_emitted_w_sr", "plume_bound_w_sr",
           "plume_model_error_w_sr", "plume_area_m2", "plume_voxel_error_w_sr")


def changed(text, *pairs):
    for old, new in pairs:
        assert re.search(old, text, re.M | re.S), old
        text = re.sub(old, new, text, count=1, flags=re.M | re.S)
    return text


# One view, one band, a coarse ship, a short plume.
SHIP = changed(FRIGATE, ("triangles = 20000", "triangles = 3000"), (r"step_um = 0.05", "step_um = 0.1"),
               (r"\[\[band\]\]\nname = \"lwir\".*?step_um = 0.1\n", ""), (r"length_m = 60", "length_m = 25"),
               (r"voxel_m = 0.5", "voxel_m = 0.95"), (r"  \{ azimuth_deg = 180[^\n]*\n", ""),
               (r"relative_error = 0.01", "relative_error = 0.05"), (r"sun = true", "sun = false\nmax_reflections = 1")) \
    + "[output]\nthumbnail_px = 0\n"
SLAB = changed(COLUMN, ("relative_error = 0.001", "relative_error = 0.01"), ("voxel_m = 0.05", "voxel_m = 0.1"),
               ("triangles = 10000", "triangles = 100")) + "[output]\nthumbnail_px = 0\n"


class Plumes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)

    def irsig(self, *arguments, exit_code=0):
        done = subprocess.run([IRSIG, *map(str, arguments)], cwd=self.path, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, exit_code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done.stdout if exit_code == 0 else done.stderr

    def run_sweep(self, text, db, workers=2):
        (self.path / "s.toml").write_text(text)
        self.irsig("run", "s.toml", "--db", db, "--workers", workers)

    def rows(self, db):
        connection = sqlite3.connect(self.path / db)
        connection.row_factory = sqlite3.Row
        rows = connection.execute("SELECT s.* FROM signature s JOIN signature_view v USING (signature_id) ORDER BY v.row").fetchall()
        connection.close()
        return rows

    def refused(self, text):
        (self.path / "bad.toml").write_text(text)
        return self.irsig("run", "bad.toml", "--db", "bad.sigdb", exit_code=2)

    def add_up(self, row):
        parts = [row[f"{c}_w_sr"] for c in ("emitted", "sun_reflected", "sky_reflected", "surface_reflected", "interreflected",
                                            "plume")]
        self.assertAlmostEqual(sum(parts) / row["intensity_w_sr"], 1, delta=1e-5)

    def test_a_slab_sends_what_it_is_computed_to(self):
        self.run_sweep(SLAB, "a.sigdb")
        (row,) = self.rows("a.sigdb")
        error = 4 * (row["plume_stderr_w_sr"] + row["plume_bound_w_sr"])
        self.assertLess(error, 0.05 * 764.65)
        self.assertAlmostEqual(row["plume_w_sr"], 764.65, delta=error + 0.003 * 764.65)
        self.assertAlmostEqual(row["emitted_w_sr"], 26.274, delta=0.3)
        self.add_up(row)
        # A file of the same gas is the same gas.
        self.irsig("model", "plume", "slab", "--temperature-k", 1000, "--soot", 4e-8, "--length-m", 2, "--width-m", 2,
                   "--height-m", 2, "--voxel-m", 0.1, "--out", "slab.vdb")
        of_file = ('kind = "file"\nposition_m = [3, 0, 0]\nfile = "slab.vdb"\nunit_m = 1\nforward_axis = "+x"\n'
                   'up_axis = "+z"\ntemperature = { grid = "temperature", unit = "K" }\n'
                   'pressure = { constant = 1013.25, unit = "hPa" }\nco2 = 0\nh2o = 0\nco = 0\n'
                   'soot = { grid = "soot", unit = "1" }\n')
        file = changed(SLAB, (r'kind = "slab".*?voxel_m = 0.1\n', of_file))
        self.run_sweep(file, "f.sigdb")
        (again,) = self.rows("f.sigdb")
        for name in COLUMNS:
            if name == "plume_voxel_error_w_sr":  # means over voxels, which a file has in another order
                self.assertAlmostEqual(again[name] / row[name], 1, delta=1e-12)
            else:
                self.assertEqual(again[name], row[name], name)
        # Not this gas: none such grid, too hot, no such file.
        self.assertIn("plume.file", self.refused(changed(file, ('grid = "soot"', 'grid = "smoke"'))))
        self.assertIn("plume.file", self.refused(changed(file, ('slab.vdb', 'none.vdb'))))
        self.assertIn("temperature: unit", self.refused(changed(file, ('unit = "K"', 'unit = "F"'))))
        self.assertIn("the tables of hot gas end there", self.refused(changed(file, ('unit = "hPa"', 'unit = "kPa"'))))
        self.irsig("model", "plume", "slab", "--temperature-k", 3500, "--soot", 4e-8, "--length-m", 2, "--width-m", 2,
                   "--height-m", 2, "--voxel-m", 0.5, "--out", "hot.vdb")
        self.assertIn("gas of 3500 to 3500 K", self.refused(changed(file, ('slab.vdb', 'hot.vdb'))))

    def test_a_funnels_exhaust_goes_with_the_wind(self):
        self.run_sweep(SHIP, "one.sigdb", workers=1)
        self.run_sweep(SHIP, "two.sigdb", workers=2)
        self.assertEqual(self.irsig("digest", "one.sigdb").split()[0], self.irsig("digest", "two.sigdb").split()[0])
        rows = self.rows("one.sigdb")
        self.assertEqual(len(rows), 2)
        for row in rows:
            self.assertGreater(row["plume_emitted_w_sr"], 0)
            self.assertLess(row["apparent_plume_emitted_w_sr"], row["plume_emitted_w_sr"])
            self.add_up(row)
        # Wind from astern as fast as the ship: a calm for the plume. No wind at all; no gas at all.
        other = changed(SHIP, ("wind_from_deg = 60", "wind_from_deg = 180"), ("speed_m_s = 8", "speed_m_s = 5"))
        self.run_sweep(other, "other.sigdb")
        for row, calm in zip(rows, self.rows("other.sigdb")):
            self.assertGreater(abs(calm["plume_emitted_w_sr"] / row["plume_emitted_w_sr"] - 1), 0.02)
        self.run_sweep(changed(SHIP, (r"\[plume\].*?(?=\[\[part)", ""), (r"^speed_m_s = 8", ""), ("wind_from_deg = 60", "")),
                       "none.sigdb")
        for row, bare in zip(rows, self.rows("none.sigdb")):
            for name in COLUMNS:
                self.assertIsNone(bare[name], name)
            self.assertAlmostEqual(bare["emitted_w_sr"] / row["emitted_w_sr"], 1, delta=1e-2)

    def test_each_condition_has_its_own_wind(self):
        text = changed(SHIP, (r"^wind_speed_m_s = 5\n", ""), (r"^\[\[band\]\]", "[vary]\nwind_speed_m_s = [0, 15]\n\n[[band]]"))
        # The first one is a calm.
        text = changed(text, (r"\{ azimuth_deg = 90, elevation_deg = 40 \},", ""), ("speed_m_s = 8", "speed_m_s = 0"))
        self.run_sweep(text, "vary.sigdb")
        rows = self.rows("vary.sigdb")
        self.assertGreaterEqual(len(rows), 2)
        self.assertGreater(abs(rows[0]["plume_emitted_w_sr"] / rows[1]["plume_emitted_w_sr"] - 1), 0.05)

    def test_what_is_refused(self):
        for change, said in (
                (("wind_from_deg = 60", ""), "season[0].wind_from_deg is missing"),
                (("excess_air = 1.2 ", "# "), "plume.excess_air is missing"),
                (("temperature_k = 650", "temperature_k = 290"), "is not above the air's 294 K"),
                (("temperature_k = 650", "temperature_k = 3100"), "expected a number from 200 to 3000"),
                (("voxel_m = 0.95", "voxel_m = 3"), "plume.voxel_m = 3, expected at most the diameter"),
                (("velocity_m_s = 25", "velocity_m_s = 25\nradius_m = 1"), 'does not apply to a plume of kind "funnel"'),
                ((r"position_m = \[.*?\]", "position_m = [1, 2]"), "has 2 numbers, expected three"),
                (('kind = "funnel"', 'kind = "chimney"'), 'plume.kind = "chimney"'),
                ((r"position_m = \[-7.75(.*?)range_m = 5000", r"position_m = [-70\1range_m = 82"), "hot gas reaches as far as")):
            text = self.refused(changed(SHIP, change))
            self.assertIn(said, text)
            self.assertRegex(text, r"bad.toml:\d+:\d+: ")
        for change, said in (
                (("soot = 4e-8", ""), "without any of co2, h2o, co and soot"),
                (("soot = 4e-8", "soot = 0.1"), "expected a volume fraction from 0 to 0.001"),
                (("soot = 4e-8", "co2 = 0.7\nh2o = 0.7"), "are mole fractions of 1.4 in all"),
                (("soot = 4e-8", 'soot = { grid = "soot" }'), "a slab has no grids"),
                (("lambda_min_um = 3.5", "lambda_min_um = 0.9"), "expected wavelengths from 1.07"),
                ((r"\[\[part\]\]", "[uncertainty]\npart_temperature_k = 1\n\n[[part]]"), "what uncertain inputs mean"),
                ((r"\[\[part\]\]", "[[profile]]\nname = 'p'\nat_m = [0, 0, 0]\nfootprint_width_m = 0.1\n\n[[part]]"),
                 "profiles do not see hot gas")):
            self.assertIn(said, self.refused(changed(SLAB, change)))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
