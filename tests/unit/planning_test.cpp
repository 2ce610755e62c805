// Pilots and predictions against a farm whose times and errors are stated.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "core/accuracy/pilot_samples.h"
#include "jobs/check_resolved.h"
#include "planning/machine.h"
#include "planning/prediction.h"
#include "planning/sweep_pilot.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

// A job takes fixed_s + sample_s x samples and the time of its conditions, a row's standard error
// is 100 W/sr x error (128 / samples)^0.6; both times what the view says.
class StatedFarm final : public PilotFarm {
 public:
  double fixed_s = 0.02, sample_s = 1e-4, error = 0.02, row_bytes = 5000;
  std::function<double(const schema::Condition&)> of_condition = [](const auto&) { return 0.0; };
  std::function<double(double azimuth_deg)> of_view = [](double) { return 1.0; };
  absl::Status failure;
  std::set<double> azimuths;  // of all views that were computed
  int conditions = 0;         // the most of a sweep
  double brightest_w_m2 = 0, hottest_k = 0;

  absl::StatusOr<std::vector<PilotStage>> run(std::vector<schema::ResolvedSweep> sweeps) override {
    if (!failure.ok()) return failure;
    std::vector<PilotStage> stages;
    wall_s_ = 0.5;  // of starting
    for (const schema::ResolvedSweep& sweep : sweeps) {
      PilotStage& stage = stages.emplace_back();
      const std::uint64_t samples = sweep.sweep().accuracy().max_samples_per_replicate();
      const auto n = static_cast<double>(samples);
      bytes_ += static_cast<double>(sweep.ByteSizeLong());
      std::uint64_t row = 0;
      EXPECT_TRUE(check_resolved(sweep).ok()) << check_resolved(sweep);
      conditions = std::max(conditions, sweep.condition_size());
      for (const schema::Condition& c : sweep.condition()) {
        brightest_w_m2 = std::max(brightest_w_m2, c.sun_irradiance_w_m2());
        hottest_k = std::max(hottest_k, c.part_temperature_k(0));
      }
      for (int v = 0; v < sweep.viewpoint_size(); ++v) {
        const double azimuth = sweep.viewpoint(v).aspect_azimuth_deg();
        azimuths.insert(azimuth);
        StoredJobCost job;
        job.viewpoint_index = static_cast<std::uint64_t>(v);
        double conditions_s = 0;
        for (const schema::Condition& c : sweep.condition()) conditions_s += of_condition(c);
        job.cpu_s = (fixed_s + sample_s * n + conditions_s) * of_view(azimuth);
        job.samples = 32 * samples;
        job.target_paths = 20 * samples;
        cpu_s_ += job.cpu_s;
        wall_s_ += job.cpu_s;
        stage.jobs.push_back(job);
        for (int i = 0; i < sweep.condition_size() * sweep.sweep().band_size(); ++i) {
          StoredSignature s{};
          s.row = ++row;
          s.aspect_azimuth_deg = azimuth;
          s.intensity_w_sr = 100;
          s.intensity_stderr_w_sr = 100 * error * std::pow(128 / n, 0.6) * of_view(azimuth);
          s.numerical_error_w_sr = s.intensity_stderr_w_sr;
          stage.rows.push_back(s);
          stage.ledgers.emplace_back();
          bytes_ += row_bytes;
        }
      }
    }
    return stages;
  }
  [[nodiscard]] absl::StatusOr<double> bytes() const override { return bytes_; }
  [[nodiscard]] double cpu_s() const override { return cpu_s_; }
  [[nodiscard]] double wall_s() const override { return wall_s_; }

 private:
  double bytes_ = 100e3, cpu_s_ = 0, wall_s_ = 0;
};

LoadedSweep quickstart(double relative_error) {
  LoadedSweep loaded;
  auto sweep = resolved_file(IRSIG_SOURCE_DIR "/jobs/examples/quickstart.toml");
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  loaded.resolved = *std::move(sweep);
  auto& accuracy = *loaded.resolved.mutable_sweep()->mutable_accuracy();
  accuracy.set_relative_error(relative_error);
  accuracy.clear_absolute_error_k();
  return loaded;
}

TEST(SweepPilot, PredictsTheTimeOfAFarmWhoseTimeIsKnown) {
  StatedFarm farm;
  const LoadedSweep loaded = quickstart(0.001);
  const auto pilot = pilot_sweep(loaded, farm);
  ASSERT_TRUE(pilot.ok()) << pilot.status();
  EXPECT_EQ(pilot->views, 24U);
  EXPECT_EQ(pilot->view.size(), 5U) << "alike: five of them tell";
  const StoredPrediction p = prediction_of(*pilot, loaded.resolved, 2);
  // 0.8 of the target (the rule of the stored run) is reached at so many samples.
  const double samples = 128 * std::pow(0.02 / (0.8 * 0.001), 1 / 0.6);
  EXPECT_NEAR(p.job_cpu_median_s, 0.02 + 1e-4 * samples, 0.15 * 1e-4 * samples);
  EXPECT_NEAR(p.cpu_s, 24 * p.job_cpu_median_s, 1e-3 * p.cpu_s);
  EXPECT_GT(p.wall_s, p.cpu_s / 2);
  EXPECT_LT(p.wall_s, 0.7 * p.cpu_s + 1);
  // The pilot's views left 6 rows each, at two or three stages.
  EXPECT_NEAR(pilot->database_bytes_per_view, 6 * 5000, 1);
  EXPECT_EQ(as_message(p).jobs(), p.jobs);
  EXPECT_EQ(as_message(p).cpu_s(), p.cpu_s);
}

TEST(SweepPilot, LooksAtMoreViewsWhereTheyDiffer) {
  StatedFarm farm;
  farm.of_view = [](double azimuth_deg) { return azimuth_deg < 90 ? 8.0 : 1.0; };
  const auto pilot = pilot_sweep(quickstart(0.001), farm);
  ASSERT_TRUE(pilot.ok()) << pilot.status();
  EXPECT_EQ(pilot->view.size(), 15U);
  EXPECT_GE(farm.azimuths.size(), 15U);
}

// Two days by the hour, and 300 conditions, of which the pilot does few: the brightest and the
// hottest among them, and the time of all from what further ones take.
TEST(SweepPilot, OfManyConditionsAFewTell) {
  for (const int conditions : {48, 300}) {
    StatedFarm farm;
    farm.of_condition = [](const auto&) { return 2e-3; };
    LoadedSweep loaded = quickstart(0.01);
    schema::ResolvedSweep& sweep = loaded.resolved;
    const schema::Condition first = sweep.condition(0);
    const schema::Season season = sweep.sweep().season(0);
    sweep.clear_condition();
    sweep.mutable_sweep()->clear_season();
    sweep.mutable_sweep()->mutable_transport()->set_job_size_vertices(1e18);
    for (int i = 0; i < conditions; ++i) {
      *sweep.mutable_sweep()->add_season() = season;
      schema::Condition& c = *sweep.add_condition();
      c = first;
      c.set_season_index(static_cast<std::uint32_t>(i));
      c.set_sun_irradiance_w_m2(i == conditions / 3 + 1 ? 1200 : 900);
      c.set_part_temperature_k(0, i == 2 * conditions / 3 + 1 ? 350 : 300);
    }
    const auto pilot = pilot_sweep(loaded, farm);
    ASSERT_TRUE(pilot.ok()) << pilot.status();
    EXPECT_EQ(farm.conditions, conditions > 60 ? 36 : 12);
    EXPECT_EQ(farm.brightest_w_m2, 1200);
    EXPECT_EQ(farm.hottest_k, 350);
    const StoredPrediction p = prediction_of(*pilot, sweep, 1);
    const double samples = 128 * std::pow(0.02 / (0.8 * 0.01), 1 / 0.6);
    EXPECT_NEAR(p.job_cpu_median_s, 0.02 + 1e-4 * samples + 2e-3 * conditions, 0.03);
    EXPECT_NEAR(pilot->database_bytes_per_view, 2 * conditions * 5000, 1);
  }
}

// The sun makes a condition dearer; which conditions the pilot takes has its own share of suns.
TEST(SweepPilot, CountsConditionsByTheirSuns) {
  constexpr double kNight_s = 4e-3, kSun_s = 2.5 * kNight_s;
  for (const int lit : {0, 30, 270, 300}) {
    StatedFarm farm;
    LoadedSweep loaded = quickstart(0.01);
    schema::ResolvedSweep& sweep = loaded.resolved;
    ASSERT_TRUE(sweep.sweep().transport().sun());
    const schema::Condition first = sweep.condition(0);
    const schema::Season season = sweep.sweep().season(0);
    const std::string noon = first.time_utc();
    const std::string night = noon.substr(0, 11) + "15:30:00Z";  // half past midnight there
    farm.of_condition = [&](const schema::Condition& c) {
      return c.time_utc() == night ? kNight_s : kSun_s;
    };
    sweep.clear_condition();
    sweep.mutable_sweep()->clear_season();
    sweep.mutable_sweep()->mutable_transport()->set_job_size_vertices(1e18);
    for (int i = 0; i < 300; ++i) {
      *sweep.mutable_sweep()->add_season() = season;
      schema::Condition& c = *sweep.add_condition();
      c = first;
      c.set_season_index(static_cast<std::uint32_t>(i));
      c.set_time_utc(i < lit ? noon : night);
    }
    const auto pilot = pilot_sweep(loaded, farm);
    ASSERT_TRUE(pilot.ok()) << pilot.status();
    const double samples = 128 * std::pow(0.02 / (0.8 * 0.01), 1 / 0.6);
    EXPECT_NEAR(prediction_of(*pilot, sweep, 1).job_cpu_median_s,
                0.02 + 1e-4 * samples + lit * kSun_s + (300 - lit) * kNight_s, 0.03)
        << lit;
  }
}

TEST(SweepPilot, PassesOnWhatTheFarmSays) {
  StatedFarm farm;
  farm.failure = absl::AbortedError("a job of the pilot failed: no luck");
  const auto pilot = pilot_sweep(quickstart(0.01), farm);
  EXPECT_EQ(pilot.status(), farm.failure);
}

TEST(Machine, SaysHowManyConditionsFit) {
  JobMemory memory{200e6, 80e6, 16e6};
  EXPECT_TRUE(check_memory(memory, 72, 2, 3e9).ok()) << "2.7 GB";
  const absl::Status refused = check_memory(memory, 600, 2, 3e9);
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(
      std::string(refused.message()),
      HasSubstr(
          "about 9.8 GB with 1 worker, 19.5 GB with 2 (16 MB for each of 600 conditions), and 3 "
          "GB of memory are free: 83 conditions would fit with 2 workers, 175 with "
          "--workers 1"));
  EXPECT_THAT(std::string(check_memory(memory, 1, 1, 1e8).message()),
              HasSubstr("not even one condition would fit"));
  // 80 MB once, and 120 MB and the conditions of each.
  EXPECT_DOUBLE_EQ(memory.bytes(10, 3), 80e6 + 3 * (120e6 + 160e6));
  EXPECT_EQ(memory.conditions_in(memory.bytes(10, 3) + 1, 3), 10U);
  // Temperatures are computed before there are views.
  memory.heat_bytes = 1e9;
  EXPECT_DOUBLE_EQ(memory.bytes(10, 1), 1.2e9);
  EXPECT_DOUBLE_EQ(memory.bytes(100, 1), 1.8e9);
  const absl::Status hot = check_memory(memory, 10, 2, 1e9);
  EXPECT_THAT(std::string(hot.message()), HasSubstr("1 GB for temperatures, before"));
  EXPECT_THAT(std::string(hot.message()), HasSubstr("its temperatures would not fit"));
  EXPECT_GT(usable_memory_bytes(), 0);
  EXPECT_GE(usable_cores(), 1U);
}

}  // namespace
}  // namespace irsig
