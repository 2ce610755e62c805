// Soundings, paths of other codes, weather.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "core/atmosphere/air_profile.h"
#include "core/atmosphere/imported/imported_path.h"
#include "core/thermal/weather_file.h"
#include "tests/fuzz/readers.h"

namespace irsig::fuzz {
namespace {

std::string file_of(const std::string& name) {
  std::ifstream in(IRSIG_SOURCE_DIR "/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

bool accepts_imported_path(const std::string& text) {
  const auto paths = parse_imported_paths(text, "f");
  if (!paths.ok()) return refused(paths.status(), "f");
  EXPECT_FALSE(paths->path.empty());
  for (const ImportedPath& p : paths->path) {
    EXPECT_EQ(p.transmittance.size(), kAirBandCount);
    for (const double t : p.transmittance) EXPECT_TRUE(std::isnan(t) || (t >= 0 && t <= 1)) << t;
    for (const AirSpectrum* spectrum : {&p.radiance_w_m2_sr_um, &p.sun_w_m2_um}) {
      EXPECT_TRUE(spectrum->empty() || spectrum->size() == kAirBandCount);
      for (const double x : *spectrum) EXPECT_FALSE(x < 0);
    }
    EXPECT_FALSE(p.range_m < 0);
    // Neither may trip over what the file says.
    (void)find_path(*paths, p.observer_height_m, p.target_height_m, p.range_m);
    (void)check_conditions(*paths, {60, 25, 130, 290, 172});
  }
  return true;
}

bool accepts_sounding(const std::string& text) {
  static const AirProfile base = afgl_profile(AfglProfile::kMidlatitudeSummer);
  const auto profile = parse_profile_csv(text, "f", base);
  if (!profile.ok()) return refused(profile.status(), "f");
  EXPECT_TRUE(check_profile(*profile).ok()) << check_profile(*profile);
  return true;
}

constexpr WeatherPlace kBay{37.62, -122.4, 2};

double unix_of(const char* time) { return unix_seconds(*parse_rfc3339(time)); }

bool accepts_weather(const std::string& text, const std::string& name) {
  const auto file = read_weather_file(text, name);
  if (!file.ok()) return refused(file.status(), name, Says::kFile);
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
      all = refused(course.status(), name, Says::kFile);
      continue;
    }
    EXPECT_TRUE(check_course(course->course).ok());
    const WeatherRecord now = weather_at(course->course, wanted.from_unix_s + 1000);
    EXPECT_GE(now.air_k, now.dew_point_k);
    if (periodic) continue;
    const auto radiation = CourseRadiation::make(
        course->course, kBay,
        {0.2, 0.1, 0.3, 0.1, CloudAbove{{0, 3000}, {288, 270}, std::nullopt, 1, std::nullopt}});
    EXPECT_TRUE(radiation.ok()) << radiation.status();
    if (!radiation.ok()) continue;
    const Radiation r = radiation->at(wanted.from_unix_s + 15000);
    EXPECT_TRUE(r.direct_normal_w_m2 >= 0 && r.direct_normal_w_m2 < 1600);
    EXPECT_TRUE(r.diffuse_horizontal_w_m2 >= 0 && r.sky_w_m2 > 0);
  }
  return all;
}

std::string weather_csv() {
  std::string csv =
      "# radiation_interval_s: 3600\ntime,air_temperature_c,dew_point_c,pressure_hpa,"
      "wind_speed_m_s,global_horizontal_w_m2,diffuse_horizontal_w_m2,sky_w_m2\n";
  for (int hour = 0; hour <= 30; ++hour)
    csv += format_rfc3339_utc(utc_time(unix_of("2026-01-27T08:00:00Z") + 3600 * hour)) +
           ",12,8,1013,4," + (hour > 9 && hour < 16 ? "300,100" : "0,0") + ",310\n";
  return csv;
}

std::string tmy3() {
  std::string out =
      "724940,\"SAN FRANCISCO INTL AP\",CA,-8.0,37.617,-122.4,2\n"
      "Date (MM/DD/YYYY),Time (HH:MM),GHI (W/m^2),DNI (W/m^2),DHI (W/m^2),OpqCld (tenths),"
      "Dry-bulb (C),Dew-point (C),RHum (%),Pressure (mbar),Wdir (degrees),Wspd (m/s)\n";
  for (int day = 26; day <= 28; ++day)
    for (int hour = 1; hour <= 24; ++hour)
      out += "01/" + std::to_string(day) + "/1999," + (hour < 10 ? "0" : "") +
             std::to_string(hour) + ":00," + (hour == 12 ? "435,700,70" : "0,0,0") +
             ",3,10.5,5.5,71,1020,310,4.1\n";
  return out;
}

}  // namespace

std::vector<Reader> air_readers() {
  const std::vector<const char*> path_words = {"nan", "1e999", "-9999.\n", ",",      "E",    "-99",
                                               ":",   "1e300", "FREQ",     "WAVLEN", "\r\n", "\n\n",
                                               "#",   "*****", "TRANS",    "1-400"};
  const std::string tape7 = file_of("tests/unit/imported_paths/sea-5km.tape7");
  const std::string path_csv =
      "# remark: free\n# observer_height_m: 20\n# target_height_m: 10\n# range_m: 5000\n"
      "# sun_zenith_deg: 60\nlambda_um,transmittance,radiance_w_m2_sr_um,sun_w_m2_um\n"
      "9.00,0.50,4,1e-2\n9.10,0.51,4,1e-2\n9.20,0.52,4,1e-2\n"
      "# observer_height_m: 5\n# target_height_m: 1\n# range_m: 50\n"
      "wavenumber_cm1,transmittance\n900,1\n910,0\n";
  const std::string sounding =
      "# a sounding\nheight_m, pressure_hpa, temperature_c, dew_point_c\n0, 1000, 20, 12\n"
      "1500, 840, 12, 4\n9000, 310, -42, -60\n";
  const std::vector<const char*> weather_words = {
      "nan",   "1e999",        "-9999",    ",",    "99.9", "999999", ":",
      "1e300", "-9900",        "\r\n",     "\n\n", "#",    "24",     "2,29",
      "time",  "DATA PERIODS", "LOCATION", "\"\""};
  const auto weather = [](const char* name) {
    return [name](const std::string& text) { return accepts_weather(text, name); };
  };
  return {{"tape7", {tape7, tape7 + tape7}, path_words, accepts_imported_path, 8000, 900},
          {"path_csv", {path_csv}, path_words, accepts_imported_path, 4000, 900},
          {"sounding",
           {sounding},
           {"nan", "1e999", "-", ",", "#", "\r", "0,", "1e"},
           accepts_sounding,
           4000},
          {"epw",
           {file_of("jobs/examples/weather/san_francisco.epw")},
           weather_words,
           weather("f.epw"),
           300,
           4000},
          {"weather_csv", {weather_csv()}, weather_words, weather("f.csv"), 300, 1500},
          {"tmy3", {tmy3()}, weather_words, weather("f.csv"), 300, 3000}};
}

}  // namespace irsig::fuzz
