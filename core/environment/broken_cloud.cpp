#include "core/environment/broken_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/check.h"

namespace irsig {
namespace {

using Spectrum = ViewEnvironment::Spectrum;

double sum_of(const Spectrum& s) {
  double sum = 0;
  for (const double x : s) sum += x;
  return sum;
}

}  // namespace

std::vector<double> CloudMixer::operator()(const std::vector<double>& clear,
                                           const std::vector<double>& overcast) const {
  IRSIG_CHECK(clear.size() == overcast.size());
  std::vector<double> out(clear.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = (*this)(clear[i], overcast[i]);
  return out;
}

std::vector<std::vector<double>> CloudMixer::operator()(
    const std::vector<std::vector<double>>& clear,
    const std::vector<std::vector<double>>& overcast) const {
  IRSIG_CHECK(clear.size() == overcast.size());
  std::vector<std::vector<double>> out;
  for (std::size_t k = 0; k < clear.size(); ++k) out.push_back((*this)(clear[k], overcast[k]));
  return out;
}

std::vector<double> CloudMixer::error(const std::vector<double>& clear_error,
                                      const std::vector<double>& overcast_error,
                                      const std::vector<double>& clear,
                                      const std::vector<double>& overcast) const {
  std::vector<double> out = (*this)(clear_error, overcast_error);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = std::hypot(out[i], spread(clear[i], overcast[i]));
  return out;
}

double CloudMixer::spread(double clear, double overcast) const {
  return std::sqrt(cover * (1 - cover)) * std::abs(overcast - clear);
}

absl::StatusOr<Atmosphere> turbid_atmosphere(const WeatherSpec& weather, ForwardPeak peak,
                                             bool overcast) {
  AtmosphereSpec air = weather.air;
  air.cloud = overcast ? weather.cloud : std::nullopt;
  air.forward_peak = peak;
  return Atmosphere::make(std::move(air));
}

namespace {

std::vector<LandAir> mixed(const CloudMixer& mix, const std::vector<LandAir>& clear,
                           const std::vector<LandAir>& overcast) {
  IRSIG_CHECK(clear.size() == overcast.size());
  std::vector<LandAir> out;
  for (std::size_t k = 0; k < clear.size(); ++k)
    out.push_back({mix(clear[k].transmittance, overcast[k].transmittance),
                   mix(clear[k].path_radiance, overcast[k].path_radiance),
                   mix(clear[k].sky, overcast[k].sky), mix(clear[k].sun, overcast[k].sun)});
  return out;
}

}  // namespace

ViewEnvironment under_broken_cloud(ViewEnvironment clear, ViewEnvironment overcast, double cover) {
  const CloudMixer mix{cover};
  ViewEnvironment out;
  out.transmittance = mix(clear.transmittance, overcast.transmittance);
  out.path_radiance = mix(clear.path_radiance, overcast.path_radiance);
  out.air = clear.air;
  out.overcast_air = overcast.air;
  out.overcast_fraction = cover;
  IRSIG_CHECK(clear.end.size() == overcast.end.size());
  for (std::size_t k = 0; k < clear.end.size(); ++k) {
    out.end.push_back(
        {mix(clear.end[k].transmittance, overcast.end[k].transmittance),
         mix(clear.end[k].path_radiance_w_m2_sr_um, overcast.end[k].path_radiance_w_m2_sr_um)});
    const IncidentRadiance::AirChange &a = clear.end_change[k], &b = overcast.end_change[k];
    out.end_change.push_back({mix(a.transmittance, b.transmittance),
                              mix(a.path_thermal, b.path_thermal),
                              mix(a.path_solar, b.path_solar)});
  }
  out.sun = mix(clear.sun, overcast.sun);
  out.sun_apparent = mix(clear.sun_apparent, overcast.sun_apparent);
  out.around = IncidentRadiance::mixed(clear.around, overcast.around, cover);
  out.background_apparent = mix(clear.background_apparent, overcast.background_apparent);
  out.background_interpolation =
      mix(clear.background_interpolation, overcast.background_interpolation);
  for (std::size_t k = 0; k < clear.background_model_error.size(); ++k) {
    out.background_model_error.push_back(
        mix(clear.background_model_error[k], overcast.background_model_error[k]));
  }
  out.land = {mixed(mix, clear.land.at_target, overcast.land.at_target),
              mixed(mix, clear.land.apparent, overcast.land.apparent),
              mixed(mix, clear.land.behind, overcast.land.behind)};
  out.sky_interpolation = std::max(clear.sky_interpolation, overcast.sky_interpolation);
  out.lower_interpolation = std::max(clear.lower_interpolation, overcast.lower_interpolation);
  out.joined_lines_bound = std::max(clear.joined_lines_bound, overcast.joined_lines_bound);
  out.model_error_transmittance =
      mix(clear.model_error_transmittance, overcast.model_error_transmittance);
  out.model_error_path_radiance =
      mix(clear.model_error_path_radiance, overcast.model_error_path_radiance);
  out.sky_mean = mix(clear.sky_mean, overcast.sky_mean);
  out.sky_model_error = mix(clear.sky_model_error, overcast.sky_model_error);
  out.lower_model_relative = std::max(clear.lower_model_relative, overcast.lower_model_relative);
  const double a = sum_of(clear.sun), b = sum_of(overcast.sun), mean = mix(a, b);
  out.sun_model_relative =
      mean > 0 ? mix(a * clear.sun_model_relative, b * overcast.sun_model_relative) / mean
               : std::max(clear.sun_model_relative, overcast.sun_model_relative);
  // The farther of both from the mean: no digits are lost in the difference.
  const bool rarely_cloudy = cover < 0.5;
  out.one_sky_sigma =
      rarely_cloudy ? std::sqrt(cover / (1 - cover)) : std::sqrt((1 - cover) / cover);
  out.one_sky = std::make_shared<const ViewEnvironment>(rarely_cloudy ? std::move(overcast)
                                                                      : std::move(clear));
  return out;
}

namespace {

constexpr std::array kAllBounds = {&LightBounds::transmittance, &LightBounds::path_radiance,
                                   &LightBounds::thermal,       &LightBounds::sun,
                                   &LightBounds::diffuse_sun,   &LightBounds::diffuse_sun_w_m2_um,
                                   &LightBounds::mirrored_sun,  &LightBounds::mirrored_sun_w_m2_um,
                                   &LightBounds::path_sun,      &LightBounds::background_sun};

}  // namespace

LightBounds under_broken_cloud(const LightBounds& clear, const LightBounds& overcast,
                               double cover) {
  const CloudMixer mix{cover};
  LightBounds out;
  for (Spectrum LightBounds::*of : kAllBounds) out.*of = mix(clear.*of, overcast.*of);
  return out;
}

LightBounds larger_of(LightBounds a, const LightBounds& b) {
  for (Spectrum LightBounds::*of : kAllBounds)
    for (std::size_t i = 0; i < (a.*of).size(); ++i) (a.*of)[i] = std::max((a.*of)[i], (b.*of)[i]);
  return a;
}

}  // namespace irsig
