"""irsig model plume: VDB files as a user makes them, what is said of them, what is refused.

usage: model_plume_test.py <irsig executable>
"""
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

IRSIG = str(pathlib.Path(sys.argv[1]).resolve())
FUNNEL = ("funnel", "--temperature-k", 650, "--opening-diameter-m", 1.2, "--velocity-m-s", 25, "--excess-air", 1.2,
          "--length-m", 15, "--voxel-m", 0.5)


class ModelPlume(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)

    def plume(self, *arguments, exit_code=0):
        done = subprocess.run([IRSIG, "model", "plume", *map(str, arguments)], cwd=self.path, capture_output=True,
                              text=True, timeout=120)
        self.assertEqual(done.returncode, exit_code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done.stdout if exit_code == 0 else done.stderr

    def numbers(self, text, before):
        return [float(x) for x in re.search(re.escape(before) + r" ([-\d.e+]+)(?: to ([-\d.e+]+))?", text).groups()
                if x is not None]

    def test_a_slab_holds_what_it_is_said_to(self):
        text = self.plume("slab", "--temperature-k", 900, "--co2", 0.1, "--h2o", 0.05, "--length-m", 2, "--width-m", 3,
                          "--height-m", 4, "--voxel-m", 0.25, "--out", "slab.vdb")
        self.assertEqual((self.path / "slab.vdb").read_bytes()[:4], b" BDV")
        mol = 0.1 * 101325 / (8.31446261815324 * 900) * 24
        self.assertAlmostEqual(self.numbers(text, "co2")[0] / mol, 1, delta=1e-4)
        self.assertAlmostEqual(self.numbers(text, "h2o")[0] / mol, 0.5, delta=1e-4)
        self.assertIn("1536 voxels of gas of 0.25 m, 900 to 900 K", text)

    def test_a_funnel_in_the_relative_wind(self):
        text = self.plume(*FUNNEL, "--wind-m-s", 5, "--wind-from-deg", 90, "--ship-speed-m-s", 4, "--out", "f.vdb")
        self.assertAlmostEqual(self.numbers(text, "relative wind")[0], math.sqrt(41), delta=1e-3)
        # Aft and to port, upwards.
        forward, starboard, down = (self.numbers(text, axis) for axis in ("x forward", "y starboard", "z down"))
        self.assertLess(forward[0], -6)
        self.assertLess(starboard[0], -8)
        self.assertLess(max(forward[1], starboard[1]), 4)
        self.assertLess(down[0], -5)
        other = self.plume(*FUNNEL, "--wind-m-s", 5, "--wind-from-deg", 270, "--out", "g.vdb")
        self.assertGreater(self.numbers(other, "y starboard")[1], 8)

    def test_what_a_kind_needs_and_what_it_does_not_have(self):
        self.assertIn("funnel needs --temperature-k, --voxel-m, --length-m, --opening-diameter-m, --velocity-m-s, --wind-m-s, "
                      "--excess-air", self.plume("funnel", "--out", "a.vdb", exit_code=2))
        self.assertIn("sphere has no --length-m", self.plume(
            "sphere", "--temperature-k", 900, "--co2", 0.1, "--radius-m", 1, "--voxel-m", 0.1, "--length-m", 1, "--out",
            "a.vdb", exit_code=2))
        self.assertIn("exit temperature 280", self.plume(*FUNNEL[:2], 280, *FUNNEL[3:], "--wind-m-s", 5, "--out", "a.vdb",
                                                         exit_code=2))
        self.plume("cone", "--out", "a.vdb", exit_code=2)
        self.plume(*FUNNEL, "--wind-m-s", 5, "--out", "a.obj", exit_code=2)
        self.plume(*FUNNEL, "--wind-m-s", 5, exit_code=2)
        self.assertEqual(list(self.path.iterdir()), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
