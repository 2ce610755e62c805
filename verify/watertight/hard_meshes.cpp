// Closed meshes that are hard on ray tracers.
#include <cmath>
#include <numbers>

#include "core/scene/generate/generate_mesh.h"
#include "verify/watertight/watertight_check.h"

namespace irsig {
namespace {

// A surface of revolution about z: poles at +-z and rings of `around` vertices at the given
// (radius, height), from the top down.
struct HardRing {
  double radius_m, height_m;
};
Mesh revolve_hard(std::uint32_t around, double pole_m, const std::vector<HardRing>& ring) {
  Mesh mesh;
  mesh.group = {"default"};
  mesh.vertex = {{0, 0, pole_m}, {0, 0, -pole_m}};
  for (const HardRing& r : ring) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const double phi = 2 * std::numbers::pi * (i + 0.3) / around;
      mesh.vertex.push_back({r.radius_m * std::cos(phi), r.radius_m * std::sin(phi), r.height_m});
    }
  }
  const auto at = [&](std::size_t k, std::uint32_t i) {
    return static_cast<std::uint32_t>(2 + k * around + i % around);
  };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangle.push_back({a, b, c});
    mesh.triangle_group.push_back(0);
  };
  for (std::uint32_t i = 0; i < around; ++i) {
    add(0, at(0, i), at(0, i + 1));
    add(1, at(ring.size() - 1, i + 1), at(ring.size() - 1, i));
    for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
      add(at(k, i), at(k + 1, i), at(k + 1, i + 1));
      add(at(k, i), at(k + 1, i + 1), at(k, i + 1));
    }
  }
  return mesh;
}

Mesh ellipsoid(std::uint32_t around, std::uint32_t down, double radius_m, double half_height_m) {
  std::vector<HardRing> ring;
  for (std::uint32_t k = 1; k < down; ++k) {
    const double theta = std::numbers::pi * k / down;
    ring.push_back({radius_m * std::sin(theta), half_height_m * std::cos(theta)});
  }
  return revolve_hard(around, half_height_m, ring);
}

}  // namespace

std::vector<NamedMesh> hard_closed_meshes(std::uint64_t frigate_triangles) {
  return {{"pole_needles", ellipsoid(2000, 10, 1, 1)},
          {"lens", ellipsoid(100, 50, 1, 0.0005)},
          {"spindle", ellipsoid(12, 6, 1e-4, 1)},
          {"box", generate_mesh({"box", 12}).value()},
          {"frigate", generate_mesh({"frigate", frigate_triangles}).value()}};
}

}  // namespace irsig
