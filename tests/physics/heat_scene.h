#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/scene/generate/generate_mesh.h"
#include "core/scene/trace/target.h"

// Scenes of a few bodies for tests of exchange and heat.
namespace irsig {

inline Mesh generated(const std::string& kind, std::uint64_t triangles, double radius_m = 0,
                      double length_m = 0, double width_m = 0, double height_m = 0) {
  auto mesh = generate_mesh({kind, triangles, radius_m, length_m, width_m, height_m});
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return *std::move(mesh);
}

inline void append(Mesh& a, const Mesh& b) {
  const auto base = static_cast<std::uint32_t>(a.vertex.size());
  const auto groups = static_cast<std::uint32_t>(a.group.size());
  a.vertex.insert(a.vertex.end(), b.vertex.begin(), b.vertex.end());
  for (const auto& t : b.triangle) a.triangle.push_back({base + t[0], base + t[1], base + t[2]});
  for (const auto g : b.triangle_group) a.triangle_group.push_back(groups + g);
  a.group.insert(a.group.end(), b.group.begin(), b.group.end());
}

// A parallelogram of n x n cells cut in two, spanned by u and v from a corner; its front is where
// u x v points.
inline Mesh plate(const std::string& name, Vec<Body> corner, Vec<Body> u, Vec<Body> v, int n) {
  Mesh out;
  out.group = {name};
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      out.vertex.push_back(corner + (static_cast<double>(i) / n) * u +
                           (static_cast<double>(j) / n) * v);
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (n + 1) + j); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      out.triangle.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      out.triangle.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  out.triangle_group.assign(out.triangle.size(), 0);
  return out;
}

// All of a mesh as one group of that name.
inline Mesh named(Mesh mesh, const std::string& name) {
  mesh.group = {name};
  mesh.triangle_group.assign(mesh.triangle.size(), 0);
  return mesh;
}

inline Target target_of(const Mesh& mesh, std::vector<PartSpec> parts) {
  auto target = make_target(mesh, std::move(parts), widest_isa());
  EXPECT_TRUE(target.ok()) << target.status();
  return *std::move(target);
}

inline PartSpec part(const std::string& name, bool two_sided = false) {
  PartSpec out;
  out.name = name;
  out.two_sided = two_sided;
  return out;
}

}  // namespace irsig
