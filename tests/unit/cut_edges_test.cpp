// Facets cut until no edge is longer than asked.
#include "core/scene/cut_edges.h"
#include "core/scene/generate/generate_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace irsig {
namespace {

Mesh of_kind(const std::string& kind, std::uint64_t triangles) {
  auto mesh = generate_mesh({kind, triangles, 0, 0, 0, 0});
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  return *std::move(mesh);
}

// Area by group, and the sum of area x normal.
struct Measure {
  std::map<std::uint32_t, double> area;
  Vec<Body> sum;
  double longest = 0;
  // Number of times that each edge is met, by direction: of a closed surface once in each.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edge;
};
Measure measured(const Mesh& mesh) {
  Measure out;
  for (std::size_t f = 0; f < mesh.triangle.size(); ++f) {
    const auto& c = mesh.triangle[f];
    const Vec<Body> twice =
        cross(mesh.vertex[c[1]] - mesh.vertex[c[0]], mesh.vertex[c[2]] - mesh.vertex[c[0]]);
    out.area[mesh.triangle_group[f]] += 0.5 * length(twice);
    out.sum = out.sum + 0.5 * twice;
    for (std::size_t i = 0; i < 3; ++i) {
      ++out.edge[{c[i], c[(i + 1) % 3]}];
      out.longest = std::max(out.longest, length(mesh.vertex[c[(i + 1) % 3]] - mesh.vertex[c[i]]));
    }
  }
  return out;
}

TEST(CutEdges, KeepSurfaceSidesGroupsAndClosedness) {
  for (const char* kind : {"box", "frigate", "cone"}) {
    const Mesh mesh = of_kind(kind, kind == std::string("frigate") ? 4000 : 60);
    const Measure before = measured(mesh);
    for (const double share : {0.9, 0.4, 0.11}) {
      const double longest = share * before.longest;
      std::vector<CutVertex> made;
      const auto cut = cut_long_edges(mesh, longest, 10'000'000, made);
      ASSERT_TRUE(cut.ok()) << cut.status();
      const Measure after = measured(*cut);
      EXPECT_LE(after.longest, longest) << kind;
      EXPECT_GT(cut->triangle.size(), mesh.triangle.size()) << kind;
      for (const auto& [group, area] : before.area)
        EXPECT_NEAR(after.area.at(group), area, 1e-9 * area) << kind;
      EXPECT_NEAR(length(after.sum - before.sum), 0, 1e-9 * before.longest * before.longest);
      // A closed mesh stays closed: no edge loses its other side.
      const auto open = [](const Measure& m) {
        return std::count_if(m.edge.begin(), m.edge.end(), [&](const auto& e) {
          const auto other = m.edge.find({e.first.second, e.first.first});
          return other == m.edge.end() || other->second != e.second;
        });
      };
      if (open(before) == 0) {
        EXPECT_EQ(open(after), 0) << kind;
      }
    }
  }
}

TEST(CutEdges, WhatIsShortEnoughStaysAsItIs) {
  const Mesh mesh = of_kind("sphere", 200);
  std::vector<CutVertex> made;
  const auto cut = cut_long_edges(mesh, 10, 1000, made);
  ASSERT_TRUE(cut.ok());
  EXPECT_EQ(cut->triangle, mesh.triangle);
  EXPECT_EQ(cut->vertex, mesh.vertex);
}

TEST(CutEdges, TooManyFacetsAreRefused) {
  std::vector<CutVertex> made;
  EXPECT_THAT(
      std::string(cut_long_edges(of_kind("box", 12), 1e-3, 100'000, made).status().message()),
      testing::HasSubstr("more than 100000"));
}

int crossing(const Mesh& mesh, double touching_m) {
  int out = 0;
  for (const auto& c : mesh.triangle) {
    const auto [low, high] =
        std::minmax({mesh.vertex[c[0]].z, mesh.vertex[c[1]].z, mesh.vertex[c[2]].z});
    out += low < -touching_m && high > touching_m ? 1 : 0;
  }
  return out;
}

// Surfaces through vertices, edges, facets and beside them; and what is made of the same vertices
// in other coordinates.
TEST(CutEdges, NoFacetIsOnBothSidesOfTheSurface) {
  for (const char* kind : {"box", "sphere", "frigate", "cone"})
    for (const double down_m : {0.0, 1e-7, 0.01, 0.13, -0.4, 0.5}) {
      Mesh mesh = of_kind(kind, kind == std::string("frigate") ? 4000 : 60);
      const Measure before = measured(mesh);
      for (Vec<Body>& v : mesh.vertex) v.z += down_m * before.longest;
      const double touching_m = 1e-6 * before.longest;
      std::vector<CutVertex> made;
      const Mesh cut = cut_at_surface(mesh, touching_m, made);
      EXPECT_EQ(crossing(cut, touching_m), 0) << kind << down_m;
      const int crossed = crossing(mesh, touching_m);
      if (crossed == 0) {
        EXPECT_EQ(cut.vertex, mesh.vertex) << kind << down_m;
      }
      EXPECT_LE(cut.triangle.size(), mesh.triangle.size() + 2 * static_cast<std::size_t>(crossed));
      const Measure after = measured(cut);
      for (const auto& [group, area] : before.area)
        EXPECT_NEAR(after.area.at(group), area, 1e-9 * area) << kind;
      EXPECT_NEAR(length(after.sum - before.sum), 0, 1e-9 * before.longest * before.longest);
      std::vector<Vec<Body>> vertex;
      for (const Vec<Body>& v : mesh.vertex) vertex.push_back({3 * v.z - 1, v.x, v.y + 7});
      add_cut_vertices(made, vertex);
      ASSERT_EQ(vertex.size(), cut.vertex.size());
      for (std::size_t k = 0; k < vertex.size(); ++k) {
        const Vec<Body>& v = cut.vertex[k];
        EXPECT_NEAR(length(vertex[k] - Vec<Body>{3 * v.z - 1, v.x, v.y + 7}), 0,
                    1e-12 * (10 + before.longest));
      }
    }
}

// Expected: facets that share no vertices are cut at the same places, to the last bit.
TEST(CutEdges, VerticesThatAFileHasTwiceAreCutAlike) {
  for (const char* kind : {"sphere", "frigate"}) {
    Mesh mesh = of_kind(kind, 2000);
    for (Vec<Body>& v : mesh.vertex) v = v + Vec<Body>{0.1, 0.7, 0.123};
    Mesh apart = mesh;
    apart.vertex.clear();
    for (auto& c : apart.triangle)
      for (std::uint32_t& v : c) {
        apart.vertex.push_back(mesh.vertex[v]);
        v = static_cast<std::uint32_t>(apart.vertex.size() - 1);
      }
    const auto places = [](const Mesh& m) {
      std::vector<CutVertex> made;
      std::set<std::array<double, 3>> out;
      for (const Vec<Body>& v : cut_at_surface(m, 1e-6, made).vertex) out.insert({v.x, v.y, v.z});
      return out;
    };
    EXPECT_EQ(places(mesh), places(apart)) << kind;
  }
}

}  // namespace
}  // namespace irsig
