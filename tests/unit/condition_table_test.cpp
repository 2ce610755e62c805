// Tables of conditions: what a condition takes from where, what a CSV file may say, how errors find
// their place.
#include "jobs/files/condition_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_sweep.h"
#include "sweep_text.h"

namespace irsig {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kTableTarget = R"(
[model]
generate = "box"
triangles = 12
[place]
latitude_deg = 45
longitude_deg = 0
heading_deg = 0
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
[[part]]
name = "box"
material = "paint"
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.5
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 0, elevation_deg = 30 } ]
[surroundings]
kind = "sea"
sea_temperature_k = 288
[transport]
sun = true
[accuracy]
samples_per_replicate = 64
[air]
model = "atmosphere"
aerosol = "maritime"
visibility_m = 23000
)";
constexpr const char* kWeather = R"(
[weather]
air_temperature_k = 290
relative_humidity_percent = 70
pressure_pa = 101300
wind_speed_m_s = 5
)";
constexpr const char* kSummer = R"(
[[season]]
name = "summer"
date = 2025-06-21
part_temperature_k = { box = 300 }
wind_speed_m_s = 3
)";

absl::StatusOr<schema::ResolvedSweep> with_csv(const std::string& toml, const std::string& csv) {
  auto file = parse_sweep(toml, "s.toml");
  if (!file.ok()) return file.status();
  file->content["condition_file"] = csv;
  return resolve_sweep(*file, "");
}

std::string table_error_of(const absl::StatusOr<schema::ResolvedSweep>& sweep) {
  return std::string(sweep.status().message());
}

TEST(ConditionTable, WhatAConditionDoesNotSayItTakesFromItsSeasonThenFromTheWeather) {
  const auto sweep = resolved_text(absl::StrCat("name = \"t\"", kTableTarget, kWeather, kSummer, R"(
[[condition]]
time = "06:00Z"
[[condition]]
time = "12:00Z"
air_temperature_k = 296
part_temperature_k = { box = 310 }
surroundings = { sea_temperature_k = 290 }
[[condition]]
name = "storm"
time = "2025-07-01T12:00:00Z"
wind_speed_m_s = 15
)"));
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  ASSERT_EQ(sweep->condition_size(), 3);
  std::vector<std::string> times, names;
  std::vector<double> part_k, air_k, wind, sea_k;
  for (const schema::Condition& c : sweep->condition()) {
    times.push_back(c.time_utc());
    names.push_back(c.season());
    part_k.push_back(c.part_temperature_k(0));
    air_k.push_back(c.air_temperature_k());
    wind.push_back(c.weather().wind_speed_m_s());
    sea_k.push_back(c.surroundings().sea_temperature_k());
  }
  EXPECT_THAT(names, ElementsAre("summer", "summer", "storm"));
  EXPECT_THAT(times,
              ElementsAre("2025-06-21T06:00:00Z", "2025-06-21T12:00:00Z", "2025-07-01T12:00:00Z"));
  EXPECT_THAT(part_k, ElementsAre(300, 310, 300));
  EXPECT_THAT(air_k, ElementsAre(290, 296, 290));
  EXPECT_THAT(wind, ElementsAre(3, 3, 15));
  EXPECT_THAT(sea_k, ElementsAre(288, 290, 288));
}

// Conditions written as seasons at times and as a table are equal jobs.
TEST(ConditionTable, JobsAreThoseOfSeasonsAtTimes) {
  const std::string target = absl::StrCat(kTableTarget, kWeather);
  const auto crossed =
      resolved_text(absl::StrCat("name = \"t\"\ntime = [\"06:00Z\", \"12:00Z\"]", target, kSummer));
  const auto table = resolved_text(absl::StrCat("name = \"t\"", target, kSummer,
                                                "[[condition]]\ntime = \"06:00Z\"\n"
                                                "[[condition]]\ntime = \"12:00Z\"\n"));
  const auto csv =
      with_csv(absl::StrCat("name = \"t\"\ncondition_file = \"c.csv\"", target, kSummer),
               "time\n06:00Z\n12:00Z\n");
  for (const auto* sweep : {&crossed, &table, &csv}) ASSERT_TRUE(sweep->ok()) << sweep->status();
  // The place of a condition in the file is in its indices alone.
  const auto keys = [](schema::ResolvedSweep sweep) {
    for (schema::Condition& c : *sweep.mutable_condition()) {
      c.clear_season_index();
      c.clear_time_index();
    }
    std::vector<std::string> out;
    for (const schema::Condition& c : sweep.condition()) out.push_back(c.SerializeAsString());
    return out;
  };
  EXPECT_EQ(keys(*crossed), keys(*table));
  EXPECT_EQ(keys(*crossed), keys(*csv));
}

TEST(ConditionTable, ACsvFileHasAColumnForEachKey) {
  const auto sweep =
      with_csv(absl::StrCat("name = \"t\"\ncondition_file = \"c.csv\"", kTableTarget, kWeather),
               "\xef\xbb\xbf# made by hand\r\n"
               "\"time\", air_temperature_k, sea_temperature_k, part_temperature_k.box\r\n"
               "2025-06-21T06:00:00Z, 288.5, 289, 290\r\n"
               "\r\n"
               "2025-06-21T12:00:00Z,      , 290, 305\r\n");
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  ASSERT_EQ(sweep->condition_size(), 2);
  EXPECT_EQ(sweep->condition(0).air_temperature_k(), 288.5);
  EXPECT_EQ(sweep->condition(1).air_temperature_k(), 290);
  EXPECT_EQ(sweep->condition(1).surroundings().sea_temperature_k(), 290);
  EXPECT_EQ(sweep->condition(1).part_temperature_k(0), 305);
  EXPECT_EQ(sweep->condition(0).season(), "2025-06-21");
}

TEST(ConditionTable, VariedWeather) {
  const std::string head =
      absl::StrCat("name = \"t\"\ntime = [\"12:00Z\"]", kTableTarget, kWeather, kSummer);
  const auto crossed = resolved_text(absl::StrCat(
      head,
      "[vary]\ncombine = \"cross\"\nwind_speed_m_s = [2, 8]\nsea_temperature_k = [285, 290]\n"));
  ASSERT_TRUE(crossed.ok()) << crossed.status();
  ASSERT_EQ(crossed->condition_size(), 4);
  EXPECT_EQ(crossed->condition(3).weather().wind_speed_m_s(), 8);
  EXPECT_EQ(crossed->condition(3).surroundings().sea_temperature_k(), 290);
  EXPECT_EQ(crossed->condition(2).season(), "summer, wind_speed_m_s = 8, sea_temperature_k = 285");
  const auto zipped = resolved_text(absl::StrCat(
      head, "[vary]\ncombine = \"zip\"\nwind_speed_m_s = [2, 8]\nvisibility_m = [5000, 50000]\n"));
  ASSERT_TRUE(zipped.ok()) << zipped.status();
  ASSERT_EQ(zipped->condition_size(), 2);
  EXPECT_EQ(zipped->condition(1).weather().visibility_m(), 50000);
  const auto profiles = resolved_text(
      absl::StrCat(head, "[vary]\nprofile = [\"midlatitude_summer\", \"us_standard_1976\"]\n"));
  ASSERT_TRUE(profiles.ok()) << profiles.status();
  EXPECT_EQ(profiles->condition(1).weather().profile(), "us_standard_1976");
}

TEST(ConditionTable, EachDirectionAtEachRange) {
  std::string text =
      absl::StrCat("name = \"t\"\ntime = [\"12:00Z\"]", kTableTarget, kWeather, kSummer);
  text.replace(text.find("range_m = 1000"), 14, "ranges_m = [1000, 5000]");
  const auto sweep = resolved_text(text);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  ASSERT_EQ(sweep->viewpoint_size(), 2);
  EXPECT_EQ(sweep->viewpoint(1).range_m(), 5000);
  EXPECT_EQ(sweep->viewpoint(1).aspect_elevation_deg(), 30);
}

struct Wrong {
  const char* what;
  std::string text, csv;
  std::vector<std::string> said;
};

TEST(ConditionTable, ErrorsStandWhereTheyWereWritten) {
  const std::string top = "name = \"t\"\n", file = "name = \"t\"\ncondition_file = \"c.csv\"\n";
  const std::string target = absl::StrCat(kTableTarget, kWeather);
  for (const Wrong& w : std::vector<Wrong>{
           {"a time that is none",
            top + target + kSummer + "[[condition]]\ntime = \"noon\"\n",
            "",
            {"condition[0].time = \"noon\" is no time of day"}},
           {"no time",
            top + target + kSummer + "[[condition]]\nwind_speed_m_s = 4\n",
            "",
            {"condition[0].time is missing"}},
           {"no date",
            top + target + "[[condition]]\ntime = \"12:00Z\"\n",
            "",
            {"condition[0].date is missing"}},
           {"an unknown season",
            top + target + kSummer + "[[condition]]\nseason = \"sumer\"\ntime = \"12:00Z\"\n",
            "",
            {"condition[0].season = \"sumer\", did you mean \"summer\"?"}},
           {"times as well",
            "name = \"t\"\ntime = [\"12:00Z\"]\n" + target + kSummer +
                "[[condition]]\ntime = \"12:00Z\"\n",
            "",
            {"s.toml:2:1: time does not apply"}},
           {"twice the same",
            top + target + kSummer +
                "[[condition]]\ntime = \"12:00Z\"\n[[condition]]\ntime = \"12:00Z\"\n",
            "",
            {"condition[1] is \"summer\" at the same time as condition[0]"}},
           {"the same instant in another zone",
            top + target + kSummer +
                "[[condition]]\ntime = \"12:00Z\"\n[[condition]]\ntime = \"14:00+02:00\"\n",
            "",
            {"condition[1] is \"summer\" at the same time as condition[0]"}},
           {"an unknown column",
            file + target + kSummer,
            "time,wind\n12:00Z,4\n",
            {"c.csv:1:6: condition_file: unknown column \"wind\""}},
           {"no number",
            file + target + kSummer,
            "time,wind_speed_m_s\n12:00Z, calm\n",
            {"c.csv:2:9: condition_file: wind_speed_m_s = \"calm\", expected a number"}},
           {"a column missing",
            file + target + kSummer,
            "time,wind_speed_m_s\n12:00Z\n",
            {"c.csv:2:1: condition_file: 1 columns, expected 2"}},
           {"out of its bounds",
            file + target + kSummer,
            "time,wind_speed_m_s\n\n12:00Z,250\n",
            {"c.csv:3:8: condition[0].wind_speed_m_s = 250, expected a number from 0 to 100"}},
           {"an hour twice",
            file + target + kSummer,
            "time,wind_speed_m_s\n12:00Z,4\n12:00Z,5\n",
            {"c.csv:3:1: condition[1] is \"summer\" at the same time as condition[0]"}},
           {"semicolons",
            file + target + kSummer,
            "time;wind_speed_m_s\n12:00Z;4\n",
            {"c.csv:1:1: condition_file: unknown column \"time;wind_speed_m_s\", expected columns "
             "separated by commas"}},
           {"an hour in another season than its name says",
            file + target + kSummer,
            "date,time\n2025-06-21,12:00Z\n2025-12-24,12:00Z\n",
            {"c.csv:3:1: condition[1].name = \"summer\" and date = 2025-12-24"}},
           {"a part that nobody knows",
            file + target + kSummer,
            "time,part_temperature_k.hull\n12:00Z,290\n",
            {"c.csv:2:8", "hull"}},
           {"an empty file", file + target + kSummer, "\n# nothing\n", {"c.csv:1:1", "is empty"}},
           {"only names", file + target + kSummer, "time\n", {"has no conditions"}},
           {"both",
            file + target + kSummer + "[[condition]]\ntime = \"12:00Z\"\n",
            "time\n12:00Z\n",
            {"condition_file and [[condition]] are both there"}},
           {"a name in the weather",
            "name = \"t\"\ntime = [\"12:00Z\"]\n" + std::string(kTableTarget) + kSummer +
                "[weather]\nname = \"x\"\n",
            "",
            {"weather.name does not apply"}},
           {"a season's own time",
            "name = \"t\"\ntime = [\"12:00Z\"]\n" + target +
                "[[season]]\nname = \"a\"\ndate = 2025-06-21\ntime = \"12:00Z\"\n",
            "",
            {"season[0].time does not apply: all seasons have the times of day of the sweep"}},
           {"lists of different lengths",
            "name = \"t\"\ntime = [\"12:00Z\"]\n" + target + kSummer +
                "[vary]\ncombine = \"zip\"\nwind_speed_m_s = [1]\n"
                "visibility_m = [1e3, 2e3]\n",
            "",
            {"vary.combine = \"zip\" of lists of 1 and 2 values"}},
           {"two lists and no word how",
            "name = \"t\"\ntime = [\"12:00Z\"]\n" + target + kSummer +
                "[vary]\nwind_speed_m_s = [1]\nvisibility_m = [1e3]\n",
            "",
            {"vary.combine is missing"}}}) {
    const auto sweep = w.csv.empty() ? resolved_text(w.text) : with_csv(w.text, w.csv);
    ASSERT_FALSE(sweep.ok()) << w.what;
    for (const std::string& said : w.said)
      EXPECT_THAT(table_error_of(sweep), HasSubstr(said)) << w.what;
    EXPECT_THAT(table_error_of(sweep), testing::Not(HasSubstr("season[1]"))) << w.what;
  }
}

}  // namespace
}  // namespace irsig
