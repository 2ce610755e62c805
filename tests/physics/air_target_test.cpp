// Rationale: a target in the air is seen from its own centre: range, aspect, air, horizon, sky and
// ground are those of its height, and what stands below it is as far away as it is.
// Expected: what a black sphere sends through the air between the two heights; in its background
// the sky of the sensor's own direction, or the ground at the end of the whole path; on a white
// plate the light of a sky that reaches down to the dip; what is left of a plate behind the
// horizon. Source: the air's own sums (core/atmosphere) along one path, which no view's nodes
// share; closed forms of a uniform sky and of a sphere's horizon.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/environment/environment.h"
#include "core/spectral/planck.h"
#include "scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

const AirProfile& air() { return afgl_profile(AfglProfile::kMidlatitudeSummer); }
constexpr double kGroundK = 300, kSphereK = 320;

WeatherSpec weather(double above_m, bool refraction = true,
                    SurfaceBoundary lower = {SurfaceBoundary::Kind::kGround, kGroundK, 1, 0}) {
  return {{air(), {}}, refraction, lower, nullptr, above_m};
}

ConditionSpec condition(double above_m, SurroundingsKind kind = SurroundingsKind::kGround) {
  ConditionSpec c;
  c.part_temperature_k = {kSphereK};
  c.surroundings.kind = kind;
  c.above_surface_m = above_m;
  return c;
}

// One of the air's bands, so that its spectrum has one number.
Band narrow() { return {"n", 10.005, 10.010, 0.005, {}}; }

struct Truth {
  double apparent_w_m2_sr, background_w_m2_sr;
};

// Along one path: of a blackbody at the target's place, and of what stands behind it. The sensor is
// at a range and elevation from a point so high.
Truth truth(double above_m, double range_m, double elevation_deg, double lambda_um) {
  const Atmosphere atmosphere = *Atmosphere::make({air(), {}});
  const double e = elevation_deg * kRadPerDeg;
  const double sensor_m =
      std::hypot(kEarthRadiusM + above_m + range_m * std::sin(e), range_m * std::cos(e)) -
      kEarthRadiusM;
  const LightPath path = *look_between(air(), sensor_m, above_m, range_m);
  const std::size_t b = *air_band(lambda_um);
  const PathRadiance between = atmosphere.radiance(path);
  const double zenith_deg = path.node.front().zenith_deg;
  const LightPath whole = look(air(), sensor_m, zenith_deg, INFINITY);
  const PathRadiance beyond = atmosphere.radiance(whole);
  const double ground =
      whole.end == PathEnd::kSurface
          ? beyond.transmittance[b] * planck_radiance_w_m2_sr_um(lambda_um, kGroundK)
          : 0;
  return {between.transmittance[b] * planck_radiance_w_m2_sr_um(lambda_um, kSphereK) +
              between.thermal_w_m2_sr_um[b],
          beyond.thermal_w_m2_sr_um[b] + ground};
}

TEST(AirTarget, ABlackSphereIsSeenThroughTheAirOfItsHeight) {
  const SceneSpec scene = [] {
    SceneSpec s = scene_of(generated("sphere", 20000, 1), grey(1), narrow());
    s.spectral_breaks_um = air_band_edges_um(9.9, 10.1);
    return s;
  }();
  const auto simulator = simulator_of(scene);
  const std::vector<double>& um = simulator->band_grids()[0].node_um;
  const double width_um = 0.005, lambda_um = 10.0075;
  for (const double above_m : {100.0, 3000.0, 10000.0}) {
    auto made = Environment::make({weather(above_m)}, {{}}, 1, um);
    ASSERT_TRUE(made.ok()) << made.status();
    const std::shared_ptr<const Environment> environment = *std::move(made);
    for (const double elevation_deg : {-89.0, -45.0, -0.5, 0.0, 0.5, 45.0, 89.0}) {
      const double range_m = elevation_deg < 0 ? 0.9 * above_m : 5000;
      ViewRequest r = request(*simulator, 90, elevation_deg, range_m, {kSphereK});
      r.condition = {condition(above_m)};
      r.environment = environment;
      const SignatureResult row = only_row(*simulator, r);
      const Truth expected = truth(above_m, range_m, elevation_deg, lambda_um);
      const double area_m2 = row.projected_area_m2.value;
      const std::string what =
          "at " + std::to_string(above_m) + " m, elevation " + std::to_string(elevation_deg);
      EXPECT_NEAR(area_m2, std::numbers::pi, 5e-3) << what;
      // Light of the surroundings that molecules scatter is in the row and not in the sum.
      EXPECT_NEAR(row.apparent_intensity_w_sr.value / area_m2 / width_um, expected.apparent_w_m2_sr,
                  4e-3 * expected.apparent_w_m2_sr)
          << what;
      // Nodes of the sky and of the ground, from the target's own place: 1 %.
      EXPECT_NEAR(row.background_radiance_w_m2_sr.value / width_um, expected.background_w_m2_sr,
                  0.012 * expected.apparent_w_m2_sr)
          << what;
      std::printf("%-40s %10.5g %10.5g   %10.5g %10.5g\n", what.c_str(),
                  row.apparent_intensity_w_sr.value / area_m2 / width_um, expected.apparent_w_m2_sr,
                  row.background_radiance_w_m2_sr.value / width_um, expected.background_w_m2_sr);
    }
  }
}

// Several heights share the paths: each row is that of its height alone.
TEST(AirTarget, HeightsShareTheirPaths) {
  SceneSpec scene = scene_of(generated("sphere", 2000, 1), grey(0.5), narrow());
  scene.spectral_breaks_um = air_band_edges_um(9.9, 10.1);
  const auto simulator = simulator_of(scene);
  const std::vector<double>& um = simulator->band_grids()[0].node_um;
  const std::vector<double> heights_m = {50, 500, 5000};
  std::vector<WeatherSpec> weathers;
  std::vector<ConditionEnvironment> of;
  for (const double h : heights_m) {
    of.push_back({static_cast<std::uint32_t>(weathers.size()), false, {}, 1});
    weathers.push_back(weather(h));
  }
  const auto rows = [&](std::vector<WeatherSpec> w, std::vector<ConditionEnvironment> c,
                        const std::vector<double>& h, double elevation_deg) {
    ViewRequest r = request(*simulator, 90, elevation_deg, 40, {kSphereK});
    r.condition.clear();
    r.selected_condition.clear();
    for (const double above_m : h) {
      r.selected_condition.push_back(static_cast<std::uint32_t>(r.condition.size()));
      r.condition.push_back(condition(above_m));
    }
    r.max_reflections = 1;
    auto made = Environment::make(std::move(w), std::move(c), 1, um);
    EXPECT_TRUE(made.ok()) << made.status();
    r.environment = *std::move(made);
    const auto view = simulator->simulate(r);
    EXPECT_TRUE(view.ok()) << view.status();
    return view->row;
  };
  for (const double elevation_deg : {-60.0, 0.0, 60.0}) {
    const auto together = rows(weathers, of, heights_m, elevation_deg);
    for (std::size_t i = 0; i < heights_m.size(); ++i) {
      const auto alone = rows({weathers[i]}, {{}}, {heights_m[i]}, elevation_deg).front();
      const SignatureResult& shared = together[i];
      constexpr auto kEmitted = static_cast<std::size_t>(Cause::kEmitted);
      EXPECT_EQ(shared.cause_w_sr[kEmitted].value, alone.cause_w_sr[kEmitted].value)
          << "one set of paths";
      for (const auto what :
           {&SignatureResult::intensity_w_sr, &SignatureResult::apparent_intensity_w_sr,
            &SignatureResult::background_radiance_w_m2_sr}) {
        EXPECT_NEAR(
            (shared.*what).value, (alone.*what).value,
            shared.numerical_error_w_sr + alone.numerical_error_w_sr + 2e-3 * (alone.*what).value)
            << heights_m[i] << " m, " << elevation_deg;
      }
    }
    EXPECT_GT(std::abs(together[2].background_radiance_w_m2_sr.value -
                       together[0].background_radiance_w_m2_sr.value),
              0.01 * together[0].background_radiance_w_m2_sr.value)
        << "the height matters";
  }
}

// A level sky that ends at the dip, and darkness below it: a white wall has 1/2 + (d + sin d cos d)
// / pi of the sky's radiance.
TEST(AirTarget, AUniformSkyReachesDownToTheDip) {
  Mesh wall;
  wall.group = {"wall"};
  wall.vertex = {{0, -1, 1}, {0, 1, 1}, {0, 1, -1}, {0, -1, -1}};
  wall.triangle = {{0, 2, 1}, {0, 3, 2}};
  wall.triangle_group = {0, 0};
  SceneSpec scene = scene_of(wall, grey(0), lwir());
  scene.part[0].two_sided = true;
  const auto simulator = simulator_of(scene);
  for (const double above_m : {100.0, 10000.0}) {
    ViewRequest r = request(*simulator, 0, 20, 1000, {1});
    r.condition = {condition(above_m, SurroundingsKind::kSea)};
    r.condition[0].surroundings = {SurroundingsKind::kSea, 300, 0, 1, 1, 0};
    r.max_reflections = 1;
    r.accuracy.samples_per_replicate = 1u << 16;
    const SignatureResult row = only_row(*simulator, r);
    const double dip = std::acos(kEarthRadiusM / (kEarthRadiusM + above_m));
    const double share = 0.5 + (dip + std::sin(dip) * std::cos(dip)) / std::numbers::pi;
    expect_within_t(
        row.intensity_w_sr,
        planck_band_radiance_w_m2_sr(8, 12, 300) * 4 * std::cos(20 * kRadPerDeg) * share, 2,
        "at " + std::to_string(above_m) + " m", 1e-3);
  }
}

// Nodes below the horizontal hold the sky down to the horizon, and the ground below it.
TEST(AirTarget, NodesBelowTheHorizontalAreTheSkyDownToTheHorizon) {
  const std::vector<double> um = {10.0075};
  const Atmosphere atmosphere = *Atmosphere::make({air(), {}});
  const std::size_t b = *air_band(um[0]);
  for (const double above_m : {100.0, 1000.0, 10000.0}) {
    auto made = Environment::make({weather(above_m)}, {{}}, 1, um);
    ASSERT_TRUE(made.ok()) << made.status();
    const std::vector<std::uint32_t> all = {0};
    const auto view = (*made)->view({5000, 0, {1, 0, 0}, BackgroundDirections({0.0f})}, all);
    ASSERT_TRUE(view.ok()) << view.status();
    const DirectionNodes& nodes = (*made)->nodes();
    ASSERT_TRUE(nodes.has_limb());
    int sky = 0, ground = 0;
    for (std::uint32_t n = nodes.sky(); n < nodes.count(); ++n) {
      const double zenith_deg = std::acos(nodes.sin_elevation(n)) / kRadPerDeg;
      const LightPath path = look(air(), above_m, zenith_deg, INFINITY);
      const PathRadiance seen = atmosphere.radiance(path);
      double expected = seen.thermal_w_m2_sr_um[b];
      if (path.end == PathEnd::kSurface) {
        ++ground;
        expected += seen.transmittance[b] * planck_radiance_w_m2_sr_um(um[0], kGroundK);
      } else {
        ++sky;
      }
      EXPECT_NEAR(view->front().around.radiance(n)[0], expected, 7e-3 * expected)
          << above_m << " m, " << zenith_deg << " deg";
    }
    EXPECT_GE(sky, 4);
    EXPECT_GE(ground, 15);
  }
}

TEST(AirTarget, HeightsThatDoNotGoTogetherAreRefused) {
  EXPECT_FALSE(
      Environment::make({weather(100), weather(0)}, {{}, {1, false, {}, 1}}, 1, {10}).ok());
  EXPECT_FALSE(Environment::make({weather(2e5)}, {{}}, 1, {10}).ok());
  EXPECT_FALSE(Environment::make({weather(-1)}, {{}}, 1, {10}).ok());
}

// A black plate across the line of sight, partly behind the sea's horizon; its air is taken at 10
// m, which is hidden from 26 km on.
Mesh plate(double high_m, double width_m) {
  Mesh mesh;
  mesh.group = {"plate"};
  mesh.vertex = {{0, -width_m / 2, 0},
                 {0, width_m / 2, 0},
                 {0, width_m / 2, -high_m},
                 {0, -width_m / 2, -high_m}};
  mesh.triangle = {{0, 2, 1}, {0, 3, 2}};
  mesh.triangle_group = {0, 0};
  return mesh;
}

Viewpoint sensor_at(double sensor_m, double along_m) {
  const double turn = along_m / kEarthRadiusM, s = kEarthRadiusM + sensor_m;
  const double x = s * std::sin(turn), y = s * std::cos(turn) - kEarthRadiusM;
  return {0, std::atan2(y, x) / kRadPerDeg, std::hypot(x, y)};
}

double refractivity(double height_m) {
  const AirLevel a = air_at(air(), height_m);
  const double p_hpa = 1e-2 * a.pressure_pa;
  return 1e-6 *
         (77.4784 * p_hpa / a.temperature_k - 1e-6 * a.gas.h2o_ppmv * p_hpa / 1013.25 * 43.476);
}

TEST(HullDown, WhatTheSeaHidesDoesNotCountAndTheRestIsComputed) {
  constexpr double kSensorM = 20, kHighM = 41, kWidthM = 40;
  SceneSpec scene = scene_of(plate(kHighM, kWidthM), grey(1), lwir());
  scene.part[0].two_sided = true;
  scene.spectral_breaks_um = air_band_edges_um(7.5, 12.5);
  const auto simulator = simulator_of(scene);
  for (const bool refraction : {false, true}) {
    auto made =
        Environment::make({weather(0, refraction, {SurfaceBoundary::Kind::kRoughSea, 292, 1, 5})},
                          {{}}, 10, simulator->band_grids()[0].node_um);
    ASSERT_TRUE(made.ok()) << made.status();
    const std::shared_ptr<const Environment> environment = *std::move(made);
    const double bent =
        refraction ? kEarthRadiusM * (refractivity(0) - refractivity(kHighM)) / kHighM : 0;
    const double radius_m = kEarthRadiusM / (1 - bent);
    const double horizon_m = std::sqrt(2 * radius_m * kSensorM);
    for (const double hidden_m : {6.0, 15.0, 25.0, 38.0}) {
      const double along_m = horizon_m + std::sqrt(2 * radius_m * hidden_m);
      const Viewpoint v = sensor_at(kSensorM, along_m);
      ViewRequest r = request(*simulator, 0, v.aspect_elevation_deg, v.range_m, {kSphereK});
      r.condition = {condition(0, SurroundingsKind::kSea)};
      r.environment = environment;
      const auto view = simulator->simulate(r);
      ASSERT_TRUE(view.ok()) << view.status() << " at " << along_m;
      const SignatureResult& row = view->row.front();
      // k changes by 2 % over the heights met; the edge is sampled.
      EXPECT_NEAR(row.projected_area_m2.value / kWidthM, kHighM - hidden_m,
                  0.06 + (refraction ? 0.01 * hidden_m : 0))
          << along_m << " m, refraction " << refraction;
      const double black = planck_band_radiance_w_m2_sr(8, 12, kSphereK);
      EXPECT_NEAR(row.intensity_w_sr.value / row.projected_area_m2.value, black, 1e-3 * black);
      EXPECT_GT(row.apparent_intensity_w_sr.value, 0.1 * black * row.projected_area_m2.value);
      EXPECT_LT(row.apparent_intensity_w_sr.value, black * row.projected_area_m2.value);
      EXPECT_TRUE(std::isfinite(row.contrast_intensity_w_sr.value));
    }
    const Viewpoint far = sensor_at(kSensorM, horizon_m + std::sqrt(2 * radius_m * 44));
    ViewRequest r = request(*simulator, 0, far.aspect_elevation_deg, far.range_m, {kSphereK});
    r.condition = {condition(0, SurroundingsKind::kSea)};
    r.environment = environment;
    const auto refused = simulator->simulate(r);
    ASSERT_FALSE(refused.ok());
    const std::string said(refused.status().message());
    EXPECT_NE(said.find("has nothing of the target in sight: the Earth hides what is lower than 4"),
              std::string::npos)
        << said;
    EXPECT_NE(said.find("highest point is 41 m"), std::string::npos) << said;
  }
}

}  // namespace
}  // namespace irsig
