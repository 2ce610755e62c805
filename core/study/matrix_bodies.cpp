#include "core/study/matrix_bodies.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "core/base/check.h"
#include "core/scene/generate/generate_mesh.h"

namespace irsig {
namespace {

using Range = std::array<double, 2>;

std::uint32_t group_named(Mesh& mesh, const std::string& name) {
  const auto found = std::find(mesh.group.begin(), mesh.group.end(), name);
  if (found == mesh.group.end()) mesh.group.push_back(name);
  return static_cast<std::uint32_t>(std::find(mesh.group.begin(), mesh.group.end(), name) -
                                    mesh.group.begin());
}

// A rectangle normal to an axis (0, 1, 2), facing along it (sign > 0) or against it; its extents
// are along the next axis and the one after that, cyclically.
void add_face(Mesh& mesh, int axis, int sign, double at, Range u, Range v,
              const std::string& group) {
  const auto base = static_cast<std::uint32_t>(mesh.vertex.size());
  for (const auto& [a, b] : {std::pair{u[0], v[0]}, {u[1], v[0]}, {u[1], v[1]}, {u[0], v[1]}}) {
    std::array<double, 3> point{};
    const auto i = static_cast<std::size_t>(axis);
    point[i] = at;
    point[(i + 1) % 3] = a;
    point[(i + 2) % 3] = b;
    mesh.vertex.push_back({point[0], point[1], point[2]});
  }
  const std::uint32_t second = sign > 0 ? 1 : 3, last = sign > 0 ? 3 : 1;
  mesh.triangle.push_back({base, base + second, base + 2});
  mesh.triangle.push_back({base, base + 2, base + last});
  mesh.triangle_group.insert(mesh.triangle_group.end(), 2, group_named(mesh, group));
}

Range about(double half) { return {-half, half}; }

// A face normal to y with a rectangular hole in its middle: four trapezia, edge to edge with what
// surrounds them.
void add_frame(Mesh& mesh, int sign, double at, HalfSize outer, HalfSize hole,
               const std::string& group) {
  const auto base = static_cast<std::uint32_t>(mesh.vertex.size());
  // Corners in the order of z towards x, which is counter-clockwise about +y.
  for (const HalfSize& half : {outer, hole})
    for (const auto& [z, x] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      mesh.vertex.push_back({x * half.x_m, at, z * half.z_m});
  const std::uint32_t id = group_named(mesh, group);
  for (std::uint32_t i = 0; i < 4; ++i) {
    std::array<std::uint32_t, 4> corner = {base + i, base + (i + 1) % 4, base + 4 + (i + 1) % 4,
                                           base + 4 + i};
    if (sign < 0) std::swap(corner[1], corner[3]);
    mesh.triangle.push_back({corner[0], corner[1], corner[2]});
    mesh.triangle.push_back({corner[0], corner[2], corner[3]});
    mesh.triangle_group.insert(mesh.triangle_group.end(), 2, id);
  }
}

// The five faces of a box but for its starboard one.
void add_open_block(Mesh& mesh, HalfSize half, const std::string& group) {
  for (const int sign : {-1, 1}) {
    add_face(mesh, 0, sign, sign * half.x_m, about(half.y_m), about(half.z_m), group);
    add_face(mesh, 2, sign, sign * half.z_m, about(half.x_m), about(half.y_m), group);
  }
  add_face(mesh, 1, -1, -half.y_m, about(half.z_m), about(half.x_m), group);
}

// The four walls around the y axis that face it.
void add_tunnel(Mesh& mesh, HalfSize half, Range y, const std::string& group) {
  for (const int sign : {-1, 1}) {
    add_face(mesh, 0, -sign, sign * half.x_m, y, about(half.z_m), group);
    add_face(mesh, 2, -sign, sign * half.z_m, about(half.x_m), y, group);
  }
}

}  // namespace

Mesh drum(double radius_m, double length_m) {
  auto mesh = generate_mesh({"cylinder", 300, radius_m, length_m, 0, 0});
  IRSIG_CHECK(mesh.ok());
  return with_group(*std::move(mesh), "body");
}

Mesh block(HalfSize half) {
  Mesh mesh;
  add_open_block(mesh, half, "body");
  add_face(mesh, 1, 1, half.y_m, about(half.z_m), about(half.x_m), "body");
  return mesh;
}

Mesh bay(HalfSize outer, HalfSize recess, HalfSize hole) {
  constexpr double kWallM = 0.2;
  const double front = outer.y_m, inner = front - kWallM, back = inner - 2 * recess.y_m;
  Mesh mesh;
  add_open_block(mesh, outer, "outside");
  add_frame(mesh, 1, front, outer, hole, "outside");
  add_tunnel(mesh, hole, {inner, front}, "inside");
  if (recess.x_m > hole.x_m) add_frame(mesh, -1, inner, recess, hole, "inside");
  add_tunnel(mesh, recess, {back, inner}, "inside");
  add_face(mesh, 1, 1, back, about(recess.z_m), about(recess.x_m), "inside");
  return mesh;
}

Mesh block_with_spot(HalfSize half, double half_spot_m) {
  const HalfSize spot{half_spot_m, 0, half_spot_m};
  Mesh mesh;
  add_open_block(mesh, half, "body");
  add_frame(mesh, 1, half.y_m, half, spot, "body");
  add_face(mesh, 1, 1, half.y_m, about(spot.z_m), about(spot.x_m), "spot");
  return mesh;
}

Mesh block_with_mirror(HalfSize half) {
  Mesh mesh;
  add_open_block(mesh, half, "body");
  add_face(mesh, 1, 1, half.y_m, about(half.z_m), about(half.x_m), "mirror");
  return mesh;
}

Mesh shifted(Mesh mesh, Vec<Body> by) {
  for (Vec<Body>& v : mesh.vertex) v = v + by;
  return mesh;
}

Mesh tilted(Mesh mesh, double up_deg) {
  const double c = std::cos(up_deg * std::numbers::pi / 180),
               s = std::sin(up_deg * std::numbers::pi / 180);
  for (Vec<Body>& v : mesh.vertex) v = {v.x, c * v.y + s * v.z, c * v.z - s * v.y};
  return mesh;
}

Mesh together(Mesh a, const Mesh& b) {
  const auto base = static_cast<std::uint32_t>(a.vertex.size());
  a.vertex.insert(a.vertex.end(), b.vertex.begin(), b.vertex.end());
  for (std::size_t i = 0; i < b.triangle.size(); ++i) {
    const auto& t = b.triangle[i];
    a.triangle.push_back({base + t[0], base + t[1], base + t[2]});
    a.triangle_group.push_back(group_named(a, b.group[b.triangle_group[i]]));
  }
  return a;
}

Mesh with_group(Mesh mesh, const std::string& name) {
  mesh.group = {name};
  mesh.triangle_group.assign(mesh.triangle.size(), 0);
  return mesh;
}

}  // namespace irsig
