// The arithmetic that predicts what a sweep takes, against numbers worked out by hand.

#include "core/accuracy/cost_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/accuracy/replicates.h"

namespace irsig {
namespace {

// CPU time 0.010 s + 2e-5 s a sample; one row of 100 W/sr whose standard error is
// e1 (128 / n)^slope.
ViewPilot pilot_of(double e1, double slope, std::vector<std::uint64_t> samples = {128, 1024}) {
  ViewPilot pilot;
  RowPilot row;
  row.value_w_sr = 100;
  for (const std::uint64_t n : samples) {
    pilot.cpu_s.push_back(0.010 + 2e-5 * static_cast<double>(n));
    row.stderr_w_sr.push_back(e1 * std::pow(128 / static_cast<double>(n), slope));
  }
  pilot.samples = std::move(samples);
  pilot.row = {row};
  return pilot;
}

CountRule relative(double error, std::uint64_t most = 1 << 22) {
  return {.relative_error = error,
          .target_paths = 0,
          .samples_per_replicate = 0,
          .max_samples_per_replicate = most};
}

double seconds_of(double samples) { return 0.010 + 2e-5 * samples; }

TEST(CostModel, StandardErrorIsAPowerBetweenAndBeyondTheStages) {
  const std::vector<std::uint64_t> n = {128, 1024, 8192};
  const std::vector<double> e = {8, 2, 1};
  EXPECT_DOUBLE_EQ(stderr_at(n, e, 128), 8);
  EXPECT_DOUBLE_EQ(stderr_at(n, e, 1024), 2);
  EXPECT_NEAR(stderr_at(n, e, 362), 4, 0.01);          // geometric middle of 128 and 1024
  EXPECT_DOUBLE_EQ(stderr_at(n, e, 32), 16);           // below: as plain Monte Carlo
  EXPECT_NEAR(stderr_at(n, e, 4 * 8192), 0.5, 1e-12);  // 1/3 measured, held at -1/2
  const std::vector<double> steep = {8, 1, 0.125};     // -1 measured, held at -0.7
  EXPECT_NEAR(stderr_at(n, steep, 10 * 8192), 0.125 * std::pow(10, -0.7), 1e-12);
}

TEST(CostModel, TheSecondPilotSuffices) {
  // The first asks for (3 / 0.8)^2 x 128 = 1800; 0.8 x 1 % of 100 W/sr is more than the 0.7 at
  // 1024.
  const ViewCost cost = view_cost(pilot_of(3, 0.7), relative(0.01), 0);
  EXPECT_EQ(cost.samples, 1024u);
  EXPECT_NEAR(cost.cpu_s, seconds_of(1024), 1e-12);
  EXPECT_EQ(cost.reached, 1u);
}

TEST(CostModel, SamplesAreThoseOfTheJobsOwnRule) {
  const ViewPilot pilot = pilot_of(2 * std::pow(8, 0.6), 0.6);  // 2 at 1024
  const ViewCost cost = view_cost(pilot, relative(0.01), 0);
  const std::uint64_t n =
      samples_needed(128, pilot.row[0].stderr_w_sr[0], 1024, 2, 1, std::uint64_t{1} << 40);
  EXPECT_EQ(cost.samples, n);
  EXPECT_GT(n, 4 * 1024u);
  EXPECT_NEAR(cost.cpu_s, seconds_of(static_cast<double>(n)), 1e-12);
}

// The model plans as the job does: where the first pilot asks for no more than the second would
// trace, there is no second.
TEST(CostModel, TheFirstPilotAloneDecidesWhereLittleIsNeeded) {
  const ViewPilot pilot = pilot_of(1.6, 0.7);  // at 128 samples
  const ViewCost cost = view_cost(pilot, relative(0.01), 0);
  EXPECT_EQ(cost.samples, samples_needed(0, 0, 128, 1.6, 1, std::uint64_t{1} << 40));
  EXPECT_EQ(cost.samples, 512u);  // (1.6 / 0.8)^2 x 128; with the slope of both pilots 344
}

TEST(CostModel, AFloorIsEnoughWhateverTheValue) {
  ViewPilot pilot = pilot_of(2 * std::pow(8, 0.6), 0.6);
  const ViewCost without = view_cost(pilot, relative(0.001), 0);
  pilot.row[0].floor_w_sr = 1;  // 1 % of the value
  const ViewCost with = view_cost(pilot, relative(0.001), 0);
  EXPECT_EQ(with.samples, view_cost(pilot, relative(0.01), 0).samples);
  EXPECT_LT(4 * with.samples, without.samples);
  EXPECT_EQ(with.reached, 0u) << "the relative error is not reached";
  EXPECT_EQ(with.at_floor, 1u);
  EXPECT_DOUBLE_EQ(sweep_cost(std::vector{with}, 1, 1, 1, 0).at_floor_fraction, 1);
  // A floor below the relative error changes nothing.
  pilot.row[0].floor_w_sr = 0.05;
  EXPECT_EQ(view_cost(pilot, relative(0.001), 0).samples, without.samples);
}

TEST(CostModel, AThirdPilotCostsASixteenth) {
  // Plain Monte Carlo, 1 at 1024 samples: 0.01 x 0.8 needs (1 / 0.008)^2 times as many.
  const ViewCost cost =
      view_cost(pilot_of(std::sqrt(8.0), 0.5), relative(1e-4, std::uint64_t{1} << 40), 0);
  const double wanted = 1024 * std::pow(1 / 0.008, 2);
  EXPECT_GE(static_cast<double>(cost.samples), wanted * 0.999);
  EXPECT_LE(static_cast<double>(cost.samples), wanted * 1.126);
  const double stored = static_cast<double>(cost.samples);
  EXPECT_NEAR(cost.cpu_s / seconds_of(stored * (1 + 1.0 / 16)), 1, 0.01);
}

TEST(CostModel, TheRowThatNeedsMostDecides) {
  ViewPilot pilot = pilot_of(0.1, 0.5);
  pilot.row.push_back(pilot_of(4 * std::sqrt(8.0), 0.5).row[0]);
  EXPECT_EQ(view_cost(pilot, relative(0.01), 0).samples,
            view_cost(pilot_of(4 * std::sqrt(8.0), 0.5), relative(0.01), 0).samples);
}

TEST(CostModel, WhatKeepsRowsFromTheirError) {
  ViewPilot biased = pilot_of(0.1, 0.5);
  biased.row[0].bias_w_sr = 5;  // 5 / sqrt(3) of 100 is 2.9 %
  biased.row[0].largest_bound = BoundOf::kTemperature;
  const ViewCost by_bias = view_cost(biased, relative(0.01), 0);
  EXPECT_EQ(by_bias.reached, 0u);
  EXPECT_EQ(by_bias.kept_by_bias, 1u);
  EXPECT_EQ(by_bias.limited, (std::map<std::string_view, std::uint32_t>{{"temperature", 1}}));
  EXPECT_EQ(view_cost(biased, relative(0.05), 0).reached, 1u);
  EXPECT_TRUE(view_cost(biased, relative(0.05), 0).limited.empty());

  const ViewCost by_limit = view_cost(pilot_of(8, 0.5), relative(0.001, 2048), 0);
  EXPECT_EQ(by_limit.samples, 2048u);
  EXPECT_EQ(by_limit.reached, 0u);
  EXPECT_EQ(by_limit.kept_by_limit, 1u);
  EXPECT_EQ(by_limit.limited, (std::map<std::string_view, std::uint32_t>{{"sampling", 1}}));
  const SweepCost both = sweep_cost(std::vector{by_bias, by_limit, by_limit}, 3, 1, 1, 0);
  EXPECT_NEAR(both.limited_fraction.at("sampling"), 2.0 / 3, 1e-12);
  EXPECT_NEAR(both.limited_fraction.at("temperature"), 1.0 / 3, 1e-12);

  // The unseen falls as 1 / n: 3 W/sr at 1024 samples, 0.3 at ten times as many.
  ViewPilot unseen = pilot_of(std::sqrt(8.0) * 2, 0.5);
  unseen.row[0].unseen_w_sr = 1.6;
  EXPECT_EQ(view_cost(unseen, relative(0.01), 0).reached, 1u);
}

TEST(CostModel, FixedCountsAndTargetPaths) {
  const ViewPilot pilot = pilot_of(1, 0.5);
  const ViewCost fixed = view_cost(pilot,
                                   {.relative_error = 0,
                                    .target_paths = 0,
                                    .samples_per_replicate = 5000,
                                    .max_samples_per_replicate = 10000},
                                   0);
  EXPECT_EQ(fixed.samples, 5000u);
  EXPECT_NEAR(fixed.cpu_s, seconds_of(5000), 1e-12);
  // 20 paths for each sample of a replicate: 2000 samples, rounded up to a multiple of 16, and a
  // pilot of 1024.
  const ViewCost paths = view_cost(pilot,
                                   {.relative_error = 0,
                                    .target_paths = 40000,
                                    .samples_per_replicate = 0,
                                    .max_samples_per_replicate = 10000},
                                   20);
  EXPECT_EQ(paths.samples, 2000u);
  EXPECT_NEAR(paths.cpu_s, seconds_of(2000 + 1024), 1e-12);
}

TEST(CostModel, ProfilesAddTheirPilotsAndTheirOwnCount) {
  ViewPilot pilot = pilot_of(0.1, 0.5);
  const double without = view_cost(pilot, relative(0.01), 0).cpu_s;
  pilot.profile_cpu_s = 0.5;
  pilot.profile_cpu_s_per_sample = 1e-4;
  ProfilePointPilot fixed;
  fixed.fixed_samples = 10000;
  ProfilePointPilot wanted;
  wanted.stderr_wanted_k = 0.1;
  wanted.stderr_k = {{0.2, 0.05}, {0.04, 0.01}};  // 0.8 x 0.1 is kept at 4096 samples
  pilot.point = {fixed, wanted};
  EXPECT_EQ(profile_samples(wanted, 1 << 22), 4096u);
  EXPECT_NEAR(view_cost(pilot, relative(0.01), 0).cpu_s,
              without + 0.5 + 1e-4 * (10000 + 512 + 4096 + 4096), 1e-12);
  wanted.stderr_wanted_k = 0.0125;
  EXPECT_EQ(profile_samples(wanted, 1 << 22),
            samples_needed(512, 0.2, 4096, 0.05, 0.0125, 1 << 22));
  EXPECT_EQ(profile_samples(wanted, 8192), 8192u);
}

TEST(CostModel, ASweepIsItsViews) {
  std::vector<ViewCost> views(4);
  for (std::size_t i = 0; i < 4; ++i) {
    views[i].cpu_s = static_cast<double>(i + 1);
    views[i].samples = 1024;
    views[i].rows = 2;
    views[i].reached = i == 3 ? 0 : 2;
    views[i].kept_by_bias = i == 3 ? 2 : 0;
  }
  const SweepCost cost = sweep_cost(views, 8, 1, 1, 0.25);
  EXPECT_DOUBLE_EQ(cost.cpu_s, 20);
  EXPECT_DOUBLE_EQ(cost.wall_s, 20.25);
  EXPECT_DOUBLE_EQ(cost.job_cpu_median_s, 2.5);
  EXPECT_DOUBLE_EQ(cost.job_cpu_quartile1_s, 1.75);
  EXPECT_DOUBLE_EQ(cost.job_cpu_quartile3_s, 3.25);
  EXPECT_DOUBLE_EQ(cost.reached_fraction, 0.75);
  EXPECT_DOUBLE_EQ(cost.kept_by_bias_fraction, 0.25);
  // 1 2 3 4 1 2 3 4 by whoever of two workers is free: 1 + 3 + 1 + 2 + 4 and 2 + 4 + 3.
  EXPECT_DOUBLE_EQ(sweep_cost(views, 8, 1, 2, 0).wall_s, 11);
  // One job cannot be shared.
  EXPECT_DOUBLE_EQ(sweep_cost(std::vector{views[3]}, 1, 1, 16, 0.5).wall_s, 4.5);
  // Cut in two.
  EXPECT_DOUBLE_EQ(sweep_cost(std::vector{views[3]}, 1, 2, 2, 0).wall_s, 2);
  EXPECT_DOUBLE_EQ(sweep_cost(std::vector{views[3]}, 1, 2, 2, 0).job_cpu_median_s, 2);
}

TEST(CostModel, BetweenTheStagesTimeIsAsMeasured) {
  ViewPilot pilot = pilot_of(0.1, 0.5, {128, 1024, 8192});
  pilot.cpu_s = {1, 2, 3};
  pilot.time_exponent = 0.5;
  CountRule rule = relative(0);
  const auto at = [&](std::uint64_t n) {
    rule.samples_per_replicate = n;
    return view_cost(pilot, rule, 0).cpu_s;
  };
  EXPECT_DOUBLE_EQ(at(16), 1);
  EXPECT_DOUBLE_EQ(at(128), 1);
  EXPECT_DOUBLE_EQ(at(576), 1.5);
  EXPECT_DOUBLE_EQ(at(1024), 2);
  EXPECT_DOUBLE_EQ(at(8192), 3);
  const double slope = 2 / (std::sqrt(8192) - std::sqrt(128));
  EXPECT_NEAR(at(4 * 8192), 3 + slope * std::sqrt(8192), 1e-12);
}

TEST(CostModel, TimeGrowsWithAPowerOfTheSamples) {
  ViewPilot pilot = pilot_of(0.1, 0.5, {128, 1024, 8192});
  EXPECT_NEAR(time_exponent(std::vector{pilot}), 1, 1e-9);
  for (std::size_t i = 0; i < 3; ++i)
    pilot.cpu_s[i] = 0.02 + 1e-4 * std::pow(static_cast<double>(pilot.samples[i]), 0.6);
  EXPECT_NEAR(time_exponent(std::vector{pilot, pilot}), 0.6, 1e-9);
  pilot.time_exponent = 0.6;
  CountRule rule = relative(0);
  rule.samples_per_replicate = 32768;
  EXPECT_NEAR(view_cost(pilot, rule, 0).cpu_s, 0.02 + 1e-4 * std::pow(32768, 0.6), 1e-12);
  // Two stages do not tell, and noise does not leave its bounds.
  EXPECT_EQ(time_exponent(std::vector{pilot_of(0.1, 0.5)}), 1);
  pilot.cpu_s = {0.02, 0.03, 0.031};
  EXPECT_NEAR(time_exponent(std::vector{pilot}), 0.5, 1e-9);
}

TEST(CostModel, ScatterOfThePilotedViews) {
  std::vector<ViewCost> views(2);
  views[0].cpu_s = 1;
  views[1].cpu_s = 3;
  EXPECT_DOUBLE_EQ(relative_scatter(views, 100), 0.5);  // sd sqrt(2), / sqrt(2), / 2
  EXPECT_EQ(relative_scatter(views, 2), 0);             // nothing is left to guess
}

TEST(CostModel, ViewsAreSpreadAndNested) {
  const auto five = spread_views(191, 5), ten = spread_views(191, 10);
  EXPECT_EQ(five, (std::vector<std::uint64_t>{95, 47, 143, 23, 119}));
  EXPECT_TRUE(std::equal(five.begin(), five.end(), ten.begin()));
  const auto all = spread_views(6, 9);
  EXPECT_EQ(std::set(all.begin(), all.end()), (std::set<std::uint64_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(all.size(), 6u);
}

}  // namespace
}  // namespace irsig
