// Rationale: clouds may be on the ground, below the sensor, without water or of a ton of it.
// Expected: nothing infinite, negative or jumping in the hardest cases; wrong layers are refused.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/physics/cloud_fixture.h"

namespace irsig {
namespace {

using namespace cloud_fixture;

TEST(CloudSky, HardCasesStayFiniteAndPositive) {
  struct Case {
    const char* name;
    CloudSpec cloud;
    double height_m, sun_zenith_deg, range_m, elevation_deg, above_m;
  };
  const CloudSpec ground = {CloudPhase::kWater, 0, 300, 0.05, 10};
  const std::vector<Case> cases = {
      {"base on the ground", ground, 10, 45, 500, 1, 0},
      {"a sensor above it", ground, 10, 45, 3000, 40, 0},
      {"almost no water", {CloudPhase::kWater, 500, 800, 1e-9, 10}, 10, 45, 3000, 5, 0},
      {"1000 kg of water", {CloudPhase::kWater, 500, 501, 1000, 1.5}, 10, 45, 3000, 40, 0},
      {"sun on the horizon", kStratus, 10, 90.2, 3000, 5, 0},
      {"sun just below it", kStratus, 10, 91.0, 3000, 5, 0},
      {"target in the cloud", kStratus, 10, 45, 400, 5, 600},
      {"target above the cloud", kStratus, 10, 45, 4000, -5, 2000},
      {"target below, sensor inside", kStratus, 10, 45, 1500, 20, 0},
      {"thin ice at 20 km", {CloudPhase::kIce, 19e3, 19.5e3, 0.001, 10}, 10, 45, 30e3, 30, 0}};
  for (const Case& c : cases) {
    for (const double cover : {1e-9, 0.5, 1.0}) {
      WeatherSpec w = weather(cover, c.cloud);
      w.above_surface_m = c.above_m;
      const Seen seen = seen_under(w, c.sun_zenith_deg, c.range_m, c.elevation_deg, c.height_m);
      for_light(seen.view, [&](const char* what, const std::vector<double>& s) {
        for (const double x : s) {
          ASSERT_TRUE(std::isfinite(x)) << c.name << " " << what;
          ASSERT_GE(x, 0) << c.name << " " << what;
          ASSERT_LT(x, 400) << c.name << " " << what;  // the sun has 10, its aureole 30 times that
        }
      });
    }
  }
}

// A deeper cloud has more levels: where one is added nothing may jump.
TEST(CloudSky, HasNoJumpWhereALevelIsAdded) {
  for (const CloudPhase phase : {CloudPhase::kWater, CloudPhase::kIce}) {
    const bool water = phase == CloudPhase::kWater;
    const double radius_um = water ? 8 : 40;
    for (const double depth : {0.6, 1.0, 2.0, 5.0, 6.0, 10.0, 18.0, 20.0}) {
      std::vector<AirSpectrum> seen;
      for (const double factor : {1 - 2e-6, 1 + 2e-6}) {
        // The particles are much larger than the wavelength.
        const double water_kg_m2 = factor * depth / 1.5 * 1e-3 * radius_um;
        const CloudSpec cloud{phase, water ? 500.0 : 5000.0, water ? 900.0 : 7000.0, water_kg_m2,
                              radius_um};
        const Sky sky(AfglProfile::kSubarcticWinter, AerosolKind::kRural, &cloud);
        seen.push_back(sky.radiance(0));
        seen.push_back(sky.radiance(85));
      }
      for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t b = 0; b < kAirBandCount; ++b)
          ASSERT_NEAR(seen[k][b], seen[k + 2][b], 1e-5 * seen[k][b])
              << depth << " " << air_band_lambda_um(b);
    }
  }
}

TEST(CloudSky, OfAlmostNoWaterIsTheClearSky) {
  const CloudSpec none = {CloudPhase::kWater, 500, 800, 1e-9, 10};
  // The air inside is saturated in both.
  WeatherSpec saturated = weather(0, none);
  saturated.air.profile = with_cloud(saturated.air.profile, none);
  const auto clear = light_of(seen_under(saturated, 45, 3000, 5).view),
             cloudy = light_of(seen_under(weather(1, none), 45, 3000, 5).view);
  for (std::size_t k = 0; k < clear.size(); ++k)
    for (std::size_t i = 0; i < clear[k].size(); ++i)
      EXPECT_NEAR(cloudy[k][i], clear[k][i], 0.005 * clear[k][i] + 1e-6) << k << " " << kUm[i];
}

// The humidity of a cloud ends within a metre of its edges: steps of a path that skip these levels
// took it for that of all air down to the next ones (2.3 % of a band's transmittance over 2 km).
TEST(CloudSky, ASensorThatRisesThroughAnEdgeLosesSightWithoutAJump) {
  const CloudSpec cloud = {CloudPhase::kIce, 1000, 2000, 0.0067, 64};
  AtmosphereSpec spec = weather(1, cloud).air;
  spec.cloud = cloud;
  spec.forward_peak = ForwardPeak::kDiffuse;
  const Atmosphere air = *Atmosphere::make(spec);
  for (const double edge_m : {1000.0, 2000.0}) {
    for (const bool above_target : {true, false}) {
      double last = 0;
      std::vector<double> steps;
      for (double off_m = -3.05; off_m < 3; off_m += 0.1) {
        // A target on the surface, or one above the cloud with the sensor below it.
        const double target_m = above_target ? 10 : 3000, rise_m = edge_m + off_m - target_m;
        const auto path =
            look_between(air.profile(), edge_m + off_m, target_m, 2 * std::abs(rise_m), true);
        ASSERT_TRUE(path.ok()) << path.status();
        const AirSpectrum t = transmittance(air.amounts(*path));
        double sum = 0, count = 0;
        for (std::size_t b = 0; b < kAirBandCount; ++b) {
          if (air_band_lambda_um(b) < 8 || air_band_lambda_um(b) > 12) continue;
          sum += t[b];
          ++count;
        }
        if (last > 0) steps.push_back(sum / count / last - 1);
        last = sum / count;
      }
      for (const double step : steps) {
        EXPECT_LT(std::abs(step), 2e-4) << edge_m;
        EXPECT_LE(above_target ? step : -step, 1e-6) << edge_m;
      }
    }
  }
}

TEST(CloudSpec, IsCheckedAgainstItsLimits) {
  for (const CloudSpec& bad : {CloudSpec{CloudPhase::kWater, -1, 100, 0.1, 8},
                               CloudSpec{CloudPhase::kWater, 100, 100, 0.1, 8},
                               CloudSpec{CloudPhase::kWater, 100, 30e3, 0.1, 8},
                               CloudSpec{CloudPhase::kWater, 100, 200, -0.1, 8},
                               CloudSpec{CloudPhase::kWater, 100, 200, 1e5, 8},
                               CloudSpec{CloudPhase::kWater, 100, 200, 0.1, 1},
                               CloudSpec{CloudPhase::kIce, 100, 200, 0.1, 5},
                               CloudSpec{CloudPhase::kIce, 100, 200, std::nan(""), 50}})
    EXPECT_FALSE(check_cloud(bad).ok());
  WeatherSpec w = weather(0.5, kStratus);
  w.cloud.reset();
  EXPECT_FALSE(Environment::make({w}, {ConditionEnvironment{}}, 10, kUm).ok());
  w.cloud_cover = 1.5;
  EXPECT_FALSE(Environment::make({w}, {ConditionEnvironment{}}, 10, kUm).ok());
}

}  // namespace
}  // namespace irsig
