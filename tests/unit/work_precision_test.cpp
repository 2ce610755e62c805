// The arithmetic on curves of work and error: slopes, times to a target, errors at a time, and
// which points a study makes.
#include "core/study/work_precision.h"

#include <gtest/gtest.h>

#include <cmath>

namespace irsig {
namespace {

// error = 0.1 work^slope at 1, 4, 16, ...
std::vector<WorkError> power_law(double slope, int points) {
  std::vector<WorkError> out;
  for (int i = 0; i < points; ++i) {
    const double work = std::pow(4.0, i);
    out.push_back({work, 0.1 * std::pow(work, slope)});
  }
  return out;
}

TEST(ErrorSlope, IsTheExponentOfAPowerLaw) {
  EXPECT_NEAR(*error_slope(power_law(-0.5, 6), 0), -0.5, 1e-12);
  EXPECT_NEAR(*error_slope(power_law(-0.75, 3), 0), -0.75, 1e-12);
  EXPECT_FALSE(error_slope(power_law(-0.5, 2), 0)) << "two points are no fit";
}

TEST(ErrorSlope, DoesNotLookBelowTheFloor) {
  std::vector<WorkError> curve = power_law(-0.7, 5);
  const double floor = curve.back().error;
  // Where the reference's own error is met, the curve levels off.
  for (int i = 0; i < 3; ++i) curve.push_back({4 * curve.back().work, 0.99 * floor});
  EXPECT_NEAR(*error_slope(curve, floor), -0.7, 1e-12);
  EXPECT_GT(*error_slope(curve, 0), -0.6);
}

TEST(WorkToTarget, IsReadBetweenPoints) {
  // 0.1 work^-0.5 is 0.01 at work 100 and 0.05 at 4.
  const auto inside = work_to_target(power_law(-0.5, 5), 0.01, 0);
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->work, 100, 1e-9);
  EXPECT_FALSE(inside->extrapolated);
  EXPECT_NEAR(work_to_target(power_law(-0.5, 5), 0.05, 0)->work, 4, 1e-9);
}

TEST(WorkToTarget, IsExtrapolatedAlongTheEndOfTheCurve) {
  const auto beyond = work_to_target(power_law(-0.5, 5), 0.001, 0);
  ASSERT_TRUE(beyond);
  EXPECT_TRUE(beyond->extrapolated);
  EXPECT_NEAR(beyond->work, 1e4, 1e-6);
}

TEST(WorkToTarget, AMethodThatIsBelowAtOnceTakesItsFirstTime) {
  const auto first = work_to_target({{2, 0.005}, {8, 0.001}}, 0.01, 0);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->work, 2);
}

TEST(WorkToTarget, ABiasIsNeverMended) {
  EXPECT_FALSE(
      work_to_target({{1, 0.1}, {4, 0.05}, {16, 0.048}, {64, 0.05}, {256, 0.049}}, 0.01, 0));
  EXPECT_FALSE(work_to_target({{1, 0.1}}, 0.01, 0));
  EXPECT_FALSE(work_to_target({}, 0.01, 0));
}

TEST(WorkToTarget, AnErrorThatComesBackDoesNotCount) {
  const auto last = work_to_target({{1, 0.1}, {4, 0.005}, {16, 0.02}, {64, 0.005}}, 0.01, 0);
  ASSERT_TRUE(last);
  EXPECT_NEAR(last->work, 32, 1e-9);  // half way from 16 to 64: 0.02 -> 0.01 -> 0.005
}

TEST(ErrorAtWork, IsKnownOnTheCurveOnly) {
  const std::vector<WorkError> curve = power_law(-0.5, 5);
  EXPECT_NEAR(*error_at_work(curve, 100), 0.01, 1e-12);
  EXPECT_FALSE(error_at_work(curve, 0.5));
  EXPECT_FALSE(error_at_work(curve, 1e6));
}

// A method whose value is off by +-1 / sqrt(n), and whose time is n ms by a clock of its own.
TEST(WorkCurve, TakesTheRootMeanSquareOverSeedsAndTheTimeOfOneRun) {
  double now_s = 0;
  const WorkMethod method{"made up",
                          [&](std::uint64_t samples, std::uint64_t seed) {
                            const double n = static_cast<double>(samples);
                            now_s += 1e-3 * n;
                            const double sign = seed % 2 == 0 ? 1 : -1;
                            const double value = 50 * (1 + sign / std::sqrt(n));
                            return EstimateRun{{value, 2 * value, 7, {value, 50}}, 32 * n, {}};
                          },
                          4};
  ReferenceValue reference;
  reference.value = {50, 100, 7, {50, 50}};
  WorkBudget budget;
  budget.cpu_s = 10;
  const auto points = work_curve(method, reference, budget, [&] { return now_s; });
  ASSERT_GE(points.size(), 3u);
  for (const WorkPoint& p : points) {
    const double n = static_cast<double>(p.samples_per_replicate);
    EXPECT_NEAR(p.cpu_s, 1e-3 * n, 1e-12);
    EXPECT_EQ(p.samples, 32 * n);
    EXPECT_GE(p.seeds, budget.least_seeds);
    const auto error = [&](StudiedQuantity what) {
      return p.relative_error[static_cast<std::size_t>(what)];
    };
    EXPECT_NEAR(error(StudiedQuantity::kIntensity), 1 / std::sqrt(n), 1e-9);
    EXPECT_NEAR(error(StudiedQuantity::kEmitted), 1 / std::sqrt(n), 1e-9);
    EXPECT_EQ(error(StudiedQuantity::kArea), 0);
    EXPECT_NEAR(error(StudiedQuantity::kSpectrum), std::sqrt(0.5 / n), 1e-9)
        << "one of two is right";
  }
  EXPECT_EQ(points[1].samples_per_replicate, 16u);
  EXPECT_NEAR(*error_slope(against_time(points, StudiedQuantity::kIntensity), 0), -0.5, 1e-9);
  EXPECT_LT(now_s, 1.5 * budget.cpu_s);
}

// 2 ms and what the samples take that an error asked for needs; stated 0.9 of what is asked.
TEST(WholeRunCurve, HasAPointForEachErrorAskedAsFarAsTheBudgetGoes) {
  double now_s = 0;
  int runs = 0;
  const WholeRunMethod method{
      "made up", [&](double asked, std::uint64_t seed) {
        const double n = std::ceil(1 / (asked * asked));
        now_s += 2e-3 + 1e-6 * n;
        ++runs;
        EstimateRun run;
        run.value = {50 * (1 + (seed % 2 == 0 ? asked : -asked) / 2), 100, 7, {50, 50}};
        run.samples = 32 * n;
        run.samples_per_replicate = static_cast<std::uint64_t>(n);
        run.relative_numerical_error = 0.9 * asked;
        return absl::StatusOr<EstimateRun>(run);
      }};
  ReferenceValue reference;
  reference.value = {50, 100, 7, {50, 50}};
  WorkBudget budget;
  budget.cpu_s = 1;
  budget.least_seeds = 4;
  budget.most_seeds = 8;
  const std::vector<double> asked = {0.1, 0.01, 0.005, 0.0005};
  const auto points = whole_run_curve(method, asked, reference, budget, [&] { return now_s; });
  ASSERT_TRUE(points.ok()) << points.status();
  ASSERT_EQ(points->size(), 3u) << "4 seeds of 4 s each do not fit into 1 s";
  EXPECT_LT(now_s, budget.cpu_s);
  std::uint32_t counted = 0;
  for (std::size_t i = 0; i < points->size(); ++i) {
    const WorkPoint& p = (*points)[i];
    EXPECT_EQ(p.asked_relative_error, asked[i]);
    EXPECT_NEAR(p.relative_error[0], asked[i] / 2, 1e-12);
    EXPECT_NEAR(p.relative_numerical_error, 0.9 * asked[i], 1e-12);
    EXPECT_NEAR(p.cpu_s, 2e-3 + 1e-6 / (asked[i] * asked[i]), 1e-4);
    EXPECT_NEAR(p.samples, 32.0 * static_cast<double>(p.samples_per_replicate), 1e-6);
    counted += p.seeds;
  }
  EXPECT_EQ(static_cast<std::uint32_t>(runs), counted + 1) << "the first run is not counted";
}

TEST(WholeRunCurve, StopsAtAnError) {
  const WholeRunMethod method{"none", [](double asked, std::uint64_t) {
                                if (asked < 0.1)
                                  return absl::StatusOr<EstimateRun>(absl::InternalError("no"));
                                return absl::StatusOr<EstimateRun>(EstimateRun{});
                              }};
  double now_s = 0;
  const std::vector<double> asked = {0.1, 0.01};
  EXPECT_EQ(whole_run_curve(method, asked, {}, {}, [&] { return now_s += 0.01; }).status(),
            absl::InternalError("no"));
}

// A budget of primary rays makes the same points whatever the clock says.
TEST(WorkCurve, ABudgetOfRaysAsksNoClock) {
  const WorkMethod method{"made up",
                          [](std::uint64_t samples, std::uint64_t seed) {
                            const double n = static_cast<double>(samples);
                            const double value = 50 + static_cast<double>(seed % 2) / n;
                            return EstimateRun{{value, 2 * value, 7, {value}}, 32 * n, {}};
                          },
                          4};
  const WholeRunMethod whole{"made up", [](double asked, std::uint64_t) {
                               EstimateRun run;
                               run.value = {50, 100, 7, {50}};
                               run.samples = 32 / (asked * asked);
                               return absl::StatusOr<EstimateRun>(run);
                             }};
  ReferenceValue reference;
  reference.value = {50, 100, 7, {50}};
  WorkBudget budget;
  budget.primary_rays = 32 * 1e5;
  const std::vector<double> asked = {0.1, 0.03, 0.01, 0.001};
  std::vector<std::size_t> points, seeds;
  for (const double step_s : {0.0, 1e-3, 1e9}) {
    double now_s = 0;
    const auto clock = [&] { return now_s += step_s; };
    const auto curve = work_curve(method, reference, budget, clock);
    std::size_t count = 0;
    for (const WorkPoint& p : curve) count += p.seeds;
    points.push_back(curve.size());
    seeds.push_back(count);
    const auto runs = whole_run_curve(whole, asked, reference, budget, clock);
    ASSERT_TRUE(runs.ok());
    EXPECT_EQ(runs->size(), 3u) << "of 1e6 samples eight do not fit";
  }
  EXPECT_GE(points[0], 3u);
  EXPECT_EQ(points[0], points[1]);
  EXPECT_EQ(points[0], points[2]);
  EXPECT_EQ(seeds[0], seeds[1]);
  EXPECT_EQ(seeds[0], seeds[2]);
}

}  // namespace
}  // namespace irsig
