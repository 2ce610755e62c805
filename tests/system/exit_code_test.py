"""One exit code for one cause, in every command: 1 where what was printed could not be written, 2 where a file may not be used.

usage: exit_code_test.py <irsig executable> <source folder>
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

IRSIG, SOURCE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
BIN = IRSIG.parent
NOBODY = 65534
sys.path.insert(0, str(SOURCE / "tests/fault"))
import small_disk

SWEEP = """
time = ["12:00Z"]
model = { generate = "sphere", triangles = 100 }
part = [{ name = "sphere", material = "blackbody", temperature_k = 300 }]
season = [{ name = "any", date = 2025-06-21 }]
band = [{ name = "b", lambda_min_um = 8, lambda_max_um = 9, step_um = 0.1 }]
viewpoints = { kind = "ring", count = 2, elevation_deg = [0], range_m = 1000 }
surroundings = { kind = "none", sky_radiance_w_m2_sr_um = 0, lower_radiance_w_m2_sr_um = 0 }
air = { model = "vacuum" }
transport = { sun = false }
accuracy = { relative_error = 0.1 }
output = { thumbnail_px = 8 }
"""


def commands():
    """Every command and its subcommands, as the shell completes them."""
    script = subprocess.run([IRSIG, "completion", "bash"], capture_output=True, text=True, check=True).stdout
    paths = re.findall(r'^    "([^":]*)"\) commands=', script, re.M)
    assert len(paths) > 40, paths
    return [path.split() for path in paths]


class ExitCodes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)
        cls.path.chmod(0o755)
        (cls.path / "a.toml").write_text(SWEEP)
        subprocess.run([IRSIG, "run", "a.toml", "--db", "a.sigdb", "--plan"], cwd=cls.path, capture_output=True, check=True, timeout=300)

    def full(self, *command):
        with open("/dev/full", "w") as full:
            done = subprocess.run([str(c) for c in command], cwd=self.path, stdout=full, stderr=subprocess.PIPE, text=True, timeout=300)
        self.assertEqual(done.returncode, 1, f"{command}: {done.stderr}")
        self.assertRegex(done.stderr, r"cannot write .*disk full", command)

    def test_help_of_every_command_on_a_full_disk(self):
        for path in commands():
            with self.subTest(path):
                self.full(IRSIG, *path, "--help")
        self.full(IRSIG, "--version")
        for program in ("irsig-coordinator", "irsig-worker"):
            self.full(BIN / program, "--help")

    def test_answers_on_a_full_disk(self):
        for command in (["digest", "a.sigdb"], ["completion", "bash"], ["completion", "zsh"], ["query", "a.sigdb"], ["query", "a.sigdb", "--csv"],
                        ["query", "a.sigdb", "--json"], ["report", "a.sigdb"], ["doctor", "a.sigdb"], ["explain", "a.sigdb", "--row", "1"],
                        ["plan", "a.toml"], ["run", "a.toml", "--db", "b.sigdb"], ["export", "a.sigdb", "--out", "-"], ["model", "box", "--triangles", "12", "--out", "-"],
                        ["material", "list"], ["material", "show", "aluminium"], ["material", "check", "blackbody"],
                        ["show", "planck", "--temperature-k", "300", "--lambda-um", "10"], ["show", "solids"], ["slice", "a.sigdb", "--out", "c.sigdb"],
                        ["merge", "a.sigdb", "--out", "d.sigdb"], ["plot", "a.sigdb", "--kind", "spectrum", "--row", "1", "--out", "-"]):
            with self.subTest(" ".join(command)):
                self.full(IRSIG, *command)
        # What is wrong with the input is said before, and stays the reason.
        with open("/dev/full", "w") as full:
            done = subprocess.run([IRSIG, "query", "none.sigdb"], cwd=self.path, stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)

    def test_files_that_may_not_be_used(self):
        """Once 1 of a database and 2 of a sweep, "no such file" of one in a closed folder, "cannot be read" without a reason."""
        if os.geteuid() != 0:
            self.skipTest("only root can become somebody else, and only others are refused")
        if subprocess.run([IRSIG, "--version"], user=NOBODY, group=NOBODY, capture_output=True).returncode != 0:
            self.skipTest(f"{IRSIG} cannot be run by another user")
        shut, closed = self.path / "shut", self.path / "closed"
        for folder in (shut, closed):
            folder.mkdir()
        for name in ("a.toml", "a.sigdb"):
            shutil.copy(self.path / name, shut / name)
            shutil.copy(self.path / name, self.path / f"no{name}")
            (self.path / f"no{name}").chmod(0)
        (self.path / "a.sigdb").chmod(0o644)
        (self.path / "no.csv").touch(0)
        (self.path / "model.toml").write_text(SWEEP.replace('generate = "sphere", triangles = 100', 'file = "no.csv.obj", unit_m = 1, forward_axis = "+x", up_axis = "+z"'))
        (self.path / "no.csv.obj").touch(0)
        shut.chmod(0)
        closed.chmod(0o755)
        self.addCleanup(shut.chmod, 0o755)
        scratch = self.path / "scratch"
        scratch.mkdir()
        scratch.chmod(0o777)
        asked = []
        for db in ("noa.sigdb", "shut/a.sigdb"):
            asked += [["query", db], ["report", db], ["digest", db], ["doctor", db], ["explain", db, "--row", "1"], ["profile", db], ["export", db, "--out", scratch / "x.csv"],
                      ["plot", db, "--kind", "polar", "--out", scratch / "x.svg"], ["slice", db, "--out", scratch / "x.sigdb"], ["merge", db, "--out", scratch / "x.sigdb"],
                      ["serve", db, "--port", "0"], ["plan", "--refine", db], ["show", "temperatures", db],
                      ["bands", db, "--window", "8,9", "--nei", "1"], ["query", db, "--row", "1", "--thumbnail", scratch / "x.exr"]]
        for sweep in ("noa.toml", "shut/a.toml"):
            asked += [["plan", sweep], ["run", sweep, "--db", scratch / "y.sigdb"], ["show", "precompute", sweep], ["goniometer", sweep, "--out", scratch / "g"],
                      ["verify-effects", sweep], ["accuracy", sweep, "--check-errors"]]
        asked += [["plan", "model.toml"], ["run", "a.toml", "--db", "noa.sigdb"], ["model", "check", "no.csv.obj"], ["init", "--model", "no.csv.obj"],
                  ["query", "a.sigdb", "--response", "no.csv"], ["bands", "a.sigdb", "--detector", "no.csv"], ["ca", "list", "shut"],
                  # Nothing may be written there.
                  ["run", "a.toml", "--db", "closed/z.sigdb"], ["plan", "a.toml", "--db", "closed/z.sigdb"], ["export", "a.sigdb", "--out", "closed/x.csv"],
                  ["export", "a.sigdb", "--out", "closed/x.nc"], ["export", "a.sigdb", "--out", "closed/x.sli"], ["export", "a.sigdb", "--thumbnails", "--out", "closed/x"],
                  ["query", "a.sigdb", "--out", "closed/x.csv"], ["slice", "a.sigdb", "--out", "closed/x.sigdb"], ["merge", "a.sigdb", "--out", "closed/x.sigdb"],
                  ["model", "box", "--triangles", "12", "--out", "closed/b.obj"], ["ca", "init", "closed/ca"], ["goniometer", SOURCE / "jobs/examples/goniometer_soil.toml", "--out", "closed/g"]]
        environment = {**os.environ, "TMPDIR": str(scratch)}
        for command in asked:
            with self.subTest(" ".join(map(str, command))):
                done = subprocess.run([IRSIG, *map(str, command)], cwd=self.path, user=NOBODY, group=NOBODY, extra_groups=[], capture_output=True, text=True, env=environment, timeout=300)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn("Permission denied", done.stderr)

    def test_a_full_disk_is_not_called_a_permission(self):
        """Exporting netCDF said "netCDF: create: Permission denied"."""
        if not hasattr(os, "fork") or (pid := os.fork()) == 0:
            os._exit(self.export_on_a_small_disk())
        code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        if code == 77:
            self.skipTest("this machine does not allow mounts")
        self.assertEqual(code, 0)

    def export_on_a_small_disk(self):
        """In a mount namespace of a process of its own. 77: none is allowed."""
        try:
            if not small_disk.enter_namespace():
                return 77
            disk = small_disk.SmallDisk(self.path / "disk", 1, ("tmpfs",))
            if disk.kind == "folder":
                return 77
            disk.fill()
            for name in ("x.nc", "x.csv", "x.sli"):
                done = subprocess.run([IRSIG, "export", "a.sigdb", "--out", disk.path / name], cwd=self.path, capture_output=True, text=True)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertRegex(done.stderr, "No space left on device|disk full")
                self.assertNotIn("Permission denied", done.stderr)
            return 0
        except BaseException as error:
            print(error, file=sys.stderr)
            return 1


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
