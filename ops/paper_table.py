#!/usr/bin/env python3
"""The findings of the ship paper (zhou2026, sections 3.4 to 3.6) beside ours, as a Markdown table.

usage: ops/paper_table.py [relative error, default 0.003]

Runs variants of jobs/examples/frigate_paper.toml with build/release/bin/irsig in a temporary folder: the three readings of
the hull's material, hot parts cooled to the ship's temperature, and mirrored viewpoints without sun.
"""
import csv, io, pathlib, re, subprocess, sys, tempfile

root = pathlib.Path(__file__).resolve().parent.parent
irsig = root / "build/release/bin/irsig"
example = (root / "jobs/examples/frigate_paper.toml").read_text()
error = sys.argv[1] if len(sys.argv) > 1 else "0.003"
SEASONS = {"winter": 293.15, "spring": 300.15, "summer": 313.15}


def run(name, text, folder):
    """Rows of the query, one a wavelength."""
    text = re.sub(r"(?m)^relative_error = .*$", f"relative_error = {error}", text)
    text = re.sub(r"(?m)^thumbnail_px.*$", "thumbnail_px = 0", text)
    sweep, db = folder / f"{name}.toml", folder / f"{name}.sigdb"
    sweep.write_text(text)
    subprocess.run([irsig, "run", sweep, "--db", db], check=True, stderr=subprocess.DEVNULL)
    out = subprocess.run([irsig, "query", db, "--spectrum", "--causes", "--format", "csv"],
                         check=True, capture_output=True, text=True).stdout
    return list(csv.DictReader(io.StringIO(out)))


def at(rows, season, lambda_um, column):
    """{(azimuth, elevation): value} at the stored wavelength nearest to lambda_um."""
    picked = [r for r in rows if r["season"] == season and abs(float(r["lambda_um"]) - lambda_um) < 0.01]
    return {(float(r["aspect_azimuth_deg"]), float(r["aspect_elevation_deg"])): float(r[column]) for r in picked}


def material(kind):
    gain = "allow_energy_gain = true" if kind == "hull_paper" else ""
    return example.replace('kind = "hull_paper"\nallow_energy_gain = true', f'kind = "{kind}"\n{gain}')


EMITTED, TOTAL = "spectral_emitted_w_sr_um", "spectral_intensity_w_sr_um"
with tempfile.TemporaryDirectory() as tmp:
    folder = pathlib.Path(tmp)
    runs = {kind: run(kind, material(kind), folder) for kind in ("hull", "hull_index", "hull_paper")}

    cold = {}
    for season, kelvin in SEASONS.items():  # the hot parts at the ship's temperature of that season
        cold[season] = run(f"cold_{season}", example.replace("temperature_k = 400", f"temperature_k = {kelvin}"), folder)

    pairs = ", ".join(f"{{ azimuth_deg = {az}, elevation_deg = {el} }}" for el in (2, 18, 36, 54, 72) for a in (30, 60, 90, 120, 150)
                      for az in (a, 360 - a))
    views = re.sub(r"(?ms)^\[viewpoints\].*?(?=^\[)", f'[viewpoints]\nkind = "list"\nrange_m = 5000\naspect = [{pairs}]\n\n', example)
    mirrored = run("mirrored", re.sub(r"(?m)^sun = true.*$", "sun = false", views), folder)

paper = runs["hull_paper"]
ten, five = at(paper, "summer", 10, EMITTED), at(paper, "summer", 5, EMITTED)
bow = min(ten, key=lambda v: min(v[0], 360 - v[0]) + v[1])
best = max(ten, key=ten.get)
print("| finding | paper | irsig |\n|---|---|---|")
print(f"| emitted, summer, 10 um: largest over 191 views / bow | 5.64 | {max(ten.values()) / ten[bow]:.2f} (at azimuth {best[0]:.0f}, elevation {best[1]:.0f} deg; bow view at {bow[0]:.0f}/{bow[1]:.1f}) |")
print(f"| emitted, summer: largest at 10 um / largest at 5 um | 3.01 | {max(ten.values()) / max(five.values()):.2f} |")
for season, theirs in zip(SEASONS, (22.2, 17.7, 6.4)):
    hot, ambient = at(paper, season, 3.8, EMITTED), at(cold[season], season, 3.8, EMITTED)
    loss = [100 * (1 - ambient[v] / hot[v]) for v in hot]
    print(f"| mean decrease of emitted 3.8 um when the hot parts are cooled, {season} | {theirs} % | {sum(loss) / len(loss):.1f} % |")
for kind, rows in runs.items():
    for season, theirs in zip(SEASONS, (56.1, 85.7, 80.3)):
        emitted, total = at(rows, season, 3.8, EMITTED), at(rows, season, 3.8, TOTAL)
        print(f"| largest total / largest emitted at 3.8 um, `{kind}`, {season} | +{theirs} % | {100 * (max(total.values()) / max(emitted.values()) - 1):+.1f} % |")
worst = 0
for season in SEASONS:
    for lam in (3.8, 10):
        v = at(mirrored, season, lam, TOTAL)
        worst = max(worst, max(abs(v[(az, el)] / v[(360 - az, el)] - 1) for az, el in v if az < 180))
print(f"| port / starboard without the sun, largest difference over 25 pairs of views | \"approximately equal\" | {100 * worst:.2f} % (asked relative error {float(error) * 100:g} % each) |")
