// Rationale: properties that hold whatever the scene: Kirchhoff's law in an isothermal world,
// standard errors that mean what they
//   say, results that do not depend on what else is computed beside them.
// Expected: stated with each test. Seeds are fixed.
// Source: thermodynamics; Student's t; docs/explanation/methods.md (guarantees).
#include <numbers>

#include "core/spectral/planck.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

SceneSpec frigate(MaterialSpec material) {
  SceneSpec scene = scene_of(generated("frigate", 20000), std::move(material), lwir());
  scene.part = {
      {"ship", {"hull", "deck", "superstructure", "funnel", "mast", "turret"}, 0, false, false},
      {"hot", {"*_*"}, 0, false, true}};
  scene.band.push_back(mwir());
  return scene;
}

Surroundings sea_world(double sky_k, double sea_k, double emissivity) {
  return {SurroundingsKind::kSea, sky_k, 0, sea_k, emissivity, 0};
}

void set_sun(ConditionSpec& c, Vec<Body> direction) {
  c.sun = true;
  c.sun_direction = normalized(direction);
  c.sun_cos_zenith = -c.sun_direction.z;
  c.sun_angular_radius_deg = 0.266;
  c.sun_scale = 0.6;
}

// An isothermal world is black whatever the ship is made of: intensity = projected area x B(T).
// Tests emissivity = 1 - DHR, sampling weights, roulette, splitting, and that no path is lost.
TEST(Kirchhoff, IsothermalWorldIsBlack) {
  CookTorrance iron;
  iron.constants = {{2, 3, 6}, {13, 8, 25}};
  iron.roughness = 0.2;
  CookTorrance smith = iron;
  smith.masking = Masking::kSmith;
  for (const MaterialSpec& material :
       {*builtin_material("hull"), *builtin_material("hull_index"), MaterialSpec{"iron", iron},
        MaterialSpec{"smith", smith}, MaterialSpec{"paint", Lambert{{{2, 0.2}, {13, 0.9}}}}}) {
    const auto simulator = simulator_of(frigate(material));
    ViewRequest r = request(*simulator, 40, 20, 5000, {300, 300});
    r.condition[0].surroundings = sea_world(300, 300, 0.9);
    r.max_reflections = 100;
    r.accuracy.samples_per_replicate = 1024;
    const auto view = simulator->simulate(r);
    ASSERT_TRUE(view.ok());
    for (std::size_t b = 0; b < 2; ++b) {
      const SignatureResult& s = view->row[b];
      const double black = b == 0 ? planck_band_radiance_w_m2_sr(8, 12, 300)
                                  : planck_band_radiance_w_m2_sr(3, 5, 300);
      const double expected = black * s.projected_area_m2.value;
      // Intensity and area share their silhouette; the difference is reflection noise. Tables: 5e-5
      // of the reflected part. A path that starts in a corner behind a facet is lost: counted, at
      // most 2e-4 here.
      expect_within_t(s.intensity_w_sr, expected, 10, material.name + (b == 0 ? " LWIR" : " MWIR"),
                      5e-3, 3e-4 * expected);
      EXPECT_LT(static_cast<double>(view->guarded_backface_hits),
                1e-3 * static_cast<double>(view->target_paths));
    }
  }
}

// A part's or a condition's company does not change its bits: seasons, suns, bands and cutting
// share nothing but paths.
TEST(SameBits, WhateverIsComputedBeside) {
  const auto simulator = simulator_of(frigate(*builtin_material("hull")));
  ViewRequest all = request(*simulator, 100, 12, 5000, {300, 400});
  all.max_reflections = 4;
  all.thumbnail_px = 32;
  all.accuracy.samples_per_replicate = 0;
  all.accuracy.relative_error = 0.01;
  all.condition.assign(3, all.condition[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    all.condition[i].part_temperature_k = {290 + 5.0 * static_cast<double>(i), 400};
    all.condition[i].surroundings = sea_world(250, 285, 0.96);
    set_sun(all.condition[i], {0.2 - 0.3 * static_cast<double>(i), 0.6, -0.7});
  }
  all.selected_condition = {0, 1, 2};
  const auto together = simulator->simulate(all);
  ASSERT_TRUE(together.ok());
  for (std::uint32_t c = 0; c < 3; ++c)
    for (std::uint32_t b = 0; b < 2; ++b) {
      ViewRequest one = all;
      one.selected_condition = {c};
      one.selected_band = {b};
      const auto alone = simulator->simulate(one);
      ASSERT_TRUE(alone.ok());
      const SignatureResult &x = alone->row[0], &y = together->row[2 * c + b];
      EXPECT_EQ(x.intensity_w_sr.value, y.intensity_w_sr.value);
      EXPECT_EQ(x.intensity_w_sr.stderr_, y.intensity_w_sr.stderr_);
      EXPECT_EQ(x.numerical_error_w_sr, y.numerical_error_w_sr);
      EXPECT_EQ(x.spectral.value, y.spectral.value);
      EXPECT_EQ(x.apparent_intensity_w_sr.value, y.apparent_intensity_w_sr.value);
      EXPECT_EQ(x.contrast_intensity_w_sr.stderr_, y.contrast_intensity_w_sr.stderr_);
      EXPECT_EQ(x.contrast_spectral.value, y.contrast_spectral.value);
      EXPECT_EQ(x.image_w_m2_sr, y.image_w_m2_sr);
    }
}

// A material whose table is the same at every wavelength gives what the grey one gives: two code
// paths, one physics.
TEST(SpectralPath, AgreesWithGrey) {
  CookTorrance grey_lobe;
  grey_lobe.constants = {{0, 1.2, 5}};
  CookTorrance flat = grey_lobe;
  flat.constants = {{2, 1.2, 5}, {13, 1.2, 5}};
  const auto a = simulator_of(frigate({"grey", grey_lobe})),
             b = simulator_of(frigate({"flat", flat}));
  ViewRequest r = request(*a, 100, 12, 5000, {300, 400});
  r.max_reflections = 8;
  r.condition[0].surroundings = sea_world(250, 285, 0.96);
  set_sun(r.condition[0], {0.2, 0.6, -0.7});
  r.accuracy.samples_per_replicate = 4096;
  const auto x = a->simulate(r), y = b->simulate(r);
  ASSERT_TRUE(x.ok() && y.ok());
  for (std::size_t row = 0; row < 2; ++row) {
    // Different seeds (the material's definition enters them): compare within both standard errors.
    const Estimate &p = x->row[row].intensity_w_sr, &q = y->row[row].intensity_w_sr;
    EXPECT_LT(std::abs(p.value - q.value),
              student_t_bound(31, 4) * std::hypot(p.stderr_, q.stderr_));
    for (std::size_t c = 0; c < kCauses; ++c) {
      const Estimate &pc = x->row[row].cause_w_sr[c], &qc = y->row[row].cause_w_sr[c];
      EXPECT_LT(std::abs(pc.value - qc.value),
                student_t_bound(31, 20) * std::hypot(pc.stderr_, qc.stderr_) + 1e-12)
          << c;
    }
  }
}

// 400 independent seeds: the 95 % interval covers the truth in 364..393 of them, the mean t is
// within 3.29 / sqrt(400) x its own spread, the mean square t agrees with Student's variance 31/29
// (limits: 0.1 % each, independent arithmetic).
TEST(StandardError, MeansWhatItSays) {
  const auto simulator = simulator_of(scene_of(generated("box", 300), grey(0.6), lwir()));
  ViewRequest r = request(*simulator, 33, 21, 1e5, {300});
  r.condition[0].surroundings = {SurroundingsKind::kNone, 250, 0, 0, 1, 20};
  r.max_reflections = 1;
  r.accuracy.samples_per_replicate = 128;
  const double az = 33 * std::numbers::pi / 180, el = 21 * std::numbers::pi / 180;
  const double sides = std::cos(el) * (std::abs(std::cos(az)) * 0.5 + std::abs(std::sin(az)) * 1.0),
               top = std::sin(el) * 2.0;
  double sky = 0, low = 0;
  const BandGrid& grid = simulator->band_grids()[0];
  for (std::size_t i = 0; i < grid.node_um.size(); ++i) {
    sky += grid.band_weight[i] * planck_radiance_w_m2_sr_um(grid.node_um[i], 250);
    low += grid.band_weight[i] * 20;
  }
  // A vertical Lambertian side sees half sky, half lower; the top sees sky.
  const double emitted = 0.6 * planck_band_radiance_w_m2_sr(8, 12, 300);
  const double truth = (sides + top) * emitted + 0.4 * (sides * 0.5 * (sky + low) + top * sky);
  int covered = 0;
  double sum = 0, square = 0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    r.seed = 1000 + static_cast<std::uint64_t>(run);
    const auto s = only_row(*simulator, r).intensity_w_sr;
    const double t = (s.value - truth) / s.stderr_;
    covered += std::abs(t) < 2.0395 ? 1 : 0;  // t(0.975, 31)
    sum += t;
    square += t * t;
  }
  std::printf("covered %d of %d, mean t %.3f, mean t^2 %.3f\n", covered, kRuns, sum / kRuns,
              square / kRuns);
  EXPECT_GE(covered, 364);
  EXPECT_LE(covered, 393);
  EXPECT_LT(std::abs(sum / kRuns), 3.29 / std::sqrt(kRuns) * std::sqrt(31.0 / 29));
  EXPECT_GT(square / kRuns, 0.784 * 31 / 29);
  EXPECT_LT(square / kRuns, 1.249 * 31 / 29);
}

// The sun below the horizon is dark, above it is not; nothing diverges at the horizon or at exact
// zenith views.
TEST(HardCases, SunAtTheHorizonAndViewFromTheZenith) {
  const auto simulator = simulator_of(frigate(*builtin_material("hull")));
  for (const double elevation : {90.0, -0.0, 45.0}) {
    ViewRequest r = request(*simulator, 77, elevation, 5000, {300, 400});
    r.max_reflections = 4;
    r.condition[0].surroundings = sea_world(250, 285, 0.96);
    r.accuracy.samples_per_replicate = 256;
    for (const double sun_elevation_deg : {-5.0, -0.3, 0.0, 0.3, 10.0}) {
      const double e = sun_elevation_deg * std::numbers::pi / 180;
      set_sun(r.condition[0], {0.3 * std::cos(e), 0.954 * std::cos(e), -std::sin(e)});
      const auto view = simulator->simulate(r);
      ASSERT_TRUE(view.ok());
      const double sun =
          view->row[1].cause_w_sr[static_cast<std::size_t>(Cause::kSunReflected)].value;
      EXPECT_TRUE(std::isfinite(view->row[1].intensity_w_sr.value));
      EXPECT_EQ(view->guarded_nonfinite, 0u);
      if (sun_elevation_deg < -0.27) {
        EXPECT_EQ(sun, 0);
      } else {
        EXPECT_GT(sun, 0);
      }
    }
  }
}

// A disk seen edge on sends nothing, and that is an answer: it took all samples there are, 143
// million rays, to come no nearer to 1e-4 of 0.
TEST(HardCases, NothingIsAnAnswer) {
  SceneSpec scene = scene_of(generated("disk", 100, 1), grey(0.9), lwir());
  scene.part.front().two_sided = true;
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 90, 0, 1000, {300});
  r.accuracy.samples_per_replicate = 0;
  r.accuracy.relative_error = 1e-4;
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();
  EXPECT_EQ(view->row[0].intensity_w_sr.value, 0);
  EXPECT_EQ(view->row[0].stop_reason, StopReason::kTargetReached);
  EXPECT_LT(view->rays, 1'000'000U);
}

// The Earth hides the foot of a distant target. From a height h the horizon lies at sqrt(2 R h);
// what is left of the distance d hides (d - sqrt(2 R h))^2 / (2 R) (relative error h/R). A wall of
// 10 m at 20 km from h = 10 m: 5.957 m hidden; from 5 m all
// of it, which is refused.
TEST(HardCases, TheSeaHidesTheFootOfADistantTarget) {
  const auto simulator = simulator_of(
      scene_of(moved(generated("box", 1200, 0, 1, 20, 10), {0, 0, -5}), grey(0.9), lwir()));
  constexpr double kRadius = 6371008.8, kDistance = 20000;
  for (const double height : {10.0, 5.0}) {
    const double elevation =
        std::asin((height - kDistance * kDistance / (2 * kRadius)) / kDistance);
    ViewRequest r = request(*simulator, 0, elevation * 180 / std::numbers::pi, kDistance, {300});
    r.condition[0].surroundings = sea_world(250, 285, 0.96);
    const double rest = kDistance - std::sqrt(2 * kRadius * height);
    const double visible = std::max(0.0, 10 - rest * rest / (2 * kRadius));
    const auto view = simulator->simulate(r);
    if (visible == 0) {
      EXPECT_TRUE(absl::IsInvalidArgument(view.status())) << view.status();
      continue;
    }
    ASSERT_TRUE(view.ok()) << view.status();
    EXPECT_NEAR(view->row[0].projected_area_m2.value, 20 * visible, 0.005 * 200) << height;
  }
}

// Points under water are not part of the picture: a ball on the waterline shows its upper half from
// the side.
TEST(HardCases, TheSeaHidesWhatIsUnderWater) {
  const auto simulator = simulator_of(scene_of(generated("sphere", 20000), grey(0.9), lwir()));
  ViewRequest r = request(*simulator, 0, 0, 5000, {300});
  r.condition[0].surroundings = sea_world(250, 285, 0.96);
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();
  EXPECT_NEAR(view->row[0].projected_area_m2.value, std::numbers::pi / 2, 2e-3);
}

// Views that cannot be simulated are refused with a reason.
TEST(Refusals, SayWhy) {
  const auto simulator = simulator_of(frigate(*builtin_material("hull")));
  const auto refused = [&](const ViewRequest& r, const std::string& what) {
    const auto view = simulator->simulate(r);
    ASSERT_FALSE(view.ok());
    EXPECT_NE(std::string(view.status().message()).find(what), std::string::npos) << view.status();
  };
  refused(request(*simulator, 0, 0, 50, {300, 400}), "inside the target");
  refused(request(*simulator, 0, 0, 5000, {300}), "one temperature for each part");
  ViewRequest under = request(*simulator, 0, -5, 5000, {300, 400});
  under.condition[0].surroundings = sea_world(250, 285, 0.96);
  refused(under, "under the sea");
  ViewRequest mixed = request(*simulator, 0, 5, 5000, {300, 400});
  mixed.condition.push_back(mixed.condition[0]);
  mixed.condition[1].surroundings = sea_world(250, 285, 0.96);
  refused(mixed, "same kind");
  ViewRequest many = request(*simulator, 0, 5, 5000, {300, 400});
  many.accuracy.samples_per_replicate = std::uint64_t{1} << 33;
  refused(many, "more replicates");
}

}  // namespace
}  // namespace irsig
