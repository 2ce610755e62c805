"""Names, warnings and messages of a database that somebody else wrote: no subcommand hands the
terminal a control character, JSON and SVG stay well-formed, and CSV in a pipe is data, byte for byte.

usage: hostile_text_test.py <irsig executable>
"""
import csv
import io
import json
import os
import pathlib
import pty
import re
import sqlite3
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

IRSIG = sys.argv[1] if len(sys.argv) > 1 else "irsig"
# A window's title, a cleared screen, a line overwritten, DEL, and CSI and OSC of C1.
HOSTILE = 'x\x1b]0;owned\x07\x1b[2J\r\b\x7f\u009b31m\u009d<&"'
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f]")  # all but tab and newline

SWEEP = """
time = ["12:00Z"]
[model]
generate = "sphere"
triangles = 100
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
[[part]]
name = "ball"
match = ["*"]
material = "paint"
temperature_k = 300
[[season]]
name = "any"
date = 2025-06-21
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 1
[viewpoints]
kind = "grid"
range_m = 1000
azimuth_deg = [0, 45, 90, 135, 180, 225, 270, 315]
elevation_deg = [0]
[surroundings]
kind = "none"
sky_radiance_w_m2_sr_um = 0
lower_radiance_w_m2_sr_um = 0
[air]
model = "vacuum"
[transport]
sun = false
max_reflections = 0
[accuracy]
samples_per_replicate = 64
[[profile]]
name = "middle"
at_m = [0, 0, 0]
footprint_width_m = 0.1
footprint_height_m = 0.1
samples = 1e4
"""


def run(*arguments):
    done = subprocess.run([IRSIG, *map(str, arguments)], capture_output=True, timeout=120)
    return done.returncode, done.stdout, done.stderr


def on_terminal(*arguments):
    """What a terminal would be given by both of the program's outputs."""
    master, slave = pty.openpty()
    child = subprocess.Popen([IRSIG, *map(str, arguments)], stdout=slave, stderr=slave)
    os.close(slave)
    text = b""
    try:
        while piece := os.read(master, 65536):
            text += piece
    except OSError:  # the other end is closed
        pass
    child.wait(timeout=120)
    os.close(master)
    return text.decode("utf-8").replace("\r\n", "\n")  # the terminal's own line ends


class HostileText(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.db = cls.folder / "some.sigdb"
        sweep = cls.folder / "some.toml"
        sweep.write_text(SWEEP)
        code, _, said = run("run", sweep, "--db", cls.db, "--workers", 1)
        assert code == 0, said
        with sqlite3.connect(cls.db) as database:
            set_all = lambda table, column: database.execute(f"UPDATE {table} SET {column} = ?", (HOSTILE,))
            for table, column in (("sweep", "name"), ("condition", "season"), ("condition", "warning"),
                                  ("band", "name"), ("part", "name"), ("part", "material"),
                                  ("profile", "name"), ("provenance", "worker_name"), ("provenance", "build_id"),
                                  ("provenance", "determinism_class")):
                set_all(table, column)
        database.close()

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    COMMANDS = (["query"], ["query", "--parts"], ["query", "--causes"], ["report"], ["profile"],
                ["explain", "--row", 1], ["query", "--sweep", "no\x1b[2Jbody"], ["query", "--band", "no\x1b[2J"],
                ["explain", "--row", 99], ["profile", "--profile-name", "no\x1b[2J"])

    def arguments(self, command):
        return [command[0], self.db, *command[1:]]

    def test_what_is_for_people_holds_no_control_character(self):
        seen = 0
        for command in self.COMMANDS:
            _, out, said = run(*self.arguments(command))
            for text in (out, said):
                self.assertEqual(CONTROL.findall(text.decode("utf-8")), [], command)
            seen += (out + said).count(b"owned")
        self.assertGreater(seen, 5)

    def test_a_terminal_gets_no_control_character_in_any_format(self):
        seen = 0
        for command in [*self.COMMANDS, ["query", "--format", "csv"], ["query", "--format", "json"],
                        ["profile", "--format", "csv"], ["explain", "--row", 1, "--format", "json"]]:
            text = on_terminal(*self.arguments(command))
            self.assertEqual(CONTROL.findall(text), [], command)
            seen += text.count("owned")
        self.assertGreater(seen, 9)

    def test_json_escapes_and_keeps_the_text(self):
        _, out, _ = run("query", self.db, "--format", "json")
        text = out.decode("utf-8")
        self.assertEqual(CONTROL.findall(text), [])
        self.assertEqual(json.loads(text)[0]["season"], HOSTILE)

    def test_csv_in_a_pipe_keeps_every_byte(self):
        _, out, _ = run("query", self.db, "--format", "csv")
        rows = list(csv.DictReader(io.StringIO(out.decode("utf-8"), newline="")))
        self.assertEqual(rows[0]["season"], HOSTILE)

    def test_pictures_are_well_formed(self):
        for kind in ("polar", "spectrum"):
            picture = self.folder / f"{kind}.svg"
            choice = ["--row", 1] if kind == "spectrum" else []
            code, _, said = run("plot", self.db, "--kind", kind, "--out", picture, *choice)
            self.assertEqual(code, 0, said)
            text = picture.read_text()
            self.assertEqual(CONTROL.findall(text), [])
            self.assertIn("owned", text)
            xml.etree.ElementTree.fromstring(text)

    def test_errors_that_quote_files_and_options(self):
        name = self.folder / "evil\x1b[2J.toml"
        name.write_text("name = 1\n")
        for arguments in (["plan", name], ["plan", self.folder / "missing\x1b[2J"], ["query", "no\x1b[2J"],
                          ["query", self.db, "--fo\x1b[2J"], ["material", "show", "no\x1b[2J"]):
            code, out, said = run(*arguments)
            self.assertNotEqual(code, 0)
            self.assertIn(b"[2J", out + said)
            self.assertEqual(CONTROL.findall((out + said).decode("utf-8")), [], arguments)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
