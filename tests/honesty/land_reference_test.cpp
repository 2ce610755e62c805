// Rationale: land enters a view by many doors - what hides, shades, is mirrored, stands behind -,
// and an error bar must hold for all of them together. Expected: on random land, under random suns
// and skies, every intensity within its stated error of an integrator that draws points on facets
// and sums the light of land anew. Source: verify/reference/reference_view.h.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <vector>

#include "core/base/constants.h"
#include "core/land/land_scene.h"
#include "tests/long_form.h"
#include "verify/cases/bodies.h"
#include "verify/reference/reference_view.h"

namespace irsig {
namespace {

struct World {
  SceneSpec scene;
  ViewRequest request;
};

// A body on rough land of two materials, whose map may end nearby.
World world_of(std::uint64_t seed) {
  std::uint64_t index = 0;
  const auto u = [&](double low, double high) {
    return low + (high - low) * uniform(seed, index++);
  };
  World out;
  const double emissivity = u(0.3, 0.98);
  Mesh mesh = moved(needle_slab(6, u(1, 5), u(0.5, 2)), {0, 0, u(-0.5, 0.2)});
  // Something that the slab mirrors and shades.
  if (u(0, 1) < 0.6)
    mesh = joined(mesh, moved(plate(u(0.5, 2), u(0.5, 2)), {u(-3, 3), u(-3, 3), -1}), "p");
  out.scene = one_body(std::move(mesh), grey_paint(emissivity));
  out.scene.part.front().two_sided = true;
  out.scene.band = {long_wave(), {"MWIR", 3.5, 5, 0.25, {}}};
  out.scene.land_material = {grey_paint(u(0.6, 1)), grey_paint(u(0.6, 1))};

  ConditionSpec condition;
  condition.part_temperature_k = {u(270, 330)};
  condition.surroundings = {SurroundingsKind::kGround, u(180, 260), 0, u(270, 310), u(0.7, 1), 0};
  condition.above_surface_m = u(0.2, 4);
  condition.land_temperature_k = {u(265, 320), u(265, 320)};
  condition.air_temperature_k = 288;
  if (u(0, 1) < 0.7) {
    const double azimuth = u(0, 2 * std::numbers::pi), elevation = u(2, 80) * kRadPerDeg;
    put_sun(condition, {std::cos(elevation) * std::cos(azimuth),
                        std::cos(elevation) * std::sin(azimuth), -std::sin(elevation)});
  }
  out.request.condition = {condition};
  out.request.selected_condition = {0};
  out.request.selected_band = {0, 1};
  if (u(0, 1) < 0.5) {
    out.request.air.model = AirModel::kHomogeneous;
    out.request.air.absorption_m2_kg = std::exp(u(std::log(1e-6), std::log(3e-3)));
    out.request.air.pressure_pa = 101325;
    out.request.air.gas_constant_j_kg_k = 287;
    out.request.air.path_emission = true;
  }
  // Half of them where land before and behind the target stretches far.
  const double elevation_deg = u(0, 1) < 0.5 ? std::exp(u(std::log(0.2), std::log(10))) : u(4, 85);
  out.request.viewpoint = {u(0, 360), elevation_deg, std::exp(u(std::log(40), std::log(3000)))};
  out.request.accuracy.samples_per_replicate = 2048;
  out.request.max_reflections = 12;
  out.request.seed = seed;

  const double relief = std::exp(u(std::log(0.1), std::log(60))),
               wave = std::exp(u(std::log(3), std::log(300)));
  const double slope = u(-0.2, 0.2), turn = u(0, 6.3), half_m = u(0, 1) < 0.3 ? 30 : 2000;
  HeightGrid grid{-half_m, -half_m, half_m / 200, 400, 400, {}};
  const auto height = [&](double x, double y) {
    return relief * (std::sin(x / wave + turn) + std::cos((y - 0.3 * x) / wave)) +
           slope * (x * std::cos(turn) + y * std::sin(turn));
  };
  for (std::uint32_t row = 0; row <= grid.rows; ++row)
    for (std::uint32_t column = 0; column <= grid.columns; ++column)
      grid.z_m.push_back(static_cast<float>(
          height(grid.west_m + column * grid.spacing_m, grid.south_m + row * grid.spacing_m)));
  HeightRaster first{LocalMetres{}, -half_m, -half_m, half_m / 50, half_m / 50, 101, 101, {}};
  for (std::uint32_t k = 0; k < 101 * 101; ++k)
    first.height_m.push_back(static_cast<float>(uniform(seed + 1, k)));
  auto land = std::make_shared<LandScene>();
  auto field = HeightField::create(std::move(grid));
  EXPECT_TRUE(field.ok()) << field.status();
  land->field = std::make_shared<const HeightField>(*std::move(field));
  auto cover =
      LandCover::create(std::vector<CoverLayer>{{"first", first}, {"second"}}, *land->field, {});
  EXPECT_TRUE(cover.ok()) << cover.status();
  land->cover = *std::move(cover);
  land->heading_deg = u(0, 360);
  land->surface_m = land->field->z_m(0, 0).value();
  out.request.land = std::move(land);
  return out;
}

TEST(LandReference, StatedErrorsHold) {
  const std::uint64_t worlds = long_form() ? 300 : 40;
  double squares = 0, worst = 0;
  int values = 0, skipped = 0, beyond_3 = 0;
  for (std::uint64_t seed = 1; seed <= worlds; ++seed) {
    const World world = world_of(seed);
    const auto simulator = Simulator::create(world.scene);
    ASSERT_TRUE(simulator.ok()) << simulator.status();
    const auto view = (*simulator)->simulate(world.request);
    if (!view.ok()) {  // hidden by land, or below it
      ++skipped;
      continue;
    }
    const auto reference = ReferenceView::make(world.scene, world.request, 0);
    ASSERT_TRUE(reference.ok()) << reference.status();
    const ReferenceView::Result truth = reference->run(4096, seed);
    for (std::size_t b = 0; b < 2; ++b) {
      const SignatureResult& r = view->row[b];
      const auto judge = [&](const char* what, double value, double error,
                             const Estimate& true_value) {
        const double both =
            std::hypot(error, true_value.stderr_) + 1e-7 * std::abs(true_value.value);
        const double t = (value - true_value.value) / both;
        squares += t * t;
        ++values;
        beyond_3 += std::abs(t) > 3 ? 1 : 0;
        worst = std::max(worst, std::abs(t));
        EXPECT_LT(std::abs(t), 5) << "seed " << seed << ", band " << b << ", " << what << ": "
                                  << value << " +- " << error << ", reference " << true_value.value
                                  << " +- " << true_value.stderr_;
      };
      judge("area", r.projected_area_m2.value, r.projected_area_m2.stderr_,
            truth.row[b].projected_area_m2);
      judge("total", r.intensity_w_sr.value, r.numerical_error_w_sr, truth.row[b].total);
      judge("apparent", r.apparent_intensity_w_sr.value, r.apparent_numerical_error_w_sr,
            truth.row[b].apparent);
      judge("contrast", r.contrast_intensity_w_sr.value, r.contrast_numerical_error_w_sr,
            truth.row[b].contrast);
    }
  }
  std::printf("%llu worlds, %d without a view, %d values: rms %.2f, worst %.2f, %d beyond 3\n",
              static_cast<unsigned long long>(worlds), skipped, values, std::sqrt(squares / values),
              worst, beyond_3);
  EXPECT_GT(values, 100);
  // Student's t has 1.03; the values of a world go together, so that few worlds scatter by 0.11.
  EXPECT_LT(std::sqrt(squares / values), long_form() ? 1.15 : 1.35);
}

// Land behind stretches from near the target to where dense air hides it. What the table of its
// ranges misses is in the error bar: the samples' scatter alone does not cover it.
TEST(LandReference, LandInDenseAirIsWithinItsBound) {
  World world = world_of(3);
  ViewRequest& request = world.request;
  ConditionSpec& c = request.condition.front();
  c.sun = false;
  c.above_surface_m = 8;
  c.land_temperature_k = {340, 340};
  c.air_temperature_k = 230;
  c.surroundings = {SurroundingsKind::kGround, 230, 0, 230, 1, 0};
  HeightGrid grid{-20'000, -20'000, 400, 100, 100, std::vector<float>(101 * 101, 0.0f)};
  auto land = std::make_shared<LandScene>(*request.land);
  auto field = HeightField::create(std::move(grid));
  ASSERT_TRUE(field.ok()) << field.status();
  land->field = std::make_shared<const HeightField>(*std::move(field));
  land->surface_m = 0;
  request.land = land;
  request.air.model = AirModel::kHomogeneous;
  request.air.pressure_pa = 101325;
  request.air.gas_constant_j_kg_k = 287;
  request.air.path_emission = true;
  request.accuracy.samples_per_replicate = 1 << 14;
  const auto simulator = Simulator::create(world.scene);
  ASSERT_TRUE(simulator.ok()) << simulator.status();
  double most_alone = 0;
  const double cases[][2] = {{3e-4, 1}, {1e-3, 1}, {3e-3, 3}};
  for (const auto& [absorption_m2_kg, elevation_deg] : cases) {
    request.air.absorption_m2_kg = absorption_m2_kg;
    request.viewpoint = {40, elevation_deg, 60};
    const auto view = (*simulator)->simulate(request);
    ASSERT_TRUE(view.ok()) << view.status();
    const auto reference = ReferenceView::make(world.scene, request, 0);
    ASSERT_TRUE(reference.ok()) << reference.status();
    const ReferenceView::Result truth = reference->run(1 << 14, 7);
    for (std::size_t b = 0; b < 2; ++b) {
      const SignatureResult& r = view->row[b];
      const Estimate& right = truth.row[b].contrast;
      const double error = std::abs(r.contrast_intensity_w_sr.value - right.value),
                   alone = error / std::hypot(r.contrast_intensity_w_sr.stderr_, right.stderr_);
      EXPECT_LT(error, 4 * std::hypot(r.contrast_numerical_error_w_sr, right.stderr_))
          << absorption_m2_kg << ' ' << elevation_deg << ' ' << b;
      std::printf("%g m2/kg, %g deg, band %zu: %.3e W/sr off, %.2f scatters, stated %.3e\n",
                  absorption_m2_kg, elevation_deg, b, error, alone,
                  r.contrast_numerical_error_w_sr);
      most_alone = std::max(most_alone, alone);
    }
  }
  EXPECT_GT(most_alone, 6);
}

}  // namespace
}  // namespace irsig
