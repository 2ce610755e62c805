#include "view/report/error_budget.h"

#include <cmath>

#include "core/accuracy/measured.h"

namespace irsig {
namespace {

bool applies(BoundOf which, SignatureQuantity quantity) {
  if (which == BoundOf::kMoved) return false;
  // At the target there is no depth of air.
  if (which == BoundOf::kDepth) return quantity != SignatureQuantity::kIntensity;
  if (which == BoundOf::kBackground) return quantity == SignatureQuantity::kContrastIntensity;
  return true;
}

}  // namespace

std::vector<ErrorPart> error_budget(const QueryRow& row, const QuantityColumns& quantity) {
  const StoredSignature& s = row.signature;
  if (quantity.quantity == SignatureQuantity::kBackgroundRadiance || row.interpolation ||
      std::isnan(s.*quantity.value))
    return {};
  std::vector<ErrorPart> out;
  if (row.range_change) {
    const Measured m = with_rest({s.*quantity.value, s.*quantity.value_stderr, {}, 0},
                                 s.*quantity.numerical_error, BoundOf::kMoved);
    out.push_back({"standard error", "of the samples", false, m.stderr_, m.sampled_fraction()});
    out.push_back({"bounds together", "all bounds of the stored row and that of moving it", true,
                   m.bias_bound(), m.share(BoundOf::kMoved)});
    return out;
  }
  const Measured m = quantity.measured(s);
  out.push_back({"standard error", "of the samples", false, m.stderr_, m.sampled_fraction()});
  out.push_back({"undersampling, estimate",
                 "a standard error for the brightest that a sample could have met", false,
                 m.undersampling_stderr, m.unseen_fraction()});
  for (std::size_t i = 0; i < kBounds; ++i) {
    const auto which = static_cast<BoundOf>(i);
    if (applies(which, quantity.quantity))
      out.push_back({std::string(info_of(which).name), std::string(info_of(which).what), true,
                     m.of(which), m.share(which)});
  }
  return out;
}

}  // namespace irsig
