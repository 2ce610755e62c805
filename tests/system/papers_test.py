"""ops/papers.sh: its quickest part runs, and the page has what the programs give.

usage: papers_test.py <irsig executable> <source folder>
"""
import pathlib, re, subprocess, sys, tempfile, unittest

IRSIG, SOURCE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
sys.path.insert(0, str(SOURCE / "ops/papers"))
import goniometer  # noqa: E402
import report  # noqa: E402

PAGE = (SOURCE / "docs/evidence/validation.md").read_text()


def rows(text):
    """{finding: [where, finding, paper, ours, agreement, part, remark]}"""
    cells = [[c.strip() for c in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("| ")]
    return {row[1]: row for row in cells if len(row) == 7}


def numbers(text):
    return [float(n) for n in re.findall(r"[-+]?\d+\.?\d*", text)]


def papers(*words, code=0):
    done = subprocess.run([SOURCE / "ops/papers.sh", "--bin", IRSIG.parent, *words], capture_output=True, text=True)
    assert done.returncode == code, done.stdout + done.stderr
    return done


class Papers(unittest.TestCase):
    def test_the_quickest_part_gives_what_the_page_has(self):
        found, written = rows(papers("--coarse", "cavity").stdout), rows(PAGE)
        self.assertGreater(len(found), 6)
        for finding, row in found.items():
            if finding == "finding":
                continue
            self.assertIn(finding, written)
            self.assertEqual(row[4], written[finding][4], finding)
            for ours, said in zip(numbers(row[3]), numbers(written[finding][3]), strict=True):
                self.assertAlmostEqual(ours, said, delta=0.2, msg=finding)  # four errors of 0.05 K

    def test_ratios_of_the_soiled_paint_are_those_of_the_page(self):
        """Rationale: the page once had the numbers of another bed under this example's command.
        Expected: the example's own; fewer coverages change none of them.
        Source: each coverage is a run of its own."""
        with tempfile.TemporaryDirectory() as folder:
            lab = report.Lab(IRSIG.parent, folder)
            text = report.change(lab.example("goniometer_soil_on_paint"), (r"^coverage = .*?$", "coverage = [0.27, 0.44, 0.9]"))
            views = goniometer.soiled(lab, "few", text)
        shown = [views[c] for c in (0.9, 0.44, 0.27)]
        said = {finding[:60]: numbers(row[3]) for finding, row in rows(PAGE).items()}
        lobe = said["soil on paint, lamp at 30 deg, 90, 44, 27 % covered: forward over backscatter"[:60]]
        colour = said["the same: blue over red in backscatter at 30 deg"]
        for v, forward, blue in zip(shown, lobe, colour, strict=True):
            self.assertAlmostEqual(v["green", 30, 30, 180] / v["green", 30, 30, 0], forward, delta=0.01 * forward)
            self.assertAlmostEqual(v["blue", 30, 30, 0] / v["red", 30, 30, 0], blue, delta=0.01 * blue)

    def test_what_is_no_part_is_named(self):
        self.assertIn('no part "moon"', papers("moon", code=2).stderr)
        for folder in ((), ("/",)):
            done = subprocess.run([SOURCE / "ops/papers.sh", "--bin", *folder], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn("no program irsig", done.stderr)
        self.assertIn("leave --coarse out", papers("--write", "--coarse", "cavity", code=2).stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
