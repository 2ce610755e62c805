#include "core/signature/row_bounds/row_bounds.h"

namespace irsig {
namespace {

struct BoundOfWeights {
  BoundOf which;
  ThreeBounds (*bound)(const BoundInput&);
  bool stored_only;
};
constexpr BoundOfWeights kBoundsOfWeights[] = {
    {BoundOf::kBasis, spectral_basis_bound, false},
    {BoundOf::kSky, direction_interpolation_bound, false},
    {BoundOf::kTemperature, temperature_bound, false},
    {BoundOf::kBackground, background_bound, true},
    {BoundOf::kDepth, target_depth_bound, true},
};

}  // namespace

void set_bounds_of_weights(const BoundInput& in, bool stored, Row& row) {
  for (const BoundOfWeights& of : kBoundsOfWeights)
    row.of(of.which) = stored || !of.stored_only ? of.bound(in) : ThreeBounds{};
  row.background_model_w_sr = stored ? background_model_w_sr(in) : 0;
  row.choice_of_sky = stored ? choice_of_sky(in) : ThreeBounds{};
}

}  // namespace irsig
