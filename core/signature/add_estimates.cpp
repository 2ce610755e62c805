#include "core/signature/add_estimates.h"

#include <cmath>

#include "core/accuracy/spectral_modes.h"

namespace irsig {

void add(const Estimate& more, Estimate& to) {
  to.value += more.value;
  to.stderr_ = std::hypot(to.stderr_, more.stderr_);
}
void add(const SpectralEstimate& more, SpectralEstimate& to) {
  for (std::size_t k = 0; k < to.value.size(); ++k) {
    to.value[k] += more.value[k];
    to.stderr_[k] = std::hypot(to.stderr_[k], more.stderr_[k]);
  }
  to.modes.insert(to.modes.end(), more.modes.begin(), more.modes.end());
  to.modes = leading_modes(to.modes, stored_modes(to.value.size()));
}

}  // namespace irsig
