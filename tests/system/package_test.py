"""The Debian package: what it holds runs from where it is unpacked, needs what it says, and its units are whole.

usage: package_test.py <irsig> <repository> <build folder>
"""
import pathlib, re, shutil, subprocess, sys, tempfile, unittest

IRSIG, ROOT, BUILD = (pathlib.Path(a).resolve() for a in sys.argv[1:4])


def run(*arguments, **options):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, timeout=600, **options)
    assert done.returncode == 0, f"{arguments}: {done.stdout}{done.stderr}"
    return done.stdout + done.stderr


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name)
        run("cpack", "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip", "-D", f"CPACK_OUTPUT_FILE_PREFIX={cls.path}/made", "-B", cls.path / "work", cwd=BUILD)
        (cls.deb,) = cls.path.glob("made/*.deb")
        cls.root = cls.path / "root"
        run("dpkg-deb", "-x", cls.deb, cls.root)

    def test_runs_from_where_it_lies(self):
        programs = {"irsig", "irsig-coordinator", "irsig-worker"}
        self.assertEqual({p.name for p in (self.root / "usr/bin").iterdir()}, programs)
        here = shutil.copytree(self.root / "usr/share/irsig", self.path / "share")
        sweep = here / "jobs/examples/quickstart.toml"
        sweep.write_text(sweep.read_text().replace("count = 24", "count = 2"))
        digests = []
        for irsig in (self.root / "usr/bin/irsig", IRSIG):
            db = self.path / f"{len(digests)}.sigdb"
            run(irsig, "run", sweep, "--db", db)
            digests.append(run(irsig, "digest", db).split()[0])
        self.assertEqual(*digests)
        # With its programs beside it: models are read by one, pictures by another.
        report = subprocess.run([self.root / "usr/bin/irsig", "model", "check", here / "jobs/models/houses.obj"], capture_output=True, text=True)
        self.assertIn("1696 facets", report.stdout)
        run(self.root / "usr/bin/irsig", "query", db, "--row", "1", "--thumbnail", self.path / "one.png", "--thumbnail-scale", "common")
        for example in sorted((ROOT / "jobs/examples").rglob("*.toml")):
            self.assertTrue((here / example.relative_to(ROOT)).exists(), example)
        self.assertIn("irsig", run(sys.executable, "-c", f"import sys; sys.path.insert(0, '{self.root}/usr/lib/python3/dist-packages'); import irsig; print(irsig.__name__)"))

    def test_states_what_it_needs(self):
        control = run("dpkg-deb", "-f", self.deb)
        for library in ("libembree3-3", "libgrpc++1.51", "libopenimageio2.4", "libopenvdb10.0", "libsqlite3-0", "libgeographiclib23", "liberfa1"):
            self.assertRegex(control, rf"Depends:.*\b{re.escape(library)}\b")
        self.assertNotIn("-dev", control.split("Depends:")[1].splitlines()[0])
        # Everything belongs to root, nothing may be written by others.
        for line in run("dpkg-deb", "-c", self.deb).splitlines():
            self.assertRegex(line, r"^[-dl]r[w-][x-]r-[x-]r-[x-] root/root|^l", line)

    def test_man_pages(self):
        pages = {p.name for p in (self.root / "usr/share/man/man1").glob("*.1")}
        self.assertLessEqual({"irsig.1", "irsig-run.1", "irsig-model-check.1"}, pages)
        self.assertIn("irsig\\-run \\- compute a sweep", (self.root / "usr/share/man/man1/irsig-run.1").read_text())

    def test_units(self):
        for unit in ("irsig-coordinator.service", "irsig-worker@.service"):
            text = (self.root / "usr/lib/systemd/system" / unit).read_text()
            self.assertIn("ExecStart=/usr/bin/irsig-", text)
            # The same with its program where it was unpacked.
            file = self.path / unit.replace("@", "@1")
            file.write_text(text.replace("=/usr/bin/", f"={self.root}/usr/bin/"))
            self.assertEqual(run("systemd-analyze", "verify", "--man=no", file), "")
            # Its command is understood.
            command = re.search(r"ExecStart=/usr/bin/(\S+) (.*)", text)
            options = run(self.root / "usr/bin" / command[1], "--help")
            for option in re.findall(r"--[a-z-]+", command[2]):
                self.assertIn(option, options)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
