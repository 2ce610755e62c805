#include "core/environment/light_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "core/base/constants.h"
#include "core/environment/sea/glitter_sums.h"
#include "core/environment/sea/sea_surface.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

// The largest sum of the weights of Lagrange's cubics that are positive, in an end interval.
constexpr double kCubicOvershoot = 1.35;

// Elevations in steps: edges of the sine.
constexpr std::array kEdges = {0.0,  0.01, 0.02, 0.035, 0.055, 0.08, 0.11, 0.15,
                               0.2,  0.25, 0.3,  0.36,  0.42,  0.48, 0.54, 0.6,
                               0.66, 0.72, 0.78, 0.84,  0.9,   0.95, 1.0};

// Azimuths from the sun's, to either side.
constexpr std::array kTurnsDeg = {0.0, 4.0, 9.0, 16.0, 26.0, 40.0, 60.0, 85.0, 115.0, 145.0, 180.0};

double rayleigh_per_sr(double cosine) {
  PhaseMean phase;
  phase.add(1, cosine);
  return phase.molecular_per_sr();
}

double cloud_peak_per_sr() {
  ScatteredSun peak;
  peak.aerosol[0] = 1;
  peak.asymmetry[0] = kPeakAsymmetry;
  return peak.per_sr(0, 1);
}

AirSpectrum grey_transmittance(const AbsorberAmounts& amounts) {
  AirSpectrum t(kAirBandCount);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    double sum = 0;
    for (const AirSpectrum& depth : amounts.optical_depth) sum += depth[b];
    t[b] = std::exp(-sum);
  }
  return t;
}

}  // namespace

ConditionBounds::ConditionBounds(const ConditionEnvironment& condition, const SunSeen& seen,
                                 const WeatherBounds& of_weather)
    : weather(of_weather), direction(seen.middle) {
  const AirSpectrum dark(kAirBandCount, 0.0);
  outside = sun = diffuse_sun = diffuse_sun_w_m2_um = mirrored_sun = mirrored_sun_w_m2_um = dark;
  lower_sun = dark;
  shines = seen.visible > 0;
  scatters = seen.lights_air;
  if (!scatters) return;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(weather.bands, b)) continue;
    outside[b] = solar_irradiance_w_m2_um(air_band_lambda_um(b)) /
                 (condition.sun_distance_au * condition.sun_distance_au);
  }
  if (!shines) {
    // In twilight light comes by way of higher, clearer air: nothing on its way counts.
    sun_above.assign(weather.above.size(), outside);
    scatter(0);
    return;
  }
  // A ray is the steepest against the layers where it is highest, and refraction flattens it.
  const double level = std::sqrt(std::max(0.0, 1 - direction.z * direction.z)) *
                       (kEarthRadiusM + weather.height_m) / (kEarthRadiusM + kBoundsTopM);
  const double slant = 1 / std::sqrt(1 - std::min(1.0, level * level) + 1e-12);
  for (const WeatherBounds::Above& above : weather.above) {
    AbsorberAmounts amounts = above.amounts;
    scale_amounts(amounts, weather.height_m < kBoundsTopM ? slant : 1);
    sun_above.push_back(transmittance(amounts, weather.bands));
    for (std::size_t b = 0; b < kAirBandCount; ++b) sun_above.back()[b] *= outside[b];
  }
  sun = sun_above.front();
  scatter(slant);
  if (weather.glints()) mirror();
}

// Light scattered once on a path of scattering depth S is at most E0 T_abs (1 - exp(-S)) x the
// phase function; S is at most the vertical depth over the sine of the elevation. Where the air
// above scatters much, the sun's way down counts: at a depth x into the path at least slant x (that
// of the target less the height gained, x times at most the sine at the top). All directions
// together hold what the phase function's integral lets them: the paths that scatter most first.
void ConditionBounds::scatter(double slant) {
  struct Step {
    bool up;
    AirSpectrum aerosol_per_sr, aerosol_sum;  // largest, and over the step's directions
    double path;   // sine by which the vertical depth is divided; 0: no limit
    double decay;  // of sunlight along the path; where it ends on the surface it is the target's
  };
  const double level = std::sqrt(std::max(0.0, 1 - direction.z * direction.z));
  std::vector<Step> step;
  for (std::size_t i = 0; i + 1 < kEdges.size(); ++i) {
    for (const bool up : {true, false}) {
      const double low = kEdges[i], high = kEdges[i + 1];
      // Cells of azimuth from the sun's: each as near to the sun as its nearest point.
      AirSpectrum largest(kAirBandCount, 0.0), all = largest;
      for (std::size_t k = 0; k + 1 < kTurnsDeg.size(); ++k) {
        const double nearest =
            std::atan2(-direction.z, level * std::cos(kTurnsDeg[k] * kRadPerDeg));
        const double e =
            std::clamp(nearest, std::asin(up ? low : -high), std::asin(up ? high : -low));
        const AirSpectrum in_cell = weather.aerosol_per_sr(
            std::min(1.0, -direction.z * std::sin(e) +
                              level * std::cos(kTurnsDeg[k] * kRadPerDeg) * std::cos(e)));
        const double sr = 2 * (kTurnsDeg[k + 1] - kTurnsDeg[k]) * kRadPerDeg * (high - low);
        for (std::size_t b = 0; b < kAirBandCount; ++b) {
          largest[b] = std::max(largest[b], in_cell[b]);
          all[b] += sr * in_cell[b];
        }
      }
      double path = low;
      if (!up) {  // as flat as it meets the surface
        const double out = (kEarthRadiusM + weather.height_m) / kEarthRadiusM * 1.0003;
        path = std::sqrt(std::max(0.0, 1 - out * out * (1 - low * low)));
      }
      const double shrunk = (kEarthRadiusM + weather.height_m) / (kEarthRadiusM + kBoundsTopM);
      const double top = std::sqrt(1 - shrunk * shrunk * (1 - (up ? high * high : 0)));
      step.push_back({up, std::move(largest), std::move(all), path, 1 - slant * top});
    }
  }
  const double rayleigh = rayleigh_per_sr(1);
  const bool is_grey = weather.grey();
  const double reflectance = is_grey ? 1 - weather.surface.emissivity : 1;
  std::vector<std::pair<double, double>> share;  // 1 - exp(-S), W/m2 for the whole of it
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(weather.bands, b)) continue;
    const double light = outside[b] * weather.absorption[b];
    const double above = weather.above.front().amounts.grey(GreyAbsorber::kAerosolScattering)[b];
    const double dimmed = std::exp(-slant * above);
    const double molecular = std::exp(-above) * weather.molecular[b];
    double sky = 0, air = 0;
    share.clear();
    for (const Step& s : step) {
      const double depth = s.up ? weather.scattering_up[b] : weather.scattering_down[b];
      double scattered = s.path > 0 ? -std::expm1(-depth / s.path) : 1;
      if (!s.up && s.path > 0) {
        scattered *= dimmed;
      } else if (s.path > 0 && std::abs(s.decay) > 1e-6) {
        scattered = std::min(scattered, dimmed * -std::expm1(-s.decay * depth / s.path) / s.decay);
      } else if (s.path <= 0 && s.decay > 0) {
        scattered = std::min(scattered, dimmed / s.decay);
      }
      double& largest = s.up ? sky : air;
      largest = std::max(largest, light * (scattered * s.aerosol_per_sr[b] + molecular * rayleigh));
      share.emplace_back(scattered, s.aerosol_sum[b]);
    }
    std::sort(share.begin(), share.end(), std::greater<>());
    double left = weather.aerosol_sum[b], sum = 0;
    for (const auto& [scattered, most] : share) {
      const double taken = std::min(left, most);
      sum += scattered * taken;
      left -= taken;
    }
    sum = light * (sum + molecular);

    // The surface reflects sunlight; a grey one evenly over its hemisphere.
    const double sun_reflected =
        is_grey ? reflectance * std::max(0.0, -direction.z) * std::numbers::inv_pi * sun[b] : 0;
    sky *= weather.overshoot;
    lower_sun[b] = std::max(air, reflectance * sky + sun_reflected);
    diffuse_sun[b] = std::max(sky, lower_sun[b]);
    diffuse_sun_w_m2_um[b] =
        sum * (1 + weather.mirrored_sky[b]) + 2 * std::numbers::pi * sun_reflected;
    if (weather.cloudy) {
      // A cloud may send all that is not absorbed into its forward peak.
      diffuse_sun[b] += weather.overshoot * light * cloud_peak_per_sr();
      lower_sun[b] = diffuse_sun[b];
      diffuse_sun_w_m2_um[b] += 2 * light * (1 + weather.mirrored_sky[b]);
    }
  }
}

void ConditionBounds::mirror() {
  constexpr double kMargin = 1.03;  // of the quadrature
  const double wind_m_s = weather.surface.wind_speed_m_s;
  const Incidences largest = largest_mirrored(direction, wind_m_s),
                   sum = mirrored_in_all(direction, wind_m_s);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(weather.bands, b)) continue;
    const std::complex<double> index = sea_water_index(air_band_lambda_um(b));
    for (std::size_t k = 0; k < kIncidences; ++k) {
      if (largest[k] <= 0 && sum[k] <= 0) continue;
      const double mirrored = kMargin * largest_reflectance(index, k) * sun[b];
      mirrored_sun[b] = std::max(mirrored_sun[b], mirrored * largest[k]);
      mirrored_sun_w_m2_um[b] += mirrored * sum[k];
    }
  }
}

LightBounds light_bounds(const ConditionBounds& condition, const SensorPath& leg,
                         const SensorLine& line, const LineHorizon& horizon) {
  const WeatherBounds& weather = condition.weather;
  AirSpectrum path(kAirBandCount, 0.0), background = path;
  const AbsorberAmounts& near = leg.layers.amounts();
  const AirSpectrum& molecules = near.grey(GreyAbsorber::kMolecularScattering);
  if (condition.scatters && !leg.imported_radiance) {
    const double cosine = -dot(condition.direction, line.direction);
    const AirSpectrum depth = scattering_optical_depth(near);
    const AirSpectrum aerosol = weather.aerosol_per_sr(cosine);
    const double rayleigh = rayleigh_per_sr(cosine);
    // The sun at the path's highest point.
    std::size_t k = 0;
    while (k < weather.above.size() && weather.above[k].height_m < leg.highest_m - 1e-3) ++k;
    const AirSpectrum& sun = k < weather.above.size() ? condition.sun_above[k] : condition.outside;
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      path[b] =
          sun[b] * (-std::expm1(-depth[b]) * aerosol[b] + std::min(1.0, molecules[b]) * rayleigh);
      if (weather.cloudy)
        path[b] += condition.outside[b] * -std::expm1(-depth[b]) * cloud_peak_per_sr();
    }
  }
  if (condition.scatters) {
    double largest_cosine = -1, lowest = 1, glint = 0, incidence = 1;
    bool sky = false, lower = false;
    for (std::uint32_t n = 0; n < line.behind.count(); ++n) {
      const BehindSight sight = horizon.sight(line.behind, static_cast<double>(line.behind.z(n)),
                                              line.behind.above(n, horizon.z()));
      const Vec<Body> d = sight.direction;
      if (sight.sky) {
        sky = true;
        largest_cosine = std::max(largest_cosine, dot(d, condition.direction));
        lowest = std::min(lowest, -d.z);
        continue;
      }
      lower = true;
      if (!weather.glints()) continue;
      const Vec<Body> to_target = -1.0 * d;
      const double per_sr =
          glint_per_sr(to_target, condition.direction, weather.surface.wind_speed_m_s);
      if (per_sr <= 0) continue;
      glint = std::max(glint, per_sr);
      incidence = std::min(incidence,
                           dot(normalized(to_target + condition.direction), condition.direction));
    }
    // Between two rings the lower scatters more.
    const auto next = std::upper_bound(weather.sky_sine.begin(), weather.sky_sine.end(), lowest);
    const double sine = next == weather.sky_sine.begin() ? 0 : *std::prev(next);
    const AirSpectrum through = leg.imported ? leg.transmittance : grey_transmittance(near);
    const double overshoot = leg.imported ? 1 : kCubicOvershoot;
    const AirSpectrum aerosol = weather.aerosol_per_sr(largest_cosine);
    const double rayleigh = rayleigh_per_sr(1);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      if (!chosen(weather.bands, b)) continue;
      double light = 0;
      if (sky) {
        const double scattered = sine > 0 ? -std::expm1(-weather.scattering_up[b] / sine) : 1;
        light = overshoot * condition.outside[b] * weather.absorption[b] *
                (scattered * aerosol[b] + weather.molecular[b] * rayleigh);
        if (weather.cloudy) light += overshoot * condition.diffuse_sun[b];
      }
      if (lower) {
        double below = condition.lower_sun[b];
        if (glint > 0) {
          below += glint * condition.sun[b] *
                   water_reflectance(sea_water_index(air_band_lambda_um(b)), incidence);
        }
        light = std::max(light, below);
      }
      background[b] = through[b] * light;
    }
  }
  const AirSpectrum dark(kAirBandCount, 0.0);
  const std::vector<double> none = leg.spread_thermal(dark);
  const auto solar = [&](const AirSpectrum& bands) { return leg.plus_solar(none, bands); };
  LightBounds out;
  out.transmittance = leg.per_wavelength(leg.transmittance);
  out.path_radiance = leg.spread_thermal(leg.radiance(nullptr));
  out.thermal = leg.spread_thermal(weather.thermal);
  out.sun = solar(condition.sun);
  out.diffuse_sun = solar(condition.diffuse_sun);
  out.diffuse_sun_w_m2_um = solar(condition.diffuse_sun_w_m2_um);
  out.mirrored_sun = solar(condition.mirrored_sun);
  out.mirrored_sun_w_m2_um = solar(condition.mirrored_sun_w_m2_um);
  out.path_sun = solar(path);
  out.background_sun = solar(background);
  return out;
}

}  // namespace irsig
