#!/usr/bin/env python3
"""Makes vehicle.obj: a tracked vehicle of closed boxes, 6.4 m long, on the ground z = 0."""
import pathlib

# x forward, y port, z up [m]: from, to
BOXES = {
    "hull": ((-3.2, 3.2), (-1.25, 1.25), (0.45, 1.45)),
    "tracks_left": ((-3.0, 3.0), (1.3, 1.8), (0.0, 0.85)),
    "tracks_right": ((-3.0, 3.0), (-1.8, -1.3), (0.0, 0.85)),
    "turret": ((-1.6, 1.2), (-1.0, 1.0), (1.5, 2.2)),
    "barrel": ((1.25, 4.6), (-0.07, 0.07), (1.8, 1.94)),
    "engine_deck": ((-3.1, -1.7), (-1.0, 1.0), (1.5, 1.6)),
    "exhaust": ((-3.6, -3.25), (0.6, 0.95), (1.1, 1.35)),
}
FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))

lines = ["# made by make_vehicle.py: x forward, y port, z up, metres"]
first = 1
for name, (x, y, z) in BOXES.items():
    lines.append(f"g {name}")
    for height in z:
        for corner in ((x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])):
            lines.append(f"v {corner[0]} {corner[1]} {height}")
    lines += ["f " + " ".join(str(first + i) for i in face) for face in FACES]
    first += 8
pathlib.Path(__file__).with_name("vehicle.obj").write_text("\n".join(lines) + "\n")
