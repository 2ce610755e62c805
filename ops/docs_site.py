#!/usr/bin/env python3
"""Builds the pages of docs/ as a web site by mkdocs, with the theme "material".

usage: ops/docs_site.py FOLDER      (ops/docs.sh installs what it needs)

Files outside docs/ that pages link to (examples, READMEs of rooms, scripts) are copied into the site; pages among them are
followed. A link to a file that does not exist is an error. The pages load nothing from other machines.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"(\]\()([^)\s#]+)(#[^)\s]*)?(\))")
# The order of the menu, with the name of each folder of docs/.
MENU = {"tutorials": "Tutorials", "howto": "How to", "reference": "Reference", "explanation": "Explanation", "evidence": "Evidence",
        "developers": "Developers", "decisions": "Decisions"}


def place_of(file):
    """Where a file of the tree lies in the site's sources."""
    path = file.relative_to(ROOT)
    return pathlib.Path(*path.parts[1:]) if path.parts[0] == "docs" else pathlib.Path("source") / path


def staged(folder):
    """Copies the pages, and every file that one of them links to, with links between the copies; their places."""
    todo = sorted((ROOT / "docs").rglob("*"))
    done = set()
    while todo:
        file = todo.pop()
        if file in done or file.is_dir():
            continue
        done.add(file)
        to = folder / place_of(file)
        to.parent.mkdir(parents=True, exist_ok=True)
        if file.suffix != ".md":
            shutil.copy(file, to)
            continue

        def moved(match):
            if re.match(r"[a-z]+:", match[2]):
                return match[0]
            there = pathlib.Path(os.path.normpath(file.parent / match[2]))
            if there.is_dir() and (there / "README.md").exists():
                there /= "README.md"
            if not there.is_file():
                return match[0]  # architecture.links judges it
            todo.append(there)
            return match[1] + os.path.relpath(place_of(there), place_of(file).parent) + (match[3] or "") + match[4]

        to.write_text(LINK.sub(moved, file.read_text()))
    return done


def title_of(page):
    found = re.search(r"^# (.+)$", page.read_text(), re.M)
    return found[1].replace("`", "") if found else page.stem


def menu_of(folder, below):
    """The menu of a folder: its own page first, then its pages by title, then its folders."""
    pages = sorted((p for p in (folder / below).glob("*.md") if p.name != "README.md"),
                   key=title_of if below.name != "decisions" else lambda p: p.name)
    own = [p for p in [folder / below / "README.md"] if p.exists()]
    out = [{title_of(p): str(p.relative_to(folder))} for p in own + pages]
    for inner in sorted(p for p in (folder / below).iterdir() if p.is_dir() and any(p.glob("*.md"))):
        name = title_of(inner / "README.md") if (inner / "README.md").exists() else inner.name.capitalize()
        out.append({name: menu_of(folder, inner.relative_to(folder))})
    return out


# Tables of keys have seven columns: the page is wide, and names are not broken.
STYLE = """.md-grid { max-width: 88rem; }
.md-typeset table:not([class]) th, .md-typeset table:not([class]) td { padding: .5em .7em; min-width: 0; }
.md-typeset table:not([class]) td:first-child code { white-space: nowrap; }
"""


def settings(folder, site):
    menu = [{"Home": "README.md"}, {"Gallery": "gallery.md"}]
    menu += [{name: menu_of(folder, pathlib.Path(below))} for below, name in MENU.items()]
    return {
        "site_name": "irsig", "docs_dir": str(folder), "site_dir": str(site), "use_directory_urls": False, "nav": menu,
        "theme": {"name": "material", "font": False, "features": ["navigation.sections", "navigation.top"]},
        "plugins": ["search"], "extra_css": ["style.css"], "markdown_extensions": ["tables", "fenced_code", {"toc": {"permalink": True}}, "sane_lists"],
        "extra": {"generator": False},
    }


def main():
    site = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "pages"
        staged(folder)
        (folder / "style.css").write_text(STYLE)
        config = pathlib.Path(scratch) / "mkdocs.yml"
        config.write_text(json.dumps(settings(folder, site)))  # JSON is YAML
        subprocess.run(["mkdocs", "--quiet", "build", "--clean", "--config-file", str(config)], check=True)
    loaded = [f"{page.relative_to(site)}: {m[0][:100]}" for page in site.rglob("*.html")
              for m in re.finditer(r'(?:src|href)="https?://[^"]*\.(?:js|css|woff2?)"', page.read_text())]
    if loaded:
        sys.exit("pages load from other machines:\n" + "\n".join(loaded[:10]))
    print(f"{sum(1 for _ in site.rglob('*.html'))} pages: {site / 'index.html'}")


if __name__ == "__main__":
    main()
