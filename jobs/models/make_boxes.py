#!/usr/bin/python3
"""Writes boxes.obj: six square boxes, open at the top, their openings flush with one plane.

    /usr/bin/python3 jobs/models/make_boxes.py > jobs/models/boxes.obj

x forward, y port, z up, in metres. Openings of 1 m x 1 m in the plane z = 0, between x = 0 and 1, a
metre of ground between them; from port to starboard three boxes 1, 2 and 3 m deep and the same three
again. Fronts face the inside of the boxes, and upwards on the ground. One group for the walls and
one for the bottom of each box, and "ground". Neighbouring facets share their vertices.
"""

WALLS = [("specular", depth) for depth in (1, 2, 3)] + [("diffuse", depth) for depth in (1, 2, 3)]


class Mesh:
    def __init__(self):
        self.index, self.points, self.groups = {}, [], {}

    def vertex(self, point):
        if point not in self.index:
            self.index[point] = len(self.points) + 1
            self.points.append(point)
        return self.index[point]

    def quad(self, group, *corners):
        """Four corners, counter-clockwise seen from the front."""
        a, b, c, d = (self.vertex(p) for p in corners)
        self.groups.setdefault(group, []).extend([(a, b, c), (a, c, d)])


def box(mesh, name, y, depth):
    """Its opening reaches from y (starboard) to y + 1 (port)."""
    top = [(0, y, 0), (1, y, 0), (1, y + 1, 0), (0, y + 1, 0)]  # counter-clockwise from above
    low = [(px, py, -depth) for px, py, _ in top]
    for i in range(4):
        j = (i + 1) % 4
        mesh.quad("walls_" + name, top[i], top[j], low[j], low[i])
    mesh.quad("bottom_" + name, *low)


def main():
    mesh = Mesh()
    starboard_edges = [4.5 - 2 * k for k in range(len(WALLS))]
    for (walls, depth), y in zip(WALLS, starboard_edges):
        box(mesh, f"{walls}_{depth}", y, depth)
    xs = [-1, 0, 1, 2]
    ys = sorted({-6.5, 6.5}.union(*({y, y + 1} for y in starboard_edges)))
    for x0, x1 in zip(xs, xs[1:]):
        for y0, y1 in zip(ys, ys[1:]):
            if x0 == 0 and y0 in starboard_edges:
                continue
            mesh.quad("ground", (x0, y0, 0), (x1, y0, 0), (x1, y1, 0), (x0, y1, 0))
    print("# made by make_boxes.py: x forward, y port, z up, metres")
    for x, y, z in mesh.points:
        print(f"v {x:.12g} {y:.12g} {z:.12g}")
    for group, facets in mesh.groups.items():
        print(f"g {group}")
        for corners in facets:
            print("f " + " ".join(str(c) for c in corners))


if __name__ == "__main__":
    main()
