"""Fail if the pages of docs/ have more prose than MOST words: a page says each thing once, and a table says it shorter.

usage: check_prose.py <source root> [--report]      --report prints the words of each page, fewest first, and their sum

Counted: every word of docs/ but decision records. Tables, fenced and indented code do not count; headings and lists do.
"""

import pathlib
import re
import sys

MOST = 60000
RECORDS = "docs/decisions"


def prose(text):
    """Returns the number of words of a page outside tables and code."""
    words, fenced, flowing = 0, False, False
    for line in text.splitlines():
        if re.match(r"\s*(```|~~~)", line):
            fenced = not fenced
            continue
        code = fenced or (line.startswith("    ") and not flowing)
        table = line.lstrip().startswith("|")
        flowing = bool(line.strip()) and not code and not table  # an indented line goes on with what stands above it
        if flowing:
            words += len(line.split())
    return words


def counts(root):
    """{path: words}, fewest first."""
    pages = [path for path in sorted(root.glob("docs/**/*.md")) if not path.is_relative_to(root / RECORDS)]
    words = {path.relative_to(root): prose(path.read_text()) for path in pages}
    return dict(sorted(words.items(), key=lambda page: page[1]))


def check(root):
    words = counts(root)
    if sum(words.values()) <= MOST:
        return []
    longest = ", ".join(f"{name} ({words[name]})" for name in list(words)[:-4:-1])
    return [f"docs: {sum(words.values())} words outside tables and code, more than {MOST}; cut what another page or a table says, "
            f"first in the longest pages: {longest}"]


def report(root):
    words = counts(root)
    return [*(f"{count:6d} {name}" for name, count in words.items()), f"{sum(words.values()):6d} in all"]


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1])
    lines = report(root) if sys.argv[2:] == ["--report"] else check(root)
    print("\n".join(lines))
    sys.exit(bool(lines) and sys.argv[2:] != ["--report"])
