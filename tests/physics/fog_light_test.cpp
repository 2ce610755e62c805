// Rationale: fog scatters light many times: what it shows is neither a black body's light nor
// sunlight scattered once.
// Expected: level paths and skies in fog within 0.5 K (8-12 um), its sunlight within 10 %, of
// photons followed one by one through the same layers; a deep fog black within 0.3 K; nothing but
// a black body's light where all is as warm. Source: a Monte Carlo below, with the air's absorption
// grey in a band, and the full phase function.
#include <gtest/gtest.h>

#include <cmath>

#include "core/atmosphere/light_path.h"
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

TEST(Fog, SunlightAsPhotonsHaveIt) {
  const std::size_t b = band_of(2605);
  for (const Fog& fog : kFogs) {
    const WeatherSpec weather = fog_of(fog.kind, fog.visibility_m);
    const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
    const Atmosphere beam = Atmosphere::make(weather.air).value();
    const SunPlace sun{.zenith_deg = 45, .azimuth_deg = 90, .distance_au = 1};
    const double at_top = beam.sun_irradiance_w_m2_um(kFogTopM, sun)[b];
    for (const double zenith_deg : {0.0, 60.0}) {
      const auto sky = [&](const std::optional<SunPlace>& by) {
        return air
            .radiance(
                WeatherAir::Sight::kDiffuse,
                [&](const AirProfile& profile) {
                  return look(profile, kObserverM, zenith_deg, kInfinity);
                },
                by)
            .value()
            .total_w_m2_sr_um[b];
      };
      const double photons =
          at_top * AirPhotons(weather, b)
                       .seen(std::cos(zenith_deg * M_PI / 180), kInfinity, std::sqrt(0.5), 0)
                       .sun_per_sr;
      // What comes through a depth of 20 is lost in what the fog emits.
      const double lost = 5e-3 * planck_radiance_w_m2_sr_um(air_band_lambda_um(b), kGroundK);
      EXPECT_NEAR(sky(sun) - sky({}), photons,
                  (fog.visibility_m < 1000 ? 0.1 : 0.25) * photons + lost)
          << fog.visibility_m << " m, " << zenith_deg;
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
