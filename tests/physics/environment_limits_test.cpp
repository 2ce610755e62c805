// Rationale: sky, sea and sun must obey what is exact whatever the tables say. Expected: the errors
// of products of band means that are known; the blackbody wherever all is of one temperature; the
// limits of no air and of opaque air; the same bits in any order and number of threads. Source: the
// random-overlap sums of core/atmosphere (atmosphere_limits_test.cpp), Kirchhoff, Planck.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "core/environment/environment.h"
#include "core/spectral/planck.h"
#include "tests/physics/around_spectra.h"

namespace irsig {
namespace {

std::vector<double> limit_wavelengths() {
  std::vector<double> um;
  for (double x = 3.4; x < 5; x += 0.04) um.push_back(x);
  for (double x = 8; x < 12; x += 0.08) um.push_back(x);
  return um;
}

AtmosphereSpec summer(AerosolKind aerosol = AerosolKind::kMaritime) {
  AtmosphereSpec spec{afgl_profile(AfglProfile::kMidlatitudeSummer), {}};
  spec.aerosol.kind = aerosol;
  spec.aerosol.visibility_m = 23e3;
  return spec;
}

WeatherSpec sea_weather() {
  WeatherSpec w{summer(), true, {}, nullptr};
  w.lower.temperature_k = 293;
  w.lower.wind_speed_m_s = 5;
  return w;
}

ConditionEnvironment limit_sunny(double zenith_deg, double azimuth_deg, std::uint32_t weather = 0) {
  const double z = zenith_deg * M_PI / 180, a = azimuth_deg * M_PI / 180;
  return {weather, true, {std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), -std::cos(z)}, 1};
}

Environment::Line limit_line(double range_m, double elevation_deg) {
  return {range_m, elevation_deg, body_from_aspect(30, elevation_deg),
          BackgroundDirections({-0.5f, -0.1f, 0.0f, 0.05f, 0.2f, 0.7f})};
}

std::unique_ptr<const Environment> limit_environment(std::vector<WeatherSpec> weather,
                                                     std::vector<ConditionEnvironment> condition,
                                                     double height_m = 10) {
  auto made =
      Environment::make(std::move(weather), std::move(condition), height_m, limit_wavelengths());
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

ViewEnvironment seen(const Environment& e, const Environment::Line& l,
                     std::uint32_t condition = 0) {
  const auto views = e.view(l, std::vector<std::uint32_t>{condition});
  EXPECT_TRUE(views.ok()) << views.status();
  return (*views)[0];
}

double in_band(const AirSpectrum& per_um, double min_um, double max_um) {
  double sum = 0;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    const double um = air_band_lambda_um(b);
    if (um >= min_um && um <= max_um) sum += um * um * per_um[b];
  }
  return sum;
}

TEST(EnvironmentLimits, ProductsOfBandMeansErrAsKnown) {
  // 5 km of mid-latitude summer at sea level. Sun 30 deg from the zenith; sky: the mean over the
  // hemisphere that a wall mirrors lies near 45 to 60 deg.
  const Atmosphere air = *Atmosphere::make(summer(AerosolKind::kNone));
  const AbsorberAmounts near = air.amounts(level_path(10, 5000));
  const auto ratio = [&](const AirSpectrum& alone, const AirSpectrum& behind, double min_um,
                         double max_um) {
    AirSpectrum product = transmittance(near);
    for (std::size_t b = 0; b < kAirBandCount; ++b) product[b] *= alone[b];
    return in_band(product, min_um, max_um) / in_band(behind, min_um, max_um);
  };
  const AirSpectrum sun = air.sun_irradiance_w_m2_um(10, {30, 0});
  const AirSpectrum sun_seen = air.sun_irradiance_w_m2_um(10, {30, 0}, &near);
  EXPECT_NEAR(ratio(sun, sun_seen, 3.34, 5), 0.92, 0.01);
  EXPECT_NEAR(ratio(sun, sun_seen, 8, 12), 0.89, 0.01);
  const auto sky = [&](double zenith_deg, double min_um, double max_um) {
    return ratio(air.sky_radiance(10, zenith_deg).thermal_w_m2_sr_um,
                 air.sky_radiance(10, zenith_deg, {}, &near).thermal_w_m2_sr_um, min_um, max_um);
  };
  EXPECT_NEAR(sky(45, 3.34, 5), 1.42, 0.02);
  EXPECT_NEAR(sky(60, 8, 12), 1.14, 0.02);

  // A view holds the exact one, not the product.
  WeatherSpec w = sea_weather();
  w.air = summer(AerosolKind::kNone);
  const auto e = limit_environment({w}, {limit_sunny(30, 0)});
  const ViewEnvironment v = seen(*e, limit_line(5000, 0.03));
  const LightPath leg =
      *look_between(air.profile(), 10 + 5000 * std::sin(0.03 * M_PI / 180) + 1.96, 10, 5000);
  const AbsorberAmounts amounts = air.amounts(leg);
  const AirSpectrum direct = air.sun_irradiance_w_m2_um(10, {30, 0}, &amounts);
  double product_error = 0;
  const std::vector<double> um = limit_wavelengths();
  for (std::size_t i = 0; i < um.size(); ++i) {
    const std::size_t b = *air_band(um[i]);
    if (direct[b] < 1e-4) continue;
    EXPECT_NEAR(v.sun_apparent[i] / v.sun[i],
                direct[b] / air.sun_irradiance_w_m2_um(10, {30, 0})[b], 2e-3)
        << um[i];
    product_error =
        std::max(product_error, std::abs(v.transmittance[i] * v.sun[i] / v.sun_apparent[i] - 1));
  }
  EXPECT_GT(product_error, 0.1);
}

// All of one temperature.
AirProfile isothermal() {
  AirProfile profile = afgl_profile(AfglProfile::kMidlatitudeSummer);
  for (AirLevel& level : profile.level) {
    level.temperature_k = 290;
    level.gas.h2o_ppmv = std::min(level.gas.h2o_ppmv, 1e4);
  }
  return profile;
}

TEST(EnvironmentLimits, InFogOfOneTemperatureAllIsABlackbody) {
  // Opaque, and half of it scatters: emission, reflection and scattering have to add up. Some of
  // the cold space above comes down through it, and a sensor above sees it in the fog's top.
  WeatherSpec w{{isothermal(), {AerosolKind::kAdvectionFog, 200}}, true, {}, nullptr};
  w.lower = {SurfaceBoundary::Kind::kRoughSea, 290, 1, 7};
  const std::vector<double> um = limit_wavelengths();
  for (const SurfaceBoundary::Kind kind :
       {SurfaceBoundary::Kind::kRoughSea, SurfaceBoundary::Kind::kFlatSea,
        SurfaceBoundary::Kind::kGround}) {
    w.lower.kind = kind;
    w.lower.emissivity = 0.7;
    const auto e = limit_environment({w}, {{}});
    for (const Environment::Line& l :
         {limit_line(50, 5), limit_line(3000, 1), limit_line(20e3, 40)}) {
      const ViewEnvironment v = seen(*e, l);
      const auto node = radiance_of(v.around);
      const auto apparent = apparent_of(v.around);
      const double reflected_space = l.range_m > 10e3 ? 0.1 : 0;
      for (std::size_t i = 0; i < um.size(); ++i) {
        const double planck = planck_radiance_w_m2_sr_um(um[i], 290);
        const auto is_black = [&](double radiance) {
          const double ratio = (radiance + v.path_radiance[i]) / planck;
          return ratio < 1 + 2e-3 && ratio > 1 - 2e-3 - reflected_space;
        };
        for (std::size_t n = 0; n < node.size(); ++n) {
          EXPECT_NEAR(node[n][i] / planck, 1, 1e-3) << um[i] << " node " << n;
          EXPECT_TRUE(is_black(apparent[n][i])) << um[i] << " node " << n;
        }
        for (const auto& b : v.background_apparent) EXPECT_TRUE(is_black(b[i])) << um[i];
      }
    }
  }
}

TEST(EnvironmentLimits, InClearAirOfOneTemperatureTheSeaIsLost) {
  // Black sea, no scattering but the molecules': what is seen below the horizon is the blackbody
  // at the target and, with the path's radiance, at the sensor.
  WeatherSpec w{{isothermal(), {}}, true, {SurfaceBoundary::Kind::kGreySea, 290, 1, 0}, nullptr};
  const auto e = limit_environment({w}, {{}});
  const std::vector<double> um = limit_wavelengths();
  const std::size_t sky = e->nodes().sky();
  for (const Environment::Line& l :
       {limit_line(1000, 2), limit_line(30e3, 10), limit_line(200e3, 30)}) {
    const ViewEnvironment v = seen(*e, l);
    const auto node = radiance_of(v.around);
    const auto apparent = apparent_of(v.around);
    for (std::size_t i = 0; i < um.size(); ++i) {
      const double planck = planck_radiance_w_m2_sr_um(um[i], 290);
      for (std::size_t n = sky; n < node.size(); ++n) {
        EXPECT_NEAR(node[n][i] / planck, 1, 1e-4) << um[i];
        EXPECT_NEAR((apparent[n][i] + v.path_radiance[i]) / planck, 1, 1e-4) << um[i];
      }
      // Sky: the emissivity of the whole path, which near air lengthens.
      for (std::size_t n = 0; n < sky; ++n) {
        EXPECT_LE(node[n][i], planck * (1 + 1e-9));
        EXPECT_GE(apparent[n][i] + v.path_radiance[i], node[n][i] - 2e-3 * planck);
        EXPECT_LE(apparent[n][i] + v.path_radiance[i], planck * (1 + 2e-3));
      }
    }
  }
}

TEST(EnvironmentLimits, NoRangeNoAir) {
  const auto e = limit_environment({sea_weather()}, {limit_sunny(50, 120)});
  const ViewEnvironment v = seen(*e, limit_line(0, 20));
  const auto node = radiance_of(v.around);
  const auto apparent = apparent_of(v.around);
  for (std::size_t i = 0; i < v.transmittance.size(); ++i) {
    EXPECT_EQ(v.transmittance[i], 1);
    EXPECT_EQ(v.path_radiance[i], 0);
    EXPECT_NEAR(v.sun_apparent[i], v.sun[i], 1e-12 * v.sun[i]);
    for (std::size_t n = 0; n < node.size(); ++n) {
      EXPECT_NEAR(apparent[n][i] / node[n][i], 1, 1e-9) << n;
    }
  }
}

TEST(EnvironmentLimits, OpaqueAirHidesEverything) {
  WeatherSpec w = sea_weather();
  w.air.aerosol = {AerosolKind::kRadiationFog, 100};
  const auto e = limit_environment({w}, {limit_sunny(40, 0)});
  const ViewEnvironment v = seen(*e, limit_line(20e3, 0.2));
  const std::vector<double> um = limit_wavelengths();
  for (std::size_t i = 0; i < um.size(); ++i) {
    EXPECT_LT(v.transmittance[i], 1e-12);
    EXPECT_LT(v.sun_apparent[i], 1e-12);
    for (const auto& n : apparent_of(v.around)) EXPECT_LT(n[i], 1e-9);
    // Air of 294 K over a sea of 293 K.
    EXPECT_NEAR(v.path_radiance[i] / planck_radiance_w_m2_sr_um(um[i], 294.2), 1, 0.05) << um[i];
  }
}

TEST(EnvironmentLimits, ImportedPathsTakeTheEmbeddedModelsPlace) {
  const Environment::Line l = limit_line(5000, 0.03);
  const double nan = std::nan("");
  ImportedPath path{14.6,
                    10,
                    5000,
                    nan,
                    nan,
                    nan,
                    nan,
                    nan,
                    0,
                    AirSpectrum(kAirBandCount, 0.4),
                    AirSpectrum(kAirBandCount, 3.5),
                    {},
                    12};
  const auto with = [&](ImportedPath p) {
    WeatherSpec w = sea_weather();
    w.imported = std::make_shared<const ImportedPaths>(ImportedPaths{"tape7", {std::move(p)}});
    return limit_environment({w}, {limit_sunny(50, 120), {}});
  };
  const auto own = limit_environment({sea_weather()}, {limit_sunny(50, 120), {}});
  const ViewEnvironment embedded = seen(*own, l);
  const auto embedded_node = radiance_of(embedded.around);
  const ViewEnvironment v = seen(*with(path), l);
  const auto node = radiance_of(v.around);
  const auto apparent = apparent_of(v.around);
  const std::vector<double> um = limit_wavelengths();
  for (std::size_t i = 0; i < um.size(); ++i) {
    EXPECT_EQ(v.transmittance[i], 0.4);
    const double centre_um = air_band_lambda_um(*air_band(um[i]));
    EXPECT_NEAR(
        v.path_radiance[i] / 3.5,
        planck_radiance_w_m2_sr_um(um[i], 294.1) / planck_radiance_w_m2_sr_um(centre_um, 294.1),
        1e-4);
    EXPECT_NEAR(v.sun_apparent[i], 0.4 * v.sun[i], 1e-12);
    for (std::size_t n = 0; n < node.size(); ++n) {
      EXPECT_EQ(node[n][i], embedded_node[n][i]);
      EXPECT_NEAR(apparent[n][i], 0.4 * node[n][i], 1e-9 * node[n][i]);
    }
  }
  EXPECT_GT(v.sun_model_relative, embedded.sun_model_relative);
  for (std::size_t i = 0; i < v.sky_mean.size(); ++i)
    EXPECT_GE(v.sky_model_error[i], 0.2 * v.sky_mean[i]);

  // Transmittance alone: the embedded model's air, as much of it as the transmittance says.
  ImportedPath dark = path;
  dark.radiance_w_m2_sr_um.clear();
  const ViewEnvironment night = seen(*with(dark), l, 1), night_own = seen(*own, l, 1);
  for (std::size_t i = 0; i < um.size(); ++i) {
    EXPECT_NEAR(night.path_radiance[i] / 0.6,
                night_own.path_radiance[i] / (1 - night_own.transmittance[i]),
                1e-6 * night.path_radiance[i]);
  }

  // Other lines of sight and missing wavelengths are refused.
  EXPECT_EQ(with(path)->view(limit_line(9000, 0.03), std::vector<std::uint32_t>{0}).status().code(),
            absl::StatusCode::kInvalidArgument);
  path.transmittance[*air_band(4.0)] = nan;
  EXPECT_EQ(with(path)->view(l, std::vector<std::uint32_t>{0}).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(EnvironmentLimits, SkyAndSeaMeetAtTheHorizon) {
  // Through kilometres of air both are the air's: across the horizon nothing
  // jumps by more than what the sea there mirrors from a higher, colder sky.
  const auto e = limit_environment({sea_weather()}, {{}});
  const DirectionNodes& nodes = e->nodes();
  const ViewEnvironment v = seen(*e, limit_line(2000, 3));
  const auto node = radiance_of(v.around);
  const std::vector<double> um = limit_wavelengths();
  for (std::size_t i = 0; i < um.size(); ++i) {
    const double sky = node[0][i], sea = node[nodes.sky()][i];
    const double air = planck_radiance_w_m2_sr_um(um[i], 294.2);
    EXPECT_LT(std::abs(sky - sea), 0.35 * air) << um[i];
    EXPECT_GT(sky, node[nodes.sky() - 1][i]) << um[i];  // brighter than the zenith
    // Straight down one sees the sea of 293 K through 10 m of air.
    EXPECT_NEAR(node[nodes.count() - 1][i] / planck_radiance_w_m2_sr_um(um[i], 293), 1, 0.06);
    EXPECT_GT(sea, 0.5 * air);
    EXPECT_LT(sea, 1.01 * air);
  }
}

TEST(EnvironmentLimits, HardCasesAreFiniteAndNotNegative) {
  std::vector<WeatherSpec> weather;
  const auto bent = [](AfglProfile profile, SurfaceWeather surface) {
    return *bend_to_surface(afgl_profile(profile), surface);
  };
  for (const AirProfile& profile :
       {bent(AfglProfile::kSubarcticWinter, {213.15, 0, 103e3}),
        bent(AfglProfile::kTropical, {323.15, 30, 100e3}),
        bent(AfglProfile::kMidlatitudeSummer, {288, 100, 101e3}),
        // Inversion: 10 K colder at the surface than the profile has it.
        bent(AfglProfile::kMidlatitudeSummer, {284, 80, 101e3})}) {
    for (const double visibility_m : {200.0, 100e3}) {
      WeatherSpec w = sea_weather();
      w.air.profile = profile;
      w.air.aerosol.visibility_m = visibility_m;
      w.lower.temperature_k = std::clamp(profile.level[0].temperature_k, 271.0, 310.0);
      w.lower.wind_speed_m_s = visibility_m < 1e3 ? 0 : 20;
      weather.push_back(std::move(w));
    }
  }
  std::vector<ConditionEnvironment> conditions;
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < weather.size(); ++i) {
    conditions.push_back(limit_sunny(i % 2 == 0 ? 89.99 : 0, 100.0 * i, i));
    all.push_back(i);
  }
  for (const double height_m : {0.5, 3000.0}) {
    const auto e = limit_environment(weather, conditions, height_m);
    for (const Environment::Line& l :
         {limit_line(1, 0), limit_line(100e3, 90), limit_line(400, -0.003), limit_line(1500e3, 10),
          limit_line(0.2, -60)}) {
      const auto views = e->view(l, all);
      ASSERT_TRUE(views.ok()) << views.status();
      for (const ViewEnvironment& v : *views) {
        const auto check = [](const std::vector<double>& spectrum) {
          for (const double x : spectrum) {
            ASSERT_TRUE(std::isfinite(x));
            ASSERT_GE(x, 0);
          }
        };
        for (const auto* spectrum : {&v.transmittance, &v.path_radiance, &v.sun, &v.sun_apparent,
                                     &v.model_error_transmittance, &v.model_error_path_radiance}) {
          check(*spectrum);
        }
        const auto node = radiance_of(v.around), apparent = apparent_of(v.around);
        for (const auto* nodes : {&node, &apparent, &v.background_apparent}) {
          for (const auto& spectrum : *nodes) check(spectrum);
        }
        for (const double x : v.transmittance) ASSERT_LE(x, 1);
        for (const auto* spectrum : {&v.sky_mean, &v.sky_model_error}) check(*spectrum);
        for (const double x : {v.sky_interpolation, v.lower_interpolation, v.lower_model_relative,
                               v.sun_model_relative}) {
          ASSERT_TRUE(std::isfinite(x) && x >= 0 && x < 1) << x;
        }
        for (const double x : {v.sky_interpolation, v.lower_interpolation}) {
          ASSERT_LT(x, 0.01);
        }
      }
    }
  }
}

TEST(EnvironmentLimits, SameBitsInAnyOrderAndFromAnyThread) {
  WeatherSpec winter = sea_weather();
  winter.air.profile = afgl_profile(AfglProfile::kMidlatitudeWinter);
  winter.lower.temperature_k = 280;
  const std::vector<ConditionEnvironment> conditions = {
      limit_sunny(60, 10), {}, limit_sunny(40, 200, 1), limit_sunny(95, 0, 1)};
  const auto a = limit_environment({sea_weather(), winter}, conditions);
  const auto b = limit_environment({sea_weather(), winter}, conditions);
  const Environment::Line l = limit_line(8000, 12);
  const auto all = *a->view(l, std::vector<std::uint32_t>{0, 1, 2, 3});
  std::vector<ViewEnvironment> one(4);
  std::vector<std::thread> threads;
  for (const std::uint32_t c : {3u, 1u, 2u, 0u}) {
    threads.emplace_back([&, c] { one[c] = (*b->view(l, std::vector<std::uint32_t>{c}))[0]; });
  }
  for (std::thread& t : threads) t.join();
  for (std::size_t c = 0; c < 4; ++c) {
    EXPECT_EQ(radiance_of(all[c].around), radiance_of(one[c].around));
    EXPECT_EQ(apparent_of(all[c].around), apparent_of(one[c].around));
    EXPECT_EQ(interpolation_of(all[c].around), interpolation_of(one[c].around));
    EXPECT_EQ(all[c].background_apparent, one[c].background_apparent);
    EXPECT_EQ(all[c].path_radiance, one[c].path_radiance);
    EXPECT_EQ(all[c].sun_apparent, one[c].sun_apparent);
  }
  // The sun below the horizon gives nothing, though it was asked for.
  for (const double x : all[3].sun) EXPECT_EQ(x, 0);
}

// Rationale: the slopes of waves are known to 20 m/s, and weather has gusts. Expected: the sea of
// 20 m/s, and a larger model error where it is seen at a grazing angle.
TEST(EnvironmentLimits, AStormIsTheSeaOf20WithALargerError) {
  const auto of_wind = [](double wind_m_s) {
    WeatherSpec w = sea_weather();
    w.lower.wind_speed_m_s = wind_m_s;
    return seen(*limit_environment({w}, {{}}), limit_line(1000, 2));
  };
  const ViewEnvironment strong = of_wind(20), storm = of_wind(26);
  double largest = 0, smallest = 1e9;
  for (std::size_t node = 0; node < strong.background_model_error.size(); ++node)
    for (std::size_t i = 0; i < strong.background_model_error[node].size(); ++i) {
      const double ratio =
          storm.background_model_error[node][i] / strong.background_model_error[node][i];
      if (!(strong.background_model_error[node][i] > 0)) continue;
      largest = std::max(largest, ratio);
      smallest = std::min(smallest, ratio);
    }
  EXPECT_GT(largest, 1.3);
  EXPECT_LT(largest, 3);
  EXPECT_NEAR(smallest, 1, 1e-6);
}

TEST(EnvironmentLimits, WhatIsNotCoveredIsRefused) {
  EXPECT_EQ(Environment::make({sea_weather()}, {{}}, 10, {2.0}).status().code(),
            absl::StatusCode::kOutOfRange);
  EXPECT_FALSE(Environment::make({sea_weather()}, {limit_sunny(10, 0, 1)}, 10, {4.0}).ok());
  EXPECT_FALSE(Environment::make({sea_weather()}, {{}}, 0, {4.0}).ok());
  WeatherSpec storm = sea_weather();
  storm.lower.wind_speed_m_s = 300;
  EXPECT_FALSE(Environment::make({storm}, {{}}, 10, {4.0}).ok());
  const auto e = limit_environment({sea_weather()}, {{}});
  const std::vector<std::uint32_t> first = {0};
  EXPECT_EQ(e->view(limit_line(1000, -5), first).status().code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(e->view(limit_line(100e3, -0.01), std::vector<std::uint32_t>{7}).status().code(),
            absl::StatusCode::kInvalidArgument);
  // 40 km away and 13 m high: behind the bulge of the sea for a target 10 m high.
  EXPECT_EQ(e->view(limit_line(40e3, -0.1755), first).status().code(),
            absl::StatusCode::kInvalidArgument);
  // A ship 10 m high is seen from 20 m over 20 km, below its own horizontal.
  EXPECT_TRUE(e->view(limit_line(20e3, -0.0613), first).ok());
}

TEST(EnvironmentLimits, BandEdgesAreTheAirs) {
  const std::vector<double> edge = air_band_edges_um(4.0, 4.1);
  ASSERT_EQ(edge.size(), 6u);
  EXPECT_DOUBLE_EQ(edge.front(), 1e4 / 2490);
  EXPECT_DOUBLE_EQ(edge.back(), 1e4 / 2440);
}

}  // namespace
}  // namespace irsig
