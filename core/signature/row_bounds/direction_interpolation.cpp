#include <algorithm>
#include <cmath>

#include "core/signature/row_bounds/row_bounds.h"

namespace irsig {
namespace {

// From this slope on lobes are as wide as those over which the environment took the mean of its
// interpolation errors (SunLight::Sky::interpolation).
constexpr double kWideLobeSlope = 0.15;

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
  return {sum, sum, sum};
}

}  // namespace irsig
