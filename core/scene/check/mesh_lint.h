#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/mesh.h"

namespace irsig {

// Faults and doubtful properties of a mesh. Vertices at exactly the same place count as one, so
// that a surface whose facets repeat their corners is still closed.
enum class MeshFault {
  kOpenEdge = 0,           // one facet only: a hole, or the rim of a sheet
  kNonManifoldEdge = 1,    // more than two facets
  kInconsistentFacet = 2,  // wound against a neighbour
  kInsideOut = 3,          // a closed shell of negative volume that is no cavity of another one
  kDuplicateFacet = 4,     // the same three corners as an earlier facet
  kOverlap = 5,            // two facets in one plane that cover each other in part
  kSelfIntersection = 6,   // a facet through another one of the same shell
  kShellIntersection = 7,  // a facet through one of another shell: overlapping solids
  kZeroArea = 8,           // 2 area <= 1e-12 x longest edge squared: no ray meets it
  kSkinny = 9,             // height below a thousandth of the longest edge
  kUnusedVertex = 10,
  kDuplicateVertex = 11,  // at the place of an earlier one
  kUnit = 12,             // a size that suggests another unit than metres
};
// Returns the fault's name in messages and JSON keys: "open_edges", ...
[[nodiscard]] std::string_view fault_name(MeshFault fault);

struct LintFinding {
  MeshFault fault;
  bool is_error = false;  // else a warning
  std::uint64_t count = 0;
  struct Place {
    std::uint32_t number;  // of the facet (the first one, where two are concerned) or vertex
    Vec<Body> at;
  };
  std::vector<Place> first;  // at most LintOptions::places
  std::string note;
};

struct LintOptions {
  bool open_surfaces = false;  // sheets are meant: open edges are only a warning
  std::size_t places = 5;
};

// Facets of shells with a rim (an edge of one facet only): a sheet, or a body with a hole. From
// behind they send nothing unless their part has two sides.
struct OpenGroup {
  std::string group;
  std::uint64_t facets = 0;
};
// Returns the open groups, in the order of the mesh's groups.
[[nodiscard]] std::vector<OpenGroup> open_groups(const Mesh& mesh);

struct LintReport {
  std::uint64_t facets = 0, vertices = 0;
  std::uint64_t shells = 0, closed_shells = 0;  // facets connected by edges that two facets share
  Vec<Body> size_m;
  std::vector<LintFinding> finding;  // errors first, in the order of MeshFault
  std::vector<OpenGroup> open_group;
  [[nodiscard]] bool has_errors() const;
};

// Errors are open edges, edges that facets pass in one direction more often than in the other,
// facets wound against each other, shells inside out, duplicate facets, overlaps and
// self-intersections; the rest are warnings. Facets that share a corner are not tested for
// intersection. About 2 s for 10^6 facets.
[[nodiscard]] LintReport lint(const Mesh& mesh, const LintOptions& options = {});

// Counts of the changes that repair() made; 0 = nothing to do.
struct RepairLog {
  std::uint64_t merged_vertices = 0, dropped_duplicates = 0, dropped_zero_area = 0;
  std::uint64_t dropped_vertices = 0;    // that no facet uses
  std::uint64_t turned_facets = 0;       // to agree with their neighbours, or to face outwards
  std::uint64_t unorientable_edges = 0;  // where no orientation agrees (a Moebius strip): left

  [[nodiscard]] bool did_something() const {
    return merged_vertices + dropped_duplicates + dropped_zero_area + dropped_vertices +
               turned_facets >
           0;
  }
};
struct RepairedMesh {
  Mesh mesh;
  RepairLog log;
};
// Merges vertices at one place, drops facets without area and all but the first of facets with the
// same corners in the same sense, drops unused vertices, winds each shell's facets consistently
// and closed shells outwards (cavities inwards). Closes no hole, moves no vertex.
[[nodiscard]] RepairedMesh repair(const Mesh& mesh);

}  // namespace irsig
