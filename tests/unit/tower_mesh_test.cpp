// The generated cooling tower: closed, outward, of its stated size, about as many triangles as
// asked.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/scene/generate/generate_mesh.h"
#include "core/scene/mesh.h"
#include "core/scene/mesh_measure.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Mesh tower(std::uint64_t triangles, double radius_m = 0, double length_m = 0, double width_m = 0,
           double height_m = 0) {
  return generate_mesh({"cooling_tower", triangles, radius_m, length_m, width_m, height_m}).value();
}

// Returns the mesh without the ground, which is open.
Mesh without_ground(Mesh mesh) {
  std::vector<std::array<std::uint32_t, 3>> triangle;
  std::vector<std::uint32_t> group;
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) {
    if (mesh.group[mesh.triangle_group[i]] == "ground") continue;
    triangle.push_back(mesh.triangle[i]);
    group.push_back(mesh.triangle_group[i]);
  }
  mesh.triangle = triangle;
  mesh.triangle_group = group;
  return mesh;
}

TEST(CoolingTower, IsClosedAndOutward) {
  for (const std::uint64_t triangles : {416U, 2000U, 20000U}) {
    const Mesh mesh = tower(triangles);
    EXPECT_LE(mesh.triangle.size(), triangles);
    EXPECT_EQ(mesh.degenerate_triangles, 0U);
    const MeshMeasure m = measure(without_ground(mesh));
    EXPECT_EQ(m.open_edges, 0U) << triangles;
    EXPECT_GT(m.volume_m3, 0) << triangles;
  }
  // Closer for more triangles: rings come in steps of eight points.
  EXPECT_GT(tower(20000).triangle.size(), 18000U);
  EXPECT_GT(tower(500000).triangle.size(), 480000U);
}

TEST(CoolingTower, HasItsSizeAndGroups) {
  const Mesh mesh = tower(20000);
  EXPECT_THAT(mesh.group, ElementsAre("casing", "deck", "stack_outside", "stack_rim",
                                      "stack_inside", "plenum", "fill", "hub", "ground"));
  const MeshMeasure m = measure(mesh);
  EXPECT_DOUBLE_EQ(m.box_min.z, -0.44 * 4);      // the stack's exit
  EXPECT_DOUBLE_EQ(m.box_max.z, 0.36 * 4 + 10);  // the ground
  // The hub: two faces and a side; the casing: four walls and the base.
  const double pi = std::numbers::pi;
  EXPECT_NEAR(m.group_area_m2[7], 2 * pi + 2 * pi * 0.4, 1e-2);
  EXPECT_NEAR(m.group_area_m2[0], 4 * 12 * 10 + 12 * 12, 1e-9);
  EXPECT_NEAR(m.group_area_m2[6], std::pow(12 - 2 * 0.08, 2), 1e-9);
  // The throat is the narrowest place of the stack: no vertex of its inside is nearer to the axis
  // than 4 m, but for the polygon's own 0.01 %.
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) {
    if (mesh.group[mesh.triangle_group[i]] != "stack_inside") continue;
    for (const std::uint32_t v : mesh.triangle[i])
      EXPECT_GT(std::hypot(mesh.vertex[v].x, mesh.vertex[v].y), 3.999);
  }
  const MeshMeasure other = measure(tower(20000, 2, 20, 10, 5));
  EXPECT_DOUBLE_EQ(other.box_max.z, 0.36 * 2 + 5);
}

TEST(CoolingTower, RefusesAStackWiderThanItsCasing) {
  const absl::Status status = generate_mesh({"cooling_tower", 2000, 6}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("a stack 13.06 m wide"));
  EXPECT_FALSE(generate_mesh({"cooling_tower", 415}).ok());
}

}  // namespace
}  // namespace irsig
