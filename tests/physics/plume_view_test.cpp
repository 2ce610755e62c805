// Rationale: hot gas beside, before and behind a target: its rays, the few columns that stand for
// all, what it takes of the light behind it.
// Expected: a slab sends what one column sends times its area; of a black target behind it the
// transmitted part is left; gas, target and surroundings of one temperature show no contrast; a
// funnel's plume is what rays computed one by one add up to, within the stated error.
// Source: closed forms; column spectra of core/gas (tests/physics/gas_test.cpp).
#include <cmath>
#include <numbers>

#include "core/plume/plume_silhouette.h"
#include "core/transport/boxed_view.h"
#include "tests/physics/plume_view_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

TEST(PlumeView, ASlabSendsItsColumnTimesItsArea) {
  const auto simulator = disk(0.01);
  ViewRequest r = request(*simulator, 0, 0, 1e5, {300});
  r.condition[0].gas = slab(10);
  r.accuracy.samples_per_replicate = 1024;
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();
  const Column column = column_of(*simulator, slab_layer(), nullptr);
  for (std::size_t b = 0; b < 2; ++b) {
    const SignatureResult& row = view->row[b];
    ASSERT_TRUE(row.has_plume);
    // 1e5 m away: perspective and the slab's sides.
    expect_within_t(row.plume_w_sr, kAreaM2 * in_band_of(*simulator, b, column.emitted), 2, "slab",
                    2e-3, 3e-4 * row.plume_w_sr.value);
    EXPECT_NEAR(row.plume_emitted_w_sr, row.plume_w_sr.value, 1e-3 * row.plume_emitted_w_sr);
    EXPECT_LT(row.plume_bound_w_sr, 1e-3 * row.plume_w_sr.value);
    for (std::size_t k = 0; k < row.spectral.value.size(); ++k)
      EXPECT_NEAR(row.plume_spectral.value[k] / row.plume_w_sr.value,
                  row.spectral.value[k] / row.intensity_w_sr.value, 1e-4);
    // A total is the sum of both; nothing is behind, nothing in front.
    EXPECT_NEAR(row.apparent_plume_w_sr.value, row.plume_w_sr.value, 1e-9 * row.plume_w_sr.value);
    EXPECT_NEAR(row.contrast_plume_w_sr.value, row.plume_w_sr.value, 1e-9 * row.plume_w_sr.value);
  }
}

TEST(PlumeView, OfATargetBehindItGasTakesItsShare) {
  const auto simulator = disk(1);
  for (const double target_k : {400.0, kGasK}) {
    ViewRequest r = request(*simulator, 0, 0, 1e5, {target_k});
    r.condition[0].gas = slab(10);
    r.accuracy.samples_per_replicate = 2048;
    const auto view = simulator->simulate(r);
    ASSERT_TRUE(view.ok()) << view.status();
    const Column column = column_of(*simulator, slab_layer(), nullptr);
    for (std::size_t b = 0; b < 2; ++b) {
      std::vector<double> taken;
      const std::vector<double> um = nodes_of(*simulator);
      for (std::size_t i = 0; i < um.size(); ++i)
        taken.push_back(column.absorbed[i] * planck_radiance_w_m2_sr_um(um[i], target_k));
      const double disk_m2 = 0.5 * 200 * std::sin(2 * std::numbers::pi / 200);
      const double expected = kAreaM2 * in_band_of(*simulator, b, column.emitted) -
                              disk_m2 * in_band_of(*simulator, b, taken);
      const SignatureResult& row = view->row[b];
      expect_within_t(row.plume_w_sr, expected, 4, "slab before a disk", 3e-3,
                      5e-4 * row.plume_emitted_w_sr);
    }
  }
}

// Behind the target there is no gas to be seen, and half of it beside an edge is half of it.
TEST(PlumeView, ATargetHidesWhatIsBehindIt) {
  const auto simulator = disk(4);
  ViewRequest r = request(*simulator, 0, 0, 1e5, {300});
  r.condition[0].gas = slab(-10);
  r.accuracy.samples_per_replicate = 256;
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();
  ASSERT_TRUE(view->row[0].has_plume);
  EXPECT_EQ(view->row[0].plume_w_sr.value, 0);
  EXPECT_EQ(view->row[0].plume_w_sr.stderr_, 0);
}

// Rays may miss nothing where they are as dense as the gas that is seen, the whole of a bright cell
// that few of them reach, and all where there are hardly any.
TEST(SightShares, SayWhatRaysMayMiss) {
  std::array<std::array<std::vector<double>, 2>, SightShares::kOpticalDepth.size()> seen;
  for (auto& of_depth : seen) of_depth.fill(std::vector<double>(1000, 1e-3));
  std::vector<double>& bright = seen[1][0];
  bright.assign(1000, 0.9 / 999);
  bright[7] = 0.1;
  const SightShares sight(seen, std::vector<double>(1000, 1e-3));
  EXPECT_NEAR(sight.missed(0, 0, 1e5), 0, 1e-12);
  EXPECT_NEAR(sight.missed(1, 0, 1000), 0.1 - 0.9 / 999, 1e-6);
  EXPECT_NEAR(sight.missed(1, 0, 2), 1, 1e-9);
  EXPECT_NEAR(sight.missed(1, 0, 1e5), 0, 1e-12);  // 100 rays reach it
  EXPECT_NEAR(sight.missed(1, 1, 1000), 0, 1e-12);
}

// Half of the slab stands behind the edge of a wide target.
TEST(PlumeView, OfGasBesideAnEdgeWhatIsBesideItIsSeen) {
  SceneSpec scene = scene_of(generated("box", 12, 0, 0.1, 800, 800), grey(1), mwir());
  scene.spectral_breaks_um = gas_band_edges_um(3, 12);
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 0, 0, 1e6, {300});
  r.condition[0].gas = slab(-10, kGasK, 400);
  r.accuracy.samples_per_replicate = 512;
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();
  const Column column = column_of(*simulator, slab_layer(), nullptr);
  expect_within_t(view->row[0].plume_w_sr,
                  0.5 * kAreaM2 * in_band_of(*simulator, 0, column.emitted), 1, "half a slab", 5e-3,
                  0.01 * view->row[0].plume_w_sr.value);
}

// Gas absorbs light of a painted target with the target's own spectrum: that of the row without
// gas.
TEST(PlumeView, OfASpectralTargetItsOwnSpectrumIsTaken) {
  SceneSpec scene = scene_of(generated("disk", 200, 1), *builtin_material("hull"), mwir());
  scene.spectral_breaks_um = gas_band_edges_um(3, 12);
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 0, 0, 1e5, {kGasK});
  r.max_reflections = 2;
  r.accuracy.samples_per_replicate = 1024;
  r.condition[0].surroundings.kind = SurroundingsKind::kSea;
  r.condition[0].surroundings.sky_temperature_k = 600;
  r.condition[0].surroundings.sea_temperature_k = 600;
  r.condition[0].surroundings.sea_emissivity = 1;
  const auto alone = simulator->simulate(r);
  r.condition[0].gas = slab(10);
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(alone.ok() && view.ok());
  const Column column = column_of(*simulator, slab_layer(), nullptr);
  const BandGrid& grid = simulator->band_grids()[0];
  double taken = 0, all = 0;  // the bins at both ends reach beyond the band
  for (std::size_t k = 0; k < grid.lambda_um.size(); ++k)
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i) {
      all += grid.band_weight[i] * alone->row[0].spectral.value[k];
      taken += grid.band_weight[i] * column.absorbed[i] * alone->row[0].spectral.value[k];
    }
  taken *= alone->row[0].intensity_w_sr.value / all;
  const SignatureResult& row = view->row[0];
  EXPECT_FALSE(row.spectral_cause[0].value.empty());
  // Steep flanks of the target's spectrum within a bin of 0.25 um.
  // The waterline hides the lower half of both.
  expect_within_t(row.plume_w_sr, 0.5 * kAreaM2 * in_band_of(*simulator, 0, column.emitted) - taken,
                  1, "slab before a painted disk", 3e-3, 1e-3 * row.plume_emitted_w_sr);
  EXPECT_GT(taken, 0.1 * row.plume_emitted_w_sr);
}

// Before a black wall as hot as itself gas of any thickness cannot be seen: each ray loses what it
// gains.
TEST(PlumeView, BeforeAWallOfItsTemperatureGasIsInvisible) {
  const auto simulator = disk(3);
  UniformPlume spec;
  spec.kind = "sphere";
  spec.radius_m = 1;
  spec.temperature_k = kGasK;
  spec.co2 = 0.07;
  spec.h2o = 0.06;
  spec.soot = 1e-7;
  spec.voxel_m = 0.2;
  auto made = generate_uniform_plume(spec);
  ASSERT_TRUE(made.ok()) << made.status();
  made->grids.position_m = {5, 0, 0};
  const auto field = plume_of(made->volume, made->grids);
  ASSERT_TRUE(field.ok()) << field.status();
  ViewRequest r = request(*simulator, 0, 0, 1e4, {kGasK});
  r.condition[0].gas = *field;
  r.accuracy.samples_per_replicate = 1024;
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();
  for (const SignatureResult& row : view->row) {
    std::printf("left %.3g of what is sent, +- %.2g, bound %.2g\n",
                row.plume_w_sr.value / row.plume_emitted_w_sr,
                row.plume_w_sr.stderr_ / row.plume_emitted_w_sr,
                row.plume_bound_w_sr / row.plume_emitted_w_sr);
    EXPECT_GT(row.plume_emitted_w_sr, 0);
    EXPECT_LT(row.plume_bound_w_sr, 0.01 * row.plume_emitted_w_sr);
    EXPECT_LT(std::abs(row.plume_w_sr.value), row.plume_bound_w_sr);
  }
}

// Other random numbers scatter as they say.
TEST(PlumeView, SeedsScatterAsTheyState) {
  const auto simulator = disk(0.5);
  ViewRequest r = request(*simulator, 30, 10, 1e4, {400});
  r.condition[0].gas = slab(3);
  r.accuracy.samples_per_replicate = 32;
  expect_seeds_scatter_as_stated(*simulator, r, &SignatureResult::plume_w_sr);
}

TEST(PlumeView, InAWorldOfOneTemperatureThereIsNoContrast) {
  const auto simulator = disk(1);
  ViewRequest r = request(*simulator, 0, 0, 1e5, {kGasK});
  ConditionSpec& c = r.condition[0];
  c.gas = slab(10);
  c.surroundings.kind = SurroundingsKind::kSea;
  c.surroundings.sky_temperature_k = c.surroundings.sea_temperature_k = kGasK;
  c.surroundings.sea_emissivity = 1;
  r.accuracy.samples_per_replicate = 512;
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();
  for (const SignatureResult& row : view->row) {
    EXPECT_LT(std::abs(row.contrast_plume_w_sr.value),
              1e-3 * row.plume_emitted_w_sr + 4 * row.contrast_plume_w_sr.stderr_);
    EXPECT_GT(row.plume_emitted_w_sr, 0);
  }
}

// From above a broken deck gas is seen through its holes alone, as all other light is.
TEST(PlumeView, UnderBrokenCloudGasIsTheMeanOfThatUnderBothSkies) {
  SceneSpec scene =
      scene_of(generated("disk", 1000, 0.3), grey(0.8), Band{"CO2", 4.3, 4.6, 0.1, {}});
  scene.spectral_breaks_um = air_band_edges_um(3, 13);
  scene.band.push_back({"water", 8.6, 9.2, 0.2, {}});
  const auto simulator = simulator_of(scene);
  constexpr double kCover = 0.3;
  for (const double water_kg_m2 : {2e-3, 0.2}) {  // the deck dims, or hides
    std::vector<ViewResult> seen;
    for (const double cover : {0.0, kCover, 1.0}) {
      ViewRequest r = request(*simulator, 0, 30, 5000, {320});
      r.condition[0].gas = slab(10);
      r.condition[0].surroundings.kind = SurroundingsKind::kSea;
      r.accuracy.samples_per_replicate = 64;
      WeatherSpec weather{
          {afgl_profile(AfglProfile::kMidlatitudeSummer), {AerosolKind::kMaritime, 23000}},
          true,
          {SurfaceBoundary::Kind::kRoughSea, 290, 1, 6},
          nullptr};
      weather.cloud = CloudSpec{CloudPhase::kWater, 330, 1000, water_kg_m2, 7.9};
      weather.cloud_cover = cover;
      auto environment =
          Environment::make({weather}, {{0, false, {0, 0, -1}, 1}}, 10, nodes_of(*simulator));
      ASSERT_TRUE(environment.ok()) << environment.status();
      r.environment = *std::move(environment);
      auto view = simulator->simulate(r);
      ASSERT_TRUE(view.ok()) << view.status();
      seen.push_back(*std::move(view));
    }
    for (std::size_t b = 0; b < 2; ++b) {
      const auto expect_mean = [&](auto&& of) {
        const double clear = of(seen[0].row[b]), overcast = of(seen[2].row[b]);
        const double mean = (1 - kCover) * clear + kCover * overcast;
        EXPECT_NEAR(of(seen[1].row[b]), mean, 1e-3 * std::abs(mean)) << b << " " << water_kg_m2;
      };
      expect_mean([](const SignatureResult& row) { return row.apparent_plume_emitted_w_sr; });
      expect_mean([](const SignatureResult& row) { return row.apparent_plume_w_sr.value; });
      expect_mean([](const SignatureResult& row) { return row.contrast_plume_w_sr.value; });
      // The hole or the deck: the model error has their difference.
      const double clear = seen[0].row[b].apparent_plume_emitted_w_sr,
                   overcast = seen[2].row[b].apparent_plume_emitted_w_sr;
      EXPECT_GT(seen[1].row[b].apparent_model_error_w_sr,
                0.9 * std::sqrt(kCover * (1 - kCover)) * (clear - overcast));
    }
  }
}

// A funnel's plume, at the target and behind 5 km of air, against rays whose spectra are computed
// one by one.
TEST(PlumeView, AFunnelsPlumeIsTheSumOfItsRays) {
  FunnelPlume spec;
  spec.exit = {1.2, 20, 650};
  spec.exhaust.excess_air = 1.2;
  spec.exhaust.soot_g_per_kg = 0.3;
  spec.wind_m_s = 6;
  spec.wind_from_deg = 40;
  spec.length_m = 40;
  spec.voxel_m = 0.4;
  auto made = generate_funnel_plume(spec);
  ASSERT_TRUE(made.ok()) << made.status();
  made->grids.position_m = {0, 0, -12};
  auto field = plume_of(made->volume, made->grids);
  ASSERT_TRUE(field.ok()) << field.status();

  SceneSpec scene =
      scene_of(generated("box", 12, 0, 0.1, 0.1, 0.1), grey(1), Band{"CO2", 4.3, 4.6, 0.1, {}});
  scene.spectral_breaks_um = air_band_edges_um(3, 13);
  scene.band.push_back({"water", 8.6, 9.2, 0.2, {}});
  const auto simulator = simulator_of(scene);
  ViewRequest r = request(*simulator, 110, 20, 5000, {300});
  r.condition[0].gas = *field;
  r.condition[0].surroundings.kind = SurroundingsKind::kSea;
  r.accuracy = AccuracySpec{};
  r.accuracy.relative_error = 0.005;
  const std::vector<double> um = nodes_of(*simulator);
  WeatherSpec weather{
      {afgl_profile(AfglProfile::kMidlatitudeSummer), {AerosolKind::kMaritime, 23000}},
      true,
      {SurfaceBoundary::Kind::kRoughSea, 290, 1, 6},
      nullptr};
  auto environment = Environment::make({weather}, {{0, false, {0, 0, -1}, 1}}, 10, um);
  ASSERT_TRUE(environment.ok()) << environment.status();
  r.environment = *std::move(environment);
  const auto view = simulator->simulate(r);
  ASSERT_TRUE(view.ok()) << view.status();

  // Rays on a lattice across the line of sight, parallel: 5 km are far.
  const Vec<Body> direction = -1.0 * body_from_aspect(110, 20);
  const GasWindow window = gas_window(**field, direction);
  auto look = r.environment->line(r.viewpoint);
  const auto seen = r.environment->view(look, std::vector<std::uint32_t>{0});
  ASSERT_TRUE(seen.ok()) << seen.status();
  const auto wavelengths = GasWavelengths::make(um);
  const auto air_before = AirBeforeColumns::make(*(*seen)[0].air, *wavelengths);
  ASSERT_TRUE(air_before.ok()) << air_before.status();
  SegmentSteps fine;
  fine.temperature_step = 0.02;
  constexpr int kAcross = 128;
  const double cell_m2 = 4 * window.half_width_m * window.half_height_m / (kAcross * kAcross);
  std::array<double, 2> here{}, there{};
  for (int i = 0; i < kAcross; ++i)
    for (int j = 0; j < kAcross; ++j) {
      const Vec<Body> at = window.center +
                           ((2.0 * i + 1) / kAcross - 1) * window.half_width_m * window.right +
                           ((2.0 * j + 1) / kAcross - 1) * window.half_height_m * window.up +
                           window.front_m * direction;
      const GasColumn column =
          march(**field, {at, direction, 0, window.back_m - window.front_m}, fine);
      if (column.empty()) continue;
      const auto hot = HotColumn::make(column, *wavelengths);
      ASSERT_TRUE(hot.ok()) << hot.status();
      const ColumnLight alone = hot->at_near_end(), behind = hot->behind(*air_before);
      for (std::size_t b = 0; b < 2; ++b) {
        here[b] += cell_m2 * in_band_of(*simulator, b, alone.emitted_w_m2_sr_um);
        there[b] += cell_m2 * in_band_of(*simulator, b, behind.emitted_w_m2_sr_um);
      }
    }
  for (std::size_t b = 0; b < 2; ++b) {
    const SignatureResult& row = view->row[b];
    const double error = std::hypot(row.plume_w_sr.stderr_, row.plume_bound_w_sr / std::sqrt(3.0));
    const double lattice = 0.01;  // of so few rays
    std::printf(
        "band %zu: %.6g +- %.2g (bound %.2g), rays one by one %.6g; at the sensor %.6g +- %.2g "
        "(bound %.2g), %.6g\n",
        b, row.plume_emitted_w_sr, row.plume_w_sr.stderr_, row.plume_bound_w_sr, here[b],
        row.apparent_plume_emitted_w_sr, row.apparent_plume_w_sr.stderr_,
        row.apparent_plume_bound_w_sr, there[b]);
    EXPECT_NEAR(row.plume_emitted_w_sr, here[b], 3 * error + lattice * here[b]);
    EXPECT_NEAR(row.apparent_plume_emitted_w_sr, there[b],
                3 * error * there[b] / here[b] + lattice * there[b]);
    EXPECT_LT(error, 0.015 * here[b]);
    EXPECT_GE(row.numerical_error_w_sr, 0.999 * error);  // of the row: the gas's is in it
  }
}

}  // namespace
}  // namespace irsig
