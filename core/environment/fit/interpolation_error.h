#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/atmosphere/absorber_amounts.h"

namespace irsig {

// Mean of |linear - direct| over mean radiance, in the worst quarter of a micrometre. Private to
// core/environment.
class InterpolationError {
 public:
  explicit InterpolationError(const BandChoice& bands) : bands_(bands) {}

  void add(double weight, const AirSpectrum& linear, const AirSpectrum& direct) {
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      if (chosen(bands_, b)) add(b, weight * std::abs(linear[b] - direct[b]), weight * direct[b]);
    }
  }
  void add(std::size_t band, double error, double radiance) {
    const auto quarter = static_cast<std::size_t>(4 * air_band_lambda_um(band));
    if (quarter >= error_.size()) {
      error_.resize(quarter + 1, 0.0);
      radiance_.resize(quarter + 1, 0.0);
    }
    error_[quarter] += error;
    radiance_[quarter] += radiance;
  }
  [[nodiscard]] double worst() const {
    double w = 0;
    for (std::size_t q = 0; q < error_.size(); ++q) {
      if (radiance_[q] > 0) w = std::max(w, error_[q] / radiance_[q]);
    }
    return w;
  }

 private:
  const BandChoice& bands_;
  std::vector<double> error_, radiance_;
};

}  // namespace irsig
