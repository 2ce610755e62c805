#!/usr/bin/python3
"""Writes drone.obj: a quadcopter of 1 m across.

    /usr/bin/python3 jobs/models/make_drone.py > jobs/models/drone.obj

x forward, y port, z up, in metres; the origin is the middle of the body. Groups: "body" (a box of 0.30 x 0.20 x 0.10 m),
"arms" (four bars from the body's corners to the motors), "motors" (four prisms of eight sides, 0.06 m across and 0.06 m high) and
"battery" (a box below the body). Closed solids that touch and do not overlap when seen from above, so that the area from above is
the sum of theirs.
"""
import math

BODY = (0.15, 0.10, 0.05)             # half sizes
BATTERY = (0.08, 0.04)                # half sizes along x and y
MOTOR_AT, MOTOR_RADIUS, MOTOR_HALF = 0.35, 0.03, 0.03
ARM_HALF, ARM_THICK = 0.01, 0.01      # half width, half height


class Mesh:
    def __init__(self):
        self.points, self.groups = [], {}

    def prism(self, group, outline, low, high):
        """A convex outline, counter-clockwise from above, from one height to another."""
        first, n = len(self.points) + 1, len(outline)
        self.points += [(x, y, z) for z in (low, high) for x, y in outline]
        faces = self.groups.setdefault(group, [])
        for i in range(n):
            j = (i + 1) % n
            a, b, c, d = first + i, first + j, first + n + j, first + n + i
            faces += [(a, b, c), (a, c, d)]
        for i in range(1, n - 1):
            faces.append((first + n, first + n + i, first + n + i + 1))  # top
            faces.append((first, first + i + 1, first + i))              # bottom


def box(x, y):
    return [(-x, -y), (x, -y), (x, y), (-x, y)]


def main():
    mesh = Mesh()
    mesh.prism("body", box(BODY[0], BODY[1]), -BODY[2], BODY[2])
    mesh.prism("battery", box(*BATTERY), -BODY[2] - 0.04, -BODY[2])
    for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        middle = (sx * MOTOR_AT, sy * MOTOR_AT)
        ring = [(middle[0] + MOTOR_RADIUS * math.cos((k + 0.5) * math.pi / 4),
                 middle[1] + MOTOR_RADIUS * math.sin((k + 0.5) * math.pi / 4)) for k in range(8)]
        mesh.prism("motors", ring, -MOTOR_HALF, MOTOR_HALF)
        corner = (sx * BODY[0], sy * BODY[1])
        along = (middle[0] - corner[0], middle[1] - corner[1])
        length = math.hypot(*along)
        u = (along[0] / length, along[1] / length)
        across = (-u[1] * ARM_HALF, u[0] * ARM_HALF)
        near, far = 0.02, length - MOTOR_RADIUS
        start = (corner[0] + near * u[0], corner[1] + near * u[1])
        end = (corner[0] + far * u[0], corner[1] + far * u[1])
        mesh.prism("arms", [(start[0] - across[0], start[1] - across[1]), (end[0] - across[0], end[1] - across[1]),
                            (end[0] + across[0], end[1] + across[1]), (start[0] + across[0], start[1] + across[1])],
                   -ARM_THICK, ARM_THICK)
    print("# made by make_drone.py: x forward, y port, z up, metres")
    for x, y, z in mesh.points:
        print(f"v {x:.9g} {y:.9g} {z:.9g}")
    for group, facets in mesh.groups.items():
        print(f"g {group}")
        for corners in facets:
            print("f " + " ".join(str(c) for c in corners))


main()
