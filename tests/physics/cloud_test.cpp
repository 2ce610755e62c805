// Rationale: a cloud's particles emit, absorb and scatter, in air that is saturated.
// Expected: isothermal worlds are black; little sunlight passes water, and thin ice keeps it around
// the sun; optics as LOWTRAN7's; one sky for rows and for single rays. Source: energy;
// lowtran7_shettle_fenn; two streams through the layer alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/atmosphere/cloud_light.h"
#include "core/atmosphere/two_stream.h"
#include "core/environment/sun_light.h"
#include "core/environment/weather_air.h"
#include "tests/physics/cloud_fixture.h"

namespace irsig {
namespace {

using namespace cloud_fixture;

TEST(CloudSky, OfIsothermalAirHasItsTemperature) {
  constexpr double kKelvin = 285;
  WeatherSpec w = weather(1, kStratus);
  for (AirLevel& level : w.air.profile.level) {
    level.temperature_k = kKelvin;
    level.gas.h2o_ppmv = std::min(level.gas.h2o_ppmv, 100.0);
  }
  w.lower.kind = SurfaceBoundary::Kind::kGround;
  w.lower.temperature_k = kKelvin;
  w.lower.emissivity = 0.9;
  w.cloud->water_path_kg_m2 = 50;
  auto environment = *Environment::make({w}, {ConditionEnvironment{}}, 10, kUm);
  Environment::Line line{3000, -0.2, body_from_aspect(30, 0),
                         BackgroundDirections({-0.05f, -0.01f})};
  const std::uint32_t first = 0;
  const ViewEnvironment v = (*environment->view(line, {&first, 1})).front();
  for (std::uint32_t n = 0; n < v.around.count(); ++n) {
    const std::vector<double> spectrum = v.around.radiance(n);
    for (std::size_t i = 0; i < kUm.size(); ++i) {
      const double planck = planck_radiance_w_m2_sr_um(kUm[i], kKelvin);
      EXPECT_NEAR(spectrum[i], planck, 0.002 * planck) << n << " " << kUm[i];
    }
  }
}

// Expected: the streams between a grey ground and an opaque cloud have its temperature too, with
// the cloud on the ground and with air below.
TEST(CloudLight, OfIsothermalAirAndGroundHasTheirTemperature) {
  constexpr double kKelvin = 285;
  for (const double base_m : {0.0, 330.0}) {
    WeatherSpec w = weather(1, {CloudPhase::kWater, base_m, base_m + 670, 50, 7.9});
    for (AirLevel& level : w.air.profile.level) {
      level.temperature_k = kKelvin;
      level.gas.h2o_ppmv = std::min(level.gas.h2o_ppmv, 100.0);
    }
    w.air.cloud = w.cloud;
    w.air.forward_peak = ForwardPeak::kDiffuse;
    const Atmosphere air = *Atmosphere::make(w.air);
    AirSpectrum planck;
    for (const double um : all_bands_um())
      planck.push_back(planck_radiance_w_m2_sr_um(um, kKelvin));
    const BandChoice bands;
    const CloudLight light(air, {planck, AirSpectrum(kAirBandCount, 0.5)}, true, bands);
    const AirSpectrum at_base = light.thermal(w.air.profile.level.front().height_m + base_m).mean;
    for (std::size_t b = 0; b < kAirBandCount; ++b)
      EXPECT_NEAR(at_base[b], planck[b], 0.005 * planck[b])
          << base_m << " " << air_band_lambda_um(b);
  }
}

TEST(CloudSky, LetsLittleSunlightThroughWater) {
  const Seen none = seen_under(weather(0, kStratus), 45, 100, 20),
             all = seen_under(weather(1, kStratus), 45, 100, 20);
  for (std::size_t i = 0; i < kUm.size(); ++i) {
    EXPECT_LT(all.view.sun[i], 1e-9 * none.view.sun[i]);
  }
  // Diffuse light of 3.6 to 4.05 um: the zenith's radiance against the sun's irradiance.
  const auto night = [&] {
    auto environment =
        *Environment::make({weather(1, kStratus)}, {ConditionEnvironment{}}, 10, kUm);
    Environment::Line line{100, 20, body_from_aspect(30, 20), {}};
    const std::uint32_t first = 0;
    return (*environment->view(line, {&first, 1})).front();
  }();
  const std::uint32_t azimuths = all.environment->nodes().azimuths();
  const std::uint32_t zenith = all.environment->nodes().sky() - azimuths;
  for (std::size_t i = 0; i < 3; ++i) {
    const double diffuse =
        M_PI * (all.view.around.radiance(zenith)[i] -
                night.around.radiance(night.around.count() > azimuths
                                          ? all.environment->nodes().sky() / azimuths - 1
                                          : 0)[i]);
    EXPECT_GT(diffuse, 0);
    EXPECT_LT(diffuse, 0.01 * none.view.sun[i] * std::cos(45 * M_PI / 180));
  }
}

TEST(CloudProfile, AirInsideIsSaturatedAndElsewhereAsItWas) {
  const AirProfile air = afgl_profile(AfglProfile::kSubarcticWinter),
                   cloudy = with_cloud(air, kStratus);
  int inside = 0;
  for (const AirLevel& level : cloudy.level) {
    if (level.height_m >= kStratus.base_m && level.height_m <= kStratus.top_m) {
      EXPECT_NEAR(relative_humidity_percent(level), 100, 1e-6) << level.height_m;
      ++inside;
    } else {
      EXPECT_NEAR(level.gas.h2o_ppmv, air_at(air, level.height_m).gas.h2o_ppmv,
                  1e-9 * level.gas.h2o_ppmv);
    }
  }
  EXPECT_GE(inside, 3);
}

// Droplets are of water and crystals of ice. Source: LOWTRAN7's stratus and cumulus of Shettle and
// Fenn (absorption over extinction, asymmetry); ice is darkest near 11 um and hardly scatters
// there.
TEST(CloudOptics, OfDropletsAreLowtrans) {
  struct Row {
    double um, radius_um, co_albedo, asymmetry;
  };
  for (const Row& row :
       {Row{3.75, 7.9, 0.09457 / 1.16990, 0.7823}, Row{8.2, 7.9, 0.29057 / 1.25190, 0.8810},
        Row{10.591, 7.9, 0.32789 / 0.74497, 0.9069}, Row{11.0, 7.9, 0.37961 / 0.68246, 0.9060},
        Row{10.591, 11.5, 0.40498 / 0.98693, 0.9342}, Row{11.0, 11.5, 0.44993 / 0.88130, 0.9367}}) {
    const std::size_t b = *air_band(row.um);
    const auto co_albedo = [&](const CloudOptics& o) {
      return o.absorption[b] / (o.absorption[b] + o.scattering[b]);
    };
    const CloudOptics water =
        cloud_optics({CloudPhase::kWater, 0, 100, 0.1, row.radius_um}, ForwardPeak::kBeam);
    EXPECT_NEAR(co_albedo(water), row.co_albedo, 0.03) << row.um;
    EXPECT_NEAR(water.asymmetry[b], row.asymmetry, 0.03) << row.um;
    const CloudOptics ice =
        cloud_optics({CloudPhase::kIce, 0, 100, 0.1, row.radius_um}, ForwardPeak::kBeam);
    EXPECT_GT(co_albedo(ice), row.co_albedo + 0.045) << row.um;
  }
}

// A sun near the horizon lights a cloud's top by the cosine of its zenith angle, down to 1 deg.
// Expected: the streams of one layer of the cloud alone, in a window.
TEST(CloudSunlight, FollowsALowSun) {
  const CloudSpec cirrus = {CloudPhase::kIce, 8000, 9000, 0.05, 40};
  const Sky sky(AfglProfile::kMidlatitudeSummer, AerosolKind::kRural, &cirrus);
  const std::size_t band = *air_band(1e4 / 2605.0);
  const CloudOptics optics = cloud_optics(cirrus, ForwardPeak::kDiffuse);
  const double depth = optics.absorption[band] + optics.scattering[band];
  const auto ratio_to_streams = [&](double zenith_deg) {
    const SunAmounts sun(*sky.air, 2, zenith_deg, BandChoice());
    AbsorberAmounts to_top;
    EXPECT_TRUE(sun.add_to(to_top, cirrus.top_m));
    const double ours =
        CloudSunlight(*sky.light->cloud(), sun, zenith_deg).scattered(cirrus.top_m).mean[band];
    const std::vector<StreamLayer> layer = {
        {depth, optics.scattering[band] / depth, optics.asymmetry[band], 0, 0}};
    return ours / diffuse_light(layer, {.sun_irradiance = transmittance(to_top)[band],
                                        .sun_cosine = std::cos(zenith_deg * M_PI / 180)})
                      .front()
                      .mean;
  };
  for (const double zenith_deg : {50.0, 80.0, 85.0, 88.0})
    EXPECT_NEAR(ratio_to_streams(zenith_deg), 1, 0.05) << zenith_deg;
}

// Single rays of the air (irsig show sky, its picture) and the skies of rows are the same.
TEST(WeatherAir, HasTheSkyOfRowsAndTheSharpBeamsTransmittance) {
  const CloudSpec cirrus{CloudPhase::kIce, 8000, 9000, 0.02, 40};
  WeatherSpec w = weather(1, cirrus);
  const WeatherAir air = *WeatherAir::make(w, 2);
  const auto up = [](const AirProfile& profile) -> absl::StatusOr<LightPath> {
    return look(profile, 2, 0, std::numeric_limits<double>::infinity(), true);
  };
  const PathRadiance ray = *air.radiance(WeatherAir::Sight::kDiffuse, up, std::nullopt);
  w.air.cloud = cirrus;
  w.air.forward_peak = ForwardPeak::kDiffuse;
  const Atmosphere diffuse = *Atmosphere::make(w.air);
  const auto environment = Environment::make({w}, {ConditionEnvironment{}}, 2, all_bands_um());
  const BandChoice bands;
  const ThermalSurroundings sky(w, diffuse, 2, (*environment)->nodes(), bands, 0);
  w.air.forward_peak = ForwardPeak::kBeam;
  const Atmosphere beam = *Atmosphere::make(w.air);
  const AirSpectrum through = transmittance(
      beam.amounts(look(beam.profile(), 2, 0, std::numeric_limits<double>::infinity(), true)));
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    EXPECT_NEAR(ray.total_w_m2_sr_um[b], sky.sky.back().total[b], 1e-9 * sky.sky.back().total[b]);
    EXPECT_NEAR(ray.transmittance[b], through[b], 1e-9 * through[b]);
  }
}

// Rationale: of the sun's light a thin cloud moves most by some degrees, out of the beam and into a
// peak around it that nodes of the sky have to carry. Expected: no node is darker than none, and
// what falls on the ground, beam and sky together, is that of two streams through the layer.
TEST(CloudSky, KeepsTheSunlightOfThinIceAroundTheSun) {
  for (const double zenith_deg : {20.0, 45.0, 70.0}) {
    const WeatherSpec cloudy = weather(1, kThin);
    const Seen day = seen_under(cloudy, zenith_deg, 100, 20),
               clear = seen_under(weather(0, kThin), zenith_deg, 100, 20);
    const double cosine = std::cos(zenith_deg * M_PI / 180);
    const DirectionNodes& nodes = day.environment->nodes();
    const std::uint32_t azimuths = nodes.azimuths();
    const auto night = *Environment::make({cloudy}, {ConditionEnvironment{}}, 10, kUm);
    const std::uint32_t first = 0;
    const ViewEnvironment dark =
        (*night->view({100, 20, body_from_aspect(30, 20), {}}, {&first, 1})).front();
    std::vector<double> diffuse(3, 0.0);
    for (std::uint32_t n = 0; n < nodes.sky(); ++n) {
      const double sine = nodes.sin_elevation(n);
      const double low = n >= azimuths ? nodes.sin_elevation(n - azimuths) : sine;
      const double high = n + azimuths < nodes.sky() ? nodes.sin_elevation(n + azimuths) : sine;
      const std::vector<double> sunlit = day.view.around.radiance(n),
                                thermal = dark.around.radiance(n / azimuths);
      for (std::size_t i = 0; i < 3; ++i) {
        const double light = sunlit[i] - thermal[i];
        EXPECT_GE(light, -1e-7 * day.view.sun[i]) << zenith_deg << " " << kUm[i] << " " << n;
        // Linear between the nodes, times the sine.
        const double of_hat =
            ((high - sine) * (2 * sine + high) + (sine - low) * (2 * sine + low)) / 6;
        diffuse[i] += light * of_hat * 2 * M_PI / azimuths;
      }
    }
    const CloudOptics optics = cloud_optics(kThin, ForwardPeak::kDiffuse);
    for (std::size_t i = 0; i < 2; ++i) {  // windows: 3.6 and 3.9 um
      const std::size_t b = *air_band(kUm[i]);
      const double depth = optics.absorption[b] + optics.scattering[b];
      const double passed =
          std::exp(-depth / cosine) +
          2 * M_PI / cosine *
              diffuse_light(std::vector<StreamLayer>{{depth, optics.scattering[b] / depth,
                                                      optics.asymmetry[b], 0, 0}},
                            {.sun_irradiance = 1, .sun_cosine = cosine})
                  .back()
                  .mean;
      EXPECT_NEAR((day.view.sun[i] * cosine + diffuse[i]) / (clear.view.sun[i] * cosine), passed,
                  0.06)
          << zenith_deg << " " << kUm[i];
    }
  }
}

// A worker holds two skies of each weather: most of a ray's layers go once nothing asks for them,
// and below the cloud both skies have the same air in front of the surface.
TEST(ThermalSurroundings, OfHoleAndDeckShareTheirAirAndKeepFewLayers) {
  const Sky sky(AfglProfile::kMidlatitudeSummer, AerosolKind::kRural, nullptr);
  WeatherSpec cloudy = sky.weather;
  cloudy.air.cloud = kStratus;
  cloudy.air.forward_peak = ForwardPeak::kDiffuse;
  const Atmosphere air = *Atmosphere::make(cloudy.air);
  const DirectionNodes& nodes = sky.environment->nodes();
  const ThermalSurroundings alone(cloudy, air, 2, nodes, sky.bands, 0),
      beside(cloudy, air, 2, nodes, sky.bands, 1, sky.light.get());
  ASSERT_EQ(beside.lower.size(), sky.light->lower.size());
  for (std::size_t r = 0; r < beside.lower.size(); ++r) {
    EXPECT_EQ(beside.lower[r].layers, sky.light->lower[r].layers);
    EXPECT_TRUE(beside.lower[r].from_ring.empty());
    for (std::size_t b = 0; b < kAirBandCount; ++b)
      ASSERT_NEAR(beside.lower[r].total[b], alone.lower[r].total[b],
                  1e-9 * alone.lower[r].total[b]);
  }
  const auto kept = [](const ThermalSurroundings& of) {
    return std::count_if(of.sky.begin(), of.sky.end(), [](const SkyRing& r) { return r.layers; });
  };
  EXPECT_EQ(kept(beside), 29);
  beside.sun_is_made();
  EXPECT_LE(kept(beside), 16);
  EXPECT_EQ(kept(alone), kept(beside));
  // A target above the base has the cloud in front of the surface.
  const ThermalSurroundings inside(cloudy, air, 329, nodes, sky.bands, 0, sky.light.get());
  EXPECT_NE(inside.lower.back().layers, sky.light->lower.back().layers);
}

}  // namespace
}  // namespace irsig
