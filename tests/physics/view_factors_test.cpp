// Shares of the exchange between faces against closed forms (values/view_factors.csv).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "core/thermal/scene/exchange_factors.h"
#include "heat_scene.h"
#include "reference_table.h"

namespace irsig {
namespace {

// z is down: x cross y points down.
constexpr Vec<Body> kX{1, 0, 0}, kY{0, 1, 0}, kUp{0, 0, -1}, kDown{0, 0, 1};
constexpr double kFar = 2000;  // what stands for an infinite length

// A polygon of the disk's area around the z axis, which its front looks along.
Mesh facing_disk(double radius, double z, bool looks_down) {
  constexpr int kSides = 192;
  const double step = 2 * std::numbers::pi / kSides;
  const double corner = radius * std::sqrt(step / std::sin(step));
  Mesh out;
  out.vertex.push_back({0, 0, z});
  for (int i = 0; i < kSides; ++i) {
    out.vertex.push_back({corner * std::cos(i * step), corner * std::sin(i * step), z});
    const auto a = static_cast<std::uint32_t>(1 + i),
               b = static_cast<std::uint32_t>(1 + (i + 1) % kSides);
    if (looks_down)
      out.triangle.push_back({0, a, b});
    else
      out.triangle.push_back({0, b, a});
  }
  out.triangle_group.assign(out.triangle.size(), 0);
  return out;
}

// A polyhedron of the sphere's area: its mean silhouette is the sphere's (Cauchy).
Mesh sphere(double radius, Vec<Body> centre, std::uint64_t facets, bool looks_in = false) {
  Mesh out = generated("sphere", facets, 1);
  double area = 0;
  for (const auto& t : out.triangle)
    area +=
        length(cross(out.vertex[t[1]] - out.vertex[t[0]], out.vertex[t[2]] - out.vertex[t[0]])) / 2;
  const double scale = radius * std::sqrt(4 * std::numbers::pi / area);
  for (auto& v : out.vertex) v = centre + scale * v;
  if (looks_in)
    for (auto& t : out.triangle) std::swap(t[1], t[2]);
  out.triangle_group.assign(out.triangle.size(), 0);
  return out;
}

// The mantle of a prism of the cylinder's circumference around an axis along y.
Mesh mantle(double radius, double centre_x, double length) {
  constexpr int kSides = 256;
  const double step = 2 * std::numbers::pi / kSides;
  const double corner = radius * (step / 2) / std::sin(step / 2);
  Mesh out;
  for (int i = 0; i < kSides; ++i) {
    for (const double y : {-length / 2, length / 2})
      out.vertex.push_back(
          {centre_x + corner * std::cos(i * step), y, corner * std::sin(i * step)});
    const auto a = static_cast<std::uint32_t>(2 * i),
               b = static_cast<std::uint32_t>(2 * ((i + 1) % kSides));
    out.triangle.push_back({a, a + 1, b + 1});
    out.triangle.push_back({a, b + 1, b});
  }
  out.triangle_group.assign(out.triangle.size(), 0);
  return out;
}

// An element of 1 mm around a point, whose front looks along u x v.
Mesh element(Vec<Body> at, Vec<Body> u, Vec<Body> v) {
  return plate("", at - 0.0005 * u - 0.0005 * v, 0.001 * u, 0.001 * v, 8);
}

struct Pair {
  Mesh from, to;
  std::uint32_t rays = 1024;  // of each face
};

// A short strip in the middle of one that is so long that its ends do not count.
Mesh strip(Vec<Body> side, double length, bool turned) {
  const Vec<Body> along = length * kY, corner = -0.5 * along;
  return turned ? plate("", corner, along, side, 1) : plate("", corner, side, along, 1);
}

const std::map<std::string, std::function<Pair()>>& scenes() {
  static const std::map<std::string, std::function<Pair()>> kScenes = {
      {"disks_1",
       [] {
         return Pair{facing_disk(1, 0, true), facing_disk(1, 1, false)};
       }},
      {"disks_2",
       [] {
         return Pair{facing_disk(1, 0, true), facing_disk(2, 1.5, false)};
       }},
      {"squares_1",
       [] {
         return Pair{plate("", {}, kX, kY, 8), plate("", {0, 0, 1}, kY, kX, 8)};
       }},
      {"squares_0.1",
       [] {
         return Pair{plate("", {}, kX, kY, 8), plate("", {0, 0, 0.1}, kY, kX, 8)};
       }},
      {"corner",
       [] {
         return Pair{plate("", {}, kY, kX, 8), plate("", {}, kUp, kY, 8)};
       }},
      {"corner_2",
       [] {
         return Pair{plate("", {}, kY, 2.0 * kX, 8), plate("", {}, kUp, kY, 8)};
       }},
      {"spheres_in",
       [] {
         return Pair{sphere(2, {}, 200, true), sphere(1, {}, 200), 64};
       }},
      {"spheres_self",
       [] {
         return Pair{sphere(2, {}, 200, true), sphere(1, {}, 200), 64};
       }},
      {"groove",
       [] {
         const double a = std::numbers::pi / 3;
         return Pair{strip(kX, 1, true), strip({std::cos(a), 0, -std::sin(a)}, kFar, false), 65536};
       }},
      {"strips",
       [] {
         return Pair{strip(kUp, 1, false), strip(2.0 * kX, kFar, true), 65536};
       }},
      {"sphere_tilted",
       [] {
         const double a = std::numbers::pi / 6;
         return Pair{element({}, kY, {std::cos(a), 0, -std::sin(a)}), sphere(1, 3.0 * kUp, 1800),
                     2048};
       }},
      {"cylinders",
       [] {
         return Pair{mantle(1, 0, 1), mantle(1, 3, kFar), 2048};
       }},
      {"cube_floor",
       [] {
         return Pair{element({0.5, 0.5, 0}, kY, kX), plate("", kUp, kX, kY, 1), 4096};
       }},
      {"wall_0.5",
       [] {
         return Pair{element({0, 0.5, 0.5}, kY, kDown), plate("", {}, kX, kY, 1), 4096};
       }},
      {"wall_0.75",
       [] {
         return Pair{element({0, 0.5, 0.75}, kY, kDown), plate("", {}, kX, kY, 1), 4096};
       }},
  };
  return kScenes;
}

// Share of what the first part sends that arrives at the second, or at itself.
//   aimed  at the second part
double share(const Target& target, std::uint32_t to, std::uint32_t rays, std::uint64_t seed,
             bool aimed = false) {
  const ThermalFaces faces = make_thermal_faces(target);
  std::vector<double> beyond_w_m2;
  for (std::uint32_t i = 0; aimed && i < faces.size(); ++i)
    beyond_w_m2.push_back(target.facet[faces.facet[i]].part == 1 ? 1e5 : 0);
  const ExchangeFactors f = exchange_factors(
      target, faces,
      {.rays = rays, .seed = seed, .surface_z_m = INFINITY, .beyond_w_m2 = beyond_w_m2});
  double sum = 0, area = 0;
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    if (target.facet[faces.facet[i]].part != 0) continue;
    area += faces.area_m2[i];
    for (std::size_t k = f.first[i]; k < f.first[i + 1]; ++k)
      if (target.facet[faces.facet[f.to[k]]].part == to)
        sum += faces.area_m2[i] * static_cast<double>(f.share[k]);
  }
  return sum / area;
}

// Near, far, touching, curved: rays that are aimed change no mean.
void closed_forms(bool aimed) {
  const ReferenceTable table("view_factors.csv");
  ASSERT_EQ(table.size(), scenes().size());
  for (std::size_t row = 0; row < table.size(); ++row) {
    const std::string& name = table.text(row, "case");
    Pair scene = scenes().at(name)();
    scene.from.group = {"from"};
    scene.to.group = {"to"};
    Mesh mesh = scene.from;
    append(mesh, scene.to);
    const Target target = target_of(mesh, {part("from"), part("to")});
    const std::uint32_t to = name == "spheres_self" ? 0 : 1;
    double sum = 0, square = 0;
    constexpr int kSeeds = 8;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      const double f = share(target, to, scene.rays, static_cast<std::uint64_t>(seed), aimed);
      sum += f;
      square += f * f;
    }
    const double expected = table.number(row, "share"), mean = sum / kSeeds;
    const double stderr_ = std::sqrt(std::max(0.0, square / kSeeds - mean * mean) / (kSeeds - 1));
    std::printf("%-14s %.6f +- %.6f expected %.6f\n", name.c_str(), mean, stderr_, expected);
    // Polygons in place of curves, and strips in place of infinite ones, are within 1e-4 of 1.
    EXPECT_NEAR(mean, expected, std::max(3 * stderr_, 2e-4 * expected)) << table.text(row, "what");
    EXPECT_LT(stderr_, 1e-3 * expected) << table.text(row, "what");
  }
}
TEST(ViewFactors, ClosedForms) { closed_forms(false); }
TEST(ViewFactors, ClosedFormsWithAimedRays) { closed_forms(true); }

// Tests a cube of 0.3 m at 25 m, which a plate's 256 rays meet once in twenty.
TEST(ViewFactors, WhatIsSmallAndHotIsAimedAt) {
  Mesh mesh = plate("plate", {-0.5, -0.5, 25}, {0, 1, 0}, {1, 0, 0}, 1);
  Mesh cube = generated("box", 12, 0, 0.3, 0.3, 0.3);
  cube = named(std::move(cube), "cube");
  append(mesh, cube);
  const Target target = target_of(mesh, {part("plate", true), part("cube")});
  // The plate has two sides, of which one sees the cube's nearer side.
  const double expected = 0.5 * 0.09 / (std::numbers::pi * 24.85 * 24.85);
  double square = 0;
  constexpr int kSeeds = 32;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const double f = share(target, 1, 256, static_cast<std::uint64_t>(seed), true);
    square += (f - expected) * (f - expected);
  }
  EXPECT_LT(std::sqrt(square / kSeeds), 0.02 * expected);
}

}  // namespace
}  // namespace irsig
