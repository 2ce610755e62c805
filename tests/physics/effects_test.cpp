// Tests effects that are left out of a view, by the core alone: convexity, bounds that hold against
// a run with everything, the energy ledger, the absolute floor. The matrix of scenes is in the
// study (effects_matrix), the planner's arithmetic in tests/unit.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/spectral/planck.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

Mesh box(double side_m) { return generated("box", 12, 0, side_m, side_m, side_m); }

Target target_of(const Mesh& mesh, bool two_sided = false) {
  auto target = make_target(mesh, {{"all", {"*"}, 0, two_sided, false}}, widest_isa());
  EXPECT_TRUE(target.ok()) << target.status();
  return *std::move(target);
}

TEST(Convexity, IsProvenForConvexBodiesAlone) {
  EXPECT_TRUE(target_of(box(2)).convex);
  EXPECT_TRUE(target_of(generated("sphere", 5000, 1)).convex);
  EXPECT_TRUE(target_of(generated("cylinder", 400, 1, 3)).convex);
  EXPECT_TRUE(target_of(generated("disk", 500, 0.5), true).convex);  // no side sees the other
  EXPECT_FALSE(target_of(generated("frigate", 3000)).convex);
  EXPECT_FALSE(target_of(joined(box(1), moved(box(1), {5, 0, 0}), "second_")).convex);
  // Both sides of a box: its inner one sees the rest of it.
  EXPECT_FALSE(target_of(box(2), true).convex);
  // A dent of a thousandth.
  Mesh dented = generated("sphere", 5000, 1);
  dented.vertex[dented.vertex.size() / 2] = 0.999 * dented.vertex[dented.vertex.size() / 2];
  EXPECT_FALSE(target_of(dented).convex);
}

// A body over a sea by day, in vacuum: two conditions, two bands.
struct Scene {
  std::shared_ptr<const Simulator> simulator;
  ViewRequest request;
};
Scene by_day(const Mesh& mesh, double emissivity, double body_k, double relative_error) {
  SceneSpec spec = scene_of(mesh, grey(emissivity), lwir());
  spec.band.push_back(mwir());
  Scene out{simulator_of(spec), {}};
  out.request = request(*out.simulator, 40, 20, 3000, {body_k});
  ConditionSpec& c = out.request.condition[0];
  c.surroundings = {SurroundingsKind::kSea, 250, 0, 288, 0.96, 0};
  out.request.condition.push_back(c);
  ConditionSpec& day = out.request.condition[1];
  day.sun = true;
  day.sun_direction = normalized(Vec<Body>{0.4, 0.3, -0.7});
  day.sun_cos_zenith = -day.sun_direction.z;
  day.sun_angular_radius_deg = 0.266;
  day.sun_scale = 0.7;
  out.request.selected_condition = {0, 1};
  out.request.max_reflections = 8;
  out.request.accuracy.samples_per_replicate = 0;
  out.request.accuracy.relative_error = relative_error;
  out.request.effects.mode = EffectChoice::Mode::kAuto;
  return out;
}

ViewPlan plan_of(const Scene& s) {
  auto plan = s.simulator->plan(s.request);
  EXPECT_TRUE(plan.ok()) << plan.status();
  return *std::move(plan);
}
ViewResult measured(const Scene& s, const ViewPlan& plan) {
  auto view = s.simulator->measure(s.request, plan);
  EXPECT_TRUE(view.ok()) << view.status();
  return *std::move(view);
}
EffectState state(const ViewPlan& plan, std::size_t row, Effect e) {
  return plan.ledger[row][static_cast<std::size_t>(e)].state;
}

TEST(Effects, AConvexTargetNeedsNoReflectedRays) {
  const Scene s = by_day(box(2), 0.6, 300, 0.003);
  const ViewPlan plan = plan_of(s);
  EXPECT_EQ(state(plan, 0, Effect::kInterReflection), EffectState::kAbsent);
  EXPECT_EQ(plan.effects.max_reflections, 1u);
  ViewPlan traced = plan;
  traced.effects.skip_self_intersection = false;
  traced.effects.max_reflections = 8;
  const ViewResult with = measured(s, traced), without = measured(s, plan);
  EXPECT_LT(without.rays, 0.6 * static_cast<double>(with.rays));
  for (std::size_t row = 0; row < with.row.size(); ++row) {
    EXPECT_EQ(with.row[row].intensity_w_sr.value, without.row[row].intensity_w_sr.value);
    EXPECT_EQ(with.row[row].replicate_contrast_w_sr, without.row[row].replicate_contrast_w_sr);
    EXPECT_EQ(without.row[row].truncation_bound_w_sr, 0);
  }
}

// The difference that the same paths make, within what is stored for it.
void expect_within_bounds(const Scene& s, const ViewPlan& plan) {
  Scene all = s;
  all.request.effects.mode = EffectChoice::Mode::kAll;
  ViewPlan everything = plan_of(all);
  everything.samples_per_replicate = plan.samples_per_replicate;
  const ViewResult a = measured(s, plan), b = measured(all, everything);
  for (std::size_t row = 0; row < a.row.size(); ++row) {
    const SignatureResult &x = a.row[row], &y = b.row[row];
    ReplicateStatistics difference(1);
    for (std::size_t r = 0; r < x.replicate_w_sr.size(); ++r)
      difference.add(std::array{x.replicate_w_sr[r] - y.replicate_w_sr[r]});
    const Estimate d = difference.estimate(0);
    std::printf("row %zu: %.6g W/sr, all %.6g: %.3g +- %.2g, bound %.3g\n", row,
                x.intensity_w_sr.value, y.intensity_w_sr.value, d.value, d.stderr_,
                x.omitted_bound_w_sr);
    EXPECT_LE(std::abs(d.value),
              x.omitted_bound_w_sr + 4 * d.stderr_ + 1e-9 * y.intensity_w_sr.value);
    EXPECT_LE(x.omitted_bound_w_sr / std::sqrt(3.0), x.numerical_error_w_sr);
    EXPECT_EQ(y.omitted_bound_w_sr, 0);
  }
}

TEST(Effects, AHotTargetOutshinesItsReflections) {
  // One that is not convex keeps those of its own light.
  const Scene ship = by_day(generated("frigate", 3000), 0.9, 900, 0.02);
  const ViewPlan of_ship = plan_of(ship);
  EXPECT_GE(of_ship.effects.max_reflections, 1u);
  EXPECT_EQ(state(of_ship, 0, Effect::kSkyReflected), EffectState::kOff);
  expect_within_bounds(ship, of_ship);
  const Scene s = by_day(box(20), 0.9, 900, 0.02);
  const ViewPlan plan = plan_of(s);
  EXPECT_EQ(plan.effects.max_reflections, 0u);
  for (std::size_t row = 0; row < 4; ++row)
    EXPECT_EQ(state(plan, row, Effect::kSkyReflected), EffectState::kOff) << row;
  expect_within_bounds(s, plan);
  for (const SignatureResult& r : measured(s, plan).row) {
    EXPECT_EQ(r.stop_reason, StopReason::kTargetReached);
    EXPECT_GT(r.omitted_bound_w_sr, 0);
  }
}

TEST(Effects, TheSunGoesWhereItCannotMatterAndStaysWhereItMay) {
  Scene s = by_day(generated("frigate", 3000), 0.9, 300, 0.02);
  // The mid-wave keeps it for both bands, so surely that nobody asks.
  EXPECT_EQ(state(plan_of(s), 2, Effect::kDirectSun), EffectState::kOn);
  EXPECT_EQ(plan_of(s).ledger[2][static_cast<std::size_t>(Effect::kDirectSun)].reason,
            EffectReason::kNotWorth);
  // The long-wave alone does not.
  SceneSpec spec = scene_of(generated("frigate", 3000), grey(0.9), lwir());
  s.simulator = simulator_of(spec);
  s.request.selected_band = {0};
  const ViewPlan plan = plan_of(s);
  EXPECT_EQ(state(plan, 1, Effect::kDirectSun), EffectState::kOff);
  EXPECT_EQ(state(plan, 0, Effect::kDirectSun), EffectState::kAbsent);  // night
  EXPECT_EQ(state(plan, 1, Effect::kSkyReflected), EffectState::kOn);
  expect_within_bounds(s, plan);
}

TEST(Effects, LateReflectionsGoWithTheirBound) {
  const Scene s = by_day(generated("frigate", 3000), 0.8, 300, 0.02);
  const ViewPlan plan = plan_of(s);
  EXPECT_LT(plan.effects.max_reflections, 8u);
  EXPECT_GE(plan.effects.max_reflections, 1u);
  expect_within_bounds(s, plan);
}

TEST(Effects, NothingIsLeftOutWithoutAGoal) {
  Scene s = by_day(generated("frigate", 3000), 0.9, 900, 0);
  s.request.accuracy.samples_per_replicate = 64;
  const ViewPlan plan = plan_of(s);
  EXPECT_EQ(plan.effects.max_reflections, 8u);
  for (const auto& row : plan.ledger)
    for (const LedgerEntry& e : row) {
      EXPECT_NE(e.state, EffectState::kOff);
      if (info_of(e.effect).switchable && e.state == EffectState::kOn) {
        EXPECT_EQ(e.reason, EffectReason::kNoGoal);
      }
    }
}

TEST(Effects, BitsDoNotDependOnTheSelection) {
  Scene s = by_day(generated("frigate", 3000), 0.9, 300, 0.02);
  const auto whole = s.simulator->simulate(s.request);
  ASSERT_TRUE(whole.ok());
  s.request.selected_condition = {1};
  s.request.selected_band = {1};
  const auto part = s.simulator->simulate(s.request);
  ASSERT_TRUE(part.ok());
  ASSERT_EQ(part->row.size(), 1u);
  EXPECT_EQ(part->row[0].intensity_w_sr.value, whole->row[3].intensity_w_sr.value);
  EXPECT_EQ(part->row[0].omitted_bound_w_sr, whole->row[3].omitted_bound_w_sr);
  EXPECT_EQ(part->row[0].effect[1].bound_w_sr, whole->row[3].effect[1].bound_w_sr);
}

TEST(Effects, WhatIsForcedOffIsZeroAndStated) {
  Scene s = by_day(generated("frigate", 3000), 0.8, 300, 0.02);
  s.request.effects = {EffectChoice::Mode::kOnly, {Effect::kLowerReflected}};
  const ViewPlan plan = plan_of(s);
  for (const SignatureResult& r : measured(s, plan).row) {
    const auto cause = [&](Cause c) { return r.cause_w_sr[static_cast<std::size_t>(c)].value; };
    EXPECT_GT(cause(Cause::kSeaReflected), 0);
    EXPECT_EQ(cause(Cause::kSkyReflected), 0);
    EXPECT_EQ(cause(Cause::kSunReflected), 0);
    EXPECT_EQ(cause(Cause::kPartsReflected), 0);
  }
  expect_within_bounds(s, plan);

  // A white ship whose facets light each other as often as they like: as bright as the sun at most,
  // and said so.
  Scene white = by_day(generated("frigate", 3000), 0.01, 300, 0.02);
  white.request.effects = {EffectChoice::Mode::kOnly, {}};
  const ViewPlan of_white = plan_of(white);
  expect_within_bounds(white, of_white);
  for (const SignatureResult& r : measured(white, of_white).row)
    EXPECT_TRUE(std::isfinite(r.omitted_bound_w_sr));
}

TEST(EnergyLedger, AddsUpToOne) {
  for (const double emissivity : {0.3, 0.9}) {
    Scene s = by_day(generated("frigate", 3000), emissivity, 300, 0);
    s.request.effects.mode = EffectChoice::Mode::kAll;
    s.request.max_reflections = 40;
    s.request.accuracy.samples_per_replicate = 4096;
    for (const SignatureResult& r : measured(s, plan_of(s)).row) {
      expect_within_t(r.energy.balance, 1, 8, "balance");
      EXPECT_NEAR(r.energy.absorbed.value + r.energy.escaped_to_sky.value +
                      r.energy.escaped_to_surface.value + r.energy.cut_off.value,
                  r.energy.balance.value, 1e-12);
      EXPECT_GT(r.energy.absorbed.value, emissivity);
    }
  }
  // Without reflections everything that is not absorbed at once is cut off.
  Scene s = by_day(box(2), 0.7, 300, 0);
  s.request.accuracy.samples_per_replicate = 256;
  s.request.max_reflections = 0;
  for (const SignatureResult& r : measured(s, plan_of(s)).row) {
    EXPECT_NEAR(r.energy.absorbed.value, 0.7, 1e-6);
    EXPECT_NEAR(r.energy.cut_off.value, 0.3, 1e-6);
  }
}

TEST(AbsoluteFloor, IsWorthItsKelvinAndEndsTheSearchForDarkRows) {
  // A mirror-like plate under a cold sky gives next to nothing, and no detector would see its
  // error.
  Scene s = by_day(generated("frigate", 3000), 0.05, 300, 1e-4);
  s.request.effects.mode = EffectChoice::Mode::kAll;
  const ViewPlan strict = plan_of(s);
  s.request.accuracy.absolute_error_k = 1;
  const ViewPlan loose = plan_of(s);
  EXPECT_LT(loose.samples_per_replicate * 4, strict.samples_per_replicate);
  bool floored = false;
  for (const SignatureResult& r : measured(s, loose).row) {
    const bool relative = r.numerical_error_w_sr <= 1e-4 * r.intensity_w_sr.value;
    EXPECT_EQ(r.stop_reason, relative ? StopReason::kTargetReached : StopReason::kFloorReached);
    floored |= !relative;
    EXPECT_LE(r.numerical_error_w_sr,
              std::max(1e-4 * r.intensity_w_sr.value, r.absolute_floor_w_sr));
    // The warmest around is the sea, grey at 288 K with what it reflects of the sky (by day: of the
    // sun).
    if (r.condition == 1) continue;
    const double low = r.band == 0 ? 8 : 3, high = r.band == 0 ? 12 : 5;
    const double per_k =
        planck_band_radiance_w_m2_sr(low, high, 288) - planck_band_radiance_w_m2_sr(low, high, 287);
    EXPECT_NEAR(r.absolute_floor_w_sr / (r.projected_area_m2.value * per_k), 1, 0.05);
  }
  EXPECT_TRUE(floored) << "no row stopped at its floor";
}

// A plan is a value: the same request gives an equal one, what is changed differs and is printed,
// and a copy measures what the plan itself measures.
TEST(Effects, APlanIsAValue) {
  const Scene s = by_day(box(2), 0.6, 300, 0.003);
  const ViewPlan plan = plan_of(s), again = plan_of(s);
  EXPECT_TRUE(plan == again);
  EXPECT_EQ(to_string(plan), to_string(again));
  EXPECT_NE(to_string(plan).find("direct_sun"), std::string::npos);
  ViewPlan other = plan;
  other.effects.sun[1].path = !other.effects.sun[1].path;
  EXPECT_FALSE(plan == other);
  EXPECT_NE(to_string(plan), to_string(other));
  other = plan;
  other.ledger[0][0].bound_w_sr = 1;
  EXPECT_FALSE(plan == other);
  EXPECT_NE(to_string(plan), to_string(other));

  // Data made on the way to a plan change nothing, and are not used for another one.
  const auto prepared = s.simulator->prepare(s.request);
  ASSERT_TRUE(prepared.ok()) << prepared.status();
  EXPECT_TRUE(prepared->plan == plan);
  const auto whole = s.simulator->measure(s.request, *prepared);
  ASSERT_TRUE(whole.ok()) << whole.status();
  PlannedView changed = *prepared;
  for (EffectSet::Sun& sun : changed.plan.effects.sun) sun = {false, false, false, false, false};
  const auto without = s.simulator->measure(s.request, changed);
  ASSERT_TRUE(without.ok()) << without.status();
  const ViewResult alone = measured(s, plan), alone_without = measured(s, changed.plan);
  for (std::size_t row = 0; row < alone.row.size(); ++row) {
    EXPECT_EQ(whole->row[row].replicate_contrast_w_sr, alone.row[row].replicate_contrast_w_sr);
    EXPECT_EQ(without->row[row].replicate_contrast_w_sr,
              alone_without.row[row].replicate_contrast_w_sr);
  }
}

}  // namespace
}  // namespace irsig
