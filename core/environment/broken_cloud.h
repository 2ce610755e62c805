#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/atmosphere/absorber_amounts.h"
#include "core/atmosphere/atmosphere.h"
#include "core/environment/view_environment.h"
#include "core/environment/weather_spec.h"

namespace irsig {

// Light under a sky of which clouds cover a part: the mean of that under a clear and under an
// overcast sky. Under any one of them a target has the one or the other; the standard deviation of
// this choice is sqrt(cover (1 - cover)) times their difference (ViewEnvironment::one_sky).
// Private to core/environment, as all of this header.

// Means of light under both skies, and their errors.
struct CloudMixer {
  double cover;

  [[nodiscard]] double operator()(double clear, double overcast) const {
    return (1 - cover) * clear + cover * overcast;
  }
  [[nodiscard]] std::vector<double> operator()(const std::vector<double>& clear,
                                               const std::vector<double>& overcast) const;
  [[nodiscard]] std::vector<std::vector<double>> operator()(
      const std::vector<std::vector<double>>& clear,
      const std::vector<std::vector<double>>& overcast) const;
  // Returns the model error of a mean whose parts have errors of their own, with the choice.
  [[nodiscard]] std::vector<double> error(const std::vector<double>& clear_error,
                                          const std::vector<double>& overcast_error,
                                          const std::vector<double>& clear,
                                          const std::vector<double>& overcast) const;
  // Returns the standard deviation of the choice between both.
  [[nodiscard]] double spread(double clear, double overcast) const;
};

// Returns the weather's atmosphere, with its cloud or without. INVALID_ARGUMENT as
// Atmosphere::make.
[[nodiscard]] absl::StatusOr<Atmosphere> turbid_atmosphere(const WeatherSpec& weather,
                                                           ForwardPeak peak, bool overcast);

// Returns the mean, with one of both as its one_sky.
[[nodiscard]] ViewEnvironment under_broken_cloud(ViewEnvironment clear, ViewEnvironment overcast,
                                                 double cover);
// Returns the mean of the bounds.
[[nodiscard]] LightBounds under_broken_cloud(const LightBounds& clear, const LightBounds& overcast,
                                             double cover);

// Returns the larger of two bounds, spectrum by spectrum.
[[nodiscard]] LightBounds larger_of(LightBounds a, const LightBounds& b);

}  // namespace irsig
