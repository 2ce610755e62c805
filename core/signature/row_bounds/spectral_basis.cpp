#include <cmath>

#include "core/signature/row_bounds/row_bounds.h"

namespace irsig {

ThreeBounds spectral_basis_bound(const BoundInput& in) {
  const ConditionSources& light = *in.row.light;
  double sum = 0;
  if (!in.largest.empty())
    sum = in.setup.scene.path_basis()->relative_error *
          largest_in_band_w_sr(light, {in.largest.begin(), in.largest.end()}, in.row.on_axis);
  if (light.by_element()) {
    const auto cause = [&](Cause which) {
      return std::abs(in.row.estimate.cause[static_cast<std::size_t>(which)].value);
    };
    const double shortest_um = in.setup.scene.axis.node_um()[in.row.on_axis.first_node];
    sum += light.emission_error(shortest_um) *
           (cause(Cause::kEmitted) + cause(Cause::kPartsReflected));
  }
  return {sum, sum, sum};
}

}  // namespace irsig
