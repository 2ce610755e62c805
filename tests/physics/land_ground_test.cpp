// Land that a target sees below its horizon: which kinds of it, and what its temperature does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "core/land/kinds/land_below_target.h"
#include "core/thermal/scene/scene_heat.h"
#include "heat_scene.h"
#include "land_days.h"

namespace irsig {
namespace {

// Kinds of one material with a horizon of their own within a radius around (x, y).
LandKinds disk_of_horizon(double x_m, double y_m, double radius_m) {
  LandKinds out;
  out.materials = 1;
  out.computed = {true};
  out.on_objects = {false};
  out.horizon.resize(2);
  constexpr std::uint32_t kCells = 400;
  LandKinds::Square square{0.5, kCells, {}};
  for (std::uint32_t row = 0; row < kCells; ++row)
    for (std::uint32_t column = 0; column < kCells; ++column) {
      const double x = 0.5 * (column + 0.5) - 100, y = 0.5 * (row + 0.5) - 100;
      square.horizon.push_back(std::hypot(x - x_m, y - y_m) < radius_m ? 1 : 0);
    }
  out.square = {square};
  out.index_kinds();
  return out;
}

double fraction_within(const LandScene& land, const TargetOnLand& target, double radius_m) {
  const LandKinds kinds = disk_of_horizon(target.x_m, target.y_m, radius_m);
  double all = 0, within = 0;
  for (const KindShare& part : land_below_target(land, kinds, target)) {
    all += static_cast<double>(part.share);
    if (kinds.kind[part.kind].horizon == 1) within += static_cast<double>(part.share);
  }
  EXPECT_NEAR(all, 1, 1e-5);
  return within;
}

// Rationale: a wall of a target sees land by its view factor. Expected: the fraction within a
// distance of the wall, by a sum over patches of the ground in front of it.
TEST(LandBelowTarget, IsSeenByViewFactor) {
  const LandScene land = land_of([](double, double) { return 0; }, 1000, 50);
  const TargetOnLand target{7, -4, 3, 2};
  for (const double away_m : {1.0, 2.0, 5.0, 15.0}) {
    double within = 0, all = 0;
    constexpr double kStepM = 0.05;
    for (double x = 0.5 * kStepM; x < 60; x += kStepM)
      for (double y = 0.5 * kStepM; y < 60; y += kStepM) {
        const double square = x * x + y * y + target.above_m * target.above_m,
                     seen = x * target.above_m / (square * square);
        all += seen;
        if (std::hypot(x, y) < away_m) within += seen;
      }
    EXPECT_NEAR(fraction_within(land, target, target.half_m + away_m), within / all, 0.045)
        << away_m;
  }
}

// Rationale: land beyond the map has no temperature. Expected: none where the map lies elsewhere,
// and all of it where a target stands at its edge.
TEST(LandBelowTarget, IsThatOfTheMap) {
  const LandScene land = land_of([](double, double) { return 0; }, 50, 10);
  EXPECT_TRUE(land_below_target(land, disk_of_horizon(0, 0, 5), {400, 0, 3, 2}).empty());
  EXPECT_NEAR(fraction_within(land, {49, 0, 3, 2}, 1e4), 1, 1e-6);
}

SceneHeatResult on_ground(const Target& target, const SceneHeatRequest& request) {
  auto out = solve_scene_heat(target, request);
  EXPECT_TRUE(out.ok()) << out.status();
  return *std::move(out);
}

// Rationale: ground may change its temperature through the day. Expected: one that does not is a
// constant to the last bit; one that does warms a box as much as that constant which it then is
// would, and never more than the warmest and the coldest of it.
TEST(LandBelowTarget, WarmsATargetThroughTheDay) {
  const Mesh mesh = named(generated("box", 12, 0, 2, 2, 2), "box");
  const Target target = target_of(mesh, {{"box", {"box"}, 0}});
  SceneHeatRequest r = steady(290, 330);
  r.build_up = {steel(InnerSide::kAdiabatic)};
  r.part = {{0.5, 0.9, 0, 0}};
  r.beneath = {.surface_z_m = 1.01, .temperature_k = 290, .emissivity = 1, .solar_albedo = 0};
  r.output_knot.clear();
  for (std::size_t k = 0; k < r.knot_s.size(); k += 4) r.output_knot.push_back(k);
  const auto constant = [&](double kelvin) {
    SceneHeatRequest other = r;
    other.beneath.temperature_k = kelvin;
    return on_ground(target, other);
  };
  SceneHeatRequest same = r;
  same.beneath.temperature_k = 250;  // is not used
  same.beneath.temperature_at_k.assign(r.knot_s.size(), 290.0);
  EXPECT_EQ(on_ground(target, same).kelvin, constant(290).kelvin);

  SceneHeatRequest day = r;
  for (const double t : r.knot_s)
    day.beneath.temperature_at_k.push_back(300 + 20 * std::sin(2 * kPi * t / 86400));
  const SceneHeatResult through = on_ground(target, day), cold = constant(280), hot = constant(320);
  float most = 0, least = 1e9f;
  for (std::size_t o = 0; o < through.kelvin.size(); ++o)
    for (std::size_t f = 0; f < through.kelvin[o].size(); ++f) {
      EXPECT_GE(through.kelvin[o][f], cold.kelvin[o][f] - 0.05f);
      EXPECT_LE(through.kelvin[o][f], hot.kelvin[o][f] + 0.05f);
      most = std::max(most, through.kelvin[o][f]);
      least = std::min(least, through.kelvin[o][f]);
    }
  EXPECT_GT(most - least, 3);
  SceneHeatRequest wrong = r;
  wrong.beneath.temperature_at_k = {290.0, 291.0};
  EXPECT_FALSE(solve_scene_heat(target, wrong).ok());
}

}  // namespace
}  // namespace irsig
