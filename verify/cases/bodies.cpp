#include "verify/cases/bodies.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/constants.h"
#include "core/base/sobol.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

Mesh of_one_group(std::vector<Vec<Body>> vertex, std::vector<std::array<std::uint32_t, 3>> triangle,
                  const char* name) {
  Mesh mesh;
  mesh.vertex = std::move(vertex);
  mesh.triangle = std::move(triangle);
  mesh.triangle_group.assign(mesh.triangle.size(), 0);
  mesh.group = {name};
  return mesh;
}

}  // namespace

Mesh needle_drum(std::uint32_t sides, double radius_m, double length_m) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < sides; ++i)
    for (const double x : {-0.5 * length_m, 0.5 * length_m})
      mesh.vertex.push_back({x, radius_m * std::cos(2 * std::numbers::pi * i / sides),
                             radius_m * std::sin(2 * std::numbers::pi * i / sides)});
  const std::uint32_t back = 2 * sides, front = back + 1;
  mesh.vertex.push_back({-0.5 * length_m, 0, 0});
  mesh.vertex.push_back({0.5 * length_m, 0, 0});
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % sides);
    mesh.triangle.push_back({a, b, b + 1});
    mesh.triangle.push_back({a, b + 1, a + 1});
    mesh.triangle.push_back({back, b, a});
    mesh.triangle.push_back({front, a + 1, b + 1});
  }
  return of_one_group(std::move(mesh.vertex), std::move(mesh.triangle), "drum");
}

Mesh needle_slab(std::uint32_t needles, double length_m, double width_m) {
  Mesh mesh;
  const double x = 0.5 * length_m, y = 0.5 * width_m;
  for (std::uint32_t i = 0; i <= needles; ++i)
    for (const double side : {-x, x})
      mesh.vertex.push_back({side, -y + width_m * i / needles, -0.5});
  for (std::uint32_t i = 0; i < needles; ++i) {
    const std::uint32_t a = 2 * i;
    mesh.triangle.push_back({a, a + 2, a + 3});
    mesh.triangle.push_back({a, a + 3, a + 1});
  }
  const auto base = static_cast<std::uint32_t>(mesh.vertex.size());
  for (const double side_y : {-y, y})
    for (const double side_x : {-x, x}) mesh.vertex.push_back({side_x, side_y, 0.5});
  mesh.triangle.push_back({base, base + 1, base + 3});  // below
  mesh.triangle.push_back({base, base + 3, base + 2});
  const std::uint32_t last = 2 * needles;
  const auto wall = [&](std::uint32_t top_a, std::uint32_t top_b, std::uint32_t low_a,
                        std::uint32_t low_b) {
    mesh.triangle.push_back({top_a, top_b, low_b});
    mesh.triangle.push_back({top_a, low_b, low_a});
  };
  wall(0, 1, base, base + 1);                // at -y
  wall(last + 1, last, base + 3, base + 2);  // at +y
  // At -x and +x the upper edge has every needle's corner: fans from the lower ones.
  for (std::uint32_t i = 0; i < needles; ++i) {
    mesh.triangle.push_back({base, 2 * i + 2, 2 * i});
    mesh.triangle.push_back({base + 1, 2 * i + 1, 2 * i + 3});
  }
  mesh.triangle.push_back({base, base + 2, last});
  mesh.triangle.push_back({base + 1, last + 1, base + 3});
  return of_one_group(std::move(mesh.vertex), std::move(mesh.triangle), "slab");
}

Mesh spherical_cavity(double half_angle_deg, std::uint32_t rings, std::uint32_t sectors) {
  Mesh mesh;
  const double begin = half_angle_deg * kRadPerDeg;
  // Chords of a regular polygon lie inside the circle: this radius gives the rings its area.
  const double widen =
      std::sqrt((2 * std::numbers::pi / sectors) / std::sin(2 * std::numbers::pi / sectors));
  for (std::uint32_t ring = 0; ring <= rings; ++ring)
    for (std::uint32_t sector = 0; sector < sectors; ++sector) {
      const double theta = begin + (std::numbers::pi - begin) * ring / rings,
                   phi = 2 * std::numbers::pi * sector / sectors;
      mesh.vertex.push_back({std::cos(theta), widen * std::sin(theta) * std::cos(phi),
                             widen * std::sin(theta) * std::sin(phi)});
    }
  for (std::uint32_t ring = 0; ring < rings; ++ring)
    for (std::uint32_t sector = 0; sector < sectors; ++sector) {
      const std::uint32_t a = ring * sectors + sector, b = ring * sectors + (sector + 1) % sectors,
                          c = a + sectors, d = b + sectors;
      if (ring > 0 || half_angle_deg > 0) mesh.triangle.push_back({a, b, c});  // facing inwards
      if (ring + 1 < rings) mesh.triangle.push_back({b, d, c});
    }
  return of_one_group(std::move(mesh.vertex), std::move(mesh.triangle), "wall");
}

Mesh plate(double width_m, double height_m, std::uint32_t cells) {
  Mesh mesh;
  for (std::uint32_t i = 0; i <= cells; ++i)
    for (std::uint32_t k = 0; k <= cells; ++k)
      mesh.vertex.push_back({0, width_m * (static_cast<double>(i) / cells - 0.5),
                             height_m * (static_cast<double>(k) / cells - 0.5)});
  for (std::uint32_t i = 0; i < cells; ++i)
    for (std::uint32_t k = 0; k < cells; ++k) {
      const std::uint32_t a = i * (cells + 1) + k, b = a + cells + 1;
      mesh.triangle.push_back({a, b, b + 1});
      mesh.triangle.push_back({a, b + 1, a + 1});
    }
  return of_one_group(std::move(mesh.vertex), std::move(mesh.triangle), "plate");
}

Mesh rectangle(Vec<Body> at, Vec<Body> u, Vec<Body> v, const std::string& group) {
  Mesh mesh;
  mesh.group = {group};
  mesh.vertex = {at - u - v, at + u - v, at + u + v, at - u + v};
  mesh.triangle = {{0, 1, 2}, {0, 2, 3}};
  mesh.triangle_group = {0, 0};
  return mesh;
}

Mesh square(Vec<Body> at, Vec<Body> normal, double half_m, const std::string& group) {
  const Vec<Body> n = normalized(normal);
  const Vec<Body> u =
      normalized(cross(std::abs(n.z) < 0.9 ? Vec<Body>{0, 0, 1} : Vec<Body>{1, 0, 0}, n));
  return rectangle(at, half_m * u, half_m * cross(n, u), group);
}

Mesh lying(Mesh mesh) {
  for (Vec<Body>& v : mesh.vertex) v = {v.z, v.y, -v.x};
  return mesh;
}

Mesh moved(Mesh mesh, Vec<Body> by) {
  for (Vec<Body>& v : mesh.vertex) v = v + by;
  return mesh;
}

Mesh joined(Mesh a, const Mesh& b, const std::string& prefix) {
  const auto vertices = static_cast<std::uint32_t>(a.vertex.size());
  const auto groups = static_cast<std::uint32_t>(a.group.size());
  a.vertex.insert(a.vertex.end(), b.vertex.begin(), b.vertex.end());
  for (const auto& t : b.triangle)
    a.triangle.push_back({vertices + t[0], vertices + t[1], vertices + t[2]});
  for (const std::uint32_t g : b.triangle_group) a.triangle_group.push_back(groups + g);
  for (const std::string& g : b.group) a.group.push_back(prefix + g);
  a.degenerate_triangles += b.degenerate_triangles;
  return a;
}

Vec<Body> askew(Vec<Body> v) {
  const Vec<Body> axis = normalized(Vec<Body>{0.3, -0.7, 0.5});
  const double turn = 1.1, along = (1 - std::cos(turn)) * dot(axis, v);
  return std::cos(turn) * v + std::sin(turn) * cross(axis, v) + along * axis;
}

Mesh inside_out(Mesh mesh) {
  for (auto& t : mesh.triangle) std::swap(t[1], t[2]);
  return mesh;
}

MaterialSpec grey_paint(double emissivity) { return {"paint", Lambert{{{0, emissivity}}}}; }

Band long_wave() { return {"LWIR", 8, 12, 0.5, {}}; }

SceneSpec one_body(Mesh mesh, MaterialSpec material) {
  SceneSpec scene;
  scene.mesh = std::move(mesh);
  scene.material = {std::move(material)};
  scene.part = {{"body", {"*"}, 0, false, false}};
  scene.band = {long_wave()};
  return scene;
}

ViewRequest dark_view(const Simulator& simulator, double azimuth_deg, double elevation_deg,
                      double range_m, std::vector<double> part_temperature_k) {
  ViewRequest r;
  r.viewpoint = {azimuth_deg, elevation_deg, range_m};
  ConditionSpec condition;
  condition.part_temperature_k = std::move(part_temperature_k);
  r.condition = {condition};
  r.selected_condition = {0};
  for (std::uint32_t b = 0; b < simulator.band_grids().size(); ++b) r.selected_band.push_back(b);
  r.accuracy.samples_per_replicate = 1024;
  r.max_reflections = 0;
  return r;
}

void put_sun(ConditionSpec& condition, Vec<Body> towards) {
  condition.sun = true;
  condition.sun_direction = normalized(towards);
  condition.sun_cos_zenith = -condition.sun_direction.z;
  condition.sun_angular_radius_deg = 0.266;
  condition.sun_scale = 1;
}

double black_radiance_w_m2_sr(const Simulator& simulator, std::size_t band, double temperature_k) {
  const Band& limits = simulator.bands()[band];
  return planck_band_radiance_w_m2_sr(limits.lambda_min_um, limits.lambda_max_um, temperature_k);
}

double t_of(const Estimate& e, double expected, double bias) {
  const double rest = std::max(0.0, std::abs(e.value - expected) - std::abs(bias));
  return rest / std::max(e.stderr_, 1e-7 * std::abs(expected));
}

double uniform(std::uint64_t seed, std::uint64_t index) {
  return static_cast<double>(mix64(mix64(seed) ^ index) >> 11) * 0x1p-53;
}

Vec<Body> uniform_direction(std::uint64_t seed, std::uint64_t index) {
  const double z = 2 * uniform(seed, 2 * index) - 1,
               phi = 2 * std::numbers::pi * uniform(seed, 2 * index + 1);
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace irsig
