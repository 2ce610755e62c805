// Weather files: what they say, hour by hour, and what is refused, with its place.
#include "core/thermal/weather_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "core/thermal/clear_sky.h"

namespace irsig {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr WeatherPlace kFileBay{37.62, -122.4, 2};

std::string shipped() {
  std::ifstream in(IRSIG_SOURCE_DIR "/jobs/examples/weather/san_francisco.epw");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

double unix_of(const char* time) { return unix_seconds(*parse_rfc3339(time)); }

CourseWanted day(const char* date) {
  CourseWanted wanted;
  wanted.from_unix_s = unix_of(absl::StrCat(date, "T01:00:00-08:00").c_str());
  wanted.to_unix_s = wanted.from_unix_s + 82800;
  wanted.place = kFileBay;
  wanted.radiation = true;
  return wanted;
}

absl::StatusOr<FileCourse> course(const std::string& text, const CourseWanted& wanted,
                                  const std::string& name = "f.epw") {
  const auto file = read_weather_file(text, name);
  if (!file.ok()) return file.status();
  return course_of(*file, wanted);
}

std::string error(const std::string& text, const CourseWanted& wanted,
                  const std::string& name = "f.epw") {
  const auto out = course(text, wanted, name);
  return out.ok() ? "" : std::string(out.status().message());
}

// Rationale: hours END at their stamp, in local standard time, in whatever year.
// Expected: what stands in the file's lines for January 27, hours 12 and 13.
TEST(Epw, HoursEndAtTheirStamp) {
  const auto out = course(shipped(), day("2026-01-27"));
  ASSERT_TRUE(out.ok()) << out.status();
  EXPECT_THAT(out->warning, IsEmpty());
  EXPECT_EQ(out->course.record.size(), 24U);
  EXPECT_EQ(out->course.radiation_interval_s, 3600);
  const WeatherRecord& noon = out->course.record[11];
  EXPECT_EQ(noon.unix_s, unix_of("2026-01-27T12:00:00-08:00"));
  std::string line;
  std::ifstream in(IRSIG_SOURCE_DIR "/jobs/examples/weather/san_francisco.epw");
  for (int i = 0; i < 8 + 12; ++i) std::getline(in, line);
  ASSERT_THAT(line, HasSubstr("1999,1,27,12,0"));
  std::vector<double> cell;
  std::size_t at = 0;
  for (std::string rest = line; at != std::string::npos; rest = rest.substr(at + 1)) {
    at = rest.find(',');
    cell.push_back(std::atof(rest.c_str()));
    if (at == std::string::npos) break;
  }
  EXPECT_DOUBLE_EQ(noon.air_k, cell[6] + 273.15);
  EXPECT_DOUBLE_EQ(noon.dew_point_k, cell[7] + 273.15);
  EXPECT_EQ(noon.pressure_pa, cell[9]);
  EXPECT_EQ(noon.sky_w_m2, cell[12]);
  EXPECT_EQ(noon.direct_normal_w_m2, cell[14]);
  EXPECT_EQ(noon.diffuse_horizontal_w_m2, cell[15]);
  EXPECT_EQ(noon.wind_from_deg, cell[20]);
  EXPECT_EQ(noon.wind_m_s, cell[21]);
  EXPECT_NEAR(noon.cloud_cover, cell[23] / 10, 1e-12);
}

TEST(Epw, ADayRepeatsAndDaysBeforeAreThere) {
  CourseWanted wanted = day("2024-07-21");  // a leap year
  wanted.periodic = true;
  wanted.from_unix_s -= 3600;
  const auto repeated = course(shipped(), wanted);
  ASSERT_TRUE(repeated.ok()) << repeated.status();
  EXPECT_TRUE(repeated->course.periodic);
  EXPECT_EQ(repeated->course.record.size(), 25U);
  EXPECT_EQ(repeated->course.record.front().unix_s, wanted.from_unix_s);
  EXPECT_EQ(repeated->course.record.front().air_k, repeated->course.record.back().air_k);
  wanted.periodic = false;
  wanted.from_unix_s += 3600;
  wanted.to_unix_s = unix_of("2024-07-22T10:30:00-08:00");
  const auto days = course(shipped(), wanted);
  ASSERT_TRUE(days.ok()) << days.status();
  EXPECT_EQ(days->course.record.front().unix_s, wanted.from_unix_s);
  EXPECT_EQ(days->course.record.back().unix_s, unix_of("2024-07-22T11:00:00-08:00"));
  EXPECT_TRUE(CourseRadiation::make(days->course, kFileBay, {}).ok());
}

TEST(Epw, WhatIsWrongIsSaidWithItsPlace) {
  const std::string good = shipped();
  const auto with = [&](const char* from, const char* to) {
    const std::string text = absl::StrReplaceAll(good, {{from, to}});
    EXPECT_NE(text, good) << from;
    return text;
  };
  CourseWanted wanted = day("2026-01-27");
  EXPECT_THAT(error(good, day("2024-02-29")),
              HasSubstr("f.epw:152:1: no record of month 2, day 29, hour 1"));
  EXPECT_THAT(error(good, day("2024-02-29")), HasSubstr("typical years have no 29 February"));
  EXPECT_THAT(error(good, day("2024-03-29")), HasSubstr("no record of month 3, day 29, hour 1"));
  wanted.place = {36, -122, 2};
  EXPECT_THAT(error(good, wanted), HasSubstr("f.epw:1:1: the file is of latitude 37.62"));
  wanted.place = {37.62, -122.4, 800};
  EXPECT_THAT(error(good, wanted), HasSubstr("f.epw:1:1: the file is of 2 m of height"));
  wanted.place = kFileBay;
  // East and west, or UTC: the sun shines at night.
  EXPECT_THAT(error(with("-122.40,-8.0", "-122.40,0"), wanted), HasSubstr("below the horizon"));
  EXPECT_THAT(error(with("-122.40,-8.0", "-122.40,-6"), wanted),
              HasSubstr("offset from UTC (the file's: -6 h)"));
  EXPECT_THAT(error(with("1999,1,27,12,0", "1999,1,27,11,0"), wanted),
              HasSubstr("f.epw:20:6: month 1, day 27, hour 11 is not later"));
  EXPECT_THAT(error(with("1999,1,27,12,0", "1999,1,27,25,0"), wanted),
              HasSubstr("f.epw:20:11: \"25\", expected an hour from 1 to 24"));
  EXPECT_THAT(error(with("LOCATION", "PLACE"), wanted), HasSubstr("no line LOCATION"));
  EXPECT_THAT(error(with("DATA PERIODS,2,1", "DATA PERIODS,2,4"), wanted),
              HasSubstr("one record an hour"));
  EXPECT_THAT(error("", wanted), HasSubstr("f.epw:1:1: there is no line DATA PERIODS"));
  EXPECT_THAT(error(good, wanted, "f.dat"), HasSubstr("f.dat:1:1: expected a weather file"));
}

// One line of January 27 with a field changed.
std::string changed(int hour, std::size_t field, const char* value) {
  std::string out;
  std::string text = shipped();
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    std::string line = text.substr(at, end - at);
    if (line.starts_with(absl::StrCat("1999,1,27,", hour, ","))) {
      std::size_t first = 0;
      for (std::size_t i = 0; i < field; ++i) first = line.find(',', first) + 1;
      line.replace(first, line.find(',', first) - first, value);
    }
    out += line + "\n";
    at = end + 1;
  }
  return out;
}

TEST(Epw, MissingValuesAreErrorsWhereTheyAreNeeded) {
  const CourseWanted wanted = day("2026-01-27");
  EXPECT_THAT(error(changed(12, 6, "99.9"), wanted),
              HasSubstr("the air's temperature is missing at 2026-01-27T12:00-08:00"));
  EXPECT_THAT(error(changed(12, 9, "999999"), wanted), HasSubstr("pressure is missing"));
  EXPECT_THAT(error(changed(12, 14, "9999"), wanted),
              HasSubstr("radiation is missing at 2026-01-27T12:00-08:00"));
  EXPECT_THAT(error(changed(12, 12, "9999"), wanted), HasSubstr("radiation is missing"));
  EXPECT_THAT(error(changed(12, 7, "35"), wanted), HasSubstr("the dew point, 308.15 K, is above"));
  EXPECT_THAT(error(changed(12, 20, "999"), wanted), HasSubstr("direction is missing"));
  EXPECT_THAT(error(changed(12, 6, "400"), wanted), HasSubstr("f.epw:20:"));
  EXPECT_EQ(error(changed(12, 6, "99.9"), day("2026-01-29")), "");
  // The humidity stands in for the dew point, to the rounding of both.
  const auto other = course(changed(12, 7, "99.9"), wanted), same = course(shipped(), wanted);
  ASSERT_TRUE(other.ok()) << other.status();
  EXPECT_NEAR(other->course.record[11].dew_point_k, same->course.record[11].dew_point_k, 0.5);
  const auto odd = course(changed(12, 13, "20"), wanted);
  ASSERT_TRUE(odd.ok());
  EXPECT_THAT(odd->warning, ElementsAre(HasSubstr("global radiation differs from")));
}

// Files say 0 of what was not measured: of one hour an error, of all of them missing. At noon a
// black sky sends 369 W/m2.
TEST(Epw, SkiesThatNoneIsAreErrorsAndOddOnesWarnedOf) {
  const CourseWanted wanted = day("2026-01-27");
  EXPECT_THAT(error(changed(12, 12, "0"), wanted),
              HasSubstr("radiation is missing at 2026-01-27T12:00-08:00"));
  EXPECT_THAT(error(changed(12, 12, "50"), wanted),
              HasSubstr("50 W/m2 is the long-wave radiation of no sky above air of 28"));
  EXPECT_THAT(error(changed(12, 12, "600"), wanted), HasSubstr("600 W/m2 is the long-wave"));
  for (const char* w_m2 : {"130", "480"}) {
    const auto odd = course(changed(12, 12, w_m2), wanted);
    ASSERT_TRUE(odd.ok()) << odd.status();
    EXPECT_THAT(odd->warning, ElementsAre(HasSubstr(absl::StrCat(": ", w_m2, " W/m2"))));
  }
  for (const char* w_m2 : {"200", "420"})
    EXPECT_TRUE(course(changed(12, 12, w_m2), wanted)->warning.empty()) << w_m2;
}

// Expected: the course without the column, and a warning; 0 of all records stood there with 13 K
// too cold a wall.
TEST(Epw, ASkyOfZeroThroughoutIsMissing) {
  std::string text, rest = shipped();
  for (std::size_t at = 0, line = 0; at < rest.size(); ++line) {
    const std::size_t end = rest.find('\n', at);
    std::string row = rest.substr(at, end - at);
    if (line >= 8) {
      std::size_t first = 0;
      for (int i = 0; i < 12; ++i) first = row.find(',', first) + 1;
      row.replace(first, row.find(',', first) - first, "0");
    }
    text += row + "\n";
    at = end + 1;
  }
  const auto out = course(text, day("2026-01-27"));
  ASSERT_TRUE(out.ok()) << out.status();
  EXPECT_THAT(out->warning, ElementsAre(HasSubstr("which no sky has: taken as missing")));
  for (const WeatherRecord& r : out->course.record) EXPECT_FALSE(r.sky_w_m2.has_value());
}

// Expected: what no weather has matters in hours that are used, whatever the quantity; codes of
// missing values are missing.
TEST(Epw, NumbersThatNoWeatherHasMatterWhereTheyAreUsed) {
  const CourseWanted wanted = day("2026-01-27"), other = day("2026-01-29");
  const struct {
    std::size_t field;
    const char *impossible, *said, *code, *missing;
  } cases[] = {
      {6, "80", "80: expected an air temperature from -93.15 to 66.85", "-999",
       "the air's temperature is missing"},
      {7, "-200", "-200: expected a dew point from -153.15", "-9999", ""},
      {9, "1013", "1013: expected an air pressure from 50000 to 110000", "-999",
       "pressure is missing"},
      {12, "3", "3: expected long-wave radiation from 15 to 1000", "-999", "radiation is missing"},
      {13, "2500", "2500: expected global radiation from 0 to 1800", "-9999",
       "radiation is missing"},
      {14, "1450", "1450: expected direct normal radiation from 0 to 1420", "-999",
       "radiation is missing"},
      {15, "-7", "-7: expected diffuse radiation from 0 to 1420", "-999", "radiation is missing"},
      {20, "720", "720: expected a wind direction from -360 to 360", "-999",
       "direction is missing"},
      {21, "150", "150: expected a wind speed from 0 to 100", "-999", "speed is missing"},
  };
  for (const auto& c : cases) {
    EXPECT_THAT(error(changed(12, c.field, c.impossible), wanted), HasSubstr(c.said)) << c.field;
    EXPECT_THAT(error(changed(12, c.field, c.code), wanted), HasSubstr(c.missing)) << c.field;
    EXPECT_EQ(error(changed(12, c.field, c.impossible), other), "") << c.field;
    EXPECT_EQ(error(changed(12, c.field, c.code), other), "") << c.field;
  }
  EXPECT_THAT(error(changed(12, 6, "warm"), other), HasSubstr("\"warm\", expected a number"));
  EXPECT_EQ(error(changed(12, 6, "NaN"), other), "");
}

constexpr const char* kCsvHead =
    "# station 7\n# radiation_interval_s: 3600\n"
    "time,air_temperature_c,dew_point_c,pressure_hpa,wind_speed_m_s,wind_from_deg,cloud_cover,"
    "direct_normal_w_m2,diffuse_horizontal_w_m2,global_horizontal_w_m2,sky_w_m2\n";

// The shipped days as CSV, at an offset of any size.
std::string as_csv(const char* date, int offset_h) {
  const auto from = course(shipped(), day(date));
  std::string out = kCsvHead;
  for (const WeatherRecord& r : from->course.record) {
    const std::string local = format_rfc3339_utc(utc_time(r.unix_s + 3600 * offset_h));
    absl::StrAppend(&out, local.substr(0, local.size() - 1), offset_h < 0 ? "-" : "+",
                    absl::Dec(std::abs(offset_h), absl::kZeroPad2), ":00,", r.air_k - 273.15, ",",
                    r.dew_point_k - 273.15, ",", r.pressure_pa / 100, ",", r.wind_m_s, ",",
                    r.wind_from_deg, ",", r.cloud_cover, ",", *r.direct_normal_w_m2, ",",
                    *r.diffuse_horizontal_w_m2, ",,", *r.sky_w_m2, "\n");
  }
  return out;
}

// Rationale: an instant is one, in whatever time zone it is written.
// Expected: the same course from EPW in local time and from CSV at three offsets.
TEST(WeatherCsv, TimeZonesChangeNothing) {
  CourseWanted wanted = day("2026-01-28");
  wanted.from_unix_s += 3400;
  wanted.to_unix_s -= 7000;
  const auto epw = course(shipped(), wanted);
  ASSERT_TRUE(epw.ok()) << epw.status();
  for (const int offset_h : {-8, 0, 9}) {
    const auto csv = course(as_csv("2026-01-28", offset_h), wanted, "f.csv");
    ASSERT_TRUE(csv.ok()) << csv.status();
    ASSERT_EQ(csv->course.record.size(), epw->course.record.size());
    for (std::size_t i = 0; i < csv->course.record.size(); ++i) {
      const WeatherRecord &a = csv->course.record[i], &b = epw->course.record[i];
      EXPECT_EQ(a.unix_s, b.unix_s);
      EXPECT_NEAR(a.air_k, b.air_k, 1e-6);
      EXPECT_NEAR(a.dew_point_k, b.dew_point_k, 1e-6);
      EXPECT_EQ(a.direct_normal_w_m2, b.direct_normal_w_m2);
      EXPECT_EQ(a.sky_w_m2, b.sky_w_m2);
    }
  }
}

// Expected: of global, direct and diffuse radiation any two give the third.
TEST(WeatherCsv, TwoKindsOfSunlightGiveTheThird) {
  const auto csv = [](bool direct, bool diffuse) {
    return absl::StrCat(
        "# radiation_interval_s: 3600\ntime,air_temperature_k,"
        "relative_humidity_percent,pressure_pa,wind_speed_m_s,",
        direct ? "direct_normal_w_m2" : "global_horizontal_w_m2", ",",
        diffuse ? "diffuse_horizontal_w_m2" : "global_horizontal_w_m2", "\n");
  };
  CourseWanted wanted;
  wanted.place = kFileBay;
  wanted.radiation = true;
  wanted.wind_from_deg = 10;
  wanted.from_unix_s = unix_of("2026-01-28T20:00:00Z");
  wanted.to_unix_s = unix_of("2026-01-28T22:00:00Z");
  const auto rows = [](double a, double b) {
    std::string out;
    for (const char* time : {"20", "21", "22"})
      absl::StrAppend(&out, "2026-01-28T", time, ":00Z,290,60,101000,3,", a, ",", b, "\n");
    return out;
  };
  const auto of_global = course(csv(false, true) + rows(400, 100), wanted, "f.csv");
  ASSERT_TRUE(of_global.ok()) << of_global.status();
  const double direct = *of_global->course.record[1].direct_normal_w_m2;
  EXPECT_GT(direct, 450);  // the sun at 34 deg: 300 / 0.56
  EXPECT_LT(direct, 600);
  const auto of_direct = course(csv(true, false) + rows(direct, 400), wanted, "f.csv");
  ASSERT_TRUE(of_direct.ok()) << of_direct.status();
  EXPECT_NEAR(*of_direct->course.record[1].diffuse_horizontal_w_m2, 100, 1e-3);
  EXPECT_EQ(of_direct->course.record[1].wind_from_deg, 10);
  EXPECT_NEAR(vapour_pressure_pa(of_direct->course.record[1].dew_point_k) / vapour_pressure_pa(290),
              0.6, 1e-9);
}

TEST(WeatherCsv, WhatIsWrongIsSaidWithItsPlace) {
  CourseWanted wanted = day("2026-01-28");
  wanted.from_unix_s += 3400;
  wanted.to_unix_s -= 7000;
  const std::string good = as_csv("2026-01-28", 0);
  EXPECT_EQ(error(good, wanted, "f.csv"), "");
  const auto with = [&](const char* from, const char* to) {
    const std::string text = absl::StrReplaceAll(good, {{from, to}});
    EXPECT_NE(text, good) << from;
    return error(text, wanted, "f.csv");
  };
  EXPECT_THAT(with("# radiation_interval_s: 3600\n", ""),
              HasSubstr("f.csv:2:90: radiation without a line"));
  EXPECT_THAT(with("radiation_interval_s: 3600", "radiation_interval_s: -1"),
              HasSubstr("f.csv:2:24: \"-1\", expected seconds"));
  EXPECT_THAT(with("# station 7", "# radiation_interval_s: 0"),
              HasSubstr("f.csv:2:1: radiation_interval_s is said already"));
  EXPECT_THAT(with("cloud_cover", "clouds"), HasSubstr("f.csv:3:78: unknown column \"clouds\""));
  EXPECT_THAT(with("pressure_hpa", "pressure_pa"), HasSubstr("expected an air pressure"));
  EXPECT_THAT(with("2026-01-28T21:00:00+00:00", "2026-01-28T19:00:00+00:00"),
              HasSubstr("is not later than the row before"));
  EXPECT_THAT(with("2026-01-28T21:00:00+00:00", "2026-01-28T21:00:00"),
              HasSubstr("it has no offset"));
  wanted.to_unix_s += 7 * 86400;
  EXPECT_THAT(error(good, wanted, "f.csv"), HasSubstr("f.csv:27:1: the file ends at"));
  wanted.to_unix_s -= 7 * 86400;
  wanted.from_unix_s -= 86400;
  EXPECT_THAT(error(good, wanted, "f.csv"), HasSubstr("f.csv:4:1: the file begins at"));
  wanted.from_unix_s += 86400;
  std::string gap = good;  // four hours in the morning
  for (const char* hour : {"12", "13", "14", "15"}) {
    const std::size_t at = gap.find(absl::StrCat("2026-01-28T", hour, ":00"));
    ASSERT_NE(at, std::string::npos);
    gap.erase(at, gap.find('\n', at) + 1 - at);
  }
  EXPECT_THAT(error(gap, wanted, "f.csv"), HasSubstr("a gap of 5 h before this record"));
  // An east of Greenwich that should be a west.
  EXPECT_THAT(error(
                  as_csv("2026-01-28", -8),
                  [&] {
                    CourseWanted east = wanted;
                    east.place.longitude_deg = 122.4;
                    return east;
                  }(),
                  "f.csv"),
              HasSubstr("below the horizon at the sweep's place"));
}

// Spreadsheets write them like this: quotes around cells, lines that end with CR.
TEST(WeatherCsv, QuotesAndLineEndsChangeNothing) {
  const std::string good = as_csv("2026-01-28", 0);
  CourseWanted wanted = day("2026-01-28");
  wanted.from_unix_s += 3400;
  wanted.to_unix_s -= 7000;
  const auto plain = course(good, wanted, "f.csv");
  ASSERT_TRUE(plain.ok()) << plain.status();
  std::string quoted;
  for (const std::string& line :
       std::vector<std::string>(absl::StrSplit(good, '\n', absl::SkipEmpty())))
    absl::StrAppend(&quoted,
                    line.front() == '#'
                        ? line
                        : absl::StrCat("\"", absl::StrReplaceAll(line, {{",", "\" ,\""}}), "\""),
                    "\n");
  for (const std::string& text : {quoted, absl::StrReplaceAll(good, {{"\n", "\r"}}),
                                  absl::StrReplaceAll(quoted, {{"\n", "\r\n"}})}) {
    const auto same = course(text, wanted, "f.csv");
    ASSERT_TRUE(same.ok()) << same.status();
    ASSERT_EQ(same->course.record.size(), plain->course.record.size());
    for (std::size_t i = 0; i < same->course.record.size(); ++i) {
      EXPECT_EQ(same->course.record[i].air_k, plain->course.record[i].air_k);
      EXPECT_EQ(same->course.record[i].sky_w_m2, plain->course.record[i].sky_w_m2);
    }
  }
}

TEST(WeatherCsv, FilesOfOtherProgramsAreToldWhatToDo) {
  const CourseWanted wanted = day("2026-01-28");
  const std::string good = as_csv("2026-01-28", 0);
  const auto said = [&](const std::string& text, const char* name = "f.csv") {
    return error(text, wanted, name);
  };
  EXPECT_THAT(said(absl::StrReplaceAll(good, {{",", ";"}})),
              AllOf(HasSubstr("f.csv:3:1: the cells are separated by semicolons, expected commas"),
                    Not(HasSubstr("unknown column"))));
  EXPECT_THAT(said(absl::StrReplaceAll(good, {{",", "\t"}})), HasSubstr("separated by tabs"));
  EXPECT_THAT(said(absl::StrReplaceAll(shipped(), {{",", ";"}}), "f.epw"),
              HasSubstr("f.epw:1:1: the cells are separated by semicolons"));
  EXPECT_THAT(said(shipped()),
              HasSubstr("f.csv:1:1: this is an EPW file, expected a name that ends "
                        "in .epw"));
  EXPECT_THAT(said("Source,Location ID,City,State\nNSRDB,1,-,-\n"), HasSubstr("of the NSRDB"));
  EXPECT_THAT(said(std::string("\xff\xfet\0", 4)), HasSubstr("UTF-16"));
  EXPECT_THAT(said(std::string("PK\3\4\0\0", 6)), HasSubstr("this is a binary file"));
  // Names of columns are in lower case; those that there are stand there once.
  const std::string names =
      said(absl::StrReplaceAll(good, {{"time,air_temperature_c", "Time,Air_Temperature_C"},
                                      {"cloud_cover", "clouds"},
                                      {"sky_w_m2", "sky"}}));
  EXPECT_THAT(names, HasSubstr("unknown column \"Time\", expected \"time\" in lower case"));
  EXPECT_THAT(names, HasSubstr("expected \"air_temperature_c\" in lower case"));
  EXPECT_THAT(names, HasSubstr("expected time, air"));
  EXPECT_EQ(names.find("expected time, air"), names.rfind("expected time, air"));
  // A unit that is another than the name says.
  const auto unit = [&](const char* from, const char* to) {
    CourseWanted inside = wanted;
    inside.from_unix_s += 3400;
    inside.to_unix_s -= 7000;
    return error(absl::StrReplaceAll(good, {{from, to}}), inside, "f.csv");
  };
  EXPECT_THAT(unit("air_temperature_c", "air_temperature_k"),
              HasSubstr("is it in degrees Celsius? Then name the column ..._c"));
  EXPECT_THAT(unit("pressure_hpa", "pressure_pa"),
              HasSubstr("is it in hPa? Then name the column pressure_hpa"));
}

TEST(Tmy3, IsReadByTheNamesOfItsColumns) {
  std::string text =
      "724940,\"SAN FRANCISCO INTL AP\",CA,-8.0,37.617,-122.4,2\n"
      "Date (MM/DD/YYYY),Time (HH:MM),ETR (W/m^2),GHI (W/m^2),DNI (W/m^2),DHI (W/m^2),"
      "OpqCld (tenths),Dry-bulb (C),Dew-point (C),RHum (%),Pressure (mbar),Wdir (degrees),"
      "Wspd (m/s)\n";
  for (int hour = 1; hour <= 24; ++hour)
    absl::StrAppend(&text, "01/27/1999,", absl::Dec(hour, absl::kZeroPad2), ":00,0,",
                    hour == 12 ? "435,700,70" : "0,0,0", ",3,10.5,5.5,71,1020,310,4.1\n");
  CourseWanted wanted = day("2026-01-27");
  wanted.from_unix_s += 3600;
  const auto out = course(text, wanted, "f.csv");
  ASSERT_TRUE(out.ok()) << out.status();
  const WeatherRecord& noon = out->course.record[10];
  EXPECT_EQ(noon.unix_s, unix_of("2026-01-27T12:00:00-08:00"));
  EXPECT_EQ(noon.direct_normal_w_m2, 700);
  EXPECT_DOUBLE_EQ(noon.pressure_pa, 102000);
  EXPECT_FALSE(noon.sky_w_m2.has_value());
  EXPECT_THAT(out->warning, ElementsAre(HasSubstr("the weather of 1999 stands for that of 2026")));
  EXPECT_THAT(error(absl::StrReplaceAll(text, {{"DNI (W/m^2)", "DNI"}}), wanted, "f.csv"),
              HasSubstr("f.csv:2:1: there is no column \"DNI (W/m^2)\""));
  EXPECT_THAT(
      error(absl::StrReplaceAll(text, {{"01/27/1999,12:00", "01/27/1999,12:30"}}), wanted, "f.csv"),
      HasSubstr("f.csv:14:12: \"12:30\", expected the end of an hour"));
  EXPECT_THAT(error(absl::StrReplaceAll(text, {{"10.5,5.5,71", "-9900,5.5,71"}}), wanted, "f.csv"),
              HasSubstr("the air's temperature is missing"));
}

// Rationale: what stands in for weather that no file states must be near what files state.
// Expected: on July 21, the day of the six without a cloud, the day's sums of direct and diffuse
// radiation within 10 % and 30 % of the data set's own model [wilcox2008] with its aerosol (0.1
// broadband; here depths of 0.13 at 500 nm and 0.19 at 380 nm). On the others sunlight and the
// column of clouds contradict each other (January 27 loses a third of it at 13 h under a clear
// sky): a third of each day's direct radiation. Long-wave radiation within 15 W/m2 in the mean of
// all.
TEST(ShippedDays, ModelsAreNearTheFile) {
  const auto file = read_weather_file(shipped(), "f.epw");
  ASSERT_TRUE(file.ok()) << file.status();
  double sky_apart = 0;
  int hours = 0;
  for (const char* date :
       {"2026-01-27", "2026-01-28", "2026-01-29", "2026-07-20", "2026-07-21", "2026-07-22"}) {
    CourseWanted wanted = day(date);
    wanted.periodic = true;
    wanted.from_unix_s -= 3600;
    const auto stated = course_of(*file, wanted);
    ASSERT_TRUE(stated.ok()) << stated.status();
    EXPECT_THAT(stated->warning, IsEmpty()) << date;
    WeatherCourse none = stated->course;
    for (WeatherRecord& r : none.record)
      r.direct_normal_w_m2 = r.diffuse_horizontal_w_m2 = r.sky_w_m2 = std::nullopt;
    const SkyAerosol air{0.19, 0.13, 0.3, 0.15,
                         CloudAbove{{0, 2500}, {288, 273}, std::nullopt, 1, std::nullopt}};
    const auto a = CourseRadiation::make(stated->course, kFileBay, air),
               b = CourseRadiation::make(none, kFileBay, air);
    ASSERT_TRUE(a.ok() && b.ok());
    double direct_a = 0, direct_b = 0, diffuse_a = 0, diffuse_b = 0;
    for (int i = 0; i < 144; ++i) {
      const double t = wanted.from_unix_s + 600 * (i + 0.5);
      direct_a += a->at(t).direct_normal_w_m2 / 6;
      direct_b += b->at(t).direct_normal_w_m2 / 6;
      diffuse_a += a->at(t).diffuse_horizontal_w_m2 / 6;
      diffuse_b += b->at(t).diffuse_horizontal_w_m2 / 6;
      sky_apart += b->at(t).sky_w_m2 - a->at(t).sky_w_m2;
      ++hours;
    }
    const bool clear = std::string(date) == "2026-07-21";
    EXPECT_NEAR(direct_b / direct_a, 1, clear ? 0.1 : 0.33) << date;
    EXPECT_NEAR(diffuse_b / diffuse_a, 1, 0.3) << date;
    EXPECT_EQ(a->unplaced_j_m2(), 0) << date;
  }
  EXPECT_LT(std::abs(sky_apart / hours), 15);
}

}  // namespace
}  // namespace irsig
