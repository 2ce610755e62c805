#include "core/scene/check/mesh_lint.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/container/flat_hash_map.h"
#include "core/scene/check/facet_overlap.h"
#include "core/scene/check/mesh_topology.h"
#include "core/scene/mesh_measure.h"
#include "fmt/format.h"

namespace irsig {
namespace {

constexpr std::string_view kName[] = {
    "open_edges",       "non_manifold_edges", "inconsistent_facets", "inside_out_shells",
    "duplicate_facets", "coplanar_overlaps",  "self_intersections",  "shell_intersections",
    "zero_area_facets", "skinny_facets",      "unused_vertices",     "duplicate_vertices",
    "suspicious_unit"};

std::vector<OpenGroup> open_groups(const Mesh& mesh, const MeshTopology& topology) {
  std::vector<bool> open(topology.shell.size(), false);
  for_each_edge(topology, [&](const auto* first, const auto* last) {
    if (last - first == 1) open[topology.shell_of[first->facet]] = true;
  });
  std::vector<std::uint64_t> facets(mesh.group.size(), 0);
  for (std::size_t f = 0; f < mesh.triangle.size(); ++f)
    if (topology.shell_of[f] != MeshTopology::kNone && open[topology.shell_of[f]])
      ++facets[mesh.triangle_group[f]];
  std::vector<OpenGroup> out;
  for (std::size_t g = 0; g < facets.size(); ++g)
    if (facets[g] > 0) out.push_back({mesh.group[g], facets[g]});
  return out;
}

class Linter {
 public:
  Linter(const Mesh& mesh, const LintOptions& options)
      : mesh_(mesh), options_(options), topology_(topology_of(mesh)) {
    for (std::size_t i = 0; i < std::size(kName); ++i)
      finding_.push_back({static_cast<MeshFault>(i), false, 0, {}, {}});
  }

  LintReport run() {
    edges();
    shells();
    duplicates();
    crossings();
    shapes();
    vertices();
    unit();
    LintReport out;
    out.facets = mesh_.triangle.size();
    out.vertices = mesh_.vertex.size();
    out.shells = topology_.shell.size();
    for (const auto& shell : topology_.shell) out.closed_shells += shell.closed ? 1 : 0;
    out.size_m = size_;
    out.open_group = open_groups(mesh_, topology_);
    for (const bool errors : {true, false})
      for (const LintFinding& f : finding_)
        if (f.count > 0 && f.is_error == errors) out.finding.push_back(f);
    return out;
  }

 private:
  LintFinding& of(MeshFault fault) { return finding_[static_cast<std::size_t>(fault)]; }

  void add(MeshFault fault, bool is_error, std::uint32_t number, Vec<Body> at) {
    LintFinding& f = of(fault);
    ++f.count;
    // An error's places are more wanted than a warning's of the same kind.
    if (is_error && !f.is_error) {
      f.is_error = true;
      f.first.clear();
    }
    if (is_error != f.is_error || f.first.size() >= options_.places) return;
    if (f.first.empty() || f.first.back().number != number) f.first.push_back({number, at});
  }

  Vec<Body> centre(std::uint32_t facet) const {
    const auto& t = mesh_.triangle[facet];
    return (1.0 / 3) * (mesh_.vertex[t[0]] + mesh_.vertex[t[1]] + mesh_.vertex[t[2]]);
  }
  Vec<Body> middle(const MeshTopology::Use& use) const {
    return 0.5 * (mesh_.vertex[use.edge >> 32] + mesh_.vertex[use.edge & 0xffffffffu]);
  }

  void edges() {
    for_each_edge(topology_, [&](const auto* first, const auto* last) {
      const auto uses = last - first;
      const auto down = std::count_if(first, last, [](const auto& u) { return u.down; });
      if (uses == 1)
        add(MeshFault::kOpenEdge, !options_.open_surfaces, first->facet, middle(*first));
      else if (uses == 2 && down != 1)
        add(MeshFault::kInconsistentFacet, true, first[1].facet, middle(*first));
      else if (uses > 2)
        add(MeshFault::kNonManifoldEdge, 2 * down != uses, first->facet, middle(*first));
    });
    LintFinding& manifold = of(MeshFault::kNonManifoldEdge);
    if (manifold.count > 0 && !manifold.is_error)
      manifold.note = "each is passed as often in one direction as in the other: solids that touch";
  }

  void shells() {
    const std::vector<bool> inside_out = shells_inside_out(mesh_, topology_);
    for (std::size_t s = 0; s < inside_out.size(); ++s)
      if (inside_out[s])
        add(MeshFault::kInsideOut, true, topology_.shell[s].first_facet,
            centre(topology_.shell[s].first_facet));
  }

  void duplicates() {
    absl::flat_hash_map<std::array<std::uint32_t, 3>, std::uint32_t> seen;
    seen.reserve(mesh_.triangle.size());
    for (std::uint32_t f = 0; f < mesh_.triangle.size(); ++f) {
      if (topology_.shell_of[f] == MeshTopology::kNone) continue;
      std::array<std::uint32_t, 3> at{};
      for (std::size_t k = 0; k < 3; ++k) at[k] = topology_.place_of[mesh_.triangle[f][k]];
      std::sort(at.begin(), at.end());
      if (!seen.try_emplace(at, f).second) add(MeshFault::kDuplicateFacet, true, f, centre(f));
    }
  }

  void crossings() {
    for (const FacetCrossing& c : facet_crossings(mesh_, topology_)) {
      const bool same = topology_.shell_of[c.facet] == topology_.shell_of[c.other];
      if (c.coplanar)
        add(MeshFault::kOverlap, same, c.facet, centre(c.facet));
      else if (same)
        add(MeshFault::kSelfIntersection, true, c.facet, centre(c.facet));
      else
        add(MeshFault::kShellIntersection, false, c.facet, centre(c.facet));
    }
    if (of(MeshFault::kShellIntersection).count > 0)
      of(MeshFault::kShellIntersection).note =
          "overlapping solids are traced correctly, but areas and volumes count the inside twice";
    if (of(MeshFault::kOverlap).count > 0)
      of(MeshFault::kOverlap).note = "which of the two a ray meets is left to rounding";
  }

  void shapes() {
    for (std::uint32_t f = 0; f < mesh_.triangle.size(); ++f) {
      const auto& t = mesh_.triangle[f];
      double longest = 0;
      for (std::size_t k = 0; k < 3; ++k)
        longest = std::max(longest, length(mesh_.vertex[t[(k + 1) % 3]] - mesh_.vertex[t[k]]));
      const double twice = length(
          cross(mesh_.vertex[t[1]] - mesh_.vertex[t[0]], mesh_.vertex[t[2]] - mesh_.vertex[t[0]]));
      if (twice <= 1e-12 * longest * longest)
        add(MeshFault::kZeroArea, false, f, centre(f));
      else if (twice < 1e-3 * longest * longest)
        add(MeshFault::kSkinny, false, f, centre(f));
    }
  }

  void vertices() {
    std::vector<bool> used(mesh_.vertex.size(), false);
    for (const auto& t : mesh_.triangle)
      for (const std::uint32_t i : t) used[i] = true;
    for (std::uint32_t i = 0; i < mesh_.vertex.size(); ++i) {
      if (!used[i]) add(MeshFault::kUnusedVertex, false, i, mesh_.vertex[i]);
      if (topology_.place_of[i] != i) add(MeshFault::kDuplicateVertex, false, i, mesh_.vertex[i]);
    }
  }

  // Targets are 5 cm to 1 km long.
  void unit() {
    const MeshMeasure m = measure(mesh_);
    size_ = m.box_max - m.box_min;
    const double longest = std::max({size_.x, size_.y, size_.z});
    if (longest >= 0.05 && longest <= 1000) return;
    std::string others;
    const auto suggest = [&](double unit, const char* name) {
      if (longest * unit >= 0.5 && longest * unit <= 500)
        others +=
            fmt::format("{}{:.4g} m if in {}", others.empty() ? "" : ", ", longest * unit, name);
    };
    suggest(0.001, "millimetres");
    suggest(0.01, "centimetres");
    suggest(0.0254, "inches");
    suggest(0.3048, "feet");
    suggest(1000, "kilometres");
    add(MeshFault::kUnit, false, 0, centre(0));
    of(MeshFault::kUnit).first.clear();
    of(MeshFault::kUnit).note =
        fmt::format("{:.4g} m long{}{}", longest, others.empty() ? "" : "; would be ", others);
  }

  const Mesh& mesh_;
  LintOptions options_;
  MeshTopology topology_;
  std::vector<LintFinding> finding_;
  Vec<Body> size_;
};

}  // namespace

std::string_view fault_name(MeshFault fault) { return kName[static_cast<std::size_t>(fault)]; }

bool LintReport::has_errors() const {
  return std::any_of(finding.begin(), finding.end(),
                     [](const LintFinding& f) { return f.is_error; });
}

std::vector<OpenGroup> open_groups(const Mesh& mesh) {
  return open_groups(mesh, topology_of(mesh));
}

LintReport lint(const Mesh& mesh, const LintOptions& options) {
  return Linter(mesh, options).run();
}

}  // namespace irsig
