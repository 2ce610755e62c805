#include "core/atmosphere/fog_sky.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/atmosphere/absorber_amounts.h"
#include "core/atmosphere/two_stream.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

constexpr double kWindowUm = 10.5, kFogStepM = 25;

// Returns the fog's layers from the top down.
std::vector<StreamLayer> fog_layers(const AerosolSpec& aerosol, const AirProfile& profile,
                                    std::size_t band) {
  const double ground_m = profile.level.front().height_m, um = air_band_lambda_um(band);
  const double surface_percent = relative_humidity_percent(profile.level.front());
  const auto planck_at = [&](double height_m) {
    return planck_radiance_w_m2_sr_um(um, air_at(profile, height_m).temperature_k);
  };
  std::vector<StreamLayer> out;
  for (double low_m = ground_m; low_m < kFogTopM; low_m += kFogStepM) {
    const double high_m = std::min(low_m + kFogStepM, kFogTopM), middle_m = 0.5 * (low_m + high_m);
    const AerosolOptics optics = aerosol_optics(
        aerosol, middle_m, relative_humidity_percent(air_at(profile, middle_m)), surface_percent);
    // The forward peak stays in the beam, as in paths.
    const double g = optics.asymmetry[band],
                 scattering = optics.scattering_per_m[band] * (1 - g * g),
                 extinction = optics.absorption_per_m[band] + scattering;
    out.push_back({extinction * (high_m - low_m), extinction > 0 ? scattering / extinction : 0,
                   g / (1 + g), planck_at(high_m), planck_at(low_m)});
  }
  std::reverse(out.begin(), out.end());
  return out;
}

// Radiance that arrives at the ground, of isotropic streams.
double down_radiance(const StreamLight& at_ground) {
  return at_ground.mean - 2.0 / 3 * at_ground.slope;
}

double blackbody_k(double um, double radiance, double warmest_k) {
  double low = 100, high = warmest_k;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (planck_radiance_w_m2_sr_um(um, middle) < radiance ? low : high) = middle;
  }
  return low;
}

}  // namespace

FogSky fog_sky(const AerosolSpec& aerosol, const AirProfile& profile) {
  constexpr double kLeastEmissivity = 1e-6, kWarmestK = 400;
  if (!is_fog(aerosol.kind)) return {0, 0};
  const std::size_t band = air_band(kWindowUm).value();
  const double um = air_band_lambda_um(band), ground_k = profile.level.front().temperature_k;
  std::vector<StreamLayer> layers = fog_layers(aerosol, profile, band);
  if (layers.empty()) return {0, 0};
  const double sent = down_radiance(
      diffuse_light(layers, {.up_radiance = planck_radiance_w_m2_sr_um(um, ground_k)}).back());
  for (StreamLayer& layer : layers) layer.planck_top = layer.planck_bottom = 0;
  const double emissivity = 1 - down_radiance(diffuse_light(layers, {.down_radiance = 1}).back());
  if (emissivity < kLeastEmissivity) return {0, 0};
  return {emissivity, ground_k - blackbody_k(um, sent / emissivity, kWarmestK)};
}

}  // namespace irsig
