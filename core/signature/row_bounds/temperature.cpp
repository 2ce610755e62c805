#include "core/signature/row_bounds/row_bounds.h"

namespace irsig {

// By how much more the target would emit if all its temperatures were as much higher as they may be
// wrong.
ThreeBounds temperature_bound(const BoundInput& in) {
  ThreeBounds out;
  const SourceTable& table = in.row.in_band;
  for (const SummedWeights& change : in.temperature_changes)
    for (const SourceId id : in.row.light->layout().all_emitted())
      for (std::size_t k = 0; k < table.columns; ++k) {
        const double weight = change.row(id)[table.first_column + k] / in.setup.accuracy.replicates;
        out.source += weight * table.row(id)[k];
        out.apparent += weight * table.apparent[index_of(id) * table.columns + k];
      }
  out.contrast = out.apparent;
  return out;
}

}  // namespace irsig
