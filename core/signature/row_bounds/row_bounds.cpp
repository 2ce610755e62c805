#include "core/signature/row_bounds/row_bounds.h"

namespace irsig {

void set_bounds_of_weights(const BoundInput& in, bool stored, Row& row) {
#define IRSIG_SET_BOUND(enumerator, function, stored_only) \
  row.of(BoundOf::enumerator) = stored || !(stored_only) ? function(in) : ThreeBounds{};
  IRSIG_BOUNDS_OF_WEIGHTS(IRSIG_SET_BOUND)
#undef IRSIG_SET_BOUND
  row.background_model_w_sr = stored ? background_model_w_sr(in) : 0;
  row.choice_of_sky = stored ? choice_of_sky(in) : ThreeBounds{};
}

}  // namespace irsig
