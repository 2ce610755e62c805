#pragma once

// Skies under clouds and in fog, and the light of a view under them, for the tests of clouds.

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/environment/environment.h"
#include "core/environment/thermal_surroundings.h"
#include "core/spectral/planck.h"

namespace irsig::cloud_fixture {

inline std::vector<double> all_bands_um() {
  std::vector<double> um;
  for (std::size_t b = 0; b < kAirBandCount; ++b) um.push_back(air_band_lambda_um(b));
  return um;
}

// A sky from the ground, as an environment is made of it.
struct Sky {
  WeatherSpec weather;
  BandChoice bands;
  std::unique_ptr<const Environment> environment;
  std::unique_ptr<const Atmosphere> air;
  std::unique_ptr<const ThermalSurroundings> light;

  Sky(AfglProfile profile, AerosolKind aerosol, const CloudSpec* cloud)
      : Sky(afgl_profile(profile),
            {.kind = aerosol,
             .visibility_m = 23e3,
             .summer_troposphere = profile == AfglProfile::kMidlatitudeSummer},
            cloud) {}
  Sky(AirProfile profile, const AerosolSpec& aerosol, const CloudSpec* cloud) {
    weather.air.profile = std::move(profile);
    weather.air.aerosol = aerosol;
    weather.lower.kind = SurfaceBoundary::Kind::kGround;
    weather.lower.emissivity = 0.95;
    weather.lower.temperature_k = weather.air.profile.level.front().temperature_k;
    environment = *Environment::make({weather}, {ConditionEnvironment{}}, 2, all_bands_um());
    if (cloud) weather.air.cloud = *cloud;
    weather.air.forward_peak = ForwardPeak::kDiffuse;
    air = std::make_unique<const Atmosphere>(*Atmosphere::make(weather.air));
    light = std::make_unique<const ThermalSurroundings>(weather, *air, 2, environment->nodes(),
                                                        bands, 0);
  }
  [[nodiscard]] AirSpectrum radiance(double zenith_deg) const {
    const double sine = std::cos(zenith_deg * M_PI / 180);
    std::size_t i = 0;
    while (i + 2 < light->sky.size() && light->sky[i + 1].sin_elevation < sine) ++i;
    const SkyRing &a = light->sky[i], &b = light->sky[i + 1];
    const double f = (sine - a.sin_elevation) / (b.sin_elevation - a.sin_elevation);
    AirSpectrum out = a.total;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = std::lerp(a.total[k], b.total[k], f);
    return out;
  }
};

// Horizontal irradiance from the sky: its hemisphere in the bands of the air, and air as black as
// it is warm at other wavelengths.
inline double hemisphere_w_m2(const Sky& sky) {
  double sum = 0;
  const std::vector<SkyRing>& ring = sky.light->sky;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    const double um = air_band_lambda_um(b), per_um = um * um * 1e-4 * kAirBandWidthCm1;
    for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
      const double low = ring[i].sin_elevation, high = ring[i + 1].sin_elevation;
      sum += M_PI * (high - low) * (low * ring[i].total[b] + high * ring[i + 1].total[b]) * per_um;
    }
  }
  const double air_k = sky.weather.air.profile.level.front().temperature_k;
  for (double cm1 = 0.5; cm1 < 8000; ++cm1) {
    if (cm1 > kAirFirstCm1 && cm1 < kAirLastCm1) continue;
    const double um = 1e4 / cm1;
    sum += M_PI * planck_radiance_w_m2_sr_um(um, air_k) * um * um * 1e-4;
  }
  return sum;
}

inline WeatherSpec weather(double cover, const CloudSpec& cloud) {
  WeatherSpec w;
  w.air.profile = afgl_profile(AfglProfile::kMidlatitudeSummer);
  w.air.aerosol.kind = AerosolKind::kRural;
  w.air.aerosol.visibility_m = 23e3;
  w.lower.temperature_k = 293;
  w.lower.wind_speed_m_s = 5;
  w.cloud_cover = cover;
  if (cover > 0) w.cloud = cloud;
  return w;
}

inline ConditionEnvironment sun_at(double zenith_deg) {
  const double z = zenith_deg * M_PI / 180;
  return {0, true, {std::sin(z), 0, -std::cos(z)}, 1};
}

inline const std::vector<double> kUm = {3.6, 3.9, 4.05, 4.7, 8.3, 9.6, 10.5, 11.8};

struct Seen {
  std::unique_ptr<const Environment> environment;
  ViewEnvironment view;
};
inline Seen seen_under(const WeatherSpec& w, double zenith_deg, double range_m,
                       double elevation_deg, double height_m = 10) {
  Seen out{*Environment::make({w}, {sun_at(zenith_deg)}, height_m, kUm), {}};
  Environment::Line line{range_m, elevation_deg, body_from_aspect(30, elevation_deg), {}};
  line.behind = elevation_deg > 2 ? BackgroundDirections({0.1f, 0.6f})
                                  : BackgroundDirections({-0.02f, 0.05f});
  const std::uint32_t first = 0;
  out.view = (*out.environment->view(line, {&first, 1})).front();
  return out;
}

template <typename Each>
void for_light(const ViewEnvironment& v, const Each& each) {
  each("transmittance", v.transmittance);
  each("path", v.path_radiance);
  each("sun", v.sun);
  each("sun apparent", v.sun_apparent);
  for (std::uint32_t n = 0; n < v.around.count(); ++n) {
    each("around", v.around.radiance(n));
    each("apparent", v.around.apparent(n));
  }
  for (const auto& b : v.background_apparent) each("background", b);
}
inline std::vector<std::vector<double>> light_of(const ViewEnvironment& v) {
  std::vector<std::vector<double>> out;
  for_light(v, [&](const char*, const std::vector<double>& s) { out.push_back(s); });
  return out;
}

inline const CloudSpec kStratus = {CloudPhase::kWater, 330, 1000, 0.201, 7.9};
inline const CloudSpec kThin = {CloudPhase::kIce, 8000, 9000, 0.01, 40};

}  // namespace irsig::cloud_fixture
