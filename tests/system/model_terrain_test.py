"""irsig model terrain: heights and fractions of one land, as a user who writes them sees them.

usage: model_terrain_test.py <irsig executable>
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

IRSIG = str(pathlib.Path(sys.argv[1]).resolve())


class ModelTerrain(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)

    def terrain(self, *arguments, exit_code=0):
        done = subprocess.run([IRSIG, "model", "terrain", *map(str, arguments)], cwd=self.path, capture_output=True,
                              text=True, timeout=120)
        self.assertEqual(done.returncode, exit_code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def grid(self, name):
        lines = (self.path / name).read_text().splitlines()
        return dict(line.split() for line in lines[:6]), [[float(word) for word in line.split()] for line in lines[6:]]

    def test_layers_share_their_samples(self):
        self.terrain("--seed", 3, "--width-m", 2000, "--spacing-m", 20, "--out", "heights.asc")
        head, heights = self.grid("heights.asc")
        self.assertEqual((head["ncols"], head["nrows"], head["xllcenter"], head["cellsize"]), ("101", "101", "-1000", "20"))
        self.assertEqual({len(row) for row in heights}, {101})
        total = [0.0] * 101 * 101
        for layer in ("asphalt", "bare_soil", "grass", "water", "wheat"):
            self.terrain("--seed", 3, "--width-m", 2000, "--spacing-m", 20, "--map-layer", layer, "--out", "fraction.asc")
            same_head, fractions = self.grid("fraction.asc")
            self.assertEqual(same_head, head)
            total = [a + b for a, b in zip(total, (value for row in fractions for value in row))]
        self.assertEqual(set(total), {1.0})

    def test_the_grid_goes_to_standard_output_alone(self):
        done = self.terrain("--width-m", 100, "--spacing-m", 50, "--out", "-")
        self.assertTrue(done.stdout.startswith("ncols 3\n"))
        self.assertIn("heights of 3 x 3 samples", done.stderr)

    def test_values_beyond_their_ranges_are_named(self):
        self.assertIn("relief_m is -3; expected 0 to 5000", self.terrain("--relief-m", -3, "--out", "a.asc", exit_code=2).stderr)
        self.assertIn("limit", self.terrain("--width-m", 4e5, "--spacing-m", 1, "--out", "a.asc", exit_code=2).stderr)
        for seed in ("-1", "1.5", "one"):
            done = self.terrain(f"--seed={seed}", "--out", "a.asc", exit_code=2)
            self.assertIn(f"{seed} is not a whole number of at least 0", done.stderr)
        self.terrain("--map-layer", "lava", "--out", "a.asc", exit_code=2)
        self.assertFalse((self.path / "a.asc").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
