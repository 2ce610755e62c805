"""Fail on links of Markdown pages to files and headings that do not exist.

usage: check_links.py <source root>

Checked: every relative link and picture of every page, and its anchor, against the names that GitHub gives to headings. Links
to other sites are not followed. Links in code are no links.
"""

import os
import pathlib
import re
import sys

from check_words import files_below

LINK = re.compile(r"\]\(([^)\s]+)\)")
FENCE = re.compile(r"^\s*(```|~~~)")
SITE = re.compile(r"^[a-z]+:")


def prose(text):
    """(number, line without code) of the lines that are not code."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if FENCE.match(line):
            fenced = not fenced
        elif not fenced and not line.startswith("    "):
            yield number, line


def anchors(text):
    """The names by which links may point into a page."""
    names, seen = set(), {}
    for _, line in prose(text):
        if heading := re.match(r"^#{1,6}\s+(.*?)\s*#*$", line):
            words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).lower()
            name = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
            times = seen.get(name, 0)
            seen[name] = times + 1
            names.add(f"{name}-{times}" if times else name)
        names |= set(re.findall(r'<a (?:id|name)="([^"]+)"', line))
    return names


def check(root):
    findings = []
    pages = {path: path.read_text(errors="replace") for path in files_below(root) if path.suffix == ".md"}
    names = {path: anchors(text) for path, text in pages.items()}
    for page, text in pages.items():
        for number, line in prose(text):
            for link in LINK.findall(re.sub(r"`[^`]*`", "", line)):
                path, _, anchor = link.partition("#")
                target = pathlib.Path(os.path.normpath(page.parent / path)) if path else page
                if SITE.match(link):
                    continue
                if not target.exists():
                    findings.append(f"{page.relative_to(root)}:{number}: links to {path}, which does not exist")
                elif anchor and anchor not in names.get(target, {anchor}):
                    findings.append(f"{page.relative_to(root)}:{number}: {target.relative_to(root)} has no heading #{anchor}")
    return findings


if __name__ == "__main__":
    findings = check(pathlib.Path(sys.argv[1]).resolve())
    print("\n".join(findings))
    sys.exit(bool(findings))
