#!/usr/bin/env bash
# Remakes the pictures and tables of docs/evidence/accuracy.md, in about half an hour; nothing else should run on
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
meshes() {  # name of what is written, sweep, meshes
  "$irsig" accuracy "jobs/examples/$2.toml" --meshes "$3" --relative-error 1e-4 --out "$work/meshes-$1" > /dev/null
}
meshes frigate frigate 0.66,1,1.63
meshes frigate-2 frigate 0.5,1,2
meshes frigate-coarse frigate 0.01,0.03,0.1,0.3,1
meshes sphere painted_sphere 0.005,0.02,0.1,1
meshes cylinder primitives/cylinder 0.01,0.1,0.5,1
"$irsig" verify-effects --matrix --timed 2 --reference-paths 50 --values "$work/matrix.csv" > "$work/matrix.txt"
"$irsig" verify-effects --matrix --small --each-effect > "$work/bounds.txt"

# Between the marks of each scene stands what the command wrote; the goals are read from the frigate's tables.
python3 - "$work" <<'PYTHON'
import csv
import pathlib
import re
import statistics
import sys

page, work = pathlib.Path("docs/evidence/accuracy.md"), pathlib.Path(sys.argv[1])
text = page.read_text()


# Captions of tables explain their columns each time; the page does it once, in "How the tables read".
CAPTIONS = (
    (r"CPU time to a target \(.*?with set-up: (.*?) once a sweep\s+\(.*?\)\s+and (.*?) for each view\s+\(.*?pilots\.",
     r"CPU time to a target. Set-up: \1 once a sweep, \2 for each view"),
    (r"(Error after equal CPU times) \(.*?\)", r"\1"),
    (r"(Effects chosen by the program and all effects): .*?\)", r"\1"),
    (r"(Slope of the random error) against.*?0\.1 %(?=\n\n)", r"\1"),
    (r"(Spectral step): relative error.*? um(?=\n\n)", r"\1"),
    (r"(Deviation from the finest mesh \(.*?\)), over.*?\(rms\)", r"\1"),
    (r"(The limit of ever more facets N): .*?(?=\n\n)", r"\1"),
)


def put(name, tables):
    global text
    for told, short in CAPTIONS:
        tables = re.sub(told, short, tables, flags=re.S)
    mark = re.compile(rf"(<!-- begin {name} -->\n).*?(<!-- end {name} -->)", re.S)
    text, count = mark.subn(lambda m: m.group(1) + tables.strip() + "\n" + m.group(2), text)
    if count != 1:
        sys.exit(f"{page}: expected one pair of marks for {name}, found {count}")


for scene in ("frigate", "cavity", "quickstart"):
    put(scene, (work / scene / "accuracy.md").read_text())


def mesh_tables(name, *captions):
    """Those tables of a comparison of meshes whose captions begin so; all without captions."""
    blocks = (work / f"meshes-{name}" / "meshes.md").read_text().strip().split("\n\n")
    if captions:
        tables = zip(blocks[1::2], blocks[2::2])
        blocks = [b for caption, rows in tables if caption.startswith(captions) for b in (caption, rows)]
    put(f"meshes {name}", "\n\n".join(blocks))


mesh_tables("frigate")
mesh_tables("frigate-2", "Deviation")
mesh_tables("frigate-coarse", "Deviation", "The limit")
mesh_tables("sphere", "Deviation")
mesh_tables("cylinder", "Deviation", "The limit")


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


# The matrix of scenes: what the command prints, the goals, and the time by what decides about it.
rows = list(csv.DictReader((work / "matrix.csv").open()))
views = {(r["cell"], r["aspect_azimuth_deg"], r["aspect_elevation_deg"]): r for r in rows}
spent, off = {}, {}
for (cell, *_), r in views.items():
    mine = spent.setdefault(cell, [0.0, 0.0, r])
    mine[0] += float(r["chosen_s"])
    mine[1] += float(r["all_s"])
    dropped = {"sky_reflected", "lower_reflected"} <= set(r["left_out"].split())
    off[cell] = off.get(cell, True) and dropped
ratio_of = {cell: a / b for cell, (a, b, _) in spent.items()}
bounds = [float(r["of_numerical_error"]) for r in rows if r["of_numerical_error"]]
beyond = [sum(x > k for x in bounds) for k in (2, 5)]
outside = sum(float(r["of_allowed"]) > 1 for r in rows)


def verdict(good, said):
    return said if good else f"**missed**: {said}"


median, median_off = (statistics.median(x) for x in (ratio_of.values(), [ratio_of[c] for c in off if off[c]]))
said = (work / "matrix.txt").read_text()
summary = re.search(r"^\d+ cells,.*", said, re.M).group(0)
against = re.search(r"^against the reference:.*", said, re.M).group(0)
bodies = [(s, h, t) for s in ("matt", "mirror") for h in ("convex", "cavity") for t in ("hot", "cold")]
lines = [
    f"{summary}; {against}.", "", *(l for l in said.splitlines() if l.startswith("|")), "",
    "| | goal | reached |", "|---|---|---|",
    f"| values out of bound | 0 | {verdict(outside == 0, str(outside))} |",
    f"| time automatic / all, median over cells | 0.5 | {verdict(median <= 0.5, f'{median:.2f}')} |",
    f"| the same where sky and sea are dropped ({sum(off.values())} cells) | 0.25 | {verdict(median_off <= 0.25, f'{median_off:.2f}')} |",
    f"| values beyond 2 numerical errors of the reference | 8 % | {verdict(beyond[0] <= 0.08 * len(bounds), f'{100 * beyond[0] / len(bounds):.1f} %')} |",
    f"| beyond 5 | 0 | {verdict(beyond[1] == 0, str(beyond[1]))} |", "",
    "| time automatic / all, median of 6 cells | " + " | ".join(" ".join(b) for b in bodies) + " |",
    "| --- |" + " --- |" * len(bodies),
]
for sun in ("night", "day"):
    for band in ("mwir", "lwir"):
        cells = []
        for body in bodies:
            key = (sun, band, *body)
            cells.append(statistics.median(
                a / b for name, (a, b, r) in spent.items() if tuple(name.split()[:5]) == key))
        lines.append(f"| {sun}, {band} | " + " | ".join(f"{c:.2f}" for c in cells) + " |")
put("matrix", "\n".join(lines))
put("bounds", "\n".join(l for l in (work / "bounds.txt").read_text().splitlines() if l.startswith("|")))
page.write_text(text)
PYTHON
