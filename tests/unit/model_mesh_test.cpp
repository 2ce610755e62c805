// The mesh of a sweep and the same facets in the coordinates of its file.
#include "runner/model_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace irsig {
namespace {

// A wedge, in metres or in others; x forward, z up.
std::string wedge(double unit_m) {
  std::string out = "g body\n";
  const double at[6][3] = {{-3, -1, -1}, {-3, 1, -1}, {-3, 0, 2},
                           {3, -1, -1},  {3, 1, -1},  {3, 0, 2}};
  for (const auto& v : at)
    out += "v " + std::to_string(v[0] / unit_m) + " " + std::to_string(v[1] / unit_m) + " " +
           std::to_string(v[2] / unit_m) + "\n";
  return out + "f 1 3 2\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 6\n";
}

// Cut at the water and to edges of 1.5 m, whatever the file's unit is.
TEST(ModelMesh, FacetsAreTheSameInTheUnitsOfTheFile) {
  std::vector<Mesh> placed;
  for (const double unit_m : {1.0, 0.001, 100.0}) {
    schema::ResolvedSweep sweep;
    schema::Model& model = *sweep.mutable_sweep()->mutable_model();
    model.set_unit_m(unit_m);
    model.set_forward_axis("+x");
    model.set_up_axis("+z");
    model.set_reference("origin");
    model.set_draft_m(0.7);
    for (const double m : {10.0, 0.0, 0.0}) model.add_offset_m(m);
    sweep.set_model_file_name("wedge.obj");
    sweep.set_model_sha256("wedge");
    sweep.mutable_sweep()->mutable_heat()->set_element_size_m(1.5);
    const Assets assets = {{"wedge", wedge(unit_m)}};
    const auto mesh = model_mesh(sweep, assets), of_file = model_mesh_of_file(sweep, assets);
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    ASSERT_TRUE(of_file.ok()) << of_file.status();
    EXPECT_EQ(of_file->triangle, mesh->triangle);
    ASSERT_EQ(of_file->vertex.size(), mesh->vertex.size());
    for (std::size_t v = 0; v < mesh->vertex.size(); ++v) {
      const Vec<Body> expected = unit_m * of_file->vertex[v] + Vec<Body>{10, 0, 0.7 - 1};
      EXPECT_NEAR(length(mesh->vertex[v] - expected), 0, 1e-9);
    }
    placed.push_back(*mesh);
  }
  EXPECT_GT(placed[0].triangle.size(), 30u);
  for (const Mesh& mesh : placed) {
    EXPECT_EQ(mesh.triangle, placed[0].triangle);
    for (const auto& c : mesh.triangle) {
      const auto [low, high] =
          std::minmax({mesh.vertex[c[0]].z, mesh.vertex[c[1]].z, mesh.vertex[c[2]].z});
      EXPECT_FALSE(low < -1e-4 && high > 1e-4);
    }
  }
}

// Files that count facets count those of the file.
TEST(ModelMesh, FacetsThatAreCountedAreNotCut) {
  schema::ResolvedSweep sweep;
  schema::Sweep& s = *sweep.mutable_sweep();
  s.mutable_model()->set_generate("box");
  s.mutable_model()->set_triangles(12);
  s.mutable_model()->set_draft_m(0.3);
  const auto facets = [&] { return model_mesh(sweep, {})->triangle.size(); };
  EXPECT_EQ(facets(), 12u) << "no temperatures are computed";
  s.mutable_heat()->set_tolerance_k(0.01);
  EXPECT_GT(facets(), 12u);
  s.add_temperature_field()->set_match("centroid");
  EXPECT_GT(facets(), 12u);
  s.add_temperature_field()->set_match("index");
  EXPECT_EQ(facets(), 12u);
}

}  // namespace
}  // namespace irsig
