#!/usr/bin/python3
"""Prints how true the stated errors of pixels are, by class of pixel: camera.toml from several seeds, against one long run.

    python3 ops/image_errors.py build/release/bin/irsig [SEEDS]

z is (pixel - long run) / (their stated errors together). Classes, from the long run:
    edge          the target fills the pixel in part
    shadow edge   else, where direct sunlight changes by more than a third of its largest value to a neighbour
    glint         else, where direct sunlight is more than three times the median of sunlit pixels
    inside        else
"""
import pathlib
import subprocess
import sys
import tempfile

import numpy

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "python"))
import irsig  # noqa: E402


def images(program, folder, seed, samples):
    sweep = (ROOT / "jobs/examples/camera.toml").read_text()
    head, tail = sweep.split("pixel_error_percent = 0.5\n")
    path = folder / f"seed-{seed}-{samples}.toml"
    path.write_text(f"seed = {seed}\n{head}samples = {samples}\n{tail}".replace('name = "camera"\n', f'name = "{path.stem}"\n'))
    database = path.with_suffix(".sigdb")
    subprocess.run([program, "run", path, "--db", database], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    rows = irsig.open(database).query()
    return rows, {(layer, stderr): rows.images(layer, stderr=stderr) for layer in (None, "at_sensor") for stderr in (False, True)}


def classes_of(rows, at, sun):
    filled = sum(rows.silhouettes()[at].values())
    steps = numpy.zeros_like(sun)
    for axis in (0, 1):
        step = numpy.abs(numpy.diff(sun, axis=axis))
        for shift in (0, 1):
            there = tuple(slice(shift, shift - 1 or None) if a == axis else slice(None) for a in (0, 1))
            steps[there] = numpy.maximum(steps[there], step)
    whole = filled > 1 - 1e-9
    lit = sun[whole & (sun > 0)]
    edge = (filled > 0) & ~whole
    shadow = whole & (steps > sun[whole].max() / 3) if lit.size else whole & False
    glint = whole & ~shadow & (sun > 3 * numpy.median(lit)) if lit.size else whole & False
    return {"edge": edge, "shadow edge": shadow, "glint": glint, "inside": whole & ~shadow & ~glint}


def main():
    program, seeds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 8
    z = {}
    with tempfile.TemporaryDirectory() as name:
        rows, truth = images(program, pathlib.Path(name), 1, 4096)
        sun = rows.images("sun")
        classes = [classes_of(rows, at, sun[at]) for at in range(len(sun))]
        for seed in range(2, 2 + seeds):
            _, found = images(program, pathlib.Path(name), seed, 8)
            for layer in (None, "at_sensor"):
                for at, of_row in enumerate(classes):
                    off = found[layer, False][at].astype(float) - truth[layer, False][at]
                    stated = numpy.hypot(found[layer, True][at], truth[layer, True][at])
                    for kind, where in of_row.items():
                        z.setdefault((layer or "target", rows["band"][at], kind), []).append(off[where] / stated[where])
    print(f"{'image':10} {'band':5} {'class':12} {'pixels':>8} {'rms z':>6} {'|z| < 1.96':>10}")
    for (layer, band, kind), values in sorted(z.items()):
        of = numpy.concatenate(values)
        if of.size:
            print(f"{layer:10} {band:5} {kind:12} {of.size:8} {numpy.sqrt((of ** 2).mean()):6.2f} {(abs(of) < 1.96).mean():10.1%}")


if __name__ == "__main__":
    main()
