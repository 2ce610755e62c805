#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/study/work_precision.h"
#include "planning/accuracy_study.h"
#include "planning/load_sweep.h"
#include "view/study_tables/mesh_tables.h"

namespace irsig {

struct MeshStudyAsked {
  // Factors on the triangles of a generated model, or files that replace the model's file; at least
  // two, separated by commas.
  std::string meshes;
  AccuracyRows rows;                     // season, time and band
  std::uint64_t views = 8;               // of the sweep's, spread evenly
  std::optional<double> relative_error;  // instead of the sweep's accuracy
};

// Computes the same views on several meshes of the sweep's target, with every effect on unless the
// sweep names the effects. Each mesh has separate random numbers. `seen` is called for each mesh
// when it is done. INVALID_ARGUMENT: a list of meshes that does not suit the sweep's model; a mesh
// that cannot be made or read, or whose groups are not those of the parts; two equal meshes; no
// such season, time or band.
[[nodiscard]] absl::StatusOr<MeshComparison> compare_meshes(
    const LoadedSweep& loaded, const MeshStudyAsked& asked, const CpuClock& cpu_s,
    const std::function<void(const MeasuredMesh&)>& seen);

}  // namespace irsig
