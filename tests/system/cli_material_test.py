"""irsig material: what comes with the program, and looking at a material before it is used.

usage: cli_material_test.py <irsig executable>
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

BANDS = """
[[band]]
name = "mwir"
lambda_min_um = 3
lambda_max_um = 5
step_um = 0.1
"""


def irsig(*arguments, cwd=None, exit_code=0):
    done = subprocess.run([IRSIG, "material", *map(str, arguments)], cwd=cwd, capture_output=True, text=True, timeout=300)
    if done.returncode != exit_code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout if exit_code == 0 else done.stdout + done.stderr


def rows(text):
    return list(csv.DictReader(io.StringIO(text)))


def fresnel(cos_i, m):
    cos_t = (1 - (1 - cos_i ** 2) / m ** 2) ** 0.5
    s = (cos_i - m * cos_t) / (cos_i + m * cos_t)
    p = (m * cos_i - cos_t) / (m * cos_i + cos_t)
    return (abs(s) ** 2 + abs(p) ** 2) / 2


class Material(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)

    def sweep(self, materials, name="s.toml"):
        (self.path / name).write_text(materials + BANDS)

    def test_list_states_where_everything_is_from(self):
        entries = {r["name"]: r for r in rows(irsig("list", "--csv"))}
        for name in ("sea_water", "iron", "magnetite", "haematite", "aluminium", "oxidised_steel", "blackbody",
                     "generic_grey_paint", "generic_white_paint", "generic_black_paint", "hull", "hull_paper"):
            self.assertIn(name, entries)
            for column in ("kind", "lambda_um", "source", "licence", "provenance"):
                self.assertTrue(entries[name][column], (name, column))
        self.assertIn("not a measurement", entries["generic_grey_paint"]["provenance"])
        people = irsig("list")
        self.assertIn("sea_water", people)
        self.assertNotIn("CRDC", people)

    def test_show_blackbody(self):
        for row in rows(irsig("show", "blackbody", "--lambda-um", 4, 10, "--theta-i-deg", 0, 89, "--csv")):
            self.assertEqual((float(row["dhr"]), float(row["emissivity"])), (0, 1))

    def test_show_file_and_near_mirror_against_fresnel(self):
        """A lobe of slope 1e-4 reflects as a mirror does: Fresnel's equations are the independent value."""
        (self.path / "gold.yml").write_text("DATA:\n  - type: tabulated nk\n    data: |\n        2 1.0 12\n        6 3.0 36\n")
        self.sweep('[[material]]\nname = "mirror"\nkind = "cook_torrance"\noptical_constants_file = "gold.yml"\n'
                   'roughness = 1e-4\nfresnel = "exact"\nmasking = "v_groove"\n')
        found = rows(irsig("show", "s.toml:mirror", "--lambda-um", 4, "--theta-i-deg", 0, 45, 80, "--csv", cwd=self.path))
        self.assertEqual(len(found), 3)
        for row in found:
            expected = fresnel(math.cos(math.radians(float(row["theta_i_deg"]))), complex(2, 24))
            self.assertAlmostEqual(float(row["dhr"]), expected, delta=1e-4)
            self.assertAlmostEqual(float(row["dhr"]) + float(row["emissivity"]), 1, delta=1e-6)

    def test_show_for_people_has_a_column_for_each_wavelength(self):
        text = irsig("show", "iron", "--lambda-um", 4, 10)
        header = " ".join(text.splitlines()[6:8])  # two lines where one has no room
        for word in ("dhr", "emissivity", "4 um", "10 um"):
            self.assertIn(word, header)
        self.assertIn("CC0", text)
        self.assertIn("hull_paper: cook_torrance", irsig("show", "hull_paper"))
        self.assertIn("creates energy", irsig("show", "hull_paper"))

    def test_plot_is_an_svg_that_does_not_depend_on_the_run(self):
        for out in ("a.svg", "b.svg"):
            irsig("plot", "iron", "--out", out, "--lambda-min-um", 2, "--lambda-max-um", 14, cwd=self.path)
        a, b = ((self.path / f).read_bytes() for f in ("a.svg", "b.svg"))
        self.assertEqual(a, b)
        tree = xml.etree.ElementTree.fromstring(a)
        lines = [e for e in tree.iter() if e.tag.endswith("polyline")]
        self.assertGreaterEqual(len(lines), 2 * 2 + 2 * 5)

    def test_check(self):
        table = rows(irsig("check", "blackbody", "--csv")) + rows(irsig("check", "aluminium", "--csv"))
        self.assertGreaterEqual(len({r["check"] for r in table}), 4)
        self.assertEqual({r["passed"] for r in table}, {"true"})

    def test_check_sweep_fails_for_a_material_that_creates_energy(self):
        self.sweep('[[material]]\nname = "paper"\nkind = "hull_paper"\nallow_energy_gain = true\n'
                   '[[material]]\nname = "paint"\nkind = "lambert"\nemissivity = 0.9\n')
        text = irsig("check", "--sweep-file", "s.toml", "--csv", cwd=self.path, exit_code=1)
        table = [r for r in rows(text) if r["passed"] in ("true", "false")]
        self.assertEqual({r["material"] for r in table}, {"paper", "paint"})
        self.assertEqual({r["material"] for r in table if r["passed"] == "false"}, {"paper"})
        self.assertIn("checks failed", text)

    def test_wrong_input(self):
        self.assertIn('did you mean "iron"?', irsig("show", "irom", exit_code=2))
        self.assertIn("12.6", irsig("show", "oxidised_aluminium", "--lambda-um", 12.6, exit_code=2))
        self.sweep('[[material]]\nname = "p"\nkind = "lambert"\nemissivity_file = "p.csv"\n')
        self.assertIn("s.toml:4:1: material[0].emissivity_file = \"p.csv\"",
                      irsig("show", "s.toml:p", cwd=self.path, exit_code=2))
        (self.path / "p.csv").write_text("lambda_um,emissivity\n3,0.9\n5,high\n")
        self.assertIn("p.csv:3:3: \"high\"", irsig("show", "s.toml:p", cwd=self.path, exit_code=2))
        (self.path / "p.csv").write_text("lambda_um,emissivity\n4,0.9\n5,0.8\n")
        self.assertIn("s.toml:4:1: material[0].emissivity_table covers 4 to 5 um",
                      irsig("show", "s.toml:p", cwd=self.path, exit_code=2))
        (self.path / "p.csv").write_text("lambda_um,emissivity\n3,0.9\n5,0.8\n")
        self.assertIn('has no material "q"', irsig("show", "s.toml:q", cwd=self.path, exit_code=2))
        irsig("check", exit_code=2)
        irsig("show", "nowhere.toml:p", cwd=self.path, exit_code=2)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
