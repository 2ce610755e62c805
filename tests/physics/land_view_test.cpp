// Rationale: land takes the place of the ground in all that a view computes: the light that the
// target reflects, the sun and sky around it, what hides it and what stands behind it.
// Expected: flat land of one material is the ground with its temperature and emissivity; a world of
// one temperature is black; a wall hides, shades and is mirrored by its closed form.
// Source: the ground of core/environment; Kirchhoff, Planck; solid angles.
#include <cmath>
#include <numbers>

#include "core/atmosphere/light_path.h"
#include "core/sources/land.h"
#include "core/spectral/planck.h"
#include "land_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

// Makes a scene by day below a plain sky of 200 K without air, before a black ground of 150 K.
Scene plain_scene(double elevation_deg) {
  Scene out = scene_on(elevation_deg, 600, true);
  out.request.environment = nullptr;
  ConditionSpec& c = out.request.condition[0];
  c.surroundings = {SurroundingsKind::kGround, 200, 0, 150, 1, 0};
  return out;
}

TEST(LandView, FlatLandOfOneMaterialIsTheGround) {
  for (const double elevation_deg : {5.0, 25.0, 70.0})
    for (const bool sun : {false, true}) {
      Scene scene = scene_on(elevation_deg, 1500, sun);
      const ViewResult ground = view_of(scene, nullptr), land = view_of(scene, land_of(flat));
      ASSERT_EQ(ground.row.size(), land.row.size());
      for (std::size_t i = 0; i < ground.row.size(); ++i) {
        const SignatureResult &a = ground.row[i], &b = land.row[i];
        std::printf("%4g deg %s %s:", elevation_deg, sun ? "day  " : "night",
                    i == 0 ? "8-12" : "3-5 ");
        const auto same = [&](const char* what, const Estimate& x, const Estimate& y, double of) {
          const double error = std::abs(y.value - x.value);
          std::printf("  %s %.2e (%.1f)", what, error / of,
                      error / std::hypot(x.stderr_, y.stderr_));
          // The target shades the land, and not the ground.
          const double shadow = sun ? 2e-3 : 0;
          EXPECT_LT(error, (1e-4 + shadow) * of + 3 * std::hypot(x.stderr_, y.stderr_)) << what;
        };
        const double of = std::abs(a.intensity_w_sr.value);
        same("source", a.intensity_w_sr, b.intensity_w_sr, of);
        same("apparent", a.apparent_intensity_w_sr, b.apparent_intensity_w_sr, of);
        same("contrast", a.contrast_intensity_w_sr, b.contrast_intensity_w_sr, of);
        same("background", a.background_radiance_w_m2_sr, b.background_radiance_w_m2_sr,
             a.background_radiance_w_m2_sr.value);
        EXPECT_NEAR(b.contrast_model_error_w_sr, a.contrast_model_error_w_sr,
                    0.02 * a.contrast_model_error_w_sr);
        std::printf("  model error %.3g, %.3g W/sr\n", a.contrast_model_error_w_sr,
                    b.contrast_model_error_w_sr);
      }
    }
}

TEST(LandView, AWorldOfOneTemperatureIsABlackbody) {
  Scene scene = scene_on(12, 800, false, 290);
  const auto hills =
      land_of([](double x,
                 double y) { return 30 * std::sin(x / 130) * std::cos(y / 170) + 4 * std::sin(x); },
              5000, 20);
  const ViewResult view = view_of(scene, hills);
  ASSERT_EQ(view.row.size(), 2u);
  for (const SignatureResult& r : view.row) {
    const double black = (r.band == 0 ? planck_band_radiance_w_m2_sr(8, 12, 290)
                                      : planck_band_radiance_w_m2_sr(3.2, 5, 290));
    // The sky is colder: what level land reflects of it is all that is missing.
    const double background = r.background_radiance_w_m2_sr.value;
    EXPECT_LT(background, black * 1.0005);
    EXPECT_GT(background, black * 0.90);
  }
}

TEST(LandView, ARidgeHidesTheTarget) {
  Scene scene = scene_on(3, 1500, false);
  // The sensor is at azimuth 70 from the bow, which points to 30.
  const auto high = land_of(wall(200, 60, 100));
  scene.request.land = high;
  const auto hidden = scene.simulator->simulate(scene.request);
  ASSERT_FALSE(hidden.ok());
  EXPECT_NE(hidden.status().message().find("land hides all of it"), std::string::npos)
      << hidden.status();
  const ViewResult behind = view_of(scene, land_of(wall(200, 60, 280)));
  EXPECT_GT(behind.row.front().projected_area_m2.value, 5);
}

// A level bank hides the lower part of a face: what is seen of it is the closed form.
TEST(LandView, ABankHidesTheLowerPart) {
  Scene scene = scene_on(1, 20'000, false);
  scene.request.accuracy.samples_per_replicate = 4096;
  const double whole = view_of(scene, land_of(flat)).row[0].projected_area_m2.value;
  // The box reaches from 2 to 4 m above the land at its place; sight rises by 1 deg.
  const double edge_m = 30, bank_m = 3 + edge_m * std::tan(1 * kRadPerDeg);
  const ViewResult view = view_of(scene, land_of(wall(edge_m - 1, bank_m, 100), 200, 1));
  const SignatureResult& r = view.row[0];
  EXPECT_GT(r.projected_area_m2.value, 0.4 * whole);
  EXPECT_LT(r.projected_area_m2.value, 0.6 * whole);
  EXPECT_NEAR(r.clutter->visible_fraction, r.projected_area_m2.value / whole, 2e-3);
}

// A mast beyond the horizon of a low sensor, in air that bends rays: a smooth Earth as land hides
// of it what the ground hides.
TEST(LandView, SmoothLandHidesAsTheGroundDoes) {
  Scene scene = scene_on(5, 1500, false);
  SceneSpec spec = scene_of(generated("box", 300, 0, 2, 2, 40), grey(0.6), lwir());
  spec.spectral_breaks_um = air_band_edges_um(8, 12);
  spec.land_material = {grey(kEmissivity)};
  scene.simulator = simulator_of(spec);
  ConditionSpec& c = scene.request.condition[0];
  c.above_surface_m = 20;
  c.part_temperature_k = {kTargetK};
  scene.request.selected_band = {0};
  const auto land = land_of(flat, 40'000, 200);
  for (const double range_m : {2e3, 12e3, 20e3, 25e3}) {
    // The sensor is 6 m above the ground.
    const double elevation_deg =
        std::asin((6 - 20 - range_m * range_m / (2 * kEarthRadiusM)) / range_m) / kRadPerDeg;
    scene.request.viewpoint = {70, elevation_deg, range_m};
    scene.request.seed = 3;
    WeatherSpec weather = scene_weather();
    weather.above_surface_m = 20;
    auto made = Environment::make({weather}, {{0, false, c.sun_direction, 1}}, 20,
                                  scene.simulator->band_grids().front().node_um);
    ASSERT_TRUE(made.ok()) << made.status();
    scene.request.environment = *std::move(made);
    const Estimate ground = view_of(scene, nullptr).row[0].projected_area_m2,
                   over = view_of(scene, land).row[0].projected_area_m2;
    std::printf("%5g m: %.3f m2 above the ground, %.3f above land\n", range_m, ground.value,
                over.value);
    EXPECT_NEAR(over.value, ground.value, 1e-3 * 103 + 4 * std::hypot(ground.stderr_, over.stderr_))
        << range_m;
  }
}

// The horizon of a sensor over a smooth Earth, 2 m to 30 km high, is where the ray that touches it
// arrives.
TEST(LandView, TheHorizonIsThatOfBentRays) {
  WeatherSpec weather = scene_weather();
  weather.above_surface_m = 1;
  const GrazingRay ray(weather.air.profile);
  auto made = Environment::make({weather}, {{0, false, {0, 0, -1}, 1}}, 1, {10});
  ASSERT_TRUE(made.ok()) << made.status();
  for (const auto& [height_m, half_m, spacing_m] :
       {std::array{2.0, 12e3, 25.0}, std::array{10.0, 20e3, 25.0}, std::array{200.0, 80e3, 125.0},
        std::array{3000.0, 300e3, 500.0}, std::array{30e3, 800e3, 1000.0}}) {
    HeightGrid grid{-half_m, -half_m, spacing_m, 0, 0, {}};
    grid.columns = grid.rows = static_cast<std::uint32_t>(2 * half_m / spacing_m);
    for (std::uint32_t row = 0; row <= grid.rows; ++row)
      for (std::uint32_t column = 0; column <= grid.columns; ++column) {
        const double x = grid.west_m + column * spacing_m, y = grid.south_m + row * spacing_m;
        grid.z_m.push_back(static_cast<float>(
            std::sqrt(kEarthRadiusM * kEarthRadiusM - x * x - y * y) - kEarthRadiusM));
      }
    auto field = HeightField::create(std::move(grid));
    ASSERT_TRUE(field.ok()) << field.status();
    auto scene = std::make_shared<LandScene>();
    scene->field = std::make_shared<const HeightField>(*std::move(field));
    // Nearly straight above the target.
    const double along_m = 1e-3 * height_m, up_m = height_m - weather.above_surface_m;
    const Viewpoint above{0, std::atan2(up_m, along_m) / kRadPerDeg, std::hypot(up_m, along_m)};
    const double bend_per_m =
        Land::bend_of((*made)->horizon((*made)->line(above)), height_m, along_m);
    const Land land(scene, 0, {0, 0, 0}, {}, bend_per_m);
    const Vec<Body> sensor{0, 0, -height_m};
    LandMix mix;
    const auto met = [&](double below) {
      const Vec<Body> down{0.6 * std::cos(below), 0.8 * std::cos(below), std::sin(below)};
      return land.meet_in_sight(sensor, sensor, down, mix).has_value();
    };
    double low = 0, high = 0.3;
    while (high - low > 1e-8) (met(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
    const double dip = ray.dip_rad(height_m);
    // Between the horizon and the nadir: where the traced ray meets the Earth. The angle is that
    // under which both places lie apart for the sensor.
    double apart_rad = 0, across_m = 0;
    for (const double depression :
         {1.01 * dip, 1.03 * dip, 1.1 * dip, 1.5 * dip, 3 * dip, 0.4, 1.2}) {
      const auto hit = land.meet_in_sight(
          sensor, sensor,
          {0.6 * std::cos(depression), 0.8 * std::cos(depression), std::sin(depression)}, mix);
      ASSERT_TRUE(hit.has_value());
      const LightPath path =
          look(weather.air.profile, height_m, 90 + depression / kRadPerDeg, INFINITY);
      ASSERT_EQ(path.end, PathEnd::kSurface);
      const double traced_m =
                       kEarthRadiusM * std::sin(path.node.back().central_angle_deg * kRadPerDeg),
                   found_m = hit->distance * std::cos(depression);
      // Along the ground, as seen from the sensor.
      const double apart = std::abs(traced_m - found_m) * std::sin(depression);
      across_m = std::max(across_m, apart);
      apart_rad = std::max(apart_rad, apart / hit->distance);
    }
    std::printf("         places below it: %.2e rad, %.3g m across the ray\n", apart_rad, across_m);
    EXPECT_LT(apart_rad, 1e-5 + 1e-7 * height_m) << height_m;
    std::printf("%6g m: horizon %.3e rad lower than the closed form, %.3e straight\n", height_m,
                high - dip, std::acos(kEarthRadiusM / (kEarthRadiusM + height_m)) - dip);
    EXPECT_NEAR(high, dip, 2e-5) << height_m;
  }
}

// The sun stands at an elevation of 53 deg; a wall above the line to it takes it away.
TEST(LandView, AWallShadesTheTarget) {
  Scene scene = scene_on(70, 1500, true);
  const ConditionSpec& c = scene.request.condition[0];
  const double azimuth_deg = 30 + std::atan2(c.sun_direction.y, c.sun_direction.x) / kRadPerDeg;
  const double tangent = -c.sun_direction.z / std::hypot(c.sun_direction.x, c.sun_direction.y);
  const auto sunlit = [&](double height_m) {
    const ViewResult view = view_of(scene, land_of(wall(50, height_m, azimuth_deg), 2000, 10));
    return view.row[1].cause_w_sr[static_cast<std::size_t>(Cause::kSunReflected)].value;
  };
  const double open = sunlit(0);
  EXPECT_GT(open, 0);
  EXPECT_NEAR(sunlit(40 * tangent), open, 1e-6 * open);
  EXPECT_EQ(sunlit(80 * tangent), 0);
}

// Stripes of two materials, warm and cold, across the line of sight: the fractions, the scatter and
// the mean of the window are those of the two radiances.
TEST(LandView, StripesAreTheirClosedForm) {
  constexpr double kColdK = 280, kWarmK = 300, kStripeM = 8;
  Scene scene = scene_on(60, 1000, false);
  SceneSpec spec = scene_of(generated("box", 300, 0, 4, 3, 2), grey(0.6), lwir());
  spec.band.push_back({"MWIR", 3.2, 5, 0.25, {}});
  spec.spectral_breaks_um = air_band_edges_um(3, 13);
  spec.land_material = {grey(kEmissivity), grey(kEmissivity)};
  scene.simulator = simulator_of(spec);
  scene.request.condition[0].land_temperature_k = {kWarmK, kColdK};
  const auto land = std::make_shared<LandScene>(*land_of(flat, 200, 5));
  HeightRaster warm{LocalMetres{}, -250, -250, 0.5, 0.5, 1001, 1001, {}};
  for (std::uint32_t row = 0; row < warm.rows; ++row)
    for (std::uint32_t column = 0; column < warm.columns; ++column)
      warm.height_m.push_back(
          std::lround(std::floor((warm.x0 + column * warm.x_step) / kStripeM)) % 2 == 0 ? 1.0f
                                                                                        : 0.0f);
  auto cover =
      LandCover::create(std::vector<CoverLayer>{{"warm", warm}, {"cold"}}, *land->field, {});
  ASSERT_TRUE(cover.ok()) << cover.status();
  land->cover = *std::move(cover);
  const ViewResult view = view_of(scene, land);
  double level[2][2];  // [band][material]
  for (int material = 0; material < 2; ++material) {
    Scene plain = scene_on(60, 1000, false);
    plain.request.condition[0].land_temperature_k = {material == 0 ? kWarmK : kColdK};
    const ViewResult one = view_of(plain, land_of(flat, 200, 5));
    for (int band = 0; band < 2; ++band) {
      level[band][material] = one.row[band].background_radiance_w_m2_sr.value;
      EXPECT_LT(one.row[band].clutter->clutter_sigma_w_m2_sr.value, 2e-3 * level[band][material]);
      EXPECT_NEAR(one.row[band].clutter->clutter_mean_w_m2_sr.value, level[band][material],
                  2e-3 * level[band][material]);
    }
  }
  for (int band = 0; band < 2; ++band) {
    ASSERT_TRUE(view.row[band].clutter.has_value());
    const BackgroundClutter& c = *view.row[band].clutter;
    const double f = c.material_fraction[0], step = level[band][0] - level[band][1];
    EXPECT_NEAR(c.material_fraction[0] + c.material_fraction[1], 1, 1e-5);
    EXPECT_NEAR(f, 0.5, 0.1);
    EXPECT_NEAR(c.clutter_mean_w_m2_sr.value, level[band][1] + f * step, 5e-3 * step);
    // Pixels of 0.7 m on edges between stripes scatter less.
    EXPECT_NEAR(c.clutter_sigma_w_m2_sr.value, std::sqrt(f * (1 - f)) * step, 0.05 * step);
    EXPECT_LT(c.clutter_sigma_w_m2_sr.value, 0.52 * step);
    // Behind the box are both: between the levels.
    const double behind = view.row[band].background_radiance_w_m2_sr.value;
    EXPECT_GT(behind, level[band][1] - 1e-3 * step);
    EXPECT_LT(behind, level[band][0] + 1e-3 * step);
    EXPECT_NEAR(c.visible_fraction, 1, 1e-6);
  }
}

// Rationale: materials of land have emissivities of their own.
// Expected: where the second of two covers all, the view is that of land of it alone; the share of
// the first is dark, as is all land whose light is left out.
TEST(LandView, EachMaterialHasItsOwnEmissivity) {
  const auto seen = [](const std::vector<MaterialSpec>& materials, const EffectChoice& effects) {
    Scene scene = plain_scene(50);
    SceneSpec spec = scene_of(generated("box", 12, 0, 4, 3, 2), grey(0.6), lwir());
    spec.land_material = materials;
    scene.simulator = simulator_of(spec);
    scene.request.selected_band = {0};
    scene.request.accuracy.samples_per_replicate = 256;
    scene.request.effects = effects;
    ConditionSpec& c = scene.request.condition[0];
    c.sun = false;
    c.land_temperature_k.assign(materials.size(), kGroundK);
    const auto land = std::make_shared<LandScene>(*land_of(flat));
    HeightRaster none{LocalMetres{}, -10'000, -10'000, 1000, 1000, 21, 21, {}};
    none.height_m.assign(441, 0.0f);
    std::vector<CoverLayer> layers{{"first", none}, {"second"}};
    if (materials.size() == 1) layers = {{"second"}};
    auto cover = LandCover::create(layers, *land->field, {});
    EXPECT_TRUE(cover.ok()) << cover.status();
    land->cover = *std::move(cover);
    return view_of(scene, land).row[0];
  };
  const SignatureResult two = seen({grey(0.95), grey(0.5)}, {}), one = seen({grey(0.5)}, {});
  const double of_land = one.background_radiance_w_m2_sr.value;
  EXPECT_GT(of_land, 0);
  EXPECT_NEAR(two.background_radiance_w_m2_sr.value, of_land, 1e-6 * of_land);
  const auto reflected = [](const SignatureResult& row) {
    return row.cause_w_sr[static_cast<std::size_t>(Cause::kSeaReflected)].value;
  };
  EXPECT_GT(reflected(one), 0);
  EXPECT_NEAR(reflected(two), reflected(one), 1e-6 * reflected(one));
  EffectChoice no_land;
  no_land.mode = EffectChoice::Mode::kOnly;
  no_land.only = {Effect::kSkyReflected};
  EXPECT_EQ(reflected(seen({grey(0.5)}, no_land)), 0);
}

// The world may be turned: land by a quarter, the bow and the sun with it.
TEST(LandView, TurningTheWorldChangesNothing) {
  const Height hills = [](double x, double y) {
    return 6 * std::sin(x / 40) + 5 * std::cos(y / 55) + 0.03 * x - 0.02 * y;
  };
  ViewResult view[2];
  for (int turn = 0; turn < 2; ++turn) {
    Scene scene = scene_on(35, 700, true);
    auto land = std::make_shared<LandScene>(*land_of(
        [&](double x, double y) { return turn == 0 ? hills(x, y) : hills(y, -x); }, 2000, 4));
    land->heading_deg = turn == 0 ? 30 : -60;
    view[turn] = view_of(scene, land);
  }
  for (std::size_t row = 0; row < 2; ++row) {
    const SignatureResult &a = view[0].row[row], &b = view[1].row[row];
    const auto same = [](const Estimate& x, const Estimate& y, double of) {
      EXPECT_LT(std::abs(x.value - y.value), 4 * std::hypot(x.stderr_, y.stderr_) + 1e-4 * of);
    };
    same(a.intensity_w_sr, b.intensity_w_sr, a.intensity_w_sr.value);
    same(a.contrast_intensity_w_sr, b.contrast_intensity_w_sr, a.apparent_intensity_w_sr.value);
    same(a.background_radiance_w_m2_sr, b.background_radiance_w_m2_sr,
         a.background_radiance_w_m2_sr.value);
    EXPECT_NEAR(a.clutter->clutter_sigma_w_m2_sr.value, b.clutter->clutter_sigma_w_m2_sr.value,
                0.05 * a.clutter->clutter_sigma_w_m2_sr.value);
  }
}

// Land that is hot beside a cold ground is no effect to leave out.
TEST(LandView, HotLandIsNotLeftOut) {
  Scene scene = scene_on(30, 900, true);
  scene.request.condition[0].land_temperature_k = {390};
  scene.request.condition[0].part_temperature_k = {250};
  scene.request.accuracy.samples_per_replicate = 0;
  scene.request.accuracy.relative_error = 0.02;
  const auto land = land_of(flat);
  const ViewResult all = view_of(scene, land);
  scene.request.effects.mode = EffectChoice::Mode::kAuto;
  const ViewResult automatic = view_of(scene, land);
  for (std::size_t i = 0; i < 2; ++i) {
    const SignatureResult &a = all.row[i], &b = automatic.row[i];
    EXPECT_LT(std::abs(a.intensity_w_sr.value - b.intensity_w_sr.value),
              3 * std::hypot(a.numerical_error_w_sr, b.numerical_error_w_sr));
    EXPECT_LT(std::abs(a.contrast_intensity_w_sr.value - b.contrast_intensity_w_sr.value),
              3 * std::hypot(a.contrast_numerical_error_w_sr, b.contrast_numerical_error_w_sr));
  }
}

// Below a plain sky without air, on land that is hotter than all around it.
TEST(LandView, HotLandBesideADarkGroundIsNotLeftOut) {
  Scene scene = plain_scene(30);
  scene.request.condition[0].sun = false;
  scene.request.condition[0].surroundings = {SurroundingsKind::kGround, 120, 0, 120, 1, 0};
  scene.request.condition[0].land_temperature_k = {390};
  scene.request.condition[0].part_temperature_k = {280};
  scene.request.accuracy.samples_per_replicate = 0;
  scene.request.accuracy.relative_error = 0.05;
  const auto land = land_of(flat, 500, 10);
  const ViewResult all = view_of(scene, land);
  scene.request.effects.mode = EffectChoice::Mode::kAuto;
  const ViewResult automatic = view_of(scene, land);
  for (std::size_t i = 0; i < 2; ++i) {
    const SignatureResult &a = all.row[i], &b = automatic.row[i];
    const auto lower = static_cast<std::size_t>(Cause::kSeaReflected);
    EXPECT_GT(a.cause_w_sr[lower].value, 0.1 * a.intensity_w_sr.value);
    EXPECT_LT(std::abs(a.intensity_w_sr.value - b.intensity_w_sr.value),
              3 * std::hypot(a.numerical_error_w_sr, b.numerical_error_w_sr));
  }
}

// The land behind the target lies in the shadow of a wall: it is the land of a night.
TEST(LandView, AWallShadesTheLandBehind) {
  Scene scene = plain_scene(60);
  ConditionSpec& c = scene.request.condition[0];
  c.land_temperature_k = {260};
  const double azimuth_deg = 30 + std::atan2(c.sun_direction.y, c.sun_direction.x) / kRadPerDeg;
  const double tangent = -c.sun_direction.z / std::hypot(c.sun_direction.x, c.sun_direction.y);
  const auto behind = [&](double height_m, bool sun) {
    scene.request.condition[0].sun = sun;
    return view_of(scene, land_of(wall(50, height_m, azimuth_deg), 1000, 10))
        .row[1]
        .background_radiance_w_m2_sr.value;
  };
  const double night = behind(0, false), open = behind(0, true);
  EXPECT_GT(open, 1.5 * night);
  EXPECT_NEAR(behind(80 * tangent, true), night, 1e-6 * night);
  EXPECT_NEAR(behind(20 * tangent, true), open, 1e-6 * open);
}

// A picture shows the land, the shadow of the target on it, and nothing of it where the target is.
TEST(LandView, APictureShowsTheShadow) {
  Scene scene = scene_on(60, 400, true);
  ImageSpec image;
  image.width_px = image.height_px = 48;
  image.margin = 1;
  image.layer = {ImageLayer::kBackground, ImageLayer::kHidden, ImageLayer::kAtSensor};
  scene.request.image = image;
  // Sunlight is most of what this land sends in the short band.
  scene.request.condition[0].land_temperature_k = {260};
  const ViewResult view = view_of(scene, land_of(flat, 500, 10));
  const SignatureResult& r = view.row[1];
  const auto layer = [&](ImageLayer which) -> const std::vector<float>& {
    for (const LayerImage& l : r.layer)
      if (l.layer == which) return l.value;
    ADD_FAILURE() << name_of(which);
    return r.layer.front().value;
  };
  const std::vector<float>&background = layer(ImageLayer::kBackground),
        &hidden = layer(ImageLayer::kHidden);
  const auto [dark, bright] = std::minmax_element(background.begin(), background.end());
  EXPECT_LT(*dark, 0.6f * *bright);
  int shaded = 0, covered = 0;
  for (std::size_t i = 0; i < background.size(); ++i) {
    shaded += background[i] < 0.8f * *bright ? 1 : 0;
    // The target hides no more than is there.
    EXPECT_LE(hidden[i], background[i] * 1.05f + 0.02f * *bright);
    covered += hidden[i] > 0.5f * background[i] ? 1 : 0;
  }
  EXPECT_GT(shaded, 20);
  EXPECT_LT(shaded, 48 * 48 / 3);
  EXPECT_GT(covered, 20);
  // At night there is none.
  Scene night = scene_on(60, 400, false);
  night.request.image = image;
  const ViewResult dark_view = view_of(night, land_of(flat, 500, 10));
  for (const LayerImage& l : dark_view.row[1].layer)
    if (l.layer == ImageLayer::kBackground) {
      const auto [low, high] = std::minmax_element(l.value.begin(), l.value.end());
      EXPECT_GT(*low, 0.98f * *high);
    }
}

// Light that leaves the target is absorbed, or escapes to sky, land or ground.
TEST(LandView, EnergyIsBalanced) {
  Scene scene = scene_on(30, 900, true);
  scene.request.max_reflections = 6;
  const ViewResult view = view_of(
      scene, land_of([](double x, double y) { return 8 * std::sin(x / 40) * std::cos(y / 50); }));
  for (const SignatureResult& r : view.row) {
    EXPECT_GT(r.energy.escaped_to_surface.value, 0.01);
    EXPECT_NEAR(r.energy.balance.value, 1, 5 * r.energy.balance.stderr_ + 1e-3);
  }
}

// Suns of other conditions cost no accuracy and change nothing, and tables do not grow with them:
// the land of a condition has the light of its own sun alone.
TEST(LandView, ASunBesideChangesNothing) {
  const auto hills = land_of(
      [](double x, double y) { return 20 * std::sin(x / 90) * std::cos(y / 70); }, 3000, 10);
  Scene scene = scene_on(30, 900, true);
  ImageSpec image;
  image.width_px = image.height_px = 12;
  image.margin = 1;
  image.layer = {ImageLayer::kAtSensor, ImageLayer::kBackground, ImageLayer::kLandSun};
  scene.request.image = image;
  const ViewResult alone = view_of(scene, hills);
  const auto weather = scene_weather();
  std::vector<ConditionEnvironment> suns;
  ConditionSpec first = scene.request.condition[0];
  scene.request.condition.clear();
  scene.request.selected_condition.clear();
  for (std::uint32_t k = 0; k < 3; ++k) {
    ConditionSpec c = first;
    if (k != 1) c.sun_direction = normalized(Vec<Body>{-0.6, 0.1 * k, -0.4});
    c.sun_cos_zenith = -c.sun_direction.z;
    scene.request.condition.push_back(c);
    scene.request.selected_condition.push_back(k);
    suns.push_back({0, true, c.sun_direction, 1});
  }
  std::vector<double> node_um;
  for (const BandGrid& grid : scene.simulator->band_grids())
    node_um.insert(node_um.end(), grid.node_um.begin(), grid.node_um.end());
  auto made = Environment::make({weather}, suns, 6, std::move(node_um));
  ASSERT_TRUE(made.ok()) << made.status();
  scene.request.environment = *std::move(made);
  const ViewResult three = view_of(scene, hills);
  for (std::size_t band = 0; band < 2; ++band) {
    const SignatureResult &a = alone.row[band], &b = three.row[2 + band];
    EXPECT_NEAR(b.intensity_w_sr.value, a.intensity_w_sr.value, 1e-12 * a.intensity_w_sr.value);
    EXPECT_NEAR(b.contrast_intensity_w_sr.value, a.contrast_intensity_w_sr.value,
                1e-9 * a.apparent_intensity_w_sr.value);
    EXPECT_NEAR(b.clutter->clutter_sigma_w_m2_sr.value, a.clutter->clutter_sigma_w_m2_sr.value,
                1e-9 * a.clutter->clutter_mean_w_m2_sr.value);
    EXPECT_NE(three.row[band].clutter->clutter_mean_w_m2_sr.value,
              b.clutter->clutter_mean_w_m2_sr.value);
    ASSERT_EQ(a.layer.size(), b.layer.size());
    for (std::size_t l = 0; l < a.layer.size(); ++l) {
      float brightest = 0;
      for (std::size_t i = 0; i < a.layer[l].value.size(); ++i) {
        brightest = std::max(brightest, a.layer[l].value[i]);
        EXPECT_NEAR(b.layer[l].value[i], a.layer[l].value[i], 1e-6 * a.layer[l].value[i]);
      }
      EXPECT_GT(brightest, 0) << name_of(a.layer[l].layer);
    }
  }
}

// Other conditions change no bit of a row.
TEST(LandView, RowsDoNotDependOnOtherConditions) {
  const auto hills = land_of(
      [](double x, double y) { return 20 * std::sin(x / 90) * std::cos(y / 70); }, 3000, 10);
  Scene scene = scene_on(30, 900, true);
  const ViewResult both = view_of(scene, hills);
  scene.request.selected_band = {1};
  const ViewResult one = view_of(scene, hills);
  EXPECT_EQ(both.row[1].contrast_intensity_w_sr.value, one.row[0].contrast_intensity_w_sr.value);
  EXPECT_EQ(both.row[1].clutter->clutter_sigma_w_m2_sr.value,
            one.row[0].clutter->clutter_sigma_w_m2_sr.value);
}

}  // namespace
}  // namespace irsig
