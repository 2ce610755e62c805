"""Fail on words that do not belong in a source tree.

usage: check_words.py <source root>

Checked in every text file: paths of one machine or of one workplace, and marks of unfinished work.
Checked in names: folders and files that say nothing (STYLE: a folder is a noun and a layer).
"""

import pathlib
import re
import sys

MACHINE_PATH = re.compile(r"(?<![\w.$}])/(work|home|root|Users)(/|\b)")
UNFINISHED = re.compile(r"\b(TODO|FIXME|XXX|HACK)\b")
EMPTY_NAME = re.compile(r"(^|_)(utils?|common|misc|helpers?|managers?)(_|$)")
SKIPPED_FOLDERS = {".git", "build", "out", "__pycache__"}
TEXT = {".c", ".cc", ".cmake", ".cpp", ".css", ".csv", ".h", ".html", ".inc", ".js", ".json", ".md", ".proto", ".py", ".service",
        ".sh", ".sql", ".supp", ".svg", ".toml", ".txt", ""}


def files_below(root):
    for path in sorted(root.iterdir()):
        if path.name in SKIPPED_FOLDERS:
            continue
        yield path
        if path.is_dir():
            yield from files_below(path)


def check(root):
    findings = []
    for path in files_below(root):
        name = path.relative_to(root)
        if EMPTY_NAME.search(path.name.split(".")[0].lower()):
            findings.append(f"{name}: a name that says nothing about what is in it")
        if path.is_dir() or path.suffix not in TEXT:
            continue
        if name.parts[:2] == ("tests", "architecture"):  # the words stand here to be searched for
            continue
        for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
            for pattern, what in ((MACHINE_PATH, "a path of one machine"), (UNFINISHED, "unfinished work")):
                if found := pattern.search(line):
                    findings.append(f"{name}:{number}: {what}: {found[0]}")
    return findings


if __name__ == "__main__":
    findings = check(pathlib.Path(sys.argv[1]))
    print("\n".join(findings))
    sys.exit(bool(findings))
