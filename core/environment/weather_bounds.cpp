#include "core/environment/weather_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/atmosphere/haze_light.h"
#include "core/atmosphere/path_layers.h"
#include "core/environment/fit/linear_basis_fit.h"
#include "core/environment/sea/glitter_sums.h"
#include "core/environment/sea/sea_surface.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Sunlight that is scattered passes all absorbers between the target and space, those below this
// height in the amounts that the paths have; between the heights at which a sun's amounts are
// computed (SunAmounts) they fall short of the truth by up to 2 % of the whole.
constexpr double kShareOfAmounts = 0.95;
constexpr std::array kAboveM = {0.0, 100.0, 400.0, 1000.0, 2500.0, 5000.0};

// Depths straight up against those of a slant path's own steps.
constexpr double kDepthMargin = 1.02;

// Molecules along the horizon, in depths of the zenith: 38 to 40 by all tables of air mass; air
// that is bent to a cold surface has more of its mass low.
constexpr double kLargestAirMass = 60;

// PhaseMean knows the phase function at steps of this of -ln(1 - asymmetry).
constexpr double kAsymmetryStep = 0.1;

// The asymmetry of the largest Henyey-Greenstein phase function at an angle; it grows below and
// falls above: the root of g^3 + c g^2 - 5 g + 3 c, which falls in g.
double best_asymmetry(double cosine) {
  double low = 0, high = 1;
  for (int i = 0; i < 40; ++i) {
    const double g = 0.5 * (low + high);
    (g * g * g + cosine * g * g - 5 * g + 3 * cosine > 0 ? low : high) = g;
  }
  return low;
}

AbsorberAmounts between(const Atmosphere& atmosphere, double low_m, double high_m, bool up,
                        bool refraction) {
  if (high_m <= low_m) return AbsorberAmounts();
  return atmosphere.amounts(
      look(atmosphere.profile(), up ? low_m : high_m, up ? 0 : 180, high_m - low_m, refraction));
}

}  // namespace

void scale_amounts(AbsorberAmounts& a, double f) {
  for (double& x : a.gas_scaled_kg_m2) x *= f;
  for (double& x : a.gas_plain_kg_m2) x *= f;
  for (AirSpectrum& depth : a.optical_depth) {
    for (double& x : depth) x *= f;
  }
}

bool WeatherBounds::glints() const {
  return surface.kind == SurfaceBoundary::Kind::kRoughSea && surface.wind_speed_m_s > 0;
}
bool WeatherBounds::grey() const {
  return surface.kind == SurfaceBoundary::Kind::kGreySea ||
         surface.kind == SurfaceBoundary::Kind::kGround;
}

WeatherBounds::WeatherBounds(const WeatherSpec& spec, const Atmosphere& atmosphere,
                             double target_height_m, const DirectionNodes& rings,
                             const BandChoice& chosen_bands)
    : surface(spec.lower),
      height_m(target_height_m),
      bands(chosen_bands),
      thermal(kAirBandCount, 0.0),
      smallest_asymmetry(kAirBandCount, 1.0),
      largest_asymmetry(kAirBandCount, 0.0) {
  const AirProfile& profile = atmosphere.profile();
  cloudy = !atmosphere.turbid_levels_m().empty() || haze_fraction(atmosphere) > 0;
  for (std::uint32_t n = 0; n < rings.sky(); n += rings.azimuths()) {
    sky_sine.push_back(rings.sin_elevation(n));
  }
  // Air is in local thermodynamic equilibrium, reflection and scattering do not add.
  double warmest_k = surface.temperature_k;
  for (const AirLevel& level : profile.level) {
    if (level.height_m < std::max(kThermosphereM, height_m)) {
      warmest_k = std::max(warmest_k, level.temperature_k);
    }
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (chosen(bands, b)) thermal[b] = planck_radiance_w_m2_sr_um(air_band_lambda_um(b), warmest_k);
  }

  for (const double up_m : kAboveM) {
    above.push_back({height_m + up_m,
                     between(atmosphere, height_m + up_m, kBoundsTopM, true, spec.refraction)});
    scale_amounts(above.back().amounts, kShareOfAmounts);
  }
  AbsorberAmounts absorbers = above.front().amounts;
  for (const GreyAbsorber scatterer :
       {GreyAbsorber::kAerosolScattering, GreyAbsorber::kMolecularScattering}) {
    AirSpectrum& depth = absorbers.optical_depth[static_cast<std::size_t>(scatterer)];
    std::fill(depth.begin(), depth.end(), 0.0);
  }
  absorption = transmittance(absorbers, bands);
  const double bottom_m = profile.level.front().height_m;
  const AbsorberAmounts up =
      atmosphere.amounts(look(profile, height_m, 0, kInfinity, spec.refraction));
  scattering_up = scattering_optical_depth(up);
  molecular = up.grey(GreyAbsorber::kMolecularScattering);
  // Light that a target in the air sees between the horizontal and the horizon has passed lower
  // air.
  if (spec.above_surface_m > 0) {
    molecular = atmosphere.amounts(look(profile, bottom_m, 0, kInfinity, spec.refraction))
                    .grey(GreyAbsorber::kMolecularScattering);
  }
  for (double& x : molecular) x = std::min(1.0, kLargestAirMass * x);
  scattering_down =
      scattering_optical_depth(between(atmosphere, bottom_m, height_m, false, spec.refraction));
  for (AirSpectrum* depth : {&scattering_up, &scattering_down}) {
    for (double& x : *depth) x *= kDepthMargin;
  }

  // Asymmetry follows the humidity, which is smooth between the profile's levels.
  const double surface_percent = relative_humidity_percent(profile.level.front());
  for (double at_m = bottom_m; at_m < 60e3; at_m += at_m < 6e3 ? 250 : 2000) {
    const AerosolOptics optics = aerosol_optics(
        spec.air.aerosol, at_m, relative_humidity_percent(air_at(profile, at_m)), surface_percent);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      if (optics.scattering_per_m[b] <= 0) continue;
      smallest_asymmetry[b] = std::min(smallest_asymmetry[b], optics.asymmetry[b]);
      largest_asymmetry[b] = std::max(largest_asymmetry[b], optics.asymmetry[b]);
    }
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    double &low = smallest_asymmetry[b], &high = largest_asymmetry[b];
    if (low > high) {
      no_aerosol = true;
      continue;
    }
    low = std::max(0.0, 1 - (1 - low) * std::exp(kAsymmetryStep));
    high = std::max(low, 1 - (1 - high) * std::exp(-kAsymmetryStep));
  }

  // Steps of the angle, each at its smaller end; finer where the function is steep.
  aerosol_sum = AirSpectrum(kAirBandCount, 0.0);
  constexpr int kSteps = 150;
  for (int i = 0; i < kSteps; ++i) {
    const auto angle = [](int k) { return std::numbers::pi * std::pow(k / double{kSteps}, 2.0); };
    const double near = std::cos(angle(i)), far = std::cos(angle(i + 1));
    const AirSpectrum largest = aerosol_per_sr(near);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      aerosol_sum[b] += 2 * std::numbers::pi * (near - far) * largest[b];
    }
  }

  overshoot = fit_overshoot(sky_sine, rings.azimuths());
  mirror_sky();
}

// Waves: light from the sky, and light that comes up from below the horizon because it has met the
// sea before.
void WeatherBounds::mirror_sky() {
  // The facets are few, and what they mirror is put on the nodes of the sky.
  constexpr double kMargin = 1.2;
  mirrored_sky = AirSpectrum(kAirBandCount, 1.0);
  if (grey()) mirrored_sky.assign(kAirBandCount, 2 * (1 - surface.emissivity));
  if (surface.kind != SurfaceBoundary::Kind::kRoughSea) return;
  mirrored_sky.assign(kAirBandCount, 0.0);
  for (const double sine : {0.0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0}) {
    const double level = std::sqrt(1 - sine * sine);
    const Incidences once = mirrored_in_all({level, 0, -sine}, surface.wind_speed_m_s),
                     twice = mirrored_in_all({level, 0, sine}, surface.wind_speed_m_s);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      if (!chosen(bands, b)) continue;
      const std::complex<double> index = sea_water_index(air_band_lambda_um(b));
      double sum = 0;
      for (std::size_t k = 0; k < kIncidences; ++k) {
        const double of = once[k] + twice[k];
        if (of > 0) sum += of * largest_reflectance(index, k);
      }
      mirrored_sky[b] = std::max(mirrored_sky[b], kMargin * sum);
    }
  }
}

AirSpectrum WeatherBounds::aerosol_per_sr(double cosine) const {
  AirSpectrum out(kAirBandCount, 0.0);
  if (no_aerosol) return out;
  const double best = best_asymmetry(cosine);
  ScatteredSun unit;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(bands, b)) continue;
    unit.aerosol[b] = 1;
    unit.asymmetry[b] = std::clamp(best, smallest_asymmetry[b], largest_asymmetry[b]);
    out[b] = unit.per_sr(b, cosine);
  }
  return out;
}

}  // namespace irsig
