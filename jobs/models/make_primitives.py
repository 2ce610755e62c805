#!/usr/bin/python3
"""Writes primitives.obj: a sphere, a box, a cylinder and a cone side by side.

    /usr/bin/python3 jobs/models/make_primitives.py > jobs/models/primitives.obj

x forward, y port, z up, in metres; one group per shape; facets counter-clockwise from outside.
The sizes are those of the generators of the same names (`generate = "sphere"` ...).
"""

import math

SEGMENTS = 64  # around the axis of every round shape


class Shape:
    def __init__(self, name, offset_y):
        self.name, self.offset_y, self.points, self.facets = name, offset_y, [], []

    def point(self, x, y, z):
        self.points.append((x, y + self.offset_y, z))
        return len(self.points) - 1

    def facet(self, *corners):
        self.facets.append(corners)


def revolved(name, offset_y, profile):
    """Turns a profile of (x, radius), from the front (+x) to the rear, about the x axis."""
    shape = Shape(name, offset_y)
    rings = []
    for x, radius in profile:
        count = SEGMENTS if radius > 0 else 1
        angles = [2 * math.pi * i / SEGMENTS for i in range(count)]
        rings.append([shape.point(x, radius * math.cos(a), radius * math.sin(a)) for a in angles])
    for front, rear in zip(rings, rings[1:]):
        for i in range(SEGMENTS):
            j = (i + 1) % SEGMENTS
            if len(rear) > 1:
                shape.facet(front[i % len(front)], rear[i], rear[j])
            if len(front) > 1:
                shape.facet(front[i], rear[j % len(rear)], front[j])
    return shape


def sphere(name, offset_y, radius):
    steps = SEGMENTS // 2
    angles = [math.pi * i / steps for i in range(steps + 1)]
    profile = [(radius * math.cos(a), radius * math.sin(a) if 0 < i < steps else 0.0)
               for i, a in enumerate(angles)]
    return revolved(name, offset_y, profile)


def box(name, offset_y, length, width, height):
    shape = Shape(name, offset_y)
    corner = {}
    for x in (-1, 1):
        for y in (-1, 1):
            for z in (-1, 1):
                corner[x, y, z] = shape.point(x * length / 2, y * width / 2, z * height / 2)
    for axis in range(3):
        for side in (-1, 1):
            # the four corners of the face, counter-clockwise seen from its outside
            turn = [(-1, -1), (1, -1), (1, 1), (-1, 1)][::side]
            face = []
            for u, v in turn:
                at = [0, 0, 0]
                at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3] = side, u, v
                face.append(corner[tuple(at)])
            shape.facet(face[0], face[1], face[2])
            shape.facet(face[0], face[2], face[3])
    return shape


def main():
    shapes = [
        sphere("sphere", 6.0, 1.0),
        box("box", 2.0, 2.0, 1.0, 0.5),
        revolved("cylinder", -2.0, [(1.5, 0.0), (1.5, 0.5), (-1.5, 0.5), (-1.5, 0.0)]),
        revolved("cone", -6.0, [(1.0, 0.0), (-1.0, 1.0), (-1.0, 0.0)]),
    ]
    print("# made by make_primitives.py: x forward, y port, z up, metres")
    first = 1
    for shape in shapes:
        print(f"g {shape.name}")
        for x, y, z in shape.points:
            print(f"v {x:.12g} {y:.12g} {z:.12g}")
        for corners in shape.facets:
            print("f " + " ".join(str(first + c) for c in corners))
        first += len(shape.points)


if __name__ == "__main__":
    main()
