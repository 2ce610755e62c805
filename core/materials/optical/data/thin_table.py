"""Print a table of optical constants (lambda_um n k) with fewer points: how the entries here were made.

usage: thin_table.py [--from-um A] [--to-um B] [--tolerance T] FILE.yml [FILE2.yml]

FILE: "tabulated nk" of the refractiveindex.info database. Points are left out as long as n + ik, linear
between those that are kept, stays within T |n + ik| of each that is left out; largest changes go to standard
error. With two files (ordinary and extraordinary ray), their permittivities are averaged 2 : 1 first: grains
of all orientations, each much smaller than the wavelength.
"""
import argparse
import bisect
import cmath
import re
import sys


def read(path):
    rows = []
    for line in open(path, encoding="utf-8"):
        fields = line.split()
        if re.match(r"^ +[0-9]", line) and len(fields) == 3:
            rows.append((float(fields[0]), complex(float(fields[1]), float(fields[2]))))
    return increasing(rows, path)


def increasing(rows, path):
    """The most rows whose wavelengths increase: some of the database's files have misprints."""
    length, before = [1] * len(rows), [-1] * len(rows)
    for i, (x, _) in enumerate(rows):
        for j in range(max(0, i - 20), i):
            if rows[j][0] < x and length[j] + 1 > length[i]:
                length[i], before[i] = length[j] + 1, j
    i, kept = max(range(len(rows)), key=lambda i: length[i]), []
    while i >= 0:
        kept.append(rows[i])
        i = before[i]
    for row in rows:
        if row not in kept:
            print(f"{path}: left out, wavelengths do not increase there: {row}", file=sys.stderr)
    return kept[::-1]


def at(rows, x):
    i = bisect.bisect_right([r[0] for r in rows], x)
    i = min(max(i, 1), len(rows) - 1)
    (x0, y0), (x1, y1) = rows[i - 1], rows[i]
    return y0 + (x - x0) / (x1 - x0) * (y1 - y0)


def thinned(rows, tolerance):
    kept, first = [rows[0]], 0
    while first < len(rows) - 1:
        last = first + 1
        while last + 1 < len(rows):
            chord = [rows[first], rows[last + 1]]
            if any(abs(at(chord, x) - y) > tolerance * abs(y) for x, y in rows[first + 1:last + 1]):
                break
            last += 1
        kept.append(rows[last])
        first = last
    return kept


def reflectance(m):
    return abs((m - 1) / (m + 1)) ** 2


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--from-um", type=float, default=0.3)
    parser.add_argument("--to-um", type=float, default=50)
    parser.add_argument("--tolerance", type=float, default=0.002)
    parser.add_argument("file", nargs="+")
    asked = parser.parse_args()
    tables = [read(f) for f in asked.file]
    if len(tables) == 2:
        ordinary, extraordinary = tables
        end = min(ordinary[-1][0], extraordinary[-1][0])
        tables = [[(x, cmath.sqrt((2 * m * m + at(extraordinary, x) ** 2) / 3)) for x, m in ordinary if x <= end]]
    rows, lambda_um = tables[0], [r[0] for r in tables[0]]  # cut so that the range asked for is covered
    rows = rows[max(bisect.bisect_right(lambda_um, asked.from_um) - 1, 0):bisect.bisect_left(lambda_um, asked.to_um) + 1]
    kept = thinned(rows, asked.tolerance)
    for x, m in kept:
        print(f"  {x:.6g} {m.real:.5g} {m.imag:.4g}")
    change = max(abs(at(kept, x) - m) / abs(m) for x, m in rows)
    change_r = max(abs(reflectance(at(kept, x)) - reflectance(m)) for x, m in rows)
    print(f"{len(rows)} -> {len(kept)} points; largest change of n + ik {change:.2g} of its modulus, "
          f"of the reflectance at normal incidence {change_r:.2g}", file=sys.stderr)
