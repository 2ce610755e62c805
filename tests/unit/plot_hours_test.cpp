// Over the hours of a day: the right hour, the right day, the numbers of the rows, and what one
// picture cannot show is refused.
#include <gmock/gmock.h>

#include <sstream>

#include "fake_database.h"
#include "view/report/hours.h"

namespace irsig {
namespace {

using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::HasSubstr;
using ::testing::Not;

std::size_t count_hours(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

// Each curve is drawn with the two edges of its band.
std::size_t curves(const std::string& svg) { return count_hours(svg, "<polyline") / 3; }

std::string utc(const std::string& date, int hour) {
  return date + (hour < 10 ? "T0" : "T") + std::to_string(hour) + ":00:00Z";
}

// Two seasons of eight times, one viewpoint, two bands. Time zone of the place: UTC + 9 h.
FakeDatabase day_of_hours(bool placed = true) {
  FakeSweep sweep;
  sweep.viewpoint = {{90, 10, 2000}};
  sweep.season.clear();
  for (const auto& [season, date] :
       {std::pair{"winter", "2025-01-29"}, std::pair{"summer", "2025-07-22"}})
    for (int h = 0; h < 24; h += 3) sweep.season.push_back({season, utc(date, h), 1 + 0.01 * h});
  FakeDatabase db = fake_database(sweep);
  schema::ResolvedSweep resolved;
  if (placed) {
    resolved.mutable_sweep()->mutable_place()->set_latitude_deg(35);
    resolved.mutable_sweep()->mutable_place()->set_longitude_deg(135);
  }
  db.sweeps["box ship"] = {resolved, {}, {}};
  return db;
}

void add_temperatures(FakeDatabase& db) {
  for (const auto& s : db.signatures) {
    if (s.band != "lwir") continue;
    for (const char* part : {"hull", "deck"})
      db.temperatures.push_back(
          {s.sweep, s.season, s.time_utc, part, 290, 285, 301, 0.2, false, "k"});
  }
}

TEST(PlotHours, HoursAreThoseOfTheSunAtThePlace) {
  FakeDatabase db = day_of_hours();
  const auto hours = hours_of(db, {.season = "winter", .band = "lwir"});
  ASSERT_TRUE(hours.ok()) << hours.status();
  ASSERT_EQ(hours->value.size(), 8U);
  // 00:00 to 21:00 UTC are 09:00 to 06:00 of the next day: its middle is at 19:30.
  EXPECT_THAT(hours->value.front().at.hour, DoubleNear(9, 1e-6));
  EXPECT_THAT(hours->value.back().at.hour, DoubleNear(30, 1e-6));
  EXPECT_EQ(hours->value.back().at.day, "winter");
  const std::string svg = plot_hours(*hours);
  EXPECT_THAT(svg,
              AllOf(HasSubstr("Local mean solar time in h (UTC + 9.00 h)"),
                    HasSubstr("box ship, azimuth 90.0\u00b0, elevation 10.0\u00b0, range 2 km"),
                    HasSubstr("lwir (8\u201312 \u00b5m)"), HasSubstr("In-band intensity in kW/sr"),
                    HasSubstr(">winter<"), Not(HasSubstr("nan"))));
  EXPECT_EQ(curves(svg), 1U);
  EXPECT_EQ(count_hours(svg, "<circle"), 8U);
}

TEST(PlotHours, WithoutAPlaceTheyAreOfUtc) {
  FakeDatabase db = day_of_hours(false);
  const auto hours = hours_of(db, {});
  ASSERT_TRUE(hours.ok()) << hours.status();
  EXPECT_FALSE(hours->solar_offset_h);
  EXPECT_EQ(hours->value.front().at.hour, 0);
  const std::string svg = plot_hours(*hours);
  EXPECT_THAT(svg, AllOf(HasSubstr(">UTC in h<"), Not(HasSubstr("solar"))));
  EXPECT_EQ(curves(svg), 4U) << "two bands, two seasons";
}

TEST(PlotHours, TemperaturesHaveAPanelForEachSeason) {
  FakeDatabase db = day_of_hours();
  add_temperatures(db);
  // A temperature of the version before, not replaced yet: its successor is shown.
  StoredTemperature old = db.temperatures.front();
  old.superseded = true;
  old.mean_k = 300;
  db.temperatures.insert(db.temperatures.begin(), old);
  const auto hours = hours_of(db, {.band = "lwir"});
  ASSERT_TRUE(hours.ok()) << hours.status();
  EXPECT_EQ(hours->temperature.size(), 32U);
  for (const auto& t : hours->temperature) EXPECT_EQ(t.part.mean_k, 290);
  const std::string svg = plot_hours(*hours);
  EXPECT_THAT(svg, AllOf(HasSubstr("winter, computed temperatures"),
                         HasSubstr("summer, computed temperatures"), HasSubstr("Temperature in K"),
                         HasSubstr(">hull<"), HasSubstr(">deck<")));
  EXPECT_EQ(curves(svg), 2U * 2U + 2U);
  const auto one = hours_of(db, {.season = "summer"});
  ASSERT_TRUE(one.ok());
  EXPECT_EQ(one->temperature.size(), 16U) << "of what was asked for alone";
}

// Rationale: a part that warms before sunrise is explained by what is behind it.
// Expected: the schedule's curve from a day's first hour to its last, upright where it jumps, in
// the hours of the place; in the table at its times.
TEST(PlotHours, WhatIsBehindWallsIsDrawn) {
  FakeDatabase db = day_of_hours();
  add_temperatures(db);
  schema::Sweep& sweep = *db.sweeps["box ship"].resolved.mutable_sweep();
  const auto wall = [&](const std::string& part, const std::string& inside) -> schema::BuildUp& {
    schema::Part& of = *sweep.add_part();
    of.set_name(part);
    of.set_build_up(part + " wall");
    schema::BuildUp& out = *sweep.add_build_up();
    out.set_name(part + " wall");
    out.set_inside(inside);
    return out;
  };
  schema::BuildUp& hull = wall("hull", "air");
  hull.set_inside_between("steps");
  for (const auto& [time, kelvin] : {std::pair{"06:00:00Z", 310}, {"10:30:00Z", 295}}) {
    schema::InsideAt& at = *hull.add_inside_schedule();
    at.set_time(time);
    at.set_temperature_k(kelvin);
  }
  schema::InsideAt& machine = *wall("deck", "heat_flux").add_inside_schedule();
  machine.set_time("00:00:00Z");
  machine.set_heat_flux_w_m2(120);
  wall("unseen", "air").add_inside_schedule()->set_time("00:00:00Z");

  const auto hours = hours_of(db, {.season = "winter", .band = "lwir"});
  ASSERT_TRUE(hours.ok()) << hours.status();
  std::vector<std::pair<double, double>> of_hull;
  for (const HourlyInside& i : hours->inside) {
    EXPECT_NE(i.build_up, "unseen wall");
    EXPECT_EQ(i.at.day, "winter");
    if (!i.heat_flux) of_hull.emplace_back(i.at.hour, i.value);
  }
  // 9 h to 30 h of the place are 0 h to 21 h UTC.
  const std::vector<std::pair<double, double>> expected = {{9, 295},    {15, 295},   {15, 310},
                                                           {19.5, 310}, {19.5, 295}, {30, 295}};
  ASSERT_EQ(of_hull.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(of_hull[i].first, expected[i].first, 1e-6) << i;
    EXPECT_EQ(of_hull[i].second, expected[i].second) << i;
  }
  EXPECT_THAT(plot_hours(*hours),
              AllOf(HasSubstr(">behind hull wall<"), HasSubstr(">behind deck wall<"),
                    HasSubstr("winter, heat into walls"), HasSubstr("Heat flux in W/m\u00b2"),
                    Not(HasSubstr("nan"))));
  std::ostringstream csv;
  ASSERT_TRUE(write_hours(*hours, "csv", csv).ok());
  EXPECT_THAT(
      csv.str(),
      AllOf(
          HasSubstr(",build_up,inside_temperature_k,inside_heat_flux_w_m2\n"),
          HasSubstr("box ship,winter,winter,2025-01-29T06:00:00Z,15,,,,,,,,,,,,,,hull wall,310,\n"),
          HasSubstr(",deck wall,,120\n")));
}

TEST(PlotHours, SeveralDaysOfASeasonAreCurvesOfTheirOwn) {
  FakeSweep sweep;
  sweep.viewpoint = {{90, 10, 2000}};
  sweep.season.clear();
  for (const char* date : {"2025-01-29", "2025-01-30"})
    for (int h : {1, 5, 9}) sweep.season.push_back({"trial", utc(date, h), 1});
  FakeDatabase db = fake_database(sweep);
  db.sweeps["box ship"] = {};
  const auto hours = hours_of(db, {.band = "mwir"});
  ASSERT_TRUE(hours.ok()) << hours.status();
  EXPECT_EQ(hours->value.front().at.day, "trial 2025-01-29");
  EXPECT_EQ(hours->value.back().at.day, "trial 2025-01-30");
  EXPECT_EQ(hours->value.back().at.hour, 9);
  EXPECT_EQ(curves(plot_hours(*hours)), 2U);
}

TEST(PlotHours, TheTableHasTheNumbersOfTheRows) {
  FakeDatabase db = day_of_hours();
  add_temperatures(db);
  const auto hours = hours_of(
      db, {.season = "winter", .band = "lwir", .quantity = SignatureQuantity::kContrastIntensity});
  ASSERT_TRUE(hours.ok()) << hours.status();
  std::ostringstream csv;
  ASSERT_TRUE(write_hours(*hours, "csv", csv).ok());
  EXPECT_THAT(
      csv.str(),
      AllOf(HasSubstr("sweep,day,season,time_utc,solar_time_h,part,mean_k,coldest_k,"
                      "hottest_k,error_k,band,aspect_azimuth_deg,aspect_elevation_deg,"
                      "range_m,contrast_intensity_w_sr,contrast_intensity_stderr_w_sr,"
                      "contrast_numerical_error_w_sr"),
            HasSubstr("box ship,winter,winter,2025-01-29T00:00:00Z,9,hull,290,285,301,0.2,"),
            HasSubstr("box ship,winter,winter,2025-01-29T21:00:00Z,30,,,,,,lwir,90,10,2000,")));
  EXPECT_EQ(count_hours(csv.str(), "\n"), 1U + 16U + 8U);
}

TEST(PlotHours, RefusesOneTimeAndSeveralViewpoints) {
  FakeDatabase db = day_of_hours();
  const auto alone = hours_of(db, {.season = "winter", .time = "2025-01-29T03:00:00Z"});
  EXPECT_EQ(alone.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(alone.status().message()),
              AllOf(HasSubstr("two times or more"), HasSubstr("winter")));
  FakeDatabase many = fake_database();
  const auto views = hours_of(many, {});
  EXPECT_EQ(views.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(views.status().message()), HasSubstr("--aspect"));
  EXPECT_EQ(hours_of(db, {.max_relative_error = 1e-9}).status().code(),
            absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace irsig
