// Rationale: once the sun has set it still lights the air above, and what is in the Earth's shadow
// has no light, however bright the air above it is.
// Expected: sunlight that the sky scatters fades without a jump from a sun 1 deg up to one 6 deg
// below the horizon; air below the edge of the shadow is dark and the sun's way to that edge the
// longest; once the refracted disk has set, the light that is left is within three sigma of the
// sky's model error, and within one from 1.5 deg on, so that rows, which have none from 6 deg on,
// are honest. Source: geometry of the shadow; the stated error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/atmosphere/atmosphere.h"
#include "core/atmosphere/path_layers.h"
#include "core/base/constants.h"

namespace irsig {
namespace {

Atmosphere air_of(AerosolKind aerosol, double visibility_m) {
  AtmosphereSpec spec;
  spec.profile = afgl_profile(AfglProfile::kMidlatitudeSummer);
  spec.aerosol = {.kind = aerosol, .visibility_m = visibility_m, .summer_troposphere = true};
  return Atmosphere::make(spec).value();
}

constexpr double kHeightM = 2;

PathRadiance sky_under(const Atmosphere& air, double zenith_deg, double sun_elevation_deg) {
  PathLight light;
  light.sun = SunPlace{.zenith_deg = 90 - sun_elevation_deg, .azimuth_deg = 0};
  return air.sky_radiance(kHeightM, zenith_deg, light);
}

// Mean over 3.7 to 3.95 um.
double window_mean(const AirSpectrum& spectrum) {
  double sum = 0;
  int count = 0;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (air_band_lambda_um(b) < 3.7 || air_band_lambda_um(b) > 3.95) continue;
    sum += spectrum[b];
    ++count;
  }
  return sum / count;
}

TEST(Twilight, FadesWithoutAJump) {
  const Atmosphere air = air_of(AerosolKind::kRural, 23e3);
  for (const double zenith_deg : {0.0, 85.0}) {
    const double first = window_mean(sky_under(air, zenith_deg, 1).scattered_w_m2_sr_um);
    double last = first;
    for (double elevation_deg = 0.8; elevation_deg > -6; elevation_deg -= 0.2) {
      const double now =
          window_mean(sky_under(air, zenith_deg, elevation_deg).scattered_w_m2_sr_um);
      EXPECT_LE(now, last + 0.02 * first) << zenith_deg << " " << elevation_deg;
      EXPECT_GE(now, 0.5 * last - 0.01 * first) << zenith_deg << " " << elevation_deg;
      last = now;
    }
    EXPECT_LT(last, 0.01 * first) << zenith_deg;
  }
}

TEST(Twilight, HasNoLightBelowTheEdgeOfTheShadow) {
  const Atmosphere air = air_of(AerosolKind::kRural, 23e3);
  for (const double below_deg : {0.5, 1.0, 2.0}) {
    const SunAmounts sun(air, kHeightM, 90 + below_deg);
    EXPECT_FALSE(sun.lit());
    // Rays that fall are bent down: the edge is higher than that of straight ones, by up to a
    // fifth.
    const double straight_m = kEarthRadiusM * (1 / std::cos(below_deg * kRadPerDeg) - 1);
    double edge_m = 0, last = 0;
    for (double height_m = 0; height_m < 1.3 * straight_m + 2000; height_m += 20) {
      AbsorberAmounts to_sun;
      if (!sun.add_to(to_sun, height_m)) {
        EXPECT_EQ(edge_m, 0) << "dark above the edge, " << height_m;
        continue;
      }
      if (edge_m == 0) edge_m = height_m;
      const double passed = window_mean(transmittance(to_sun));
      EXPECT_GE(passed, 0.999 * last) << below_deg << " " << height_m;
      last = passed;
    }
    EXPECT_GT(edge_m, 0.98 * straight_m) << below_deg;
    EXPECT_LT(edge_m, 1.25 * straight_m + 40) << below_deg;
  }
}

// The disk sets at 0.83 deg.
TEST(Twilight, AfterSunsetIsWithinTheStatedError) {
  double largest_at_sunset = 0, largest_later = 0;
  for (const double visibility_m : {5e3, 23e3}) {
    for (const AerosolKind kind : {AerosolKind::kRural, AerosolKind::kMaritime}) {
      const Atmosphere air = air_of(kind, visibility_m);
      for (const double zenith_deg : {0.0, 60.0, 80.0, 85.0, 88.0}) {
        const PathRadiance night = air.sky_radiance(kHeightM, zenith_deg);
        for (const double elevation_deg : {-0.85, -1.5, -3.0, -6.0}) {
          const PathRadiance sky = sky_under(air, zenith_deg, elevation_deg);
          for (std::size_t b = 0; b < kAirBandCount; ++b) {
            const double um = air_band_lambda_um(b);
            if (um > 5 || (um > 4.1 && um < 4.6)) continue;
            const double sigmas = sky.scattered_w_m2_sr_um[b] / night.model_error_w_m2_sr_um[b];
            double& most = elevation_deg > -1 ? largest_at_sunset : largest_later;
            most = std::max(most, sigmas);
          }
        }
      }
    }
  }
  RecordProperty("largest_at_sunset", std::to_string(largest_at_sunset));
  RecordProperty("largest_later", std::to_string(largest_later));
  EXPECT_LT(largest_at_sunset, 3);
  EXPECT_LT(largest_later, 1);
}

}  // namespace
}  // namespace irsig
