"""Build the static site of docs/ with MkDocs and check it: every link has a target, nothing loads from a network.

usage: docs_site.py <output folder>      writes <output>/html; <output>/source has the pages that MkDocs was given;
                                         exit code 77 without MkDocs, 1 with a broken link
"""

import html.parser
import os
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"\]\(([^)\s]+)\)")
FENCE = re.compile(r"^\s*(```|~~~)")
ITEM = re.compile(r"^ *([-*+]|\d+\.) ")
SECTIONS = {"tutorials": "Tutorials", "howto": "How-to", "reference": "Reference", "explanation": "Explanation",
            "evidence": "Evidence", "developers": "Developers", "decisions": "Decisions"}
# Debian packages whose files the site carries; their licences go with it.
CARRIED = ("mkdocs", "sphinx-rtd-theme-common", "fonts-lato", "fonts-font-awesome", "libjs-jquery", "libjs-modernizr",
           "libjs-lunr")
CONFIG = """site_name: irsig
docs_dir: source
site_dir: html
use_directory_urls: false
theme:
  name: readthedocs
  highlightjs: false
  navigation_depth: 3
plugins: [search]
extra_css: [site.css]
markdown_extensions:
  - sane_lists
  - toc:
      slugify: !!python/name:docs_site.github_slug
nav:
"""


# The theme keeps each cell of a table on one line and pages 800 pixels wide: the columns of reference need more.
STYLE = """.wy-nav-content { max-width: 1100px; }
.wy-table-responsive table td, .wy-table-responsive table th { white-space: normal; }
"""


def github_slug(heading, separator):
    """Returns the anchor that GitHub gives to a heading, which the links of docs/ name."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", separator)


def target_of(page, link):
    """Returns the file of the repository that a page's link names, or None; a folder stands for its README.md."""
    if re.match(r"[a-z]+:|#", link):
        return None
    path = pathlib.Path(os.path.normpath(page.parent / urllib.parse.unquote(link.split("#")[0])))
    if path.is_dir():
        path = path / "README.md"
    return path if path.is_file() and ROOT in path.parents else None


def staged(page, found):
    """Returns a page's text for MkDocs and adds the files it links to to found.

    Lists get the empty line before them that Python-Markdown needs. Links to folders name their README.md; a link to a
    folder without one becomes its text.
    """
    def link(match):
        target = target_of(page, match[1])
        if target is None:
            return match[0]
        found.append(target)
        anchor = "#" + match[1].split("#")[1] if "#" in match[1] else ""
        return f"]({os.path.relpath(target, page.parent)}{anchor})"

    lines, fenced, before = [], False, ""
    for line in page.read_text().splitlines():
        if FENCE.match(line):
            fenced = not fenced
        elif not fenced:
            line = LINK.sub(link, line)
            line = re.sub(r"\[([^\]]+)\]\(([^)\s#:]+/)\)", r"\1", line)
            if ITEM.match(line) and before.strip() and not ITEM.match(before) and not before.startswith(" "):
                lines.append("")
        lines.append(line)
        before = line
    return "\n".join(lines) + "\n"


def stage(source):
    """Writes README.md, docs/ and every file that these link to into source, at their places; returns the pages."""
    waiting = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    done = set()
    while waiting:
        path = waiting.pop()
        if path in done:
            continue
        done.add(path)
        copy = source / path.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".md":
            copy.write_text(staged(path, waiting))
        else:
            shutil.copyfile(path, copy)
    return sorted(path.relative_to(ROOT) for path in done if path.suffix == ".md")


def navigation(pages):
    """Returns the YAML lines of the menu: a section for each kind of page, the pages of the code last."""
    sections = {"Start": [], **{title: [] for title in SECTIONS.values()}, "Code": []}
    for page in pages:
        top = page.parts[1] if page.parts[0] == "docs" and len(page.parts) > 2 else ""
        start = page.parts[0] == "docs" or page == pathlib.Path("README.md")
        sections[SECTIONS.get(top, "Start" if start else "Code")].append(page)
    lines = []
    for title, members in sections.items():
        if members:
            lines += [f"  - {title}:"] + [f"      - {page}" for page in members]
    return "\n".join(lines) + "\n"


class Page(html.parser.HTMLParser):
    """Collects a page's anchors, its links and what a browser loads with it."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.links, self.loads = {""}, [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.anchors |= {attrs[key] for key in ("id", "name") if attrs.get(key)}
        if tag == "a" and attrs.get("href"):
            self.links.append(attrs["href"])
        self.loads += [attrs[key] for key in ("src", "href") if attrs.get(key) and tag != "a"]


def problems_of(site):
    """Returns a line for each link of the site without a target and each file that comes from a network."""
    pages = {path: Page(path.read_text()) for path in sorted(site.rglob("*.html"))}
    problems = []
    for path, page in pages.items():
        name = path.relative_to(site)
        problems += [f"{name}: loads {link} from a network" for link in page.loads if re.match(r"(https?:)?//", link)]
        for link in page.links + page.loads:
            if re.match(r"[a-z]+:|//", link) or (name.name == "404.html" and link.startswith("/")):
                continue
            file, _, anchor = urllib.parse.unquote(link).partition("#")
            target = pathlib.Path(os.path.normpath(path.parent / file.split("?")[0])) if file else path
            if target.is_dir():
                target = target / "index.html"
            if not target.is_file():
                problems.append(f"{name}: {link} has no target")
            elif anchor and target in pages and anchor not in pages[target].anchors:
                problems.append(f"{name}: {link} names a heading that its page does not have")
    for sheet in site.rglob("*.css"):
        if re.search(r"url\([\"']?(https?:)?//|@import [\"'](https?:)?//", sheet.read_text()):
            problems.append(f"{sheet.relative_to(site)}: loads a file from a network")
    return problems


def mend_theme(site):
    """Mends what Debian 12's theme (mkdocs 1.4.2) leaves broken.

    Its pages name jquery by upstream's version, not by the file that Debian ships, and want a script that Debian does
    not ship, which gives tables their look. The page 404.html has absolute addresses, of no use in a folder. Fonts that
    are there as WOFF2, which every browser since 2018 reads, go in their older formats: they are half of the package.
    """
    (site / "404.html").unlink(missing_ok=True)
    for font in [*site.rglob("*.ttf"), *site.rglob("*.eot"), *site.rglob("*.woff"), *site.rglob("fonts/*.svg")]:
        if font.with_suffix(".woff2").exists():
            font.unlink()
    shipped = sorted((site / "js").glob("jquery-*.min.js"))
    for path in site.rglob("*.html"):
        text = path.read_text()
        if shipped:
            text = re.sub(r"jquery-[\d.]+\.min\.js", shipped[0].name, text)
        if not (site / "js/theme_extra.js").exists():
            text = re.sub(r'<script src="[^"]*theme_extra\.js"[^>]*></script>', "", text)
            text = text.replace("<table>", '<table class="docutils">')
        path.write_text(text)


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    if not shutil.which("mkdocs"):
        print("docs_site.py: mkdocs is not installed: no site is built; install it with ops/setup.sh")
        return 77  # ctest: skipped
    out = pathlib.Path(sys.argv[1]).resolve()
    shutil.rmtree(out, ignore_errors=True)
    (out / "source").mkdir(parents=True)
    pages = stage(out / "source")
    (out / "source/site.css").write_text(STYLE)
    (out / "mkdocs.yml").write_text(CONFIG + navigation(pages))
    here = {**os.environ, "PYTHONPATH": str(ROOT / "ops"), "PYTHONDONTWRITEBYTECODE": "1"}
    build = subprocess.run(["mkdocs", "build", "--quiet", "--config-file", out / "mkdocs.yml"], env=here)
    if build.returncode:
        return build.returncode
    mend_theme(out / "html")
    (out / "html/licences").mkdir()
    for package in CARRIED:
        shutil.copyfile(f"/usr/share/doc/{package}/copyright", out / f"html/licences/{package}.txt")
    problems = problems_of(out / "html")
    print("\n".join(problems) or f"{len(pages)} pages: {out / 'html/index.html'}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
