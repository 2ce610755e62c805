#include <cmath>

#include "core/signature/row_bounds/row_bounds.h"

namespace irsig {
namespace {

// Returns the integral of an error of the background's radiance over the silhouette and the band.
//   spectrum  [direction of the background][node]
double behind_silhouette_w_sr(const BoundInput& in,
                              const std::vector<std::vector<double>>& spectrum) {
  double out = 0;
  std::size_t node = 0;
  for (const SourceId id : in.setup.sources.layout().behind_directions()) {
    // Nothing of the target's materials is in these weights: they are the same at each node.
    double area_m2 = 0;
    for (const SummedWeights& s : in.lit.sums()) area_m2 += s.row(id)[0];
    area_m2 /= in.setup.accuracy.replicates;
    out += area_m2 * in_band(spectrum[node++], in.row.on_axis);
  }
  return out;
}

// Returns by how much more land behind the silhouette would send if its temperatures were as much
// higher as they may be wrong.
double land_temperature_w_sr(const BoundInput& in) {
  const ConditionSources& light = *in.row.light;
  if (!light.has_land_errors()) return 0;
  double out = 0;
  for (const SourceId id : light.layout().behind_lands())
    if (const double area_m2 = std::abs(in.mean.row(id)[0]); area_m2 > 0)
      out += area_m2 * light.land_error_w_m2_sr(id, in.row.on_axis).apparent;
  return out;
}

}  // namespace

ThreeBounds background_bound(const BoundInput& in) {
  const ViewEnvironment& e = in.row.light->environment();
  const double directions = e.background_interpolation.empty()
                                ? 0
                                : behind_silhouette_w_sr(in, e.background_interpolation);
  return {0, 0, directions + land_temperature_w_sr(in)};
}

double background_model_w_sr(const BoundInput& in) {
  const ViewEnvironment& e = in.row.light->environment();
  if (e.background_interpolation.empty()) return 0;
  double land_w_sr = 0;
  for (const SourceId id : in.setup.sources.layout().behind_lands())
    land_w_sr += in.mean.row(id)[0] * in_band(in.row.light->apparent(id), in.row.on_axis);
  return behind_silhouette_w_sr(in, e.background_model_error) +
         e.lower_model_relative * std::abs(land_w_sr);
}

}  // namespace irsig
