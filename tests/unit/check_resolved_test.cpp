// Submissions pass the checks of sweep files: every example does, and a sweep that no file could
// state does not.
#include "jobs/check_resolved.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "absl/strings/str_cat.h"
#include "jobs/keys/expand.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

schema::ResolvedSweep resolved_example(const std::string& name) {
  const absl::StatusOr<schema::ResolvedSweep> sweep =
      resolved_file(absl::StrCat(IRSIG_SOURCE_DIR, "/jobs/examples/", name));
  EXPECT_TRUE(sweep.ok()) << name << ": " << sweep.status();
  return sweep.value_or(schema::ResolvedSweep());
}

struct Change {
  std::string named;
  std::function<void(schema::ResolvedSweep&)> apply;
};

void expect_refused(const schema::ResolvedSweep& good, const std::vector<Change>& changes) {
  ASSERT_TRUE(check_resolved(good).ok()) << check_resolved(good);
  for (const Change& change : changes) {
    schema::ResolvedSweep sweep = good;
    change.apply(sweep);
    const absl::Status status = check_resolved(sweep);
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << change.named << ": " << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(change.named));
    EXPECT_LT(status.message().size(), 20000U) << change.named;
  }
}

TEST(CheckResolved, WhatNoFileCouldSayIsRefusedByThePathOfTheField) {
  expect_refused(
      resolved_example("frigate.toml"),
      {
          {"condition[1].part_temperature_k[0] = -5",
           [](auto& s) { s.mutable_condition(1)->set_part_temperature_k(0, -5); }},
          {"condition[0].part_temperature_k[2] = nan",
           [](auto& s) { s.mutable_condition(0)->set_part_temperature_k(2, NAN); }},
          {"sweep.part[0].temperature_k = -5",
           [](auto& s) { s.mutable_sweep()->mutable_part(0)->set_temperature_k(-5); }},
          {"sweep.accuracy.relative_error = -1",
           [](auto& s) { s.mutable_sweep()->mutable_accuracy()->set_relative_error(-1); }},
          {"sweep.band[0].step_um = 0",
           [](auto& s) { s.mutable_sweep()->mutable_band(0)->set_step_um(0); }},
          {"sweep.band[0].step_um = nan",
           [](auto& s) { s.mutable_sweep()->mutable_band(0)->set_step_um(NAN); }},
          {"band[0].step_um = 1e-08 makes more than 100000 wavelengths",
           [](auto& s) { s.mutable_sweep()->mutable_band(0)->set_step_um(1e-8); }},
          {"sweep.profile[0].points = 4e+09",
           [](auto& s) { s.mutable_sweep()->add_profile()->set_points(4000000000U); }},
          {"published[0].relation = \"cousin\"",
           [](auto& s) { s.mutable_sweep()->add_published()->set_relation("cousin"); }},
          {"sweep.material has 1000",
           [](auto& s) {
             for (int i = 0; i < 1000000; ++i) s.mutable_sweep()->add_material();
           }},
          {"sweep.time has 1000",
           [](auto& s) {
             for (int i = 0; i < 1000000; ++i) s.mutable_sweep()->add_time("10:30Z");
           }},
          {"sweep.name has 60000000 bytes",
           [](auto& s) { s.mutable_sweep()->set_name(std::string(60000000, 'x')); }},
          {"condition has 5 elements, expected one for each season at each time: 3",
           [](auto& s) {
             s.add_condition();
             s.add_condition();
           }},
          {"condition has 2 elements", [](auto& s) { s.mutable_condition()->RemoveLast(); }},
          {"condition[2] is of season 0, time 0, expected season 2, time 0",
           [](auto& s) { s.mutable_condition(2)->set_season_index(0); }},
          {"condition[0].part_temperature_k has",
           [](auto& s) { s.mutable_condition(0)->add_part_temperature_k(300); }},
          {"condition[0].time_utc = \"noon\"",
           [](auto& s) { s.mutable_condition(0)->set_time_utc("noon"); }},
          {"condition[0].surroundings.kind = \"moon\"",
           [](auto& s) { s.mutable_condition(0)->mutable_surroundings()->set_kind("moon"); }},
          {"condition[0].surroundings.sea_temperature_k is missing",
           [](auto& s) {
             s.mutable_condition(0)->mutable_surroundings()->clear_sea_temperature_k();
           }},
          {"condition[0].weather is missing",
           [](auto& s) { s.mutable_condition(0)->clear_weather(); }},
          {"condition[0].weather: ",
           [](auto& s) { s.mutable_condition(0)->mutable_weather()->set_profile("marsian"); }},
          {"condition[0].temperature_field.sha256",
           [](auto& s) {
             s.mutable_condition(0)->mutable_temperature_field()->set_file_name("x.csv");
           }},
          {"condition[0].temperature_field.file_name = \"/etc/passwd\"",
           [](auto& s) {
             auto& field = *s.mutable_condition(0)->mutable_temperature_field();
             field.set_sha256(std::string(64, '0'));
             field.set_file_name("/etc/passwd");
           }},
          {"condition[0].temperature_field.part = 4000",
           [](auto& s) { s.mutable_condition(0)->mutable_temperature_field()->add_part(4000); }},
          {"condition[0].temperature_field.heat = 7",
           [](auto& s) { s.mutable_condition(0)->mutable_temperature_field()->set_heat(7); }},
          {"viewpoint[3].range_m = 0", [](auto& s) { s.mutable_viewpoint(3)->clear_range_m(); }},
          {"viewpoint[3].aspect_elevation_deg = 91",
           [](auto& s) { s.mutable_viewpoint(3)->set_aspect_elevation_deg(91); }},
          {"viewpoint[3] is the same as one before it",
           [](auto& s) { *s.mutable_viewpoint(3) = s.viewpoint(1); }},
          {"viewpoint is missing", [](auto& s) { s.clear_viewpoint(); }},
          {"band is missing", [](auto& s) { s.mutable_sweep()->clear_band(); }},
          {"part is missing", [](auto& s) { s.mutable_sweep()->clear_part(); }},
          {"season is missing", [](auto& s) { s.mutable_sweep()->clear_season(); }},
          {"name = \"\" is empty", [](auto& s) { s.mutable_sweep()->clear_name(); }},
          {"air.model = \"soup\"",
           [](auto& s) { s.mutable_sweep()->mutable_air()->set_model("soup"); }},
          {"effects.only[0] = \"moon\"",
           [](auto& s) { s.mutable_sweep()->mutable_effects()->add_only("moon"); }},
          {"model.generate = \"castle\"",
           [](auto& s) { s.mutable_sweep()->mutable_model()->set_generate("castle"); }},
          {"model_sha256 = \"../x\"", [](auto& s) { s.set_model_sha256("../x"); }},
      });
}

TEST(CheckResolved, ImagesAreThoseThatAFileMayAskFor) {
  const auto image = [](schema::ResolvedSweep& s) { return s.mutable_sweep()->mutable_image(); };
  expect_refused(
      resolved_example("camera.toml"),
      {{"image.layers[11] = \"sunn\"", [&](auto& s) { image(s)->add_layers("sunn"); }},
       {"sweep.image.pixels has 3 elements", [&](auto& s) { image(s)->add_pixels(1); }},
       {"may take",
        [&](auto& s) {
          image(s)->set_pixels(0, 4096);
          image(s)->set_pixels(1, 4096);
        }},
       {"sweep.image.pixels[0] = 4e+06", [&](auto& s) { image(s)->set_pixels(0, 4000000); }},
       {"image.kind", [&](auto& s) { image(s)->set_kind("fisheye"); }},
       {"image.max_samples = 12", [&](auto& s) { image(s)->set_max_samples(12); }},
       {"image.field_of_view_deg", [&](auto& s) { image(s)->clear_field_of_view_deg(); }}});
  schema::ResolvedSweep pilot = resolved_example("camera.toml");
  pilot.mutable_sweep()->mutable_output()->set_thumbnail_px(0);
  EXPECT_TRUE(check_resolved(pilot).ok()) << check_resolved(pilot);
  EXPECT_TRUE(check_resolved(resolved_example("training_images.toml")).ok());
}

TEST(CheckResolved, RunsOfTemperaturesAreThoseOfTheFile) {
  const schema::ResolvedSweep good = resolved_example("frigate_day.toml");
  const int last = good.heat_size() - 1;
  ASSERT_GT(good.heat(last).input_size(), 0);
  ASSERT_EQ(good.heat(0).input_size(), 0);
  const std::string run = absl::StrCat("heat[", last, "]");
  const std::string others = "heat has other runs of changes than those that follow";
  expect_refused(
      good,
      {
          {"heat[0].part_temperature_k has",
           [](auto& s) { s.mutable_heat(0)->add_part_temperature_k(300); }},
          {"heat[0].time_utc = \"noon\"",
           [](auto& s) { s.mutable_heat(0)->set_time_utc(0, "noon"); }},
          {"heat[0] has no times", [](auto& s) { s.mutable_heat(0)->clear_time_utc(); }},
          {"heat[0] has no times", [](auto& s) { s.mutable_heat(0)->clear_course(); }},
          {"heat[0].weather is missing", [](auto& s) { s.mutable_heat(0)->clear_weather(); }},
          {"heat[0].surroundings.kind = \"moon\"",
           [](auto& s) { s.mutable_heat(0)->mutable_surroundings()->set_kind("moon"); }},
          {"heat[0].course.record[2] is not after",
           [](auto& s) {
             auto& course = *s.mutable_heat(0)->mutable_course();
             course.mutable_record(2)->set_unix_s(course.record(1).unix_s());
           }},
          {"heat[0].course.record[1].cloud_cover = 7",
           [](auto& s) {
             s.mutable_heat(0)->mutable_course()->mutable_record(1)->set_cloud_cover(7);
           }},
          {"condition[0].temperature_field.shift_k = 5",
           [](auto& s) { s.mutable_condition(0)->mutable_temperature_field()->set_shift_k(5); }},
          {"is a run of changes, expected one of temperatures",
           [=](auto& s) {
             s.mutable_condition(0)->mutable_temperature_field()->set_heat(
                 static_cast<std::uint32_t>(last));
           }},
          {run + ".input[0].sigma = nan",
           [=](auto& s) { s.mutable_heat(last)->mutable_input(0)->set_sigma(NAN); }},
          {run + ".input[0].move = 40",
           [=](auto& s) { s.mutable_heat(last)->mutable_input(0)->set_move(40); }},
          {run + ".input has 100000 elements",
           [=](auto& s) {
             while (s.heat(last).input_size() < 100000) s.mutable_heat(last)->add_input();
           }},
          {others, [=](auto& s) { s.mutable_heat(last)->mutable_input(0)->set_sigma(2); }},
          {others, [=](auto& s) { s.mutable_heat(last)->mutable_input(0)->set_name("luck"); }},
          {others,
           [=](auto& s) { s.mutable_heat(last)->set_base(static_cast<std::uint32_t>(last)); }},
          {others, [=](auto& s) { s.mutable_heat()->RemoveLast(); }},
          {others, [=](auto& s) { s.mutable_sweep()->clear_uncertainty(); }},
          {"uncertainty.sides = \"upper\"",
           [](auto& s) { s.mutable_sweep()->mutable_uncertainty()->set_sides("upper"); }},
          {"sweep.uncertainty.emissivity = -1",
           [](auto& s) { s.mutable_sweep()->mutable_uncertainty()->set_emissivity(-1); }},
          {"uncertainty.ground_temperature_k changes nothing",
           [](auto& s) { s.mutable_sweep()->mutable_uncertainty()->set_ground_temperature_k(1); }},
      });
}

TEST(CheckResolved, JobsAreCountedBeforeTheyAreMade) {
  for (const char* name : {"frigate.toml", "houses.toml", "frigate_day.toml"}) {
    schema::ResolvedSweep sweep = resolved_example(name);
    sweep.mutable_sweep()->mutable_transport()->set_job_size_vertices(1e5);
    EXPECT_EQ(job_count(sweep), static_cast<double>(expand_jobs(sweep, 1).size())) << name;
  }
}

// Pilots go without the changes of temperatures, and nothing else does.
TEST(CheckResolved, PilotsMayLackRunsOfChanges) {
  schema::ResolvedSweep sweep = resolved_example("frigate_day.toml");
  const int all = sweep.heat_size();
  while (sweep.heat(sweep.heat_size() - 1).input_size() > 0) sweep.mutable_heat()->RemoveLast();
  ASSERT_LT(sweep.heat_size(), all);
  EXPECT_FALSE(check_resolved(sweep).ok());
  sweep.mutable_sweep()->mutable_accuracy()->set_samples_per_replicate(64);
  EXPECT_TRUE(check_resolved(sweep).ok()) << check_resolved(sweep);
}

// Sweeps like those of planning/sweep_pilot.cpp and planning/time_budget.cpp.
TEST(CheckResolved, SweepsOfPilotsAndBudgetsAreTaken) {
  schema::ResolvedSweep pilot = resolved_example("frigate.toml");
  while (pilot.viewpoint_size() > 3) pilot.mutable_viewpoint()->RemoveLast();
  schema::Accuracy& accuracy = *pilot.mutable_sweep()->mutable_accuracy();
  ASSERT_TRUE(accuracy.has_relative_error());
  accuracy.set_samples_per_replicate(64);
  accuracy.set_max_samples_per_replicate(64);
  EXPECT_TRUE(check_resolved(pilot).ok()) << check_resolved(pilot);
  accuracy.clear_relative_error();
  accuracy.clear_absolute_error_k();
  EXPECT_TRUE(check_resolved(pilot).ok()) << check_resolved(pilot);
}

TEST(CheckResolved, OfManyErrorsTheRestIsCounted) {
  schema::ResolvedSweep sweep = resolved_example("frigate.toml");
  for (schema::Viewpoint& v : *sweep.mutable_viewpoint()) v.set_range_m(-1);
  const absl::Status status = check_resolved(sweep);
  EXPECT_THAT(std::string(status.message()), HasSubstr("viewpoint[0].range_m = -1"));
  EXPECT_THAT(std::string(status.message()),
              ::testing::EndsWith(absl::StrCat("\nand ", sweep.viewpoint_size() - 20, " more")));
}

// Files may say more than memory holds, too; and the checks of what they may say take no time that
// grows with its square.
TEST(CheckResolved, FilesAreHeldToTheSameSizes) {
  std::string text = text_of(std::filesystem::path(IRSIG_SOURCE_DIR "/jobs/examples/frigate.toml"));
  std::string times = "time = [";
  for (int i = 0; i < 20000; ++i) absl::StrAppend(&times, "\"10:30Z\", ");
  const std::size_t at = text.find("time = [");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, text.find('\n', at) - at, times + "]");
  const auto status = resolved_text(text).status();
  EXPECT_THAT(std::string(status.message()), HasSubstr("time has 20000 elements"));
}

}  // namespace
}  // namespace irsig
