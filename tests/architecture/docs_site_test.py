"""The checks of the site of docs/ find each kind of broken page, and its pages are staged as GitHub shows them.

usage: docs_site_test.py <source root>
"""

import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(ROOT / "ops"))
import docs_site  # noqa: E402


class Checks(unittest.TestCase):
    def problems(self, body, sheet=""):
        with tempfile.TemporaryDirectory() as folder:
            site = pathlib.Path(folder)
            (site / "a.html").write_text(body)
            (site / "b.html").write_text('<h2 id="here">b</h2>')
            (site / "a.css").write_text(sheet)
            return docs_site.problems_of(site)

    def test_sound_links_pass(self):
        self.assertEqual(self.problems('<a href="b.html#here">b</a><a href="https://example.org">out</a>'), [])

    def test_a_missing_page_is_found(self):
        self.assertEqual(self.problems('<a href="c.html">c</a>'), ["a.html: c.html has no target"])

    def test_a_missing_heading_is_found(self):
        self.assertIn("names a heading", self.problems('<a href="b.html#there">b</a>')[0])
        self.assertIn("names a heading", self.problems('<a href="#there">a</a>')[0])

    def test_a_missing_picture_is_found(self):
        self.assertEqual(len(self.problems('<img src="c.png">')), 1)

    def test_what_a_network_brings_is_found(self):
        self.assertEqual(len(self.problems('<script src="https://example.org/a.js"></script>')), 1)
        self.assertEqual(len(self.problems('<link href="//example.org/a.css">')), 1)
        self.assertEqual(len(self.problems("", "@font-face { src: url(https://example.org/a.woff) }")), 1)


class Staging(unittest.TestCase):
    def test_anchors_are_those_of_github(self):
        self.assertEqual(docs_site.github_slug("[land]: a `key`, 2 - 3", "-"), "land-a-key-2---3")

    def test_folders_stand_for_their_readme(self):
        page, found = ROOT / "docs/README.md", []
        text = docs_site.staged(page, found)
        self.assertIn("(../jobs/examples/README.md)", text)
        self.assertIn(ROOT / "jobs/examples/README.md", found)

    def test_every_page_of_docs_is_in_the_menu_once(self):
        pages = [page.relative_to(ROOT) for page in sorted((ROOT / "docs").rglob("*.md"))]
        menu = docs_site.navigation(pages)
        for page in pages:
            self.assertEqual(menu.splitlines().count(f"      - {page}"), 1)


if __name__ == "__main__":
    unittest.main()
