#include "core/scene/check/mesh_lint.h"
#include "core/scene/generate/generate_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/scene/mesh_measure.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

Mesh box() { return generate_mesh({"box", 12}).value(); }

void add_facet(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.triangle.push_back({a, b, c});
  mesh.triangle_group.push_back(0);
}

// Another mesh beside or in the first, its vertices moved and scaled.
Mesh with(Mesh mesh, const Mesh& other, Vec<Body> by, double scale = 1) {
  const auto first = static_cast<std::uint32_t>(mesh.vertex.size());
  for (const Vec<Body>& v : other.vertex) mesh.vertex.push_back(scale * v + by);
  for (const auto& t : other.triangle) add_facet(mesh, first + t[0], first + t[1], first + t[2]);
  return mesh;
}

Mesh turned(Mesh mesh) {
  for (auto& t : mesh.triangle) std::swap(t[1], t[2]);
  return mesh;
}

std::map<std::string, std::uint64_t> faults(const Mesh& mesh, bool errors,
                                            const LintOptions& options = {}) {
  std::map<std::string, std::uint64_t> out;
  for (const LintFinding& f : lint(mesh, options).finding)
    if (f.is_error == errors) out[std::string(fault_name(f.fault))] = f.count;
  return out;
}
auto errors(const Mesh& mesh) { return faults(mesh, true); }
auto warnings(const Mesh& mesh) { return faults(mesh, false); }

const LintFinding& finding(const LintReport& report, MeshFault fault) {
  return *std::find_if(report.finding.begin(), report.finding.end(),
                       [&](const LintFinding& f) { return f.fault == fault; });
}

TEST(MeshLint, CleanModelsHaveNoFindings) {
  for (const char* kind : {"sphere", "box", "cylinder", "cone"}) {
    const LintReport report = lint(generate_mesh({kind, 3000}).value());
    EXPECT_THAT(report.finding, IsEmpty())
        << kind << " " << fault_name(report.finding.front().fault);
    EXPECT_EQ(report.shells, 1u);
    EXPECT_EQ(report.closed_shells, 1u);
  }
}

TEST(MeshLint, TheFrigateHasNoErrors) {
  const LintReport report = lint(generate_mesh({"frigate", 20'000}).value());
  EXPECT_FALSE(report.has_errors()) << fault_name(report.finding.front().fault);
  EXPECT_EQ(report.shells, report.closed_shells);
  EXPECT_GT(report.shells, 5u);
  EXPECT_GT(finding(report, MeshFault::kShellIntersection).count, 100u);  // parts stand in others
}

TEST(MeshLint, OpenEdges) {
  Mesh mesh = box();
  mesh.triangle.pop_back();
  mesh.triangle_group.pop_back();
  EXPECT_THAT(errors(mesh), ElementsAre(Pair("open_edges", 3)));
  EXPECT_EQ(lint(mesh).closed_shells, 0u);
  EXPECT_THAT(faults(mesh, true, {true, 5}), IsEmpty());
  EXPECT_THAT(faults(mesh, false, {true, 5}), ElementsAre(Pair("open_edges", 3)));
  const LintReport report = lint(mesh, {false, 2});
  EXPECT_EQ(finding(report, MeshFault::kOpenEdge).first.size(), 2u);
}

TEST(MeshLint, NonManifoldEdges) {
  Mesh fin = box();  // a fin stands on an edge of the box
  fin.vertex.push_back({3, 3, 3});
  add_facet(fin, fin.triangle[0][0], fin.triangle[0][1],
            static_cast<std::uint32_t>(fin.vertex.size() - 1));
  EXPECT_THAT(errors(fin), ElementsAre(Pair("non_manifold_edges", 1), Pair("open_edges", 2)));
  // Two boxes that touch along an edge enclose a volume properly: a warning.
  const Mesh touching = with(box(), box(), {2, 1, 0});
  EXPECT_THAT(errors(touching), IsEmpty());
  EXPECT_THAT(warnings(touching),
              ElementsAre(Pair("duplicate_vertices", 2), Pair("non_manifold_edges", 1)));
}

TEST(MeshLint, FacetsInsideOut) {
  Mesh one = box();
  std::swap(one.triangle[5][1], one.triangle[5][2]);
  EXPECT_THAT(errors(one), ElementsAre(Pair("inconsistent_facets", 3)));
  EXPECT_THAT(errors(turned(box())), ElementsAre(Pair("inside_out_shells", 1)));
  // A cavity is wound inwards; so is a shell in the open, by mistake.
  EXPECT_THAT(errors(with(box(), turned(box()), {0, 0, 0}, 0.5)), IsEmpty());
  EXPECT_THAT(errors(with(box(), turned(box()), {5, 0, 0})),
              ElementsAre(Pair("inside_out_shells", 1)));
  EXPECT_THAT(errors(turned(with(box(), turned(box()), {0, 0, 0}, 0.5))),
              ElementsAre(Pair("inside_out_shells", 1)));
}

TEST(MeshLint, DuplicateFacets) {
  Mesh mesh = box();
  const auto t = mesh.triangle[4];
  add_facet(mesh, t[1], t[2], t[0]);
  const LintReport report = lint(mesh);
  EXPECT_EQ(finding(report, MeshFault::kDuplicateFacet).count, 1u);
  EXPECT_EQ(finding(report, MeshFault::kDuplicateFacet).first.front().number, 12u);
  EXPECT_EQ(finding(report, MeshFault::kNonManifoldEdge).count, 3u);
}

TEST(MeshLint, FacetsThatMeet) {
  // Overlapping solids are a way to build; a surface through itself is a mistake.
  const Mesh overlapping = with(box(), box(), {0.9, 0.35, 0.2}, 0.7);
  EXPECT_THAT(errors(overlapping), IsEmpty());
  EXPECT_GT(warnings(overlapping)["shell_intersections"], 3u);
  Mesh sphere = generate_mesh({"sphere", 500}).value();
  for (Vec<Body>& v : sphere.vertex)
    if (v.z > 0.9) v.z = -2;  // the pole is pushed out through the other side
  EXPECT_GT(errors(sphere)["self_intersections"], 3u);
  // Contact is no overlap: a box on a box, with and without common faces.
  EXPECT_EQ(warnings(with(box(), box(), {0, 0, 0.5})).count("shell_intersections"), 0u);
  const Mesh standing = with(box(), box(), {0.1, 0.1, 0.375}, 0.5);
  EXPECT_EQ(warnings(standing).count("shell_intersections"), 0u);
  EXPECT_GT(warnings(standing)["coplanar_overlaps"], 0u);
  EXPECT_THAT(errors(with(box(), box(), {2.5, 0, 0})), IsEmpty());
}

TEST(MeshLint, FacetsWithoutArea) {
  Mesh mesh = box();
  mesh.vertex.push_back({10, 0, 0});
  mesh.vertex.push_back({11, 0, 0});
  mesh.vertex.push_back({10.5, 1e-14, 0});
  mesh.vertex.push_back({10.5, 5e-4, 0});
  const auto n = static_cast<std::uint32_t>(mesh.vertex.size());
  add_facet(mesh, n - 4, n - 3, n - 2);
  add_facet(mesh, n - 4, n - 4, n - 3);
  add_facet(mesh, n - 4, n - 3, n - 1);
  EXPECT_EQ(warnings(mesh)["zero_area_facets"], 2u);
  EXPECT_EQ(warnings(mesh)["skinny_facets"], 1u);
}

TEST(MeshLint, VerticesUnusedAndTwice) {
  Mesh mesh = box();
  mesh.vertex.push_back({7, 7, 7});
  mesh.vertex.push_back(mesh.vertex[0]);
  for (auto& index : mesh.triangle.back())
    if (index == 0) index = static_cast<std::uint32_t>(mesh.vertex.size() - 1);
  const auto found = warnings(mesh);
  EXPECT_EQ(found.at("duplicate_vertices"), 1u);
  EXPECT_GE(found.at("unused_vertices"), 1u);
  EXPECT_THAT(errors(mesh), IsEmpty());  // closed all the same
}

TEST(MeshLint, Units) {
  const auto note = [](double scale) {
    Mesh mesh = generate_mesh({"frigate", 2000}).value();
    for (Vec<Body>& v : mesh.vertex) v = scale * v;
    const LintReport report = lint(mesh);
    for (const LintFinding& f : report.finding)
      if (f.fault == MeshFault::kUnit) return f.note;
    return std::string();
  };
  EXPECT_EQ(note(1), "");
  EXPECT_THAT(note(1000), HasSubstr("153.8 m if in millimetres"));
  EXPECT_THAT(note(1 / 0.0254), HasSubstr("153.8 m if in inches"));
  EXPECT_THAT(note(0.0001), HasSubstr("long"));
}

TEST(MeshRepair, DoesWhatItSays) {
  // A box whose facets have corners of their own (36), every third one turned, one twice, one
  // without area, and two vertices that nobody uses.
  const Mesh good = box();
  Mesh bad;
  bad.group = good.group;
  for (std::size_t f = 0; f < good.triangle.size(); ++f) {
    const auto first = static_cast<std::uint32_t>(bad.vertex.size());
    for (const std::uint32_t i : good.triangle[f]) bad.vertex.push_back(good.vertex[i]);
    if (f % 3 == 0)
      add_facet(bad, first, first + 2, first + 1);
    else
      add_facet(bad, first, first + 1, first + 2);
  }
  add_facet(bad, 4, 5, 3);
  add_facet(bad, 0, 0, 1);
  bad.vertex.push_back({9, 9, 9});
  bad.vertex.push_back({8, 9, 9});
  EXPECT_TRUE(lint(bad).has_errors());
  const RepairedMesh repaired = repair(bad);
  EXPECT_THAT(lint(repaired.mesh).finding, IsEmpty());
  EXPECT_EQ(repaired.log.merged_vertices, 36u - good.vertex.size());
  EXPECT_EQ(repaired.log.dropped_duplicates, 1u);
  EXPECT_EQ(repaired.log.dropped_zero_area, 1u);
  EXPECT_EQ(repaired.log.dropped_vertices, 2u);
  EXPECT_EQ(repaired.log.turned_facets, 4u);
  EXPECT_EQ(repaired.log.unorientable_edges, 0u);
  EXPECT_EQ(repaired.mesh.triangle.size(), 12u);
  EXPECT_DOUBLE_EQ(measure(repaired.mesh).volume_m3, measure(good).volume_m3);
}

TEST(MeshRepair, ShellsFaceOutwardsAndCavitiesInwards) {
  const double hollow = measure(with(box(), turned(box()), {0, 0, 0}, 0.5)).volume_m3;
  const RepairedMesh repaired = repair(turned(with(box(), turned(box()), {0, 0, 0}, 0.5)));
  EXPECT_FALSE(lint(repaired.mesh).has_errors());
  EXPECT_GT(measure(repaired.mesh).volume_m3, 0.99 * hollow);
}

TEST(MeshRepair, LeavesACleanMeshAlone) {
  const Mesh mesh = generate_mesh({"frigate", 5000}).value();
  const RepairedMesh repaired = repair(mesh);
  EXPECT_EQ(repaired.mesh.triangle.size(), mesh.triangle.size());
  EXPECT_EQ(
      repaired.log.turned_facets + repaired.log.dropped_duplicates + repaired.log.dropped_zero_area,
      0u);
}

TEST(MeshRepair, SaysWhereNoOrientationAgrees) {
  Mesh strip;  // a Moebius strip of 12 quadrangles
  strip.group = {"default"};
  constexpr std::uint32_t n = 12;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double phi = 2 * M_PI * i / n;
    for (const double side : {-0.3, 0.3}) {
      const double r = 1 + side * std::cos(phi / 2);
      strip.vertex.push_back({r * std::cos(phi), r * std::sin(phi), side * std::sin(phi / 2)});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool last = i + 1 == n;
    const std::uint32_t a = 2 * i, b = 2 * i + 1, c = last ? 1 : 2 * i + 2,
                        d = last ? 0 : 2 * i + 3;
    add_facet(strip, a, b, d);
    add_facet(strip, a, d, c);
  }
  EXPECT_EQ(repair(strip).log.unorientable_edges, 1u);
}

}  // namespace
}  // namespace irsig
