#include "core/environment/unknown_cloud.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/atmosphere/cloud.h"
#include "core/atmosphere/two_stream.h"
#include "core/base/constants.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

constexpr double kSigmaOfEnd = std::numbers::inv_sqrt3;
// Sines of the sun's elevation below which a plane layer is no cloud any more.
constexpr double kLowestSine = 0.02;

double cosine_of(double zenith_deg) {
  return std::max(kLowestSine, std::cos(zenith_deg * kRadPerDeg));
}

// Deeper layers let nothing pass that counts, nor would half of them.
constexpr double kOpaqueDepth = 80;

// Change of light that passes a depth if this changes by a factor.
//   most  that light without the layer
double passed_change(double light, double most, double depth, double factor) {
  if (!(light > 0)) return 0;
  if (depth > kOpaqueDepth) return std::min(light, most);
  return std::min(light * std::exp(-(factor - 1) * depth), most * std::exp(-factor * depth)) -
         light;
}

}  // namespace

std::optional<UnknownCloud> UnknownCloud::of(const WeatherSpec& weather, const Atmosphere& overcast,
                                             const BandChoice& bands) {
  const std::vector<double>& level = overcast.cloud_levels_m();
  const std::optional<CloudSpec>& cloud = overcast.spec().cloud;
  if (!cloud || level.empty()) return std::nullopt;
  if (!weather.cloud_base_range_m && !weather.cloud_water_range) return std::nullopt;
  UnknownCloud out;
  out.base_m_ = level.front();
  out.top_m_ = level.back();
  const auto planck_of = [&](double kelvin) {
    AirSpectrum planck(kAirBandCount, 0.0);
    for (std::size_t b = 0; b < kAirBandCount; ++b)
      if (chosen(bands, b)) planck[b] = planck_radiance_w_m2_sr_um(air_band_lambda_um(b), kelvin);
    return planck;
  };
  const AirProfile& profile = overcast.profile();
  out.planck_ = planck_of(air_at(profile, out.base_m_).temperature_k);
  if (weather.cloud_base_range_m) {
    for (std::size_t i = 0; i < 2; ++i) {
      const double at_m = profile.level.front().height_m + (*weather.cloud_base_range_m)[i];
      out.other_base_.push_back(planck_of(weather.cloud_base_range_k
                                              ? (*weather.cloud_base_range_k)[i]
                                              : air_at(profile, at_m).temperature_k));
    }
  }
  if (weather.cloud_water_range)
    out.other_water_.assign(weather.cloud_water_range->begin(), weather.cloud_water_range->end());
  CloudOptics diffuse = cloud_optics(*cloud, ForwardPeak::kDiffuse);
  CloudOptics beam = cloud_optics(*cloud, ForwardPeak::kBeam);
  out.diffuse_ = {std::move(diffuse.absorption), std::move(diffuse.scattering),
                  std::move(diffuse.asymmetry)};
  out.beam_ = {std::move(beam.absorption), std::move(beam.scattering), std::move(beam.asymmetry)};
  return out;
}

AirSpectrum UnknownCloud::sky_error(const PathLayers& path) const {
  AirSpectrum out(kAirBandCount, 0.0);
  const std::optional<PathLayers::Crossing> met = path.crossing(base_m_, top_m_);
  if (!met) return out;
  const double slant = (top_m_ - std::max(base_m_, met->begins_m)) / (top_m_ - base_m_) /
                       std::max(kLowestSine, met->cosine);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    double by_base = 0, by_water = 0;
    for (const AirSpectrum& other : other_base_)
      by_base = std::max(by_base, met->transmittance[b] * std::abs(other[b] - planck_[b]));
    const double depth = diffuse_.extinction(b) * slant;
    for (const double factor : other_water_) {
      if (depth <= 0 || depth > kOpaqueDepth) break;
      const double emits = std::expm1(-factor * depth) / std::expm1(-depth) - 1;
      const double passes = passed_change(met->beyond[b], planck_[b], depth, factor);
      by_water = std::max(by_water, std::abs(emits * met->inside[b] + passes));
    }
    out[b] = kSigmaOfEnd * std::hypot(by_base, by_water);
  }
  return out;
}

double UnknownCloud::part_above(double height_m) const {
  return std::clamp((top_m_ - height_m) / (top_m_ - base_m_), 0.0, 1.0);
}

double UnknownCloud::beam_relative(const AirSpectrum& irradiance, const AirSpectrum& outside,
                                   double height_m, double zenith_deg) const {
  const double slant = part_above(height_m) / cosine_of(zenith_deg);
  double all = 0, largest = 0;
  for (const double x : irradiance) all += x;
  if (all <= 0) return 0;
  for (const double factor : other_water_) {
    double change = 0;
    for (std::size_t b = 0; b < kAirBandCount; ++b)
      change += passed_change(irradiance[b], outside[b], beam_.extinction(b) * slant, factor);
    largest = std::max(largest, std::abs(change));
  }
  return kSigmaOfEnd * largest / all;
}

AirSpectrum UnknownCloud::diffuse_sun_relative(double height_m, double zenith_deg) const {
  AirSpectrum out(kAirBandCount, 0.0);
  const double part = part_above(height_m);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    const double depth = diffuse_.extinction(b);
    if (depth <= 0 || part <= 0) continue;
    const auto scattered_down = [&](double factor) {
      const StreamLayer layer{factor * part * depth, diffuse_.scattering[b] / depth,
                              diffuse_.asymmetry[b], 0, 0};
      return diffuse_light({&layer, 1}, {.sun_irradiance = 1, .sun_cosine = cosine_of(zenith_deg)})
          .back()
          .mean;
    };
    const double own = scattered_down(1);
    if (own <= 0) continue;
    for (const double factor : other_water_)
      out[b] = std::max(out[b], kSigmaOfEnd * std::abs(scattered_down(factor) / own - 1));
  }
  return out;
}

void UnknownCloud::add_to(ModelError& error, const AirSpectrum& transmittance, double low_m,
                          double high_m, double range_m) const {
  const double thickness_m = top_m_ - base_m_;
  double part = 0;  // of the layer's vertical depth
  if (high_m > low_m) {
    const double inside_m = std::min(high_m, top_m_) - std::max(low_m, base_m_);
    part = inside_m <= 0 ? 0 : inside_m / thickness_m * range_m / (high_m - low_m);
  } else if (low_m >= base_m_ && low_m <= top_m_) {
    part = range_m / thickness_m;
  }
  if (part <= 0) return;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    double change = 0;
    for (const double factor : other_water_)
      change = std::max(
          change, std::abs(passed_change(transmittance[b], 1, part * beam_.extinction(b), factor)));
    change *= kSigmaOfEnd;
    error.transmittance[b] = std::hypot(error.transmittance[b], change);
    error.radiance_w_m2_sr_um[b] = std::hypot(error.radiance_w_m2_sr_um[b], change * planck_[b]);
  }
}

}  // namespace irsig
