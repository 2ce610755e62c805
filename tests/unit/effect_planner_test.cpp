// The planner of effects on bounds made up by hand: what is left out, how much room it takes, what
// the ledger says.
#include <cmath>
#include <limits>
#include <numbers>

#include "core/effects/plan.h"
#include "gtest/gtest.h"

namespace irsig {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kRoomOfOne = kOmittedShare * std::numbers::sqrt3;

RowBounds::Bound& at(RowBounds& row, Effect e) { return row.effect[static_cast<std::size_t>(e)]; }

// A row that wants an error of 1 W/sr, by day, with bounds of this size.
RowBounds row_with(double reflected, double direct, double diffuse, double mirrored) {
  RowBounds row;
  row.goal_w_sr = row.aperture_goal_w_sr = 1;
  for (RowBounds::Bound& b : row.effect) b = {false, kInfinite, kInfinite, kInfinite};
  const auto all = [](double x) { return RowBounds::Bound{false, x, x, x}; };
  row.reflected = all(reflected);
  for (const Effect e : {Effect::kSkyReflected, Effect::kLowerReflected, Effect::kInterReflection})
    at(row, e) = all(reflected);
  at(row, Effect::kDirectSun) = all(direct);
  at(row, Effect::kDiffuseSun) = all(diffuse);
  at(row, Effect::kMirroredSun) = all(mirrored);
  at(row, Effect::kJoinedLines) = {false, 0, 3, 3};
  at(row, Effect::kPathSun) = {false, 0, 0.01, 0};
  at(row, Effect::kBackgroundSun) = {false, 0, 0, 100};
  at(row, Effect::kCloud) = {true, 0, 0, 0};
  return row;
}

const EffectChoice kAutomatic{EffectChoice::Mode::kAuto, {}};

const LedgerEntry& entry(const EffectPlanner& planner, std::size_t row, Effect e) {
  static std::vector<std::vector<LedgerEntry>> ledger;
  ledger = planner.ledger();
  return ledger[row][static_cast<std::size_t>(e)];
}

TEST(EffectTable, IsInOrderAndHasUniqueNames) {
  for (std::size_t i = 0; i < kEffects; ++i) {
    const EffectInfo& e = effect_table()[i];
    EXPECT_EQ(static_cast<std::size_t>(e.effect), i) << e.name;
    EXPECT_EQ(effect_named(e.name), e.effect);
    EXPECT_FALSE(e.what.empty() || e.when.empty() || e.bound.empty() || e.cost.empty()) << e.name;
  }
  EXPECT_EQ(effect_named("sunshine"), std::nullopt);
}

TEST(EffectPlanner, LeavesOutAllReflectionsWhereTheyFitTogether) {
  EffectPlanner planner({row_with(0.5 * kRoomOfOne, 0.2 * kRoomOfOne, 0.1 * kRoomOfOne, 0)}, 1,
                        kAutomatic);
  planner.decide();
  EXPECT_FALSE(planner.reflections());
  EXPECT_FALSE(planner.on(Effect::kSkyReflected, 0));
  EXPECT_FALSE(planner.on(Effect::kDirectSun, 0));
  EXPECT_TRUE(planner.on(Effect::kBackgroundSun, 0));
  EXPECT_FALSE(planner.on(Effect::kJoinedLines, 0));
  EXPECT_EQ(entry(planner, 0, Effect::kJoinedLines).apparent_bound_w_sr, 0);
  // Reflected light counts once, not once for sky, sea and parts.
  EXPECT_NEAR(planner.omitted()[0].source, 0.8 * kRoomOfOne, 1e-12);
  EXPECT_EQ(entry(planner, 0, Effect::kSkyReflected).reason, EffectReason::kWithinShare);
  EXPECT_EQ(entry(planner, 0, Effect::kBackgroundSun).reason, EffectReason::kAlways);
  EXPECT_EQ(entry(planner, 0, Effect::kSelfEmission).reason, EffectReason::kAlways);
  EXPECT_TRUE(std::isnan(entry(planner, 0, Effect::kSelfEmission).bound_w_sr));
}

TEST(EffectTable, CloudsAreAfterTheEffectsOfEveryRow) {
  const EffectInfo& cloud = cloud_effect_table()[0];
  EXPECT_EQ(static_cast<std::size_t>(cloud.effect), kEffects);
  EXPECT_EQ(&info_of(cloud.effect), &cloud);
  EXPECT_EQ(effect_named("cloud"), Effect::kCloud);
  for (const EffectInfo& e : heat_effect_table()) EXPECT_EQ(&info_of(e.effect), &e);
  for (const EffectInfo& e : plume_effect_table()) EXPECT_EQ(&info_of(e.effect), &e);
}

// One band without room keeps an effect, whichever band of its condition that is.
TEST(EffectPlanner, EachBandOfAConditionHasAVoice) {
  const RowBounds clear = row_with(5, 0.1, 0.1, 0.1), bright = row_with(5, 9, 9, 9);
  RowBounds little = clear, much = clear;
  at(little, Effect::kCloud) = {false, 0.1 * kRoomOfOne, 0.1 * kRoomOfOne, 0.1 * kRoomOfOne};
  at(much, Effect::kCloud) = {false, 2, 2, 2};
  for (std::size_t place = 0; place < 3; ++place) {
    std::vector<RowBounds> cloudy(3, little), sunny(3, clear);
    cloudy[place] = much;
    sunny[place] = bright;
    EffectPlanner clouds(cloudy, 3, kAutomatic), suns(sunny, 3, kAutomatic);
    clouds.decide();
    suns.decide();
    EXPECT_TRUE(clouds.on(Effect::kCloud, 0)) << place;
    for (const Effect e : {Effect::kDirectSun, Effect::kDiffuseSun, Effect::kMirroredSun})
      EXPECT_TRUE(suns.on(e, 0)) << place << " " << info_of(e).name;
  }
}

// Without reflections a cloud changes what no reflection brings, and no more.
TEST(EffectPlanner, ACloudGoesWhereItsBoundFitsInAllBandsOfItsCondition) {
  const auto cloudy = [](double reflected, double cloud, double unreflected) {
    RowBounds row = row_with(reflected, 50, 50, 50);
    at(row, Effect::kCloud) = {false, cloud, cloud, cloud};
    row.cloud_unreflected = {false, 0, unreflected, unreflected};
    return row;
  };
  const RowBounds clear = row_with(2, 50, 50, 50), much = cloudy(2, 2, 1.5),
                  little = cloudy(2, 0.5 * kRoomOfOne, 0.1);
  // Conditions: none, in one band too much, little in both.
  EffectPlanner planner({clear, clear, little, much, little, little}, 2, kAutomatic);
  planner.decide();
  EXPECT_TRUE(planner.reflections());
  EXPECT_TRUE(planner.on(Effect::kCloud, 0));
  EXPECT_TRUE(planner.on(Effect::kCloud, 1));
  EXPECT_FALSE(planner.on(Effect::kCloud, 2));
  const auto ledger = planner.ledger();
  EXPECT_EQ(ledger[0].size(), kEffects);
  EXPECT_EQ(ledger[2].size(), kPlannedEffects);
  EXPECT_EQ(ledger[2].back().reason, EffectReason::kOtherRow);
  EXPECT_EQ(ledger[3].back().reason, EffectReason::kAboveShare);
  EXPECT_EQ(ledger[4].back().reason, EffectReason::kWithinShare);
  EXPECT_EQ(planner.omitted()[2].contrast, 0);
  EXPECT_NEAR(planner.omitted()[4].contrast, 0.5 * kRoomOfOne, 1e-12);
  EXPECT_NEAR(planner.room()[4].source, 0.5 * kRoomOfOne, 1e-12);

  RowBounds dark = cloudy(0.5 * kRoomOfOne, 2, 0.3 * kRoomOfOne);
  for (const Effect e : {Effect::kDirectSun, Effect::kDiffuseSun, Effect::kMirroredSun})
    at(dark, e) = {true, 0, 0, 0};
  EffectPlanner by_night({dark}, 1, kAutomatic);
  by_night.decide();
  EXPECT_FALSE(by_night.reflections());
  EXPECT_FALSE(by_night.on(Effect::kCloud, 0));
  EXPECT_NEAR(by_night.omitted()[0].contrast, 0.8 * kRoomOfOne, 1e-12);
  EXPECT_NEAR(by_night.omitted()[0].source, 0.5 * kRoomOfOne, 1e-12);

  EffectChoice kept = kAutomatic;
  kept.kept = {Effect::kCloud};
  EffectPlanner uncertain({little}, 1, kept);
  uncertain.decide();
  EXPECT_TRUE(uncertain.on(Effect::kCloud, 0));
  EXPECT_EQ(uncertain.ledger()[0].back().reason, EffectReason::kForced);
}

TEST(EffectPlanner, WhatAnUncertainInputMovesStays) {
  const RowBounds row = row_with(0.1 * kRoomOfOne, 0.1 * kRoomOfOne, 0.1 * kRoomOfOne, 0);
  EffectChoice choice = kAutomatic;
  choice.kept = {Effect::kSkyReflected};
  EffectPlanner planner({row}, 1, choice);
  planner.decide();
  EXPECT_TRUE(planner.reflections());
  EXPECT_TRUE(planner.on(Effect::kSkyReflected, 0));
  EXPECT_EQ(entry(planner, 0, Effect::kSkyReflected).reason, EffectReason::kForced);
  EXPECT_FALSE(planner.on(Effect::kDirectSun, 0));  // no input moves it, and it fits
  choice.kept = {Effect::kDirectSun};
  EffectPlanner lit({row}, 1, choice);
  lit.decide();
  EXPECT_TRUE(lit.on(Effect::kDirectSun, 0));
  EXPECT_FALSE(lit.on(Effect::kSkyReflected, 0));
}

TEST(EffectPlanner, TheSurroundingsGoWhereOnlyTheTargetsOwnLightMatters) {
  RowBounds row = row_with(50, 9, 0.1 * kRoomOfOne, 9);  // lit by its own parts
  for (const Effect e : {Effect::kSkyReflected, Effect::kLowerReflected})
    at(row, e) = {false, 0.8 * kRoomOfOne, 0.8 * kRoomOfOne, 0.8 * kRoomOfOne};
  EffectPlanner planner({row}, 1, kAutomatic);
  planner.decide();
  EXPECT_TRUE(planner.reflections());
  EXPECT_TRUE(planner.on(Effect::kInterReflection, 0));
  for (const Effect e :
       {Effect::kSkyReflected, Effect::kLowerReflected, Effect::kDiffuseSun, Effect::kJoinedLines})
    EXPECT_FALSE(planner.on(e, 0)) << info_of(e).name;
  EXPECT_TRUE(planner.on(Effect::kDirectSun, 0));
  // Each path ends in the sky or below the horizon: their light counts once.
  EXPECT_NEAR(planner.omitted()[0].source, 0.9 * kRoomOfOne, 1e-12);
}

TEST(EffectPlanner, NothingGoesThatDoesNotFitEverywhere) {
  // Row 1 needs reflections; both its conditions' paths are shared.
  EffectPlanner planner({row_with(0.1, 0, 0, 0), row_with(2, 0, 0, 0)}, 1, kAutomatic);
  planner.decide();
  EXPECT_TRUE(planner.reflections());
  EXPECT_TRUE(planner.on(Effect::kSkyReflected, 0));
  EXPECT_EQ(entry(planner, 0, Effect::kSkyReflected).reason, EffectReason::kOtherRow);
  EXPECT_EQ(entry(planner, 1, Effect::kSkyReflected).reason, EffectReason::kAboveShare);
}

TEST(EffectPlanner, SunlightIsDecidedByConditionAndByAllItsBands) {
  const RowBounds dim = row_with(5, 0.1, 0.1, 0.1), bright = row_with(5, 9, 9, 9);
  EffectPlanner planner({dim, dim, dim, bright}, 2, kAutomatic);
  planner.decide();
  EXPECT_FALSE(planner.on(Effect::kDiffuseSun, 0));
  EXPECT_FALSE(planner.on(Effect::kDirectSun, 0));
  EXPECT_TRUE(planner.on(Effect::kDiffuseSun, 1));
  EXPECT_TRUE(planner.on(Effect::kDirectSun, 1));
  EXPECT_EQ(entry(planner, 2, Effect::kDiffuseSun).reason, EffectReason::kOtherRow);
  // Its bound would fit, but rows state the radiance of the path.
  EXPECT_TRUE(planner.on(Effect::kPathSun, 1));
  EXPECT_EQ(entry(planner, 2, Effect::kPathSun).reason, EffectReason::kAlways);
}

TEST(EffectPlanner, OmissionsShareOneRoom) {
  // Each alone would fit, all three do not.
  EffectPlanner planner({row_with(9, 0.4 * kRoomOfOne, 0.4 * kRoomOfOne, 0.4 * kRoomOfOne)}, 1,
                        kAutomatic);
  planner.decide();
  double off = 0;
  for (const Effect e : {Effect::kDirectSun, Effect::kDiffuseSun, Effect::kMirroredSun})
    off += planner.on(e, 0) ? 0 : 1;
  EXPECT_EQ(off, 2);
  EXPECT_LE(planner.omitted()[0].source, kRoomOfOne);
}

TEST(EffectPlanner, TheSunStaysWhereTheSeaMirrorsIt) {
  EffectPlanner planner({row_with(9, 0.1, 0.1, 5)}, 1, kAutomatic);
  planner.decide();
  EXPECT_TRUE(planner.on(Effect::kMirroredSun, 0));
  EXPECT_TRUE(planner.on(Effect::kDirectSun, 0));
}

TEST(EffectPlanner, UnknownBoundsAndRowsWithoutAGoalKeepEverything) {
  for (const bool goal : {false, true}) {
    RowBounds row = row_with(goal ? kInfinite : 0.01, goal ? kInfinite : 0.01,
                             goal ? std::nan("") : 0.01, kInfinite);
    if (!goal) row.goal_w_sr = 0;
    EffectPlanner planner({row}, 1, kAutomatic);
    planner.decide();
    for (const Effect e : {Effect::kSkyReflected, Effect::kDirectSun, Effect::kDiffuseSun})
      EXPECT_TRUE(planner.on(e, 0)) << goal << " " << info_of(e).name;
    EXPECT_EQ(entry(planner, 0, Effect::kDirectSun).reason,
              goal ? EffectReason::kUnbounded : EffectReason::kNoGoal);
  }
}

TEST(EffectPlanner, AbsentEffectsAreNeitherOnNorOffAndTakeNothing) {
  RowBounds row = row_with(0.1, 0, 0, 0);
  for (const Effect e : {Effect::kDirectSun, Effect::kDiffuseSun, Effect::kMirroredSun,
                         Effect::kPathSun, Effect::kBackgroundSun})
    at(row, e) = {true, 0, 0, 0};
  EffectPlanner planner({row}, 1, kAutomatic);
  planner.decide();
  EXPECT_EQ(entry(planner, 0, Effect::kDirectSun).state, EffectState::kAbsent);
  EXPECT_NEAR(planner.omitted()[0].source, 0.1, 1e-12);
}

TEST(EffectPlanner, TheUsersWordIsForced) {
  EffectPlanner all({row_with(0.01, 0.01, 0.01, 0.01)}, 1, {EffectChoice::Mode::kAll, {}});
  all.decide();
  EXPECT_TRUE(all.reflections());
  EXPECT_EQ(entry(all, 0, Effect::kDirectSun).reason, EffectReason::kForced);
  EXPECT_EQ(entry(all, 0, Effect::kDirectSun).state, EffectState::kOn);

  EffectPlanner only({row_with(5, 7, 9, 11)}, 1,
                     {EffectChoice::Mode::kOnly, {Effect::kSkyReflected}});
  only.decide();
  EXPECT_TRUE(only.reflections());
  EXPECT_TRUE(only.on(Effect::kSkyReflected, 0));
  EXPECT_FALSE(only.on(Effect::kLowerReflected, 0));
  EXPECT_EQ(entry(only, 0, Effect::kDirectSun).state, EffectState::kOff);
  // Forced or not, what is left out is in the error: lower, inter-reflection, three kinds of sun.
  EXPECT_NEAR(only.omitted()[0].source, 5 + 5 + 7 + 9 + 11, 1e-12);
  EXPECT_NEAR(only.omitted()[0].apparent, 5 + 5 + 7 + 9 + 11 + 3 + 0.01, 1e-12);

  EffectPlanner without_sea(
      {row_with(5, 7, 9, 11)}, 1,
      {EffectChoice::Mode::kOnly, {Effect::kSkyReflected, Effect::kDiffuseSun}});
  without_sea.decide();
  EXPECT_FALSE(without_sea.on(Effect::kDiffuseSun, 0)) << "the sea scatters it too";

  EffectPlanner none({row_with(5, 7, 9, 11)}, 1, {EffectChoice::Mode::kOnly, {}});
  none.decide();
  EXPECT_FALSE(none.reflections());
  EXPECT_NEAR(none.omitted()[0].source, 5 + 7 + 9 + 11, 1e-12);
}

TEST(EffectPlanner, OneMoreEffectGoesOnlyIfRoomIsLeft) {
  EffectPlanner planner({row_with(9, 0.5 * kRoomOfOne, 9, 0)}, 1, kAutomatic);
  planner.decide();
  EXPECT_FALSE(planner.leave_out(Effect::kJoinedLines, {{false, 0, 1.1 * kRoomOfOne, 0}}));
  EXPECT_EQ(entry(planner, 0, Effect::kJoinedLines).reason, EffectReason::kAboveShare);
  EXPECT_TRUE(planner.leave_out(Effect::kJoinedLines, {{false, 0, 0.3 * kRoomOfOne, 0}}));
  EXPECT_FALSE(planner.on(Effect::kJoinedLines, 0));
}

}  // namespace
}  // namespace irsig
