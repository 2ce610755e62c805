#include <cmath>
#include <numeric>

#include "core/scene/import/import_formats.h"

namespace irsig {
namespace {

struct Flat {
  double u = 0, v = 0;
};

double turn(const Flat& a, const Flat& b, const Flat& c) {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

bool inside(const Flat& p, const Flat& a, const Flat& b, const Flat& c) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

bool same(const Flat& a, const Flat& b) { return a.u == b.u && a.v == b.v; }

// The polygon in its own plane, counter-clockwise: Newell's normal says which axis to drop.
// Differences to the first corner keep polygons far from the origin exact.
std::vector<Flat> flatten(const std::vector<std::uint32_t>& corner, const FileMesh& mesh) {
  const Vec<FileFrame> origin = mesh.vertex[corner[0]];
  Vec<FileFrame> normal;
  for (std::size_t i = 0; i < corner.size(); ++i) {
    normal = normal + cross(mesh.vertex[corner[i]] - origin,
                            mesh.vertex[corner[(i + 1) % corner.size()]] - origin);
  }
  const double nx = std::abs(normal.x), ny = std::abs(normal.y), nz = std::abs(normal.z);
  std::vector<Flat> out;
  out.reserve(corner.size());
  for (const std::uint32_t index : corner) {
    const Vec<FileFrame> p = mesh.vertex[index] - origin;
    Flat f = nx >= ny && nx >= nz ? Flat{p.y, p.z} : ny >= nz ? Flat{p.z, p.x} : Flat{p.x, p.y};
    const double along = nx >= ny && nx >= nz ? normal.x : ny >= nz ? normal.y : normal.z;
    if (along < 0) f.u = -f.u;
    out.push_back(f);
  }
  return out;
}

bool is_strictly_convex(const std::vector<Flat>& p) {
  const std::size_t n = p.size();
  double turned_rad = 0;  // a star also turns left at each corner, but more than once around
  for (std::size_t i = 0; i < n; ++i) {
    const Flat &a = p[i], &b = p[(i + 1) % n], &c = p[(i + 2) % n];
    const double cross_product = turn(a, b, c);
    if (cross_product <= 0) return false;
    turned_rad += std::atan2(cross_product, (b.u - a.u) * (c.u - b.u) + (b.v - a.v) * (c.v - b.v));
  }
  return turned_rad < 9;  // 2 pi, not 4 pi
}

// Is the triangle a, b, c of the remaining outline free of the other corners?
bool is_ear(const std::vector<std::size_t>& left, std::size_t at, const std::vector<Flat>& p) {
  const std::size_t n = left.size();
  const Flat &a = p[left[(at + n - 1) % n]], &b = p[left[at]], &c = p[left[(at + 1) % n]];
  if (turn(a, b, c) <= 0) return false;
  for (std::size_t i = 0; i < n; ++i) {
    if (i == at || i == (at + 1) % n || i == (at + n - 1) % n) continue;
    const Flat& q = p[left[i]];
    if (same(q, a) || same(q, b) || same(q, c)) continue;  // a slit that leads to a hole
    if (inside(q, a, b, c)) return false;
  }
  return true;
}

void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t group, FileMesh& mesh) {
  mesh.triangle.push_back({a, b, c});
  mesh.triangle_group.push_back(group);
}

}  // namespace

bool add_polygon(const std::vector<std::uint32_t>& corner, std::uint32_t group, FileMesh& mesh) {
  const std::size_t n = corner.size();
  if (n == 3) {
    add(corner[0], corner[1], corner[2], group, mesh);
    return true;
  }
  const std::vector<Flat> p = flatten(corner, mesh);
  if (is_strictly_convex(p)) {
    for (std::size_t i = 1; i + 1 < n; ++i) add(corner[0], corner[i], corner[i + 1], group, mesh);
    return true;
  }
  if (n > max_concave_corners) return false;
  std::vector<std::size_t> left(n);
  std::iota(left.begin(), left.end(), std::size_t{0});
  while (left.size() > 3) {
    const std::size_t size = left.size();
    std::size_t ear = size;
    for (std::size_t i = 0; i < size && ear == size; ++i)
      if (is_ear(left, i, p)) ear = i;
    // Corners in a straight line are no ears, but their flat triangle may be cut off.
    for (std::size_t i = 0; i < size && ear == size; ++i) {
      if (turn(p[left[(i + size - 1) % size]], p[left[i]], p[left[(i + 1) % size]]) == 0) ear = i;
    }
    if (ear == size) return false;
    add(corner[left[(ear + size - 1) % size]], corner[left[ear]], corner[left[(ear + 1) % size]],
        group, mesh);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  if (turn(p[left[0]], p[left[1]], p[left[2]]) < 0) return false;
  add(corner[left[0]], corner[left[1]], corner[left[2]], group, mesh);
  return true;
}

}  // namespace irsig
