// Rationale: the disk of the sun sets in parts, lifted by refraction, and lights the air above when
// it is partly or all below the horizon.
// Expected: direct sunlight is that of the visible part, and none after sunset; the sky towards
// the sun is that of the whole disk along the same ray within the stated error; it fades without a
// jump from half a degree up to the end of twilight; the sea reflects it. Source: sums over all
// steps of a ray, each with its own sun.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

#include "core/atmosphere/path_layers.h"
#include "core/atmosphere/path_sums.h"
#include "core/atmosphere/scattered_again.h"
#include "core/base/constants.h"
#include "core/environment/environment.h"
#include "core/spectral/solar.h"
#include "tests/physics/around_spectra.h"

namespace irsig {
namespace {

const std::vector<double> kTwilightUm = [] {
  std::vector<double> um;
  for (const double x : {3.5, 3.7, 3.9, 4.7}) um.push_back(air_band_lambda_um(*air_band(x)));
  return um;
}();
constexpr double kEyeM = 10;
constexpr double kSkyDeg = 5;  // elevation of the sky that is looked at

WeatherSpec twilight_weather() {
  WeatherSpec w{{afgl_profile(AfglProfile::kMidlatitudeSummer), {}}, true, {}, nullptr};
  w.air.aerosol.kind = AerosolKind::kRural;
  w.air.aerosol.visibility_m = 23e3;
  w.lower.temperature_k = 293;
  w.lower.wind_speed_m_s = 5;
  return w;
}

ConditionEnvironment sun_up_by(double elevation_deg) {
  const double e = elevation_deg * M_PI / 180;
  return {0, true, {std::cos(e), 0, -std::sin(e)}, 1};
}

// The views under suns of these elevations, and without one as the last; sky towards the sun. The
// surface is the sea, or a grey ground of an emissivity.
struct Evening {
  std::unique_ptr<const Environment> environment;
  std::vector<ViewEnvironment> view;
};
Evening evening(const std::vector<double>& elevation_deg,
                std::optional<double> ground_emissivity = std::nullopt) {
  std::vector<ConditionEnvironment> conditions;
  for (const double e : elevation_deg) conditions.push_back(sun_up_by(e));
  conditions.push_back({});
  WeatherSpec weather = twilight_weather();
  if (ground_emissivity) {
    weather.lower.kind = SurfaceBoundary::Kind::kGround;
    weather.lower.emissivity = *ground_emissivity;
  }
  Evening out{*Environment::make({weather}, conditions, kEyeM, kTwilightUm), {}};
  const Vec<Body> from = body_from_aspect(180, -kSkyDeg);
  SensorLine line{10, -kSkyDeg, from,
                  BackgroundDirections({static_cast<float>(-std::sin(kSkyDeg * kRadPerDeg))},
                                       std::atan2(-from.y, -from.x))};
  std::vector<std::uint32_t> all;
  for (std::uint32_t c = 0; c < conditions.size(); ++c) all.push_back(c);
  out.view = *out.environment->view(line, all);
  return out;
}

double background(const ViewEnvironment& v, std::size_t i) { return v.background_apparent[0][i]; }

// Sunlight that a ray 5 deg up scatters, for an irradiance of 1: over all of its steps, from each
// of whose ends the sun is seen under its own angle. [band of the air, 1/sr]
AirSpectrum scattered_step_by_step(const Atmosphere& air, double zenith_deg) {
  const LightPath path =
      look(air.profile(), kEyeM, 90 - kSkyDeg, std::numeric_limits<double>::infinity());
  AbsorberAmounts so_far;
  StepScattering step;
  AirSpectrum out(kAirBandCount, 0.0), before = out, after = out;
  const double z = zenith_deg * kRadPerDeg,
               cosine = std::cos((90 - kSkyDeg - zenith_deg) * kRadPerDeg);
  for (std::size_t i = 0; i < path.node.size(); ++i) {
    const double turn = path.node[i].central_angle_deg * kRadPerDeg;
    const auto to_sun = air.sun_amounts(path.node[i].height_m, (z - turn) / kRadPerDeg);
    before = std::exchange(
        after, to_sun ? transmittance(so_far + *to_sun) : AirSpectrum(kAirBandCount, 0.0));
    if (i > 0) {
      for (std::size_t b = 0; b < kAirBandCount; ++b)
        out[b] += mean_of_sunlight(before[b], after[b], step.grey_depth[b]) *
                  (step.aerosol_depth[b] * henyey_greenstein_per_sr(step.asymmetry[b], cosine) +
                   step.molecular_depth[b] * rayleigh_per_sr(cosine));
    }
    if (i + 1 < path.node.size()) add_step(so_far, &step, air, path, i);
  }
  return out;
}

TEST(EnvironmentTwilight, TheSkyIsThatOfTheWholeDiskWithinTheStatedError) {
  const std::vector<double> elevations = {0.5, -0.3, -0.6, -0.85, -1.0, -2.5};
  const Evening seen = evening(elevations);
  const Atmosphere air = *Atmosphere::make(twilight_weather().air);
  for (std::size_t c = 0; c < elevations.size(); ++c) {
    const SunSeen& sun = seen.environment->sun_seen(static_cast<std::uint32_t>(c));
    ASSERT_TRUE(sun.lights_air);
    const double zenith_deg = 90 - std::asin(-sun.middle.z) / kRadPerDeg;
    const AirSpectrum exact = scattered_step_by_step(air, zenith_deg);
    const double stated = std::hypot(kAerosolRelativeError, low_sun_relative(zenith_deg));
    std::printf("sun at %+.2f deg, stated +-%.2f:", elevations[c], stated);
    for (std::size_t i = 0; i < kTwilightUm.size(); ++i) {
      const std::size_t b = *air_band(kTwilightUm[i]);
      const double ours = background(seen.view[c], i) - background(seen.view.back(), i),
                   expected = exact[b] * solar_irradiance_w_m2_um(air_band_lambda_um(b));
      std::printf(" %.2f um %.4g of %.4g;", kTwilightUm[i], ours, expected);
      if (expected < 1e-3 * background(seen.view.back(), i)) continue;
      EXPECT_GT(ours, 0);
      EXPECT_NEAR(ours, expected, 1.5 * stated * ours) << elevations[c] << " " << kTwilightUm[i];
    }
    std::printf("\n");
  }
}

TEST(EnvironmentTwilight, DirectLightIsThatOfTheVisiblePartAndNoneAfterSunset) {
  const Evening seen = evening({0.5, -0.6, -0.95, -1.5});  // sets at -0.9
  const Environment& e = *seen.environment;
  EXPECT_EQ(e.sun_seen(0).visible, 1);
  EXPECT_GT(e.sun_seen(1).visible, 0.1);
  EXPECT_LT(e.sun_seen(1).visible, 0.9);
  for (const std::uint32_t c : {2u, 3u}) {
    EXPECT_EQ(e.sun_seen(c).visible, 0);
    for (const double x : seen.view[c].sun) EXPECT_EQ(x, 0);
    for (const double x : seen.view[c].sun_apparent) EXPECT_EQ(x, 0);
  }
  EXPECT_GT(seen.view[1].sun[0], 0);
  // The middle of the visible part is above the horizon, and lifted by refraction.
  EXPECT_GT(std::asin(-e.sun_seen(0).direction.z) / kRadPerDeg, 0.5 + 0.3);
}

// Expected: from 10 m, where the horizon is 0.1 deg below the level, a sun 6 deg below it still
// lights air that is seen, and one 6.2 deg below does not: its views are those of the night.
TEST(EnvironmentTwilight, EndsSixDegreesBelowTheHorizon) {
  const Evening seen = evening({-5.9, -6.2});
  const ViewEnvironment &last = seen.view[0], &after = seen.view[1], &night = seen.view[2];
  EXPECT_TRUE(seen.environment->sun_seen(0).lights_air);
  EXPECT_GT(background(last, 0), background(night, 0));
  EXPECT_FALSE(seen.environment->sun_seen(1).lights_air);
  EXPECT_EQ(after.background_apparent, night.background_apparent);
  EXPECT_EQ(after.path_radiance, night.path_radiance);
}

// Rationale: light that the air scatters comes from the whole disk, also when a part of it or all
// has set; only the level air around the target lies in the shadow after sunset.
// Expected: from a whole disk, past one of which a seventh is left, to one that has set, each kind
// of scattered light fades by less than the disk does, and grows nowhere; the errors of the models
// are at least those of the light towards a low sun; lines between nodes stay as good.
TEST(EnvironmentTwilight, AllScatteredLightOutlastsTheDisk) {
  const std::vector<ConditionEnvironment> suns = {
      sun_up_by(-0.3), sun_up_by(-0.8), sun_up_by(-1), {}};
  const auto environment = *Environment::make({twilight_weather()}, suns, kEyeM, kTwilightUm);
  EXPECT_EQ(environment->sun_seen(0).visible, 1);
  EXPECT_NEAR(environment->sun_seen(1).visible, 1.0 / 7, 0.02);
  EXPECT_EQ(environment->sun_seen(2).visible, 0);
  const Vec<Body> from = body_from_aspect(150, 3);
  SensorLine line{5000, 3, from,
                  BackgroundDirections({-0.3f, -0.05f, 0.0018f, 0.0022f, 0.01f, 0.1f, 0.5f},
                                       std::atan2(-from.y, -from.x))};
  line.land = true;
  line.land_range_m = {6000, 20'000};
  const std::vector<std::uint32_t> all = {0, 1, 2, 3};
  const auto view = *environment->view(line, all);
  const auto fades = [&](const char* what, std::size_t n, auto of, std::size_t suns_of_it = 3) {
    for (std::size_t c = 1; c < suns_of_it; ++c) {
      const double before = of(view[c - 1]) - of(view[3]), now = of(view[c]) - of(view[3]);
      EXPECT_GT(now, 0.25 * before) << what << " " << n << " under sun " << c;
      EXPECT_LT(now, 0.95 * before) << what << " " << n << " under sun " << c;
    }
  };
  fades("path", 0, [](const ViewEnvironment& v) { return v.path_radiance[0]; });
  for (std::size_t n = 0; n < line.behind.count(); ++n)
    fades("background", n, [&](const ViewEnvironment& v) { return v.background_apparent[n][0]; });
  for (std::uint32_t n = 0; n < environment->nodes().count(); n += 3) {
    fades("node", n, [&](const ViewEnvironment& v) { return v.around.radiance(n)[0]; });
    fades("apparent", n, [&](const ViewEnvironment& v) { return v.around.apparent(n)[0]; });
  }
  for (const auto part : {&LandLight::at_target, &LandLight::apparent, &LandLight::behind})
    for (std::size_t k = 0; k < (view[0].land.*part).size(); ++k) {
      const bool behind = part == &LandLight::behind;
      fades("sky on land", k, [&](const ViewEnvironment& v) { return (v.land.*part)[k].sky[0]; });
      fades(
          "air before land", k,
          [&](const ViewEnvironment& v) { return (v.land.*part)[k].path_radiance[0]; },
          behind ? 3 : 2);
    }
  for (std::size_t c = 0; c < 3; ++c) {
    const SunSeen& seen = environment->sun_seen(static_cast<std::uint32_t>(c));
    const double low = low_sun_relative(90 - std::asin(-seen.middle.z) / kRadPerDeg);
    for (const std::size_t n : {0, 1, 2}) {
      const auto change = [&](const auto& of) { return of(view[c]) - of(view[3]); };
      EXPECT_GT(
          change([&](const ViewEnvironment& v) { return v.background_model_error[n][0]; }),
          0.9 * low * change([&](const ViewEnvironment& v) { return v.background_apparent[n][0]; }))
          << c << " " << n;
    }
    EXPECT_LT(view[c].sky_interpolation, 0.01);
    EXPECT_LT(view[c].lower_interpolation, 0.02);
  }
}

// A black ground reflects nothing: all sunlight from below the horizon is that of the air before
// it.
TEST(EnvironmentTwilight, AirBelowTheHorizonIsLitByTheWholeDisk) {
  WeatherSpec weather = twilight_weather();
  weather.lower = {SurfaceBoundary::Kind::kGround, 293, 1, 0};
  const auto environment =
      *Environment::make({weather}, {sun_up_by(-0.3), sun_up_by(-0.8), {}}, kEyeM, kTwilightUm);
  const Vec<Body> from = body_from_aspect(150, 3);
  const SensorLine line{10, 3, from,
                        BackgroundDirections({0.05f, 0.1f}, std::atan2(-from.y, -from.x))};
  const std::vector<std::uint32_t> all = {0, 1, 2};
  const auto view = *environment->view(line, all);
  EXPECT_LT(environment->sun_seen(1).visible, 0.2);
  const auto fades = [&](const char* what, std::uint32_t n, auto of) {
    EXPECT_GT(of(view[0]), of(view[2])) << what << " " << n;
    EXPECT_GT(of(view[1]) - of(view[2]), 0.25 * (of(view[0]) - of(view[2]))) << what << " " << n;
  };
  for (const std::uint32_t n : {0u, 1u})
    fades("background", n, [&](const ViewEnvironment& v) { return v.background_apparent[n][0]; });
  const std::uint32_t nodes = environment->nodes().count(),
                      azimuths = environment->nodes().azimuths();
  for (std::uint32_t n = nodes - 4 * azimuths; n < nodes; ++n)
    fades("node", n, [&](const ViewEnvironment& v) { return v.around.radiance(n)[0]; });
}

// Expected: the error of light under a low sun begins 5 deg above the horizon, has the size that
// was fitted 2 deg above it, grows towards the horizon and ends at 1.5.
TEST(EnvironmentTwilight, TheErrorGrowsTowardsTheHorizon) {
  EXPECT_EQ(low_sun_relative(84.9), 0);
  EXPECT_NEAR(low_sun_relative(88), 0.12, 1e-12);
  EXPECT_NEAR(low_sun_relative(89) / low_sun_relative(88), std::exp(0.81), 1e-12);
  for (double zenith_deg = 85.2; zenith_deg < 97; zenith_deg += 0.2) {
    EXPECT_GT(low_sun_relative(zenith_deg), 0);
    EXPECT_GE(low_sun_relative(zenith_deg), low_sun_relative(zenith_deg - 0.2));
  }
  EXPECT_EQ(low_sun_relative(96), 1.5);
}

// Steps of 0.05 deg, 12 s at the equator, past the moment at which the disk has set.
TEST(EnvironmentTwilight, LightFadesWithoutAJump) {
  std::vector<double> elevations;
  for (double e = 0.5; e > -1.5; e -= 0.05) elevations.push_back(e);
  const std::size_t fine = elevations.size();
  for (double e = -2; e > -7; e -= 1) elevations.push_back(e);
  const Evening seen = evening(elevations);
  const ViewEnvironment& night = seen.view.back();
  for (std::size_t i = 0; i < 3; ++i) {
    const double first = background(seen.view[0], i) - background(night, i);
    double last = first, last_sea = 0;
    EXPECT_GT(first, 0);
    for (std::size_t c = 0; c + 1 < seen.view.size(); ++c) {
      const double now = background(seen.view[c], i) - background(night, i);
      EXPECT_LE(now, 1.02 * last + 1e-3 * first) << elevations[c];
      if (c < fine) {
        EXPECT_GE(now, 0.8 * last) << elevations[c];
      }
      last = now;
      // The sea's reflection of the sky, steeply below, at the azimuth of the sun.
      const std::uint32_t azimuths = seen.environment->nodes().azimuths();
      const std::uint32_t node = seen.environment->nodes().count() - 3 * azimuths;
      const double sea = seen.view[c].around.radiance(node)[i] -
                         night.around.radiance(seen.environment->nodes().count() - 3 * azimuths)[i];
      EXPECT_GE(sea, 0);
      if (c > 0 && c < fine) {
        EXPECT_GE(sea, 0.5 * last_sea) << elevations[c];
      }
      last_sea = sea;
    }
    EXPECT_LT(last, 0.02 * first);
  }
}

// Rationale: the edge of the Earth's shadow moves over the rings of the sky, beside which a fit to
// the light at rings falls below 0, and an error relative to it is without a limit.
// Expected: no node sends less than nothing, no bound is negative, and their sum over all nodes
// does not jump between suns 0.02 deg apart.
TEST(EnvironmentTwilight, ErrorsBetweenNodesAreNeverNegativeAndDoNotJump) {
  std::vector<double> elevations;
  for (double e = -0.6; e > -1.6; e -= 0.02) elevations.push_back(e);
  const Evening seen = evening(elevations);
  const std::vector<double> weight(3, 1.0);
  const auto night = seen.view.back().around.integrals(0, weight, nullptr, 1);
  double last = 0;
  for (std::size_t c = 0; c < elevations.size(); ++c) {
    const auto light = seen.view[c].around.integrals(0, weight, nullptr, 1);
    double sum = 0;
    const std::size_t turns = light.source.size() / night.source.size();
    for (std::size_t k = 0; k < light.source.size(); ++k) {
      EXPECT_GE(light.interpolation[k], 0) << elevations[c] << " node " << k;
      EXPECT_GE(light.source[k], 0.999 * night.source[k / turns]) << elevations[c] << " node " << k;
      sum += light.interpolation[k] - night.interpolation[k / turns];
    }
    if (c > 0) {
      EXPECT_LT(sum, 1.5 * last) << elevations[c];
      EXPECT_GT(sum, last / 1.5) << elevations[c];
    }
    last = sum;
  }
}

// Rationale: what a diffuse ground reflects of the sunlit sky is summed once for all directions.
// Expected: after sunset, when the ground has no direct sunlight, each direction straight down
// gains (1 - emissivity) x the mean of the sky's sunlight over the ground, by the cosine of its
// zenith angle, within 3 % (10 m of air, and the light that this ground throws back at the air).
TEST(EnvironmentTwilight, AGreyGroundReflectsTheMeanOfTheSky) {
  constexpr double kEmissivity = 0.4;
  const Evening grey = evening({-1.5}, kEmissivity), black = evening({-1.5}, 1.0);
  ASSERT_EQ(grey.environment->sun_seen(0).visible, 0);
  const DirectionNodes nodes = grey.environment->nodes(true);
  const auto sunlight = [](const Evening& of) {
    auto lit = radiance_of(of.view[0].around);
    const auto night = radiance_of(of.view[1].around);
    const std::size_t turns = lit.size() / night.size();
    for (std::size_t n = 0; n < lit.size(); ++n)
      for (std::size_t i = 0; i < lit[n].size(); ++i) lit[n][i] -= night[n / turns][i];
    return lit;
  };
  const auto of_grey = sunlight(grey), of_black = sunlight(black);
  ASSERT_EQ(of_grey.size(), nodes.count());
  for (std::size_t i = 0; i < kTwilightUm.size(); ++i) {
    // Rings of the sky, between which light is linear in the sine: the mean of 2 sine x light.
    std::vector<double> sine, light;
    for (std::uint32_t n = 0; n < nodes.sky(); n += nodes.azimuths()) {
      sine.push_back(nodes.sin_elevation(n));
      double sum = 0;
      for (std::uint32_t a = 0; a < nodes.azimuths(); ++a) sum += of_grey[n + a][i];
      light.push_back(sum / nodes.azimuths());
    }
    double mean = sine.front() * sine.front() * light.front();
    for (std::size_t r = 0; r + 1 < sine.size(); ++r)
      mean += (sine[r + 1] - sine[r]) * (sine[r] * light[r] + sine[r + 1] * light[r + 1]);
    const double expected = (1 - kEmissivity) * mean;
    for (std::uint32_t n = nodes.count() - nodes.azimuths(); n < nodes.count(); ++n)
      EXPECT_NEAR(of_grey[n][i] - of_black[n][i], expected, 0.03 * expected)
          << kTwilightUm[i] << " um, node " << n;
  }
}

}  // namespace
}  // namespace irsig
