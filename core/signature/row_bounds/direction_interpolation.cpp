#include <algorithm>
#include <cmath>

#include "core/signature/row_bounds/row_bounds.h"

namespace irsig {
namespace {

// From this slope on lobes are as wide as those over which the environment took the mean of its
// interpolation errors (SunLight::Sky::interpolation).
constexpr double kWideLobeSlope = 0.15;

// Error of light that is linear between nodes of a land's range. A line between a node's neighbours
// misses the node by twice as much as lines to them miss what is half way, where nodes are as far
// apart again, and by four times as much where they are equally far.
//   lights  [material][node of the range] of `table`'s rows
double range_interpolation_w_sr(const BoundInput& in, const std::vector<double>& entry,
                                SourceRange lights, std::span<const double> range_m) {
  const std::size_t ranges = range_m.size(), columns = in.row.in_band.columns;
  if (ranges < 3) return 0;
  double sum = 0;
  for (std::uint32_t first = lights.first; first < lights.last;
       first += static_cast<std::uint32_t>(ranges))
    for (std::size_t k = 0; k < ranges; ++k) {
      const std::size_t middle = std::clamp<std::size_t>(k, 1, ranges - 2);
      const double f =
          (range_m[middle] - range_m[middle - 1]) / (range_m[middle + 1] - range_m[middle - 1]);
      const double* at = entry.data() + (first + middle) * columns;
      const double* weight = in.mean.row(SourceId{first + static_cast<std::uint32_t>(k)}) +
                             in.row.in_band.first_column;
      for (std::size_t i = 0; i < columns; ++i)
        sum += std::abs(weight[i]) * 0.5 *
               std::abs(at[i] - std::lerp(at[i - columns], at[i + columns], f));
    }
  return sum;
}

}  // namespace

// Errors are taken where paths went to, whatever reflected them there. Wide lobes see the mean over
// many cells, whose errors partly cancel.
ThreeBounds direction_interpolation_bound(const BoundInput& in) {
  const std::vector<Material>& material = in.setup.scene.material;
  const bool wide = std::all_of(material.begin(), material.end(), [](const Material& m) {
    return static_cast<double>(m.narrowest_slope()) >= kWideLobeSlope;
  });
  const SourceLayout& layout = in.setup.sources.layout();
  const ViewEnvironment& environment = in.row.light->environment();
  const auto of_side = [&](SourceRange nodes, double relative, Cause cause) {
    const double each = interpolation_w_sr(in.row.in_band, nodes, layout, in.mean);
    const double lobes =
        relative * std::abs(in.row.estimate.cause[static_cast<std::size_t>(cause)].value);
    return wide ? std::min(each, lobes) : each;
  };
  const double sum = of_side(layout.sky(), environment.sky_interpolation, Cause::kSkyReflected) +
                     of_side(layout.lower(), environment.lower_interpolation, Cause::kSeaReflected);
  const SourceTable& table = in.row.in_band;
  const std::vector<double>& behind_m = in.setup.view->environments.land_range_m;
  ThreeBounds out{sum, sum, sum};
  for (const SourceRange lights : {layout.land(), layout.land_suns()}) {
    out.source += range_interpolation_w_sr(in, table.source, lights, kLandRangeM);
    const double seen = range_interpolation_w_sr(in, table.apparent, lights, kLandRangeM);
    out.apparent += seen;
    out.contrast += seen;
  }
  out.contrast += range_interpolation_w_sr(in, table.apparent, layout.behind_lands(), behind_m);
  return out;
}

}  // namespace irsig
