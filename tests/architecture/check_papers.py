"""The tables of the five papers in docs/evidence/validation.md are those that ops/papers.sh makes.

usage: check_papers.py <repository>
"""
import pathlib, re, sys

PAGE = "docs/evidence/validation.md"
AGREEMENTS = ("yes", "in order", "no", "not compared")


def complaints(page, script):
    """What is wrong: marks without a part, rows of another part, rows that neither agree nor say why."""
    parts = re.search(r"\|\| parts=\(([^)]+)\)", script)
    if not parts:
        return ["ops/papers.sh: no list `parts=(...)` of all parts"]
    known = parts[1].split()
    out = []
    for part in known:
        tables = re.findall(rf"<!-- begin papers {part} -->\n(.*?)<!-- end papers {part} -->", page, re.S)
        if len(tables) != 1:
            out.append(f"{PAGE}: expected one pair of marks `papers {part}`, found {len(tables)}")
            continue
        rows = [[c.strip() for c in line.strip("|\n").split("|")] for line in tables[0].splitlines()[2:]]
        if not rows:
            out.append(f"{PAGE}: the table of `{part}` is empty: run `ops/papers.sh --write {part}`")
        for row in rows:
            if len(row) != 7:
                out.append(f"{PAGE}: {row[0]}: {len(row)} cells in a row of `{part}`, expected 7")
            elif row[5] != f"`{part}`":
                out.append(f"{PAGE}: {row[0]}: {row[5]} in the table of `{part}`")
            elif row[4] not in AGREEMENTS or (row[4] in AGREEMENTS[2:] and not row[6]):
                out.append(f"{PAGE}: {row[0]}: agreement `{row[4]}` in `{part}`, expected one of {', '.join(AGREEMENTS)}; the last two need a remark")
    for part in set(re.findall(r"<!-- begin papers (\S+) -->", page)) - set(known):
        out.append(f"{PAGE}: marks `papers {part}`, but ops/papers.sh has no such part")
    return out


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1])
    wrong = complaints((root / PAGE).read_text(), (root / "ops/papers.sh").read_text())
    if wrong:
        sys.exit("\n".join(wrong))
