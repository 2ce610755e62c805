#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/viewpoint.h"
#include "core/study/mesh_convergence.h"
#include "view/study_tables/work_precision_plot.h"

namespace irsig {

// One view of one mesh, in one condition.
struct MeshView {
  MeshValue projected_area_m2;
  std::vector<MeshValue> intensity_w_sr;  // [band] of the source, with its numerical error
  double samples = 0;                     // primary rays, all replicates
  double cpu_s = 0;                       // air, sky, sea, pilots, tracing and shading
};

struct MeasuredMesh {
  std::string name;                   // as the user gave it: a factor or a file
  std::uint64_t asked_triangles = 0;  // of the generator; 0: the mesh comes from a file
  std::uint64_t facets = 0;
  double surface_area_m2 = 0;  // of all facets, hidden ones included
  double setup_cpu_s = 0;      // mesh, ray tracer, materials, air
  std::vector<MeshView> view;
};

// Views of a sweep on several meshes of its target.
struct MeshComparison {
  std::string sweep, season, time_utc;
  std::vector<std::string> band;
  std::vector<Viewpoint> viewpoint;
  std::vector<MeasuredMesh> mesh;  // by the number of facets; deviations are from the last
};

// Returns a heading and tables in Markdown: the meshes, their deviations from the finest one, and
// the limit of infinitely many facets.
[[nodiscard]] std::string mesh_tables(const MeshComparison& comparison);

// Returns one line for each mesh, viewpoint and band; numbers have all their digits.
[[nodiscard]] absl::StatusOr<std::string> mesh_csv(const MeshComparison& comparison);

}  // namespace irsig
