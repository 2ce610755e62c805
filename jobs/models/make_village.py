#!/usr/bin/python3
"""Writes house.obj and tree.obj beside itself: meshes that stand on the land of vehicle_village.toml.

    /usr/bin/python3 jobs/models/make_village.py

x forward, y port, z up, in metres, the ground at z = 0. The house is 10 m x 8 m with walls 5 m high and a gable roof
whose ridge, along x, is 8 m high (groups "walls" and "roof"; closed by a floor). The tree has a trunk of six sides,
0.4 m across and 3 m high ("trunk"), in a crown 6 m wide from 2.5 m to 9 m ("crown", 12 x 6 faces).
"""
import math
import pathlib

HALF_LENGTH, HALF_WIDTH, EAVE, RIDGE = 5.0, 4.0, 5.0, 8.0
TRUNK_RADIUS, TRUNK_HEIGHT = 0.2, 3.0
CROWN_RADIUS, CROWN_LOW, CROWN_HIGH = 3.0, 2.5, 9.0
SIDES, RINGS = 12, 6


class Mesh:
    def __init__(self, remark):
        self.remark, self.index, self.points, self.groups = remark, {}, [], {}

    def face(self, group, *corners):
        """Corners counter-clockwise seen from outside."""
        v = []
        for point in corners:
            rounded = tuple(round(c, 6) + 0.0 for c in point)
            if rounded not in self.index:
                self.index[rounded] = len(self.points) + 1
                self.points.append(rounded)
            v.append(self.index[rounded])
        self.groups.setdefault(group, []).extend((v[0], v[i], v[i + 1]) for i in range(1, len(v) - 1))

    def write(self, path):
        lines = [f"# Made by make_village.py. {self.remark}; metres, x forward, y port, z up."]
        lines += ["v " + " ".join(format(c, ".10g") for c in p) for p in self.points]
        for group, faces in self.groups.items():
            lines += [f"o {group}"] + ["f " + " ".join(map(str, f)) for f in faces]
        path.write_text("\n".join(lines) + "\n")


def house():
    mesh = Mesh("A house")
    a, w = HALF_LENGTH, HALF_WIDTH
    low = [(-a, -w, 0), (a, -w, 0), (a, w, 0), (-a, w, 0)]
    high = [(x, y, EAVE) for x, y, _ in low]
    back, front = (-a, 0, RIDGE), (a, 0, RIDGE)
    mesh.face("walls", low[0], low[1], high[1], high[0])
    mesh.face("walls", low[1], low[2], high[2], front, high[1])
    mesh.face("walls", low[2], low[3], high[3], high[2])
    mesh.face("walls", low[3], low[0], high[0], back, high[3])
    mesh.face("walls", low[3], low[2], low[1], low[0])
    mesh.face("roof", high[0], high[1], front, back)
    mesh.face("roof", high[2], high[3], back, front)
    return mesh


def ring(count, radius, z):
    turn = [2 * math.pi * i / count for i in range(count)]
    return [(radius * math.cos(t), radius * math.sin(t), z) for t in turn]


def tree():
    mesh = Mesh("A tree")
    low, high = ring(6, TRUNK_RADIUS, 0), ring(6, TRUNK_RADIUS, TRUNK_HEIGHT)
    for i in range(6):
        k = (i + 1) % 6
        mesh.face("trunk", low[i], low[k], high[k], high[i])
    mesh.face("trunk", *reversed(low))
    mesh.face("trunk", *high)
    middle, half = (CROWN_LOW + CROWN_HIGH) / 2, (CROWN_HIGH - CROWN_LOW) / 2
    rings = []
    for j in range(1, RINGS):
        angle = math.pi * j / RINGS
        rings.append(ring(SIDES, CROWN_RADIUS * math.sin(angle), middle - half * math.cos(angle)))
    bottom, top = (0, 0, CROWN_LOW), (0, 0, CROWN_HIGH)
    for i in range(SIDES):
        k = (i + 1) % SIDES
        mesh.face("crown", bottom, rings[0][k], rings[0][i])
        for lower, upper in zip(rings, rings[1:]):
            mesh.face("crown", lower[i], lower[k], upper[k], upper[i])
        mesh.face("crown", rings[-1][i], rings[-1][k], top)
    return mesh


def main():
    folder = pathlib.Path(__file__).parent
    house().write(folder / "house.obj")
    tree().write(folder / "tree.obj")


if __name__ == "__main__":
    main()
