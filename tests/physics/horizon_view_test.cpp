// Rationale: a row's silhouette, its background and its sunlight end at one horizon: that of rays
// bent as the air of the sweep bends them.
// Expected: what is hidden of a wall by the sphere of the equivalent radius; sky behind a plate
// that stands above the line of sight to the horizon and sea behind one that stands below it, with
// one step; half of the sun's disk where its centre is on the apparent horizon. Source: h = (D -
// sqrt(2 R' h_s))^2 / (2 R'), R' = R / (1 - k), k = -R dn/dh of the lowest air, for straight rays
// above a sphere of radius R', to (h / R)^2 and the change of k over the heights met.
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

// A level strip of a wall that faces forward, from one height to another.
Mesh wall(double low_m, double high_m, double width_m) {
  Mesh mesh;
  mesh.group = {"wall"};
  mesh.vertex = {{0, -width_m / 2, -low_m},
                 {0, width_m / 2, -low_m},
                 {0, width_m / 2, -high_m},
                 {0, -width_m / 2, -high_m}};
  mesh.triangle = {{0, 2, 1}, {0, 3, 2}};
  mesh.triangle_group = {0, 0};
  return mesh;
}

// Returns the viewpoint of a sensor at this height above a place at this distance, at the wall's
// foot.
Viewpoint from(double sensor_m, double along_m) {
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

double equivalent_radius_m(bool refraction, double sensor_m) {
  const double k =
      refraction ? kEarthRadiusM * (refractivity(0) - refractivity(sensor_m)) / sensor_m : 0;
  return kEarthRadiusM / (1 - k);
}

// Height at which the line of sight that touches the sea passes a place.
double passes_m(double sensor_m, double along_m, double radius_m) {
  return std::pow(along_m - std::sqrt(2 * radius_m * sensor_m), 2) / (2 * radius_m);
}

struct Seen {
  double area_m2, background_w_m2_sr;
  // Errors of the contrast: bound of the background's interpolation, and model error.
  double background_bound_w_sr, model_error_w_sr;
};

Seen look_at(const Mesh& mesh, const Viewpoint& viewpoint, int refraction,
             ConditionSpec condition = {}) {
  SceneSpec scene = scene_of(mesh, grey(1), {"MWIR", 3.5, 4.1, 0.3, {}});
  scene.part[0].two_sided = true;
  scene.spectral_breaks_um = air_band_edges_um(3.2, 4.4);
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, viewpoint.aspect_azimuth_deg, viewpoint.aspect_elevation_deg,
                          viewpoint.range_m, {295});
  condition.part_temperature_k = {295};
  r.condition = {condition};
  r.accuracy.samples_per_replicate = 1024;
  if (refraction >= 0) {
    WeatherSpec w{{air(), {AerosolKind::kMaritime, 50e3}},
                  refraction > 0,
                  {SurfaceBoundary::Kind::kRoughSea, 292, 1, 5},
                  nullptr};
    std::vector<double> node_um = simulator->band_grids()[0].node_um;
    auto made = Environment::make({w}, {{0, condition.sun, condition.sun_direction, 1}}, 10,
                                  std::move(node_um));
    EXPECT_TRUE(made.ok()) << made.status();
    r.environment = *std::move(made);
    r.condition[0].surroundings.kind = SurroundingsKind::kSea;
    r.condition[0].sea_wind_m_s = 5;
  }
  const SignatureResult row = only_row(*simulator, r);
  return {row.projected_area_m2.value, row.background_radiance_w_m2_sr.value,
          row.background_bound_w_sr, row.contrast_model_error_w_sr};
}

TEST(HorizonView, RefractionHidesLess) {
  constexpr double kSensorM = 20, kAlongM = 26e3, kHighM = 14, kWidthM = 100;
  double hidden_m[2];
  for (const int refraction : {0, 1}) {
    const double expected_m =
        passes_m(kSensorM, kAlongM, equivalent_radius_m(refraction > 0, kSensorM));
    const Seen seen = look_at(wall(0, kHighM, kWidthM), from(kSensorM, kAlongM), refraction);
    hidden_m[refraction] = kHighM - seen.area_m2 / kWidthM;
    // k changes by 2 % over the heights met, which is 0.02 m here; sampling of the edge 0.01 m.
    EXPECT_NEAR(hidden_m[refraction], expected_m, 0.05) << "refraction " << refraction;
  }
  EXPECT_GT(hidden_m[0] - hidden_m[1], 2.5) << "a third of what is hidden";
}

// Lines from high on the wall go on behind the sensor and meet the sea there.
TEST(HorizonView, ALowSensorSeesAHighWall) {
  constexpr double kSensorM = 2.7, kHighM = 22, kWidthM = 100;
  ConditionSpec c;
  c.surroundings = {SurroundingsKind::kSea, 150, 0, 290, 1, 0};
  for (const int refraction : {-1, 0, 1})
    for (const double along_m : {2e3, 5e3, 6.5e3, 12e3}) {
      const double radius_m = equivalent_radius_m(refraction > 0, kSensorM);
      const bool beyond = along_m > std::sqrt(2 * radius_m * kSensorM);
      const double expected_m = beyond ? passes_m(kSensorM, along_m, radius_m) : 0;
      const Seen seen = look_at(wall(0, kHighM, kWidthM), from(kSensorM, along_m), refraction, c);
      EXPECT_NEAR(kHighM - seen.area_m2 / kWidthM, expected_m, 0.05)
          << "refraction " << refraction << ", at " << along_m << " m";
    }
}

TEST(HorizonView, OneStepOfTheBackgroundAtTheDip) {
  constexpr double kSensorM = 10, kAlongM = 5e3;
  for (const int refraction : {-1, 0, 1}) {  // -1: no atmosphere
    ConditionSpec c;
    c.surroundings = {SurroundingsKind::kSea, 150, 0, 350, 1, 0};
    if (refraction >= 0) {  // the sun low behind the target: glitter on the sea
      c.sun = true;
      c.sun_direction = normalized(Vec<Body>{-1, 0, -std::tan(9.8 * kRadPerDeg)});
      c.sun_cos_zenith = -c.sun_direction.z;
      c.sun_angular_radius_deg = 0.266;
      c.sun_scale = 1;
    }
    const double step_m =
        passes_m(kSensorM, kAlongM, equivalent_radius_m(refraction > 0, kSensorM));
    EXPECT_GT(step_m, 3) << "well below the sensor: above it the sky begins at the horizontal";
    const auto background = [&](double height_m) {
      return look_at(wall(height_m - 0.01, height_m + 0.01, 1), from(kSensorM, kAlongM), refraction,
                     c)
          .background_w_m2_sr;
    };
    std::vector<double> sky, sea;
    for (const double away_m : {0.05, 0.3, 1.5}) {
      sky.push_back(background(step_m + away_m));
      sea.push_back(background(step_m - away_m));
    }
    sky.push_back(background(7));  // below the sensor, above the line to the horizon
    for (const double b : sky) EXPECT_LT(b, 0.4 * sea.front()) << "refraction " << refraction;
    for (const double b : sea) EXPECT_GT(b, 0.5 * sea.front()) << "refraction " << refraction;
    if (refraction < 0) {
      EXPECT_NEAR(sky[0], planck_band_radiance_w_m2_sr(3.5, 4.1, 150), 1e-5 * sky[0]);
      EXPECT_NEAR(sea[0], planck_band_radiance_w_m2_sr(3.5, 4.1, 350), 1e-5 * sea[0]);
    } else {
      EXPECT_NEAR(sky[0] / sky[3], 1, 0.1) << "the sky changes slowly";
    }
  }
}

// Each strip has directions of its own between which its background is interpolated.
TEST(HorizonView, BackgroundOfAWallIsThatOfItsStripsWithinBounds) {
  constexpr int kStrips = 10;
  struct Case {
    double sensor_m, along_m, high_m, least_model_error;  // the last: of the background
  };
  double worst = 0;
  // Sea without glitter is known to a few percent, the clear sky at 3.5 to 4.1 um to some 40 %.
  for (const Case& c : {Case{30, 500, 24, 0.02}, Case{10, 2000, 60, 0.2}, Case{2, 300, 40, 0.2},
                        Case{200, 1000, 150, 0.02}}) {
    const Viewpoint viewpoint = from(c.sensor_m, c.along_m);
    const Seen whole = look_at(wall(0, c.high_m, 1), viewpoint, 1);
    double sum_w_sr = 0, bounds_w_sr = whole.background_bound_w_sr, area_m2 = 0;
    for (int i = 0; i < kStrips; ++i) {
      const Seen s =
          look_at(wall(c.high_m * i / kStrips, c.high_m * (i + 1) / kStrips, 1), viewpoint, 1);
      sum_w_sr += s.area_m2 * s.background_w_m2_sr;
      area_m2 += s.area_m2;
      bounds_w_sr += s.background_bound_w_sr;
    }
    // Per area: the edges of strips are sampled, too.
    const double off_w_sr = area_m2 * whole.background_w_m2_sr - sum_w_sr;
    worst = std::max(worst, std::abs(off_w_sr) / bounds_w_sr);
    EXPECT_LT(std::abs(off_w_sr), bounds_w_sr) << c.sensor_m << " m, " << c.along_m << " m";
    EXPECT_LT(bounds_w_sr, 1e-3 * sum_w_sr) << c.sensor_m << " m, " << c.along_m << " m";
    EXPECT_GT(whole.model_error_w_sr, c.least_model_error * sum_w_sr)
        << c.sensor_m << " m, " << c.along_m << " m";
  }
  EXPECT_GT(worst, 0.1) << "a bound a tenth as wide would pass";
}

TEST(HorizonView, TheSunsDiskIsCutByTheApparentHorizon) {
  constexpr double kHeightM = 7, kRadiusDeg = 0.266;
  for (const bool refraction : {false, true}) {
    WeatherSpec w{{air(), {AerosolKind::kMaritime, 50e3}},
                  refraction,
                  {SurfaceBoundary::Kind::kRoughSea, 292, 1, 5},
                  nullptr};
    // The place where the sea ends, and the end of a ray that leaves there for the sun.
    double above = 90, below = 91;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (above + below);
      const bool meets =
          look(air(), kHeightM, middle, INFINITY, refraction).end == PathEnd::kSurface;
      (meets ? below : above) = middle;
    }
    const double horizon_deg =
        90 - above - look(air(), kHeightM, above - 1e-5, INFINITY, refraction).bending_deg;
    EXPECT_NEAR(horizon_deg, refraction ? -0.65 : -0.085, refraction ? 0.1 : 0.002);
    std::vector<ConditionEnvironment> conditions;
    const std::vector<double> offset = {-1.5, -0.99, -0.5, 0, 0.5, 0.99, 2.5, 20};
    for (const double radii : offset) {
      const double e = (horizon_deg + radii * kRadiusDeg) * kRadPerDeg;
      conditions.push_back({0, true, {std::cos(e), 0, -std::sin(e)}, 1.0018});
    }
    const auto made = Environment::make({w}, conditions, kHeightM, {3.9});
    ASSERT_TRUE(made.ok()) << made.status();
    double last_z = 1;
    for (std::uint32_t i = 0; i < offset.size(); ++i) {
      const Environment::SunSeen& seen = (*made)->sun_seen(i);
      const double x = std::clamp(offset[i], -1.0, 1.0);
      const double share = 0.5 + (x * std::sqrt(1 - x * x) + std::asin(x)) / std::numbers::pi;
      // Above the horizon refraction lifts the disk less than at it: by a fifth of the difference.
      EXPECT_NEAR(seen.visible, share, x > 0 && refraction ? 0.1 : 2e-3) << offset[i];
      EXPECT_LT(seen.direction.z, last_z);
      last_z = seen.direction.z;
    }
    // High up next to nothing is left of it.
    const double lifted_deg = std::asin(-last_z) / kRadPerDeg - horizon_deg - 20 * kRadiusDeg;
    EXPECT_NEAR(lifted_deg, refraction ? 0.15 : 0, refraction ? 0.05 : 1e-9);
  }
}

// A level mirror beside the sun sees one direction of the sky: turned with sun and sensor, the
// world is the same, and the nodes between which the sky is interpolated are not.
TEST(HorizonView, AMirrorsSkyIsWithinItsErrorHoweverTheWorldIsTurned) {
  CookTorrance mirror;
  mirror.constants = {{2, 1.5, 7}, {15, 1.5, 7}};
  mirror.roughness = 0.01;
  Mesh plate;
  plate.group = {"plate"};
  plate.vertex = {{-1, -1, -2}, {1, -1, -2}, {1, 1, -2}, {-1, 1, -2}};
  plate.triangle = {{0, 2, 1}, {0, 3, 2}};
  plate.triangle_group = {0, 0};
  SceneSpec scene = scene_of(plate, {"m", mirror}, {"MWIR", 3.5, 4.1, 0.3, {}});
  scene.part[0].two_sided = true;
  scene.spectral_breaks_um = air_band_edges_um(3.2, 4.4);
  const auto simulator = simulator_of(scene);
  std::vector<double> value, error;
  for (const double turn_deg : {0.0, 3.0, 7.5}) {
    const double z = 41.5 * kRadPerDeg, a = (100 + turn_deg) * kRadPerDeg;
    const Vec<Body> sun{std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), -std::cos(z)};
    ViewRequest r = request(*simulator, std::fmod(290 + turn_deg, 360), 40, 1000, {290});
    r.accuracy.samples_per_replicate = 4096;
    const WeatherSpec w{{air(), {AerosolKind::kMaritime, 23e3}},
                        true,
                        {SurfaceBoundary::Kind::kRoughSea, 290, 1, 5},
                        nullptr};
    auto made = Environment::make({w}, {{0, true, sun, 1}}, 5, simulator->band_grids()[0].node_um);
    ASSERT_TRUE(made.ok()) << made.status();
    r.environment = *std::move(made);
    ConditionSpec& c = r.condition[0];
    c.surroundings.kind = SurroundingsKind::kSea;
    c.sea_wind_m_s = 5;
    c.sun = true;
    c.sun_direction = r.environment->sun_seen(0).direction;
    c.sun_cos_zenith = -c.sun_direction.z;
    c.sun_horizon_z = r.environment->sun_seen(0).horizon_z;
    c.sun_angular_radius_deg = 0.266;
    c.sun_scale = 1;
    r.max_reflections = 1;
    const SignatureResult row = only_row(*simulator, r);
    value.push_back(row.intensity_w_sr.value);
    error.push_back(row.numerical_error_w_sr);
  }
  const auto [low, high] = std::minmax_element(value.begin(), value.end());
  const double most = *std::max_element(error.begin(), error.end());
  EXPECT_GT(*high - *low, 0.01 * *low) << "the nodes matter";
  EXPECT_LT(*high - *low, 2 * most);
  EXPECT_LT(most, 0.2 * *low);
}

// A wall that faces the setting sun: half of the disk gives half of the light.
TEST(HorizonView, ASetHalfOfTheDiskGivesNoLight) {
  const auto simulator = simulator_of(scene_of(wall(0, 1, 1), grey(0.5), mwir()));
  const auto lit = [&](double elevation_deg) {
    ViewRequest r = request(*simulator, 0, 0, 1000, {1});
    ConditionSpec& c = r.condition[0];
    c.surroundings = {SurroundingsKind::kSea, 1, 0, 1, 1, 0};
    c.sun = true;
    const double e = elevation_deg * kRadPerDeg;
    c.sun_direction = {std::cos(e), 0, -std::sin(e)};
    c.sun_cos_zenith = std::sin(e);
    c.sun_angular_radius_deg = 0.266;
    c.sun_scale = 1;
    c.sun_horizon_z = std::sin(0.1 * kRadPerDeg);
    r.max_reflections = 1;
    r.accuracy.samples_per_replicate = 4096;
    return only_row(*simulator, r).cause_w_sr[static_cast<std::size_t>(Cause::kSunReflected)].value;
  };
  const double whole = lit(0.3);
  EXPECT_GT(whole, 0);
  EXPECT_NEAR(lit(-0.1) / whole, 0.5, 0.01);
  EXPECT_NEAR(lit(-0.1 + 0.133) / whole, 0.8045, 0.01);  // half a radius up
  EXPECT_NEAR(lit(-0.1 - 0.133) / whole, 0.1955, 0.01);
  EXPECT_EQ(lit(-0.1 - 0.267), 0);
}

}  // namespace
}  // namespace irsig
