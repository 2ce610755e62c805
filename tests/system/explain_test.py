"""irsig run --effects -> explain, show effects: what a row says about itself.

usage: explain_test.py <irsig executable> <source folder>
"""
import json
import pathlib
import re
import sqlite3
import subprocess
import sys
import tempfile
import unittest

IRSIG, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
QUICKSTART = (SOURCE / "jobs/examples/quickstart.toml").read_text().replace("count = 24", "count = 3").replace(
    "triangles = 20000", "triangles = 2000")
# Hot, nearly black and alone in the dark: what it reflects is worth nothing. At night.
BALL = """
time = ["12:00Z"]
[model]
generate = "sphere"
triangles = 2000
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.97
[[part]]
name = "sphere"
material = "paint"
temperature_k = 600
[[season]]
name = "any"
date = 2025-06-21
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.1
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 0, elevation_deg = 10 } ]
[surroundings]
kind = "sea"
sky_temperature_k = 250
sea_temperature_k = 290
sea_emissivity = 0.98
[air]
model = "vacuum"
[transport]
sun = false
"""


def irsig(*arguments, code=0):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert done.returncode == code, f"{arguments}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout if code == 0 else done.stderr


class Explain(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)
        self.sweep = self.path / "small.toml"
        self.db = self.path / "small.sigdb"

    def run_sweep(self, text, *more):
        self.sweep.write_text(text)
        self.db.unlink(missing_ok=True)
        irsig("run", self.sweep, "--db", self.db, *more)

    def explained(self, row):
        return json.loads(irsig("explain", self.db, "--row", row, "--format", "json"))

    def effects(self, row):
        return {e["effect"]: e for e in self.explained(row)["effects"]}

    def test_every_row_of_a_sweep(self):
        self.run_sweep(QUICKSTART)
        rows = json.loads(irsig("query", self.db, "--format", "json", "--causes"))
        self.assertEqual(len(rows), 18)
        for stored in rows:
            d = self.explained(stored["row"])
            (signature,), (energy,) = d["signature"], d["energy"]
            self.assertEqual(signature, stored)
            self.assertEqual(len(d["effects"]), 19)
            # Where the light ends: parts of a whole, which is one.
            parts = [energy[k] for k in ("absorbed", "escaped_to_sky", "escaped_to_surface", "cut_off")]
            self.assertAlmostEqual(sum(parts), energy["balance"], delta=1e-9)
            self.assertLess(abs(energy["balance"] - 1), 5 * energy["balance_stderr"] + 1e-6)
            # By cause and by part: the intensity.
            intensity = stored["intensity_w_sr"]
            causes = sum(stored[f"{c}_w_sr"] for c in
                         ("emitted", "sun_reflected", "sky_reflected", "surface_reflected", "interreflected"))
            self.assertAlmostEqual(causes / intensity, 1, delta=1e-9)
            self.assertAlmostEqual(sum(p["part_intensity_w_sr"] for p in d["parts"]) / intensity, 1, delta=1e-9)
            # What is off is in the omitted bound, and that in the numerical error.
            off = sum(e["bound_w_sr"] or 0 for e in d["effects"] if e["state"] == "off")
            self.assertLessEqual(stored["omitted_bound_w_sr"], 1.000001 * off + 1e-12)
            self.assertGreaterEqual(stored["numerical_error_w_sr"], stored["omitted_bound_w_sr"] / 3 ** 0.5)
            states = {e["effect"]: e["state"] for e in d["effects"]}
            self.assertEqual(states["self_emission"], "on")
            self.assertEqual(states["transmission"], "absent")  # no air

    def test_text(self):
        self.run_sweep(QUICKSTART)
        text = irsig("explain", self.db, "--row", 3)
        self.assertIn("row 3 of quickstart: spring ", text)
        self.assertRegex(text, r"(?m)^intensity +[\d.]+ W/sr, at the target$")
        self.assertRegex(text, r"(?m)^  omitted bound +[\d.e-]+ +[\d.e-]+ %")
        self.assertRegex(text, r"(?m)^asked     1 % of the intensity: [\d.]+ W/sr, or the floor of 0.05 K: [\d.]+ W/sr$")
        self.assertRegex(text, r"(?m)^stopped   accuracy_reached$")
        self.assertRegex(text, r"(?m)^self_emission +on .* never left out unasked$")
        self.assertRegex(text, r"(?m)^path_sun +absent .* nothing in this scene and condition causes it$")
        self.assertRegex(text, r"(?m)^  sum +[\d.]+ \+- ")
        self.assertRegex(text, r"(?m)^  funnel +[\d.]+ ")
        self.assertIn("no row 19 in this database; the last one is 18", irsig("explain", self.db, "--row", 19, code=2))
        self.assertIn("nothing.sigdb", irsig("explain", self.path / "nothing.sigdb", "--row", 1, code=2))
        irsig("explain", self.db, code=2)

    def test_what_does_not_matter_is_left_out(self):
        self.run_sweep(BALL, "--relative-error", 0.05)
        (signature,) = self.explained(1)["signature"]
        effects = self.effects(1)
        for name in ("sky_reflected", "lower_reflected"):
            self.assertEqual((effects[name]["state"], effects[name]["reason"]), ("off", "within_fraction"))
            self.assertGreater(effects[name]["bound_w_sr"], 0)
        self.assertGreater(signature["omitted_bound_w_sr"], 0)
        self.assertEqual(signature["reflections"], 0)
        automatic = signature["intensity_w_sr"]
        error = signature["numerical_error_w_sr"] + signature["omitted_bound_w_sr"]

        self.run_sweep(BALL, "--relative-error", 0.05, "--effects", "all")
        (signature,) = self.explained(1)["signature"]
        effects = self.effects(1)
        for name in ("sky_reflected", "lower_reflected"):
            self.assertEqual((effects[name]["state"], effects[name]["reason"]), ("on", "forced"))
        self.assertEqual(signature["omitted_bound_w_sr"], 0)
        self.assertGreater(signature["sky_reflected_w_sr"], 0)
        self.assertLess(abs(signature["intensity_w_sr"] - automatic), 4 * (error + signature["numerical_error_w_sr"]))

    def test_the_users_word(self):
        self.run_sweep(BALL, "--relative-error", 0.05, "--effects", "only=sky_reflected")
        effects = self.effects(1)
        self.assertEqual([effects[n]["state"] for n in ("sky_reflected", "lower_reflected")], ["on", "off"])
        self.assertEqual({effects[n]["reason"] for n in ("sky_reflected", "lower_reflected")}, {"forced"})
        (signature,) = self.explained(1)["signature"]
        self.assertGreater(signature["sky_reflected_w_sr"], 0)
        self.assertEqual(signature["surface_reflected_w_sr"], 0)
        self.assertIn("forced: the user's word", irsig("explain", self.db, "--row", 1))
        # The file's table says the same; it is another sweep than the automatic one.
        by_option = irsig("digest", self.db)
        self.run_sweep(BALL + '[effects]\nmode = "only"\nonly = ["sky_reflected"]\n', "--relative-error", 0.05)
        self.assertEqual(irsig("digest", self.db), by_option)
        self.run_sweep(BALL, "--relative-error", 0.05)
        self.assertNotEqual(irsig("digest", self.db), by_option)

    def test_wrong_words(self):
        self.sweep.write_text(BALL)
        for effects, message in (("sometimes", '--effects: effects.mode = "sometimes": expected one of "auto", "all", "only"'),
                                 ("only=sky_reflectd", 'did you mean "sky_reflected"?'),
                                 ("only=perspective", 'effects.only[0] = "perspective" cannot be left out by itself'),
                                 ("only", "effects.only is missing"),
                                 ("all=direct_sun", "expected auto, all or only=NAME,NAME")):
            for command in (("run", self.sweep, "--db", self.db), ("plan", self.sweep)):
                self.assertIn(message, irsig(*command, "--effects", effects, code=2))
        self.assertFalse(self.db.exists())

    def test_a_number_of_samples_calls_for_everything(self):
        self.run_sweep(BALL + "[accuracy]\nsamples_per_replicate = 256\n")
        effects = self.effects(1)
        self.assertEqual((effects["sky_reflected"]["state"], effects["sky_reflected"]["reason"]), ("on", "no_goal"))
        self.assertIn("asked     a number of samples", irsig("explain", self.db, "--row", 1))

    def test_show_effects(self):
        text = irsig("show", "effects")
        self.assertIn("direct_sun *: sunlight reflected by the target", text)
        self.assertIn("self_emission: what surfaces emit", text)
        table = json.loads(irsig("show", "effects", "--format", "json"))
        self.assertEqual(len(table), 25)
        self.assertEqual(sum(e["switchable"] for e in table), len(re.findall(r"(?m)^\w+ \*:", text)))
        for effect in table:
            self.assertTrue(all(effect[k] for k in ("effect", "what", "matters", "bound", "cost")), effect)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
