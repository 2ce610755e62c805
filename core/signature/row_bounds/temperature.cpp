#include <cmath>

#include "core/signature/row_bounds/row_bounds.h"

namespace irsig {
namespace {

// Land that the target reflects. What paths weaken of its light they weaken of the error. (Land
// behind the target: background.cpp.)
void add_land(const BoundInput& in, ThreeBounds& out) {
  const ConditionSources& light = *in.row.light;
  if (!light.has_land_errors()) return;
  const SourceTable& table = in.row.in_band;
  const SourceLayout& layout = light.layout();
  const auto share = [&](double error, std::span<const double> radiance) {
    const double all = in_band(radiance, in.row.on_axis);
    return all > 0 ? error / all : 0;
  };
  double seen = 0;
  for (const SourceId id : layout.land()) {
    const double* weight = in.mean.row(id) + table.first_column;
    double source = 0, apparent = 0;
    for (std::size_t k = 0; k < table.columns; ++k) {
      source += weight[k] * table.row(id)[k];
      apparent += weight[k] * table.apparent[index_of(id) * table.columns + k];
    }
    if (source == 0 && apparent == 0) continue;
    const auto error = light.land_error_w_m2_sr(id, in.row.on_axis);
    out.source += std::abs(source) * share(error.source, light.radiance(id));
    seen += std::abs(apparent) * share(error.apparent, light.apparent(id));
  }
  out.apparent += seen;
  out.contrast += seen;
}

}  // namespace

// By how much more target and land would emit if all temperatures were as much higher as they may
// be wrong.
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
  add_land(in, out);
  return out;
}

}  // namespace irsig
