#!/usr/bin/env bash
# Remakes the pictures and tables of docs/accuracy.md, in about three minutes; nothing else should run on
# the machine meanwhile.
#
# usage: ops/accuracy-page.sh [path of the irsig executable]      (default: built by ops/build.sh)
set -euo pipefail
cd "$(dirname "$0")/.."
if (($# == 0)); then
  ops/build.sh irsig >&2
fi
irsig=${1:-$PWD/build/release/bin/irsig}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

study() {  # name, then options
  local name=$1
  shift
  "$irsig" accuracy "jobs/examples/$name.toml" --out "$work/$name" "$@" > /dev/null
  cp "$work/$name"/accuracy-"$name"-*.svg docs/images/
}
study frigate --seconds 100
study cavity --seconds 30
study quickstart --seconds 40 --band mwir

# Between the marks of each scene stands what the command wrote; the goals are read from the frigate's tables.
python3 - "$work" <<'PYTHON'
import pathlib
import re
import sys

page, work = pathlib.Path("docs/accuracy.md"), pathlib.Path(sys.argv[1])
text = page.read_text()


def put(name, tables):
    global text
    mark = re.compile(rf"(<!-- begin {name} -->\n).*?(<!-- end {name} -->)", re.S)
    text, count = mark.subn(lambda m: m.group(1) + tables.strip() + "\n" + m.group(2), text)
    if count != 1:
        sys.exit(f"{page}: expected one pair of marks for {name}, found {count}")


for scene in ("frigate", "cavity", "quickstart"):
    put(scene, (work / scene / "accuracy.md").read_text())


def frigate(band):
    """[start of a table's caption][method]: its cells."""
    section = next(s for s in (work / "frigate" / "accuracy.md").read_text().split("### ")
                   if f", {band}, " in s.partition("\n")[0])
    tables, caption = {}, None
    for line in section.splitlines():
        if line.startswith("| "):
            cells = [c.strip() for c in line.strip("|").split("|")]
            tables[caption][cells[0]] = cells[1:]
        elif line and not line.startswith("|"):
            caption = " ".join(line.split()[:4])
            tables.setdefault(caption, {})
    return tables["CPU time to a"], tables["Slope of the random"]


OURS, BARE, PLAIN = "ours, quasi-Monte Carlo", "ours, quasi, no masks or strata", "plain Monte Carlo, each wavelength"
bands = [frigate(band) for band in ("mwir", "lwir")]


def goal(what, wanted, table, method, column, reached):
    """One line; reached(number): whether a band's number is good enough (None: no goal)."""
    cells = [band[table][method][column] for band in bands]
    numbers = [float(c.lstrip("~")) for c in cells]
    missed = reached and not all(map(reached, numbers))
    return f"| {what} | {wanted} | {'**missed**: ' if missed else ''}{', '.join(cells)} |"


def ratio(what, wanted, column):
    return goal(what, wanted, 0, OURS, column, wanted != "-" and (lambda r: r >= float(wanted)))


def slope(what, method, column, wanted=None):
    return goal(what, "-" if wanted is None else f"{wanted:.2f}", 1, method, column,
                wanted is not None and (lambda s: s <= wanted))


put("goals", "\n".join([
    "| | goal | reached: mid-wave, long-wave |", "|---|---|---|",
    ratio("time to 1 %, plain / ours, spectrum", "10", 7),
    ratio("time to 0.1 %, plain / ours, spectrum", "20", 9),
    ratio("the same, of the in-band intensity alone: 1 %", "10", 1),
    ratio("in-band, 0.1 %", "20", 4),
    ratio("in-band, 1 %, with all set-up of a single view in both", "-", 2),
    ratio("in-band, 0.1 %, with all set-up of a single view in both", "-", 5),
    goal("rays for 0.1 % of emission, all replicates", "2e5", 1, OURS, 4, lambda n: n <= 2e5),
    slope("slope of projected area, as shipped", OURS, 0, -0.7),
    slope("slope of emission, as shipped", OURS, 1, -0.7),
    slope("slope of projected area, without masks and strata", BARE, 0),
    slope("slope of emission, without masks and strata (hot parts by chance)", BARE, 1),
    slope("slope of plain Monte Carlo (law of large numbers: -0.5), intensity", PLAIN, 2),
]))
page.write_text(text)
PYTHON
