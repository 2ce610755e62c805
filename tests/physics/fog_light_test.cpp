// Rationale: fog scatters light many times: what it shows is neither a black body's light nor
// sunlight scattered once.
// Expected: level paths and skies in fog within 0.5 K (8-12 um), its sunlight within 10 %, of
// photons followed one by one through the same layers; a deep fog black within 0.3 K; nothing but
// a black body's light where all is as warm. Source: a Monte Carlo below, with the air's absorption
// grey in a band, and the full phase function.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/atmosphere/forward_scattering.h"
#include "core/atmosphere/light_path.h"
#include "core/atmosphere/path_layers.h"
#include "core/atmosphere/path_sums.h"
#include "core/atmosphere/scattered_again.h"
#include "core/environment/environment.h"
#include "core/environment/sun_light.h"
#include "core/environment/weather_air.h"
#include "core/spectral/planck.h"
#include "tests/physics/air_photons.h"

namespace irsig {
namespace {

using namespace air_photons;

constexpr double kGroundK = 294.2, kGroundAlbedo = 0.05;

WeatherSpec fog_of(AerosolKind kind, double visibility_m) {
  WeatherSpec out;
  out.air.profile = afgl_profile(AfglProfile::kMidlatitudeSummer);
  out.air.aerosol.kind = kind;
  out.air.aerosol.visibility_m = visibility_m;
  out.lower.kind = SurfaceBoundary::Kind::kGround;
  out.lower.temperature_k = kGroundK;
  out.lower.emissivity = 1 - kGroundAlbedo;
  return out;
}

struct Fog {
  AerosolKind kind;
  double visibility_m;
};
const Fog kFogs[] = {{AerosolKind::kAdvectionFog, 200},
                     {AerosolKind::kRadiationFog, 500},
                     {AerosolKind::kAdvectionFog, 1000},
                     {AerosolKind::kRadiationFog, 1000}};

std::size_t band_of(double wavenumber_cm1) { return air_band(1e4 / wavenumber_cm1).value(); }

TEST(Fog, LevelPathsShineAsPhotonsHaveIt) {
  for (const Fog& fog : kFogs) {
    const WeatherSpec weather = fog_of(fog.kind, fog.visibility_m);
    const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
    const PathRadiance path =
        air.radiance(WeatherAir::Sight::kSharp,
                     [](const AirProfile&) { return level_path(kObserverM, 1000); }, {})
            .value();
    for (const double cm1 : {845.0, 935.0, 1105.0, 1185.0}) {
      const std::size_t b = band_of(cm1);
      const double photons = AirPhotons(weather, b)
                                 .seen(0, 1000, 0.7, -1e-3 * std::log(path.transmittance[b]))
                                 .thermal;
      EXPECT_NEAR(kelvin(b, path.total_w_m2_sr_um[b]), kelvin(b, photons), 0.5)
          << cm1 << " cm-1, " << fog.visibility_m << " m";
    }
  }
}

TEST(Fog, SkiesShineAsPhotonsHaveIt) {
  for (const Fog& fog : kFogs) {
    const WeatherSpec weather = fog_of(fog.kind, fog.visibility_m);
    const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
    for (const double zenith_deg : {0.0, 60.0, 80.0}) {
      const PathRadiance sky =
          air.radiance(WeatherAir::Sight::kDiffuse,
                       [&](const AirProfile& profile) {
                         return look(profile, kObserverM, zenith_deg, kInfinity);
                       },
                       {})
              .value();
      for (const double cm1 : {845.0, 1105.0}) {
        const std::size_t b = band_of(cm1);
        const double photons = AirPhotons(weather, b)
                                   .seen(std::cos(zenith_deg * M_PI / 180), kInfinity, 0.7, 0)
                                   .thermal;
        EXPECT_NEAR(kelvin(b, sky.total_w_m2_sr_um[b]), kelvin(b, photons), 1.0)
            << cm1 << " cm-1, " << fog.visibility_m << " m, " << zenith_deg;
      }
    }
  }
}

// Returns the sunlight in a direction of the sky.
double sunlight_of(const WeatherAir& air, std::size_t band, double zenith_deg,
                   const SunPlace& sun) {
  const auto sky = [&](const std::optional<SunPlace>& by) {
    return air
        .radiance(
            WeatherAir::Sight::kDiffuse,
            [&](const AirProfile& profile) {
              return look(profile, kObserverM, zenith_deg, kInfinity);
            },
            by)
        .value()
        .total_w_m2_sr_um[band];
  };
  return sky(sun) - sky({});
}

double cos_deg(double angle_deg) { return std::cos(angle_deg * M_PI / 180); }

TEST(Fog, SunlightAsPhotonsHaveIt) {
  constexpr int kManyPhotons = 200000;
  const std::size_t b = band_of(2605);
  const SunPlace sun{
      .zenith_deg = 45, .azimuth_deg = AirPhotons::kAzimuth * 180 / M_PI, .distance_au = 1};
  for (const Fog& fog : kFogs) {
    const WeatherSpec weather = fog_of(fog.kind, fog.visibility_m);
    const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
    const Atmosphere beam = Atmosphere::make(weather.air).value();
    const double at_top = beam.sun_irradiance_w_m2_um(kFogTopM, sun)[b];
    for (const double zenith_deg : {0.0, 60.0}) {
      const double photons = at_top * AirPhotons(weather, b)
                                          .seen(cos_deg(zenith_deg), kInfinity, cos_deg(45), 0,
                                                AirPhotons::kAzimuth, kManyPhotons)
                                          .sun_per_sr;
      // Sunlight through a depth of 20 is lost in what the fog emits.
      const double lost = fog.visibility_m > 200
                              ? 0
                              : 5e-3 * planck_radiance_w_m2_sr_um(air_band_lambda_um(b), kGroundK);
      EXPECT_NEAR(sunlight_of(air, b, zenith_deg, sun), photons, 0.1 * photons + lost)
          << fog.visibility_m << " m, " << zenith_deg;
    }
  }
}

// The forward peaks are counted once.
TEST(Fog, SunlightAroundTheSunIsAsPhotonsHaveIt) {
  constexpr double kFromSun = 0.15;
  const std::size_t b = band_of(2605);
  const SunPlace sun{.zenith_deg = 45, .azimuth_deg = kFromSun * 180 / M_PI, .distance_au = 1};
  for (const Fog& fog : kFogs) {
    if (fog.visibility_m < 1000) continue;
    const WeatherSpec weather = fog_of(fog.kind, fog.visibility_m);
    const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
    const double photons =
        Atmosphere::make(weather.air).value().sun_irradiance_w_m2_um(kFogTopM, sun)[b] *
        AirPhotons(weather, b).seen(cos_deg(45), kInfinity, cos_deg(45), 0, kFromSun).sun_per_sr;
    EXPECT_NEAR(sunlight_of(air, b, 45, sun), photons, 0.15 * photons);
  }
}

TEST(Fog, SunlightOfRowsIsThatOfSingleRays) {
  WeatherSpec weather = fog_of(AerosolKind::kRadiationFog, 1000);
  const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
  const std::vector<double> um = {air_band_lambda_um(band_of(2605))};
  const SunPlace place{.zenith_deg = 45, .azimuth_deg = 0, .distance_au = 1};
  const auto environment = Environment::make({weather}, {ConditionEnvironment{}}, kObserverM, um);
  weather.air.forward_peak = ForwardPeak::kDiffuse;
  const Atmosphere diffuse = Atmosphere::make(weather.air).value();
  weather.air.forward_peak = ForwardPeak::kBeam;
  const Atmosphere beam = Atmosphere::make(weather.air).value();
  const NodeWavelengths wavelengths = node_wavelengths(um).value();
  const DirectionNodes& nodes = (*environment)->nodes();
  const ThermalSurroundings sky(weather, diffuse, kObserverM, nodes, wavelengths.bands, 1);
  const Vec<Body> up{std::sqrt(0.5), 0, -std::sqrt(0.5)};
  ConditionEnvironment condition{};
  condition.sun_distance_au = 1;
  const SunLight sun(condition, {up, 1, 1, up, true}, sky, weather.lower, diffuse, beam, kObserverM,
                     nodes, wavelengths);
  const std::size_t b = band_of(2605), last = sky.sky.size() - 1;
  const double zenith_deg = std::acos(sky.sky[last].sin_elevation) * 180 / M_PI;
  EXPECT_NEAR(sun.sky_towards({std::sqrt(1 - std::pow(sky.sky[last].sin_elevation, 2)), 0,
                               -sky.sky[last].sin_elevation},
                              last, 0)[b],
              sunlight_of(air, b, zenith_deg, place),
              0.01 * sunlight_of(air, b, zenith_deg, place));
}

TEST(Fog, SunlightAllOverTheSkyIsWithinTheStatedError) {
  const std::size_t b = band_of(2605);
  double squares = 0, largest = 0;
  int count = 0;
  for (const Fog& fog : kFogs) {
    if (fog.visibility_m < 500) continue;
    const WeatherSpec weather = fog_of(fog.kind, fog.visibility_m);
    const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
    const Atmosphere beam = Atmosphere::make(weather.air).value();
    const AirPhotons photons(weather, b);
    for (const double sun_deg : {45.0, 75.0}) {
      const double stated =
          std::hypot(kAerosolRelativeError, scattered_again_relative(beam, kObserverM, sun_deg)[b]);
      for (const double zenith_deg : {0.0, 60.0, 78.0})
        for (const double azimuth : {0.05, 0.3, 3.0}) {
          const SunPlace sun{
              .zenith_deg = sun_deg, .azimuth_deg = azimuth * 180 / M_PI, .distance_au = 1};
          const double found =
              beam.sun_irradiance_w_m2_um(kFogTopM, sun)[b] *
              photons.seen(cos_deg(zenith_deg), kInfinity, cos_deg(sun_deg), 0, azimuth).sun_per_sr;
          const double ours = sunlight_of(air, b, zenith_deg, sun);
          const double z = (ours - found) / (stated * ours);
          squares += z * z;
          largest = std::max(largest, std::abs(z));
          ++count;
        }
    }
  }
  const double rms = std::sqrt(squares / count);
  RecordProperty("rms_z", std::to_string(rms));
  RecordProperty("largest_z", std::to_string(largest));
  // 0.40 and 1.4; with 30 % under all suns 0.60 and 2.4.
  EXPECT_LT(rms, 0.48);
  EXPECT_LT(largest, 2);
}

// Sum over Legendre's moments that core/atmosphere/forward_scattering.h states.
double turned_once_per_sr(double g, double peak_depth, double cosine) {
  const double f = g * g, truncated = g / (1 + g), x = peak_depth;
  double before = 1, at = cosine, sum = 0, of_whole = 1, of_rest = 1;
  for (int l = 0; l < 300; ++l) {
    const double p = (of_whole - (1 - f) * of_rest) / f;
    const double moment =
        f * std::exp(-x) * std::expm1(x * p) / x + (1 - f) * of_rest * std::exp(-x * (1 - p));
    sum += (2 * l + 1) * moment * before / (4 * M_PI * (1 - f));
    const double next = ((2 * l + 3) * cosine * at - (l + 1) * before) / (l + 2);
    before = at;
    at = next;
    of_whole *= g;
    of_rest *= truncated;
  }
  return sum;
}

TEST(Fog, LightTurnedOnceHasItsMoments) {
  for (const double g : {0.5, 0.82, 0.9}) {
    const double truncated = g / (1 + g);
    EXPECT_NEAR(peak_ratio(truncated), g * g / (1 - g * g), 1e-12);
    // Without peaks on its way light has the whole phase function.
    const TurnedOnce thin = turned_once(truncated, 0, 1);
    EXPECT_NEAR(thin.fraction * (1 - g * g), 1, 1e-5);
    EXPECT_NEAR(thin.asymmetry, g, 1e-5);
    for (const double peak_depth : {0.01, 0.3, 1.0, 3.0}) {
      const TurnedOnce turned = turned_once(truncated, peak_depth, 1);
      for (const double angle_deg : {5.0, 20.0, 45.0, 90.0}) {
        const double expected = turned_once_per_sr(g, peak_depth, cos_deg(angle_deg));
        EXPECT_NEAR(
            turned.fraction * henyey_greenstein_per_sr(turned.asymmetry, cos_deg(angle_deg)),
            expected, 0.17 * expected)
            << g << ", " << peak_depth << ", " << angle_deg;
      }
    }
  }
}

TEST(Fog, DeepIsBlack) {
  const WeatherAir air =
      WeatherAir::make(fog_of(AerosolKind::kAdvectionFog, 200), kObserverM).value();
  const PathRadiance path =
      air.radiance(WeatherAir::Sight::kSharp,
                   [](const AirProfile&) { return level_path(kObserverM, 5000); }, {})
          .value();
  for (std::size_t b = band_of(835); b <= band_of(1245); ++b)
    EXPECT_NEAR(kelvin(b, path.total_w_m2_sr_um[b]), kGroundK, 0.3) << air_band_centre_cm1(b);
}

TEST(Fog, OfIsothermalAirIsABlackBody) {
  WeatherSpec weather = fog_of(AerosolKind::kRadiationFog, 500);
  for (AirLevel& level : weather.air.profile.level) level.temperature_k = kGroundK;
  const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
  for (const double range_m : {300.0, 3000.0}) {
    const PathRadiance path =
        air.radiance(WeatherAir::Sight::kSharp,
                     [&](const AirProfile&) { return level_path(kObserverM, range_m); }, {})
            .value();
    // In 8-12 um the fog's own top lets some of a cold space's light in.
    const std::size_t b = band_of(675);
    EXPECT_NEAR(
        path.total_w_m2_sr_um[b],
        (1 - path.transmittance[b]) * planck_radiance_w_m2_sr_um(air_band_lambda_um(b), kGroundK),
        2e-3 * path.total_w_m2_sr_um[b]);
  }
}

}  // namespace
}  // namespace irsig
