"""Each option has one meaning, whichever command takes it: walks the table of `irsig manual options`.

usage: options_test.py <irsig>
"""
import collections, csv, io, pathlib, re, subprocess, sys, unittest

IRSIG = pathlib.Path(sys.argv[1]).resolve()

# The meaning of each option whose texts differ from command to command, as words that each text has. A text without them is
# another meaning: name that option otherwise.
MEANING = {
    "--address": r"address to listen at",
    "--air-temperature-k": r"^Temperature of the air",
    "--altitude-m": r"^Altitude ",
    "--aspect": r"^Direction from the target to the sensor",
    "--band": r"^Name of the band",
    "--co": r"^Mole fraction",
    "--co2": r"^Mole fraction",
    "--coordinator": r"^unix:PATH or HOST:PORT",
    "--db": r"made if it does not exist$",
    "--detector": r"detector",
    "--format": r"\(default: as the file's name ends, or \w+\)$",
    "--h2o": r"^Mole fraction",
    "--height-m": r"^Height ",
    "--host": r"\bname\b.* reach",
    "--lambda-max-um": r"^Longest wavelength",
    "--lambda-min-um": r"^Shortest wavelength",
    "--lambda-um": r"\bwavelength",
    "--layer": r"a further image of the rows, as \[image\] layers of the sweep asked for it",
    "--length-m": r"^Length ",
    "--no-imager": r"stored radiance, although the sweep has \[imager\]",
    "--out": r"\b(to write|folder|database)\b",
    "--port": r"^Port to listen at",
    "--pressure-pa": r"^Pressure ",
    "--quantity": r"intensity, apparent_intensity, contrast_intensity",
    "--radius-m": r"^Radius ",
    "--range-m": r"\bas seen from",
    "--relative-error": r"\bwanted of every in-band intensity",
    "--row": r"\bsignatures? with (this|these) row number",
    "--season": r"^Name of the season",
    "--soot": r"^Volume fraction",
    "--surroundings": r"^What it (stands|is to stand) on",
    "--sweep": r"^Name of the sweep",
    "--sweep-file": r"^Sweep file",
    "--temperature-k": r"^Temperature of the (blackbody|gas)",
    "--threads": r"\bthreads\b",
    "--thumbnail-scale": r"^Black and white of ",
    "--time": r"\bRFC 3339 with (any )?offset",
    "--views": r"\bviewpoints\b.* spread",
    "--width-m": r"^Width ",
    "--window": r"\bwindows? from L1 to L2 \[um\]",
    "--workers": r"\bworker (processes|threads)",
}

# Values of one option that have two names: where output goes is a file or a folder.
VALUES = {"--out": {"FILE", "FOLDER"}}

# Spellings that had two meanings: the command, the old spelling with a value, the new one.
RENAMED = [
    ("material check", ["--sweep", "a.toml"], "--sweep-file"),
    ("model plume funnel", ["--diameter-m", "1"], "--opening-diameter-m"),
    ("model terrain", ["--layer=heights", "--out", "a.asc"], "--map-layer"),
    ("profile a.sigdb", ["--profile", "floor"], "--profile-name"),
    ("selftest --hard", ["--filter", "planck"], "--cases"),
    ("show atmosphere", ["--sun-azimuth-deg", "20"], "--sun-from-path-deg"),
    ("show atmosphere", ["--sweep", "a.toml"], "--sweep-file"),
    ("show atmosphere", ["--temperature-k", "290"], "--air-temperature-k"),
    ("show gas --temperature-k 600", ["--height-m", "10"], "--altitude-m"),
    ("show gas", ["--sweep", "a.toml"], "--sweep-file"),
    ("show sky", ["--height-m", "10"], "--altitude-m"),
    ("show sky", ["--sweep", "a.toml"], "--sweep-file"),
    ("show sky", ["--temperature-k", "290"], "--air-temperature-k"),
    ("show sun", ["--height-m", "10"], "--altitude-m"),
    ("show sun", ["--sweep=a.toml"], "--sweep-file"),
    ("show sun", ["--temperature-k", "290"], "--air-temperature-k"),
    ("status", ["--workers"], "--by-worker"),
    ("verify-effects a.toml", ["--reference", "4"], "--reference-paths"),
]


def irsig(*arguments):
    return subprocess.run([IRSIG, *arguments], capture_output=True, text=True, timeout=60)


def value_name(value):
    """The name of one value: that of a list ("R,... ...") is the name of its elements."""
    return re.split(r"[ ,.]", value)[0]


class Options(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        done = irsig("manual", "options")
        assert done.returncode == 0, done.stderr
        cls.lines = list(csv.DictReader(io.StringIO(done.stdout)))
        cls.by_option = collections.defaultdict(list)
        for line in cls.lines:
            cls.by_option[line["option"]].append(line)

    def test_the_table_has_every_option(self):
        self.assertGreater(len(self.by_option), 180)
        commands = {line["command"] for line in self.lines}
        for command in ("irsig", "irsig query", "irsig show sky", "irsig model plume", "irsig ca issue"):
            self.assertIn(command, commands)
            text = irsig(*command.split()[1:], "--help").stdout
            for option in set(re.findall(r"^  (?:-\w,)?(--[a-z0-9-]+)", text, re.M)):
                self.assertTrue(any(line["command"] == command for line in self.by_option[option]), f"{command} {option}")

    def test_each_option_has_one_kind_of_value(self):
        for option, lines in self.by_option.items():
            with self.subTest(option=option):
                names = {value_name(line["value"]): line["command"] for line in lines}
                self.assertTrue(len(names) == 1 or set(names) <= VALUES.get(option, set()), names)

    def test_each_option_has_one_meaning(self):
        several = {option: lines for option, lines in self.by_option.items() if len({line["meaning"] for line in lines}) > 1}
        for option, lines in several.items():
            with self.subTest(option=option):
                texts = {line["meaning"]: line["command"] for line in lines}
                self.assertIn(option, MEANING, f"two texts: one meaning? {texts}")
                for text, command in texts.items():
                    self.assertRegex(text, re.compile(MEANING[option], re.I), command)
        self.assertEqual(set(MEANING) - set(several), set(), "options that have one text need no line here")

    def test_an_old_spelling_names_the_new_one(self):
        for command, old, new in RENAMED:
            with self.subTest(command=command, old=old):
                done = irsig(*command.split(), *old)
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                spelling = old[0].split("=")[0]
                words = " ".join(word for word in command.split("--")[0].split() if "." not in word and word != "funnel")
                self.assertEqual(done.stderr, f"irsig: {spelling}: this option of `irsig {words}` is called {new}\n")
                self.assertTrue(any(line["command"] == f"irsig {words}" for line in self.by_option[new]))

    def test_an_old_spelling_of_another_command_is_only_unknown(self):
        for command, spelling in (("query a.sigdb", "--map-layer"), ("query a.sigdb", "--filter"), ("init", "--diameter-m")):
            with self.subTest(command=command, spelling=spelling):
                done = irsig(*command.split(), spelling, "1")
                self.assertEqual(done.returncode, 2)
                self.assertIn(spelling, done.stderr)
                self.assertNotIn("is called", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
