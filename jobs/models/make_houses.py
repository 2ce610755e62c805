#!/usr/bin/python3
"""Writes houses.obj: four houses around a car park on a square of bare soil.

    /usr/bin/python3 jobs/models/make_houses.py > jobs/models/houses.obj

x forward (north in houses.toml), y port (west), z up, in metres. Soil of 60 m x 60 m with a car park of
24 m x 24 m in its middle, both 5 cm above the plane z = 0 (the ground around the scene); on each side
of the park a house of 10 m x 8 m, walls 5 m high, a gable roof whose ridge is 8 m high, along the
longer side. Fronts face outwards and upwards; houses stand on the soil without a floor. Groups: soil,
park, walls, roof. Facets are cut by the sweep (heat.element_size_m).
"""

LEVEL = 0.05


class Mesh:
    def __init__(self):
        self.index, self.points, self.groups = {}, [], {}

    def vertex(self, point):
        if point not in self.index:
            self.index[point] = len(self.points) + 1
            self.points.append(point)
        return self.index[point]

    def polygon(self, group, *corners):
        """Corners counter-clockwise seen from the front."""
        v = [self.vertex(p) for p in corners]
        self.groups.setdefault(group, []).extend((v[0], v[i], v[i + 1]) for i in range(1, len(v) - 1))


def ground(mesh):
    """Squares of 2 m, so that the park's edge is one of theirs; none below the houses."""
    for i in range(-15, 15):
        for j in range(-15, 15):
            x, y = 2 * i, 2 * j
            park = -12 <= x < 12 and -12 <= y < 12
            under = any(a <= x < b and c <= y < d for a, b, c, d in HOUSES)
            if not under:
                mesh.polygon("park" if park else "soil", (x, y, LEVEL), (x + 2, y, LEVEL),
                             (x + 2, y + 2, LEVEL), (x, y + 2, LEVEL))


def house(mesh, a, b, c, d):
    """From x = a to b and y = c to d."""
    eave, ridge = 5.0, 8.0
    p = {(x, y, z): (x, y, z) for x in (a, b) for y in (c, d) for z in (LEVEL, eave)}
    if b - a > d - c:  # the ridge goes along x
        first, last = (a, (c + d) / 2, ridge), (b, (c + d) / 2, ridge)
        mesh.polygon("walls", p[a, c, LEVEL], p[b, c, LEVEL], p[b, c, eave], p[a, c, eave])
        mesh.polygon("walls", p[b, d, LEVEL], p[a, d, LEVEL], p[a, d, eave], p[b, d, eave])
        mesh.polygon("walls", p[b, c, LEVEL], p[b, d, LEVEL], p[b, d, eave], last, p[b, c, eave])
        mesh.polygon("walls", p[a, d, LEVEL], p[a, c, LEVEL], p[a, c, eave], first, p[a, d, eave])
        mesh.polygon("roof", p[a, c, eave], p[b, c, eave], last, first)
        mesh.polygon("roof", p[b, d, eave], p[a, d, eave], first, last)
    else:
        first, last = ((a + b) / 2, c, ridge), ((a + b) / 2, d, ridge)
        mesh.polygon("walls", p[b, c, LEVEL], p[b, d, LEVEL], p[b, d, eave], p[b, c, eave])
        mesh.polygon("walls", p[a, d, LEVEL], p[a, c, LEVEL], p[a, c, eave], p[a, d, eave])
        mesh.polygon("walls", p[a, c, LEVEL], p[b, c, LEVEL], p[b, c, eave], first, p[a, c, eave])
        mesh.polygon("walls", p[b, d, LEVEL], p[a, d, LEVEL], p[a, d, eave], last, p[b, d, eave])
        mesh.polygon("roof", p[b, c, eave], p[b, d, eave], last, first)
        mesh.polygon("roof", p[a, d, eave], p[a, c, eave], first, last)


# a, b, c, d of each: north, south, west, east of the park
HOUSES = [(16, 24, -4, 6), (-24, -16, -6, 4), (-6, 4, 16, 24), (-4, 6, -24, -16)]


def main():
    mesh = Mesh()
    ground(mesh)
    for corners in HOUSES:
        house(mesh, *corners)
    print("# Made by make_houses.py. Four houses around a car park; metres, x forward, y port, z up.")
    for point in mesh.points:
        print("v", *(format(float(c), ".10g") for c in point))
    for group, facets in mesh.groups.items():
        print("o", group)
        for facet in facets:
            print("f", *facet)


if __name__ == "__main__":
    main()
