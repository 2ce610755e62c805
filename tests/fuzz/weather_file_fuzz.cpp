// Mutated weather files, the same ones in every run: the reader must refuse them with
// file:line:column or return courses that are sound, whatever stands in the file. Run it with
// IRSIG_SANITIZE=address,undefined to see more.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "core/thermal/weather_file.h"
#include "tests/fuzz/mutator.h"
#include "tests/fuzz/turns.h"

namespace irsig {
namespace {

constexpr WeatherPlace kBay{37.62, -122.4, 2};

constexpr const char* kWords[] = {
    "nan",  "1e999", "-9999", ",",    "99.9", "999999",       ":",        "1e300", "-9900", "\r\n",
    "\n\n", "#",     "24",    "2,29", "time", "DATA PERIODS", "LOCATION", "\"\""};

double unix_of(const char* time) { return unix_seconds(*parse_rfc3339(time)); }

bool refused(const absl::Status& status, const std::string& name) {
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(std::string(status.message()).substr(0, name.size() + 1), name + ":") << status;
  return false;
}

// One file: sound, or refused for a reason that says where.
bool accepted(const std::string& text, const std::string& name) {
  const auto file = read_weather_file(text, name);
  if (!file.ok()) return refused(file.status(), name);
  bool all = true;
  for (const bool periodic : {false, true}) {
    CourseWanted wanted;
    wanted.from_unix_s = unix_of(periodic ? "2026-01-27T08:00:00Z" : "2026-01-27T12:30:00Z");
    wanted.to_unix_s = wanted.from_unix_s + (periodic ? 86400 : 20000);
    wanted.periodic = periodic;
    wanted.place = kBay;
    wanted.radiation = true;
    wanted.wind_from_deg = 200;
    const auto course = course_of(*file, wanted);
    if (!course.ok()) {
      all = refused(course.status(), name);
      continue;
    }
    EXPECT_TRUE(check_course(course->course).ok());
    const WeatherRecord now = weather_at(course->course, wanted.from_unix_s + 1000);
    EXPECT_GE(now.air_k, now.dew_point_k);
    if (periodic) continue;
    const auto radiation = CourseRadiation::make(course->course, kBay, {0.2, 0.1, 0.3, 0.1});
    EXPECT_TRUE(radiation.ok()) << radiation.status();
    if (!radiation.ok()) continue;
    const Radiation r = radiation->at(wanted.from_unix_s + 15000);
    EXPECT_TRUE(r.direct_normal_w_m2 >= 0 && r.direct_normal_w_m2 < 1600);
    EXPECT_TRUE(r.diffuse_horizontal_w_m2 >= 0 && r.sky_w_m2 > 0);
  }
  return all;
}

void mutate_many(const std::string& seed_text, const std::string& name, std::uint64_t seed,
                 std::size_t length) {
  fuzz::Mutator mutator(seed, kWords, length);
  int sound = 0;
  fuzz::Turns turn(300);
  while (turn.next()) sound += accepted(mutator.mutate(seed_text), name) ? 1 : 0;
  // Otherwise the mutations would only ever test the first check.
  EXPECT_GT(sound, turn.done() / 100);
  EXPECT_LT(sound, turn.done());
}

std::string shipped() {
  std::ifstream in(IRSIG_SOURCE_DIR "/jobs/examples/weather/san_francisco.epw");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(WeatherFileFuzz, Epw) {
  ASSERT_TRUE(accepted(shipped(), "f.epw"));
  mutate_many(shipped(), "f.epw", 1, 4000);
}

TEST(WeatherFileFuzz, Csv) {
  std::string csv =
      "# radiation_interval_s: 3600\ntime,air_temperature_c,dew_point_c,pressure_hpa,"
      "wind_speed_m_s,global_horizontal_w_m2,diffuse_horizontal_w_m2,sky_w_m2\n";
  for (int hour = 0; hour <= 30; ++hour)
    csv += format_rfc3339_utc(utc_time(unix_of("2026-01-27T08:00:00Z") + 3600 * hour)) +
           ",12,8,1013,4," + (hour > 9 && hour < 16 ? "300,100" : "0,0") + ",310\n";
  ASSERT_TRUE(accepted(csv, "f.csv"));
  mutate_many(csv, "f.csv", 2, 1500);
}

TEST(WeatherFileFuzz, Tmy3) {
  std::string tmy3 =
      "724940,\"SAN FRANCISCO INTL AP\",CA,-8.0,37.617,-122.4,2\n"
      "Date (MM/DD/YYYY),Time (HH:MM),GHI (W/m^2),DNI (W/m^2),DHI (W/m^2),OpqCld (tenths),"
      "Dry-bulb (C),Dew-point (C),RHum (%),Pressure (mbar),Wdir (degrees),Wspd (m/s)\n";
  for (int day = 26; day <= 28; ++day)
    for (int hour = 1; hour <= 24; ++hour)
      tmy3 += "01/" + std::to_string(day) + "/1999," + (hour < 10 ? "0" : "") +
              std::to_string(hour) + ":00," + (hour == 12 ? "435,700,70" : "0,0,0") +
              ",3,10.5,5.5,71,1020,310,4.1\n";
  ASSERT_TRUE(accepted(tmy3, "f.csv"));
  mutate_many(tmy3, "f.csv", 3, 3000);
}

}  // namespace
}  // namespace irsig
