// Rationale: a cloud's base and water path may be unknown, and its light has an error of two
// streams. Expected: the error that is stated is the change of the light over the range. Source:
// skies computed with other bases and water paths.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/environment/unknown_cloud.h"
#include "tests/physics/cloud_fixture.h"

namespace irsig {
namespace {

using namespace cloud_fixture;

// Expected in the window, below an opaque cloud: 0.5 K of two streams, and the bases of 300 and
// 2500 m as the ends of an even distribution.
TEST(CloudSky, StatesTheErrorOfItsLightAndOfAnUnknownBase) {
  Sky sky(AfglProfile::kMidlatitudeSummer, AerosolKind::kRural, &kStratus);
  const std::size_t window = *air_band(1e4 / 955.0);
  const SkyRing& zenith = sky.light->sky.back();
  const double light = zenith.total[window], um = air_band_lambda_um(window);
  const auto planck = [&](double kelvin) { return planck_radiance_w_m2_sr_um(um, kelvin); };
  const double kelvin = air_at(sky.air->profile(), 330).temperature_k;
  const double known = sky.light->model_error_of(zenith)[window];
  EXPECT_GT(known, 0.95 * (planck(kelvin + 0.5) - planck(kelvin)));
  EXPECT_LT(known, 2 * (planck(kelvin + 0.5) - planck(kelvin)));
  WeatherSpec anywhere = sky.weather;
  anywhere.cloud_base_range_m = {300, 2500};
  const ThermalSurroundings of(anywhere, *sky.air, 2, sky.environment->nodes(), sky.bands, 0);
  // The change is seen through the air in front of the cloud.
  const double passed = zenith.layers->crossing(330, 1000)->transmittance[window];
  EXPECT_GT(passed, 0.8);
  const double base = passed *
                      (planck(kelvin) - planck(air_at(sky.air->profile(), 2500).temperature_k)) /
                      std::sqrt(3);
  EXPECT_NEAR(of.model_error_of(of.sky.back())[window], std::hypot(known, base), 1e-6 * base);
  EXPECT_NEAR(light, planck(kelvin), 0.02 * light);
}

// Rationale: a type of cloud has a water path that may as well be half or twice as large.
// Expected: the error is the larger of both skies' differences from its own over the square root of
// 3, for thin ice within a tenth in the window; where ozone shines through the cloud it is up to
// 2.5 times that. For opaque water it is below 0.1 % of the light, of which 0.5 % change. The same
// of the sun's beam. Source: skies computed with these water paths.
TEST(CloudSky, StatesTheErrorOfAnUnknownWaterPath) {
  const CloudSpec cirrus{CloudPhase::kIce, 10000, 11000, 0.0067, 64};
  const auto with_water = [](CloudSpec cloud, double factor) {
    cloud.water_path_kg_m2 *= factor;
    return cloud;
  };
  for (const CloudSpec& cloud : {cirrus, kStratus}) {
    const auto sky_of = [&](double factor) {
      const CloudSpec of = with_water(cloud, factor);
      return Sky(AfglProfile::kMidlatitudeSummer, AerosolKind::kRural, &of);
    };
    const Sky own = sky_of(1), half = sky_of(0.5), twice = sky_of(2);
    WeatherSpec unknown = own.weather;
    unknown.cloud = cloud;
    unknown.cloud_water_range = {0.5, 2};
    const std::optional<UnknownCloud> error = UnknownCloud::of(unknown, *own.air, own.bands);
    ASSERT_TRUE(error.has_value());
    int rings = 0;
    for (std::size_t r = 0; r < own.light->sky.size(); ++r) {
      const SkyRing& ring = own.light->sky[r];
      if (!ring.layers) continue;
      ++rings;
      const AirSpectrum stated = error->sky_error(*ring.layers);
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        const double light = ring.total[b], um = air_band_lambda_um(b),
                     found = std::max(std::abs(half.light->sky[r].total[b] - light),
                                      std::abs(twice.light->sky[r].total[b] - light)) /
                             std::sqrt(3);
        // Behind a cloud stand the ozone and the air above it, of which it scatters some back.
        const bool window = um > 10.2 && um < 12;
        EXPECT_GT(stated[b], (window ? 0.9 : 0.75) * found - 5e-3 * light) << um << " " << r;
        EXPECT_LT(stated[b], (window ? 1.1 : 2.5) * found + 1e-3 * light) << um << " " << r;
        EXPECT_LT(stated[b], (cloud.phase == CloudPhase::kWater ? 0.001 : 0.1) * light);
      }
    }
    EXPECT_GT(rings, 5);
  }
  const auto day = [&](double factor, bool unknown) {
    WeatherSpec w = weather(1, with_water(cirrus, factor));
    if (unknown) w.cloud_water_range = {0.5, 2};
    return seen_under(w, 45, 100, 20).view;
  };
  const ViewEnvironment own = day(1, false), stated = day(1, true), twice = day(2, false);
  EXPECT_EQ(stated.sun, own.sun);
  double change = 0, sum = 0;
  for (std::size_t i = 0; i < kUm.size(); ++i) {
    change += own.sun[i] - twice.sun[i];
    sum += own.sun[i];
  }
  EXPECT_NEAR(stated.sun_model_relative,
              std::hypot(own.sun_model_relative, change / sum / std::sqrt(3)), 0.1 * change / sum);
  for (std::size_t i = 0; i < kUm.size(); ++i) {
    EXPECT_EQ(stated.sky_mean[i], own.sky_mean[i]);
    EXPECT_GT(stated.sky_model_error[i], own.sky_model_error[i]) << kUm[i];
  }
}

// Rationale: what lies below a target takes nothing from the sky that the target reflects.
// Expected: above the cloud, sun and sky and their stated errors are those without a cloud, up to
// where the air is so thin that nothing of it emits; inside, the error of an unknown water path is
// no larger than all of the light.
TEST(CloudSky, StatesNoErrorOfACloudBelowTheTarget) {
  const auto at = [&](double height_m, double cover, bool unknown) {
    WeatherSpec w = weather(cover, kStratus);
    if (unknown) w.cloud_water_range = {0.5, 2};
    return seen_under(w, 60, 100, 20, height_m).view;
  };
  for (const double height_m : {1100.0, 20000.0, 60000.0, 99000.0}) {
    const ViewEnvironment clear = at(height_m, 0, false), known = at(height_m, 1, false),
                          unknown = at(height_m, 1, true);
    EXPECT_EQ(unknown.sun_model_relative, clear.sun_model_relative) << height_m;
    for (std::size_t i = 0; i < kUm.size(); ++i) {
      EXPECT_NEAR(known.sun[i], clear.sun[i], 1e-6 * clear.sun[i]) << height_m << " " << kUm[i];
      EXPECT_EQ(unknown.sky_model_error[i], known.sky_model_error[i]) << height_m << " " << kUm[i];
      EXPECT_NEAR(known.sky_mean[i], clear.sky_mean[i], 0.05 * clear.sky_mean[i] + 1e-12)
          << height_m << " " << kUm[i];
      EXPECT_NEAR(known.sky_model_error[i], clear.sky_model_error[i],
                  0.05 * clear.sky_mean[i] + 1e-12)
          << height_m << " " << kUm[i];
    }
  }
  for (const double height_m : {950.0, 660.0, 340.0, 10.0}) {
    const ViewEnvironment known = at(height_m, 1, false), unknown = at(height_m, 1, true);
    double relative = 0;
    for (std::size_t i = 0; i < kUm.size(); ++i) {
      relative = std::max(relative, unknown.sky_model_error[i] / unknown.sky_mean[i]);
      EXPECT_GE(unknown.sky_model_error[i], known.sky_model_error[i]);
    }
    EXPECT_LT(relative, 1.2) << height_m;
  }
}

// A sensor above a thin cloud looks through water of which the amount is not known.
TEST(CloudSky, StatesTheErrorOfAnUnknownWaterPathInFrontOfTheTarget) {
  const CloudSpec cirrus{CloudPhase::kIce, 1000, 2000, 0.0067, 64};
  const auto from_above = [&](double factor, bool unknown) {
    WeatherSpec w = weather(1, cirrus);
    w.cloud->water_path_kg_m2 *= factor;
    if (unknown) w.cloud_water_range = {0.5, 2};
    return seen_under(w, 45, 6000, 60).view;
  };
  const ViewEnvironment own = from_above(1, false), stated = from_above(1, true),
                        half = from_above(0.5, false), twice = from_above(2, false);
  for (std::size_t i = 0; i < kUm.size(); ++i) {
    const double found = std::max(half.transmittance[i] - own.transmittance[i],
                                  own.transmittance[i] - twice.transmittance[i]) /
                         std::sqrt(3);
    EXPECT_NEAR(stated.model_error_transmittance[i],
                std::hypot(own.model_error_transmittance[i], found), 0.15 * found + 1e-4)
        << kUm[i];
  }
}

}  // namespace
}  // namespace irsig
