// Rationale: light in haze is scattered once by the program, and in truth more than once.
// Expected: skies of haze (visibility 1 to 23 km, stated as aerosol) differ from those of photons
// followed one by one by no more than the stated model error says: rms z below 1.4 (of sunlight 0.7
// to 1.4), none above 3 (3.5).
// Source: the photons of air_photons.h; the air's lines grey in a band.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "core/atmosphere/light_path.h"
#include "core/atmosphere/path_layers.h"
#include "core/atmosphere/scattered_again.h"
#include "core/environment/weather_air.h"
#include "tests/physics/air_photons.h"

namespace irsig {
namespace {

using namespace air_photons;

constexpr double kHazeTopM = 10e3, kHazeStepM = 250;
constexpr double kHazeZenithsDeg[] = {0, 60, 80};

WeatherSpec haze_of(AerosolKind kind, double visibility_m) {
  WeatherSpec out;
  out.air.profile = afgl_profile(AfglProfile::kMidlatitudeSummer);
  out.air.aerosol = {.kind = kind, .visibility_m = visibility_m, .summer_troposphere = true};
  out.lower.kind = SurfaceBoundary::Kind::kGround;
  out.lower.temperature_k = 294.2;
  out.lower.emissivity = 0.95;
  return out;
}

AirPhotons photons_of(const WeatherSpec& haze, std::size_t band) {
  return {haze, band, kHazeTopM, kHazeStepM, AerosolKind::kNone};
}

PathRadiance sky_of(const WeatherAir& air, double zenith_deg, const std::optional<SunPlace>& sun) {
  return air
      .radiance(
          WeatherAir::Sight::kDiffuse,
          [&](const AirProfile& profile) {
            return look(profile, kObserverM, zenith_deg, kInfinity);
          },
          sun)
      .value();
}

// Collects deviations over stated errors.
struct Deviations {
  double squares = 0, largest = 0;
  int count = 0;
  void add(double z) {
    squares += z * z;
    largest = std::max(largest, std::abs(z));
    ++count;
  }
  [[nodiscard]] double rms() const { return std::sqrt(squares / count); }
};

template <typename Each>
void for_hazes(const Each& each) {
  for (const AerosolKind kind : {AerosolKind::kRural, AerosolKind::kMaritime})
    for (const double visibility_m : {1e3, 3e3, 10e3, 23e3}) each(kind, visibility_m);
}

TEST(Haze, SkiesShineAsPhotonsHaveItWithinTheStatedError) {
  Deviations z;
  double coldest = 0, warmest = 0;
  for_hazes([&](AerosolKind kind, double visibility_m) {
    const WeatherSpec haze = haze_of(kind, visibility_m);
    const WeatherAir air = WeatherAir::make(haze, kObserverM).value();
    for (const double cm1 : {845.0, 935.0, 1105.0, 2605.0}) {
      const std::size_t b = air_band(1e4 / cm1).value();
      const AirPhotons photons = photons_of(haze, b);
      // Nearer to the horizon lines that are grey in a band err by more than what is looked for.
      for (const double zenith_deg : {0.0, 60.0}) {
        const PathRadiance sky = sky_of(air, zenith_deg, std::nullopt);
        const double found =
            photons.seen(std::cos(zenith_deg * M_PI / 180), kInfinity, 0.7, 0).thermal;
        const double error = sky.total_w_m2_sr_um[b] - found;
        z.add(error / sky.model_error_w_m2_sr_um[b]);
        const double warmer_k = kelvin(b, sky.total_w_m2_sr_um[b]) - kelvin(b, found);
        coldest = std::min(coldest, warmer_k);
        warmest = std::max(warmest, warmer_k);
      }
    }
  });
  RecordProperty("rms_z", std::to_string(z.rms()));
  RecordProperty("coldest_k", std::to_string(coldest));
  RecordProperty("warmest_k", std::to_string(warmest));
  EXPECT_LT(z.rms(), 1.4);
  EXPECT_LT(z.largest, 3);
}

TEST(Haze, SunlightIsAsPhotonsHaveItWithinTheStatedError) {
  Deviations z;
  for_hazes([&](AerosolKind kind, double visibility_m) {
    const WeatherSpec haze = haze_of(kind, visibility_m);
    const WeatherAir air = WeatherAir::make(haze, kObserverM).value();
    const Atmosphere atmosphere = Atmosphere::make(haze.air).value();
    for (const double cm1 : {2455.0, 2605.0, 2785.0}) {
      const std::size_t b = air_band(1e4 / cm1).value();
      const AirPhotons photons = photons_of(haze, b);
      for (const double sun_deg : {30.0, 60.0, 80.0}) {
        const SunPlace sun{.zenith_deg = sun_deg,
                           .azimuth_deg = AirPhotons::kAzimuth * 180 / M_PI,
                           .distance_au = 1};
        const double at_top = atmosphere.sun_irradiance_w_m2_um(kHazeTopM, sun)[b];
        for (const double zenith_deg : kHazeZenithsDeg) {
          const double ours = sky_of(air, zenith_deg, sun).total_w_m2_sr_um[b] -
                              sky_of(air, zenith_deg, std::nullopt).total_w_m2_sr_um[b];
          const double found = at_top * photons
                                            .seen(std::cos(zenith_deg * M_PI / 180), kInfinity,
                                                  std::cos(sun_deg * M_PI / 180), 0)
                                            .sun_per_sr;
          const double relative = std::hypot(
              kAerosolRelativeError, scattered_again_relative(atmosphere, kObserverM, sun_deg)[b]);
          z.add((ours - found) / (relative * ours));
        }
      }
    }
  });
  RecordProperty("rms_z", std::to_string(z.rms()));
  RecordProperty("largest_z", std::to_string(z.largest));
  EXPECT_GT(z.rms(), 0.7);
  EXPECT_LT(z.rms(), 1.4);
  EXPECT_LT(z.largest, 3.5);
}

// Rationale: the growth of the stated error with depth and slant was fitted to the hazes and suns
// above. Expected: it holds in hazes that the fit has not seen, of 2 and 5 km among others, under
// suns 45 and 15 deg high, and 5 deg above the horizon. Prints what is missing.
TEST(Haze, OtherSkiesAreWithinTheStatedError) {
  Deviations sunlight, thermal;
  for (const AerosolKind kind : {AerosolKind::kRural, AerosolKind::kMaritime})
    for (const double visibility_m : {2e3, 5e3, 10e3, 23e3}) {
      const WeatherSpec haze = haze_of(kind, visibility_m);
      const WeatherAir air = WeatherAir::make(haze, kObserverM).value();
      const Atmosphere atmosphere = Atmosphere::make(haze.air).value();
      for (const double cm1 : {2605.0, 945.0, 1155.0}) {
        const std::size_t b = air_band(1e4 / cm1).value();
        const AirPhotons photons = photons_of(haze, b);
        for (const double zenith_deg : {0.0, 45.0, 85.0}) {
          const double cosine = std::cos(zenith_deg * M_PI / 180);
          const PathRadiance night = sky_of(air, zenith_deg, std::nullopt);
          const double own = night.total_w_m2_sr_um[b];
          std::printf("%s %2.0f km, %4.0f cm-1, %2.0f deg:",
                      kind == AerosolKind::kRural ? "rural" : "maritime", visibility_m / 1e3, cm1,
                      zenith_deg);
          const double seen = photons.seen(cosine, kInfinity, 0.7, 0).thermal;
          std::printf(" thermal %+5.1f K", kelvin(b, own) - kelvin(b, seen));
          // Nearer to the horizon lines that are grey in a band err by more.
          if (zenith_deg < 80) thermal.add((own - seen) / night.model_error_w_m2_sr_um[b]);
          for (const double sun_deg : {45.0, 75.0}) {
            if (cm1 < 2000) continue;  // sunlight is below 1 % there
            const SunPlace sun{.zenith_deg = sun_deg,
                               .azimuth_deg = AirPhotons::kAzimuth * 180 / M_PI,
                               .distance_au = 1};
            const double ours = sky_of(air, zenith_deg, sun).total_w_m2_sr_um[b] - own;
            const double found =
                atmosphere.sun_irradiance_w_m2_um(kHazeTopM, sun)[b] *
                photons.seen(cosine, kInfinity, std::cos(sun_deg * M_PI / 180), 0).sun_per_sr;
            const double relative =
                std::hypot(kAerosolRelativeError,
                           scattered_again_relative(atmosphere, kObserverM, sun_deg)[b]);
            const double z = (ours - found) / (relative * ours);
            std::printf("; sun %2.0f deg high: %.2f, stated +-%.2f, z %+.1f", 90 - sun_deg,
                        ours / found, relative, z);
            sunlight.add(z);
          }
          std::printf("\n");
        }
      }
    }
  RecordProperty("sunlight_rms_z", std::to_string(sunlight.rms()));
  RecordProperty("sunlight_largest_z", std::to_string(sunlight.largest));
  RecordProperty("thermal_rms_z", std::to_string(thermal.rms()));
  EXPECT_LT(sunlight.rms(), 1.4);
  EXPECT_LT(sunlight.largest, 3.5);
  EXPECT_LT(thermal.rms(), 1.4);
  EXPECT_LT(thermal.largest, 3);
}

}  // namespace
}  // namespace irsig
