// The weather that goes on through a day: what lies between records, and that radiation spread over
// intervals keeps the energy of each.
#include "core/thermal/weather_course.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/constants.h"
#include "core/thermal/clear_sky.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

constexpr WeatherPlace kBay{37.62, -122.4, 2};
const SkyAerosol kSky{0.3, 0.2, 0.3, 0.06,
                      CloudAbove{{0, 1000, 3000}, {285, 279, 266}, 1000.0, 0.95, std::nullopt}};
const double kMidnight = solar_midnight_unix_s(2025, 6, 21, kBay.longitude_deg);

double sine_at(double t) {
  const auto sun = sun_position(utc_time(t), kBay.latitude_deg, kBay.longitude_deg, kBay.height_m);
  return std::cos(sun->zenith_deg * kRadPerDeg);
}

WeatherCourse hours(int count, double first = 1750464000) {  // 2025-06-21T00:00Z
  WeatherCourse course;
  course.radiation_interval_s = 3600;
  for (int i = 0; i < count; ++i) {
    WeatherRecord r{first + 3600 * i, 285, 280, 101300, 5, 90, 0.2, {}, {}, {}};
    r.direct_normal_w_m2 = r.diffuse_horizontal_w_m2 = 0;
    r.sky_w_m2 = 300 + i;
    course.record.push_back(r);
  }
  return course;
}

TEST(UtcTime, IsTheInverseOfUnixSeconds) {
  for (const double t : {0.0, 1750464000.0, 1772236799.75, -1.0, 951782400.0}) {
    EXPECT_NEAR(unix_seconds(utc_time(t)), t, 3e-7) << t;
  }
  EXPECT_EQ(format_rfc3339_utc(utc_time(951782400)), "2000-02-29T00:00:00Z");
  EXPECT_EQ(format_rfc3339_utc(utc_time(1767225599)), "2025-12-31T23:59:59Z");
}

TEST(WeatherAt, IsLinearAndTurnsWithTheWindsVector) {
  WeatherCourse course = hours(3);
  course.record[1].air_k = 287;
  course.record[1].dew_point_k = 284;
  course.record[1].wind_from_deg = 180;
  const double t = course.record[0].unix_s;
  const WeatherRecord half = weather_at(course, t + 1800);
  EXPECT_DOUBLE_EQ(half.air_k, 286);
  EXPECT_DOUBLE_EQ(half.dew_point_k, 282);
  EXPECT_DOUBLE_EQ(half.wind_from_deg, 135);
  EXPECT_DOUBLE_EQ(half.wind_m_s, 5);
  // Across north, not through south.
  course.record[0].wind_from_deg = 350;
  course.record[1].wind_from_deg = 10;
  const double north = weather_at(course, t + 1800).wind_from_deg;
  EXPECT_NEAR(std::min(north, 360 - north), 0, 1e-9);
  // A calm has no direction; opposite winds cancel.
  course.record[0].wind_m_s = 0;
  EXPECT_NEAR(weather_at(course, t + 60).wind_from_deg, 10, 1e-9);
  course.record[0].wind_m_s = 5;
  course.record[0].wind_from_deg = 190;
  EXPECT_DOUBLE_EQ(weather_at(course, t + 1800).wind_from_deg, 10);
  EXPECT_DOUBLE_EQ(weather_at(course, t - 99).air_k, 285);
  EXPECT_DOUBLE_EQ(weather_at(course, t + 7200 + 99).air_k, 285);
}

// Rationale: what a file says of an hour must reach the ship, however the sun moves in it.
// Expected: direct normal and diffuse radiation integrate to the record's means, 1e-9; direct
// horizontal radiation goes with the sine of the sun's elevation. Source: independent sums here.
TEST(CourseRadiation, KeepsEachRecordsEnergy) {
  WeatherCourse course = hours(30);
  for (std::size_t i = 0; i < course.record.size(); ++i) {
    course.record[i].direct_normal_w_m2 = 100 + 10 * static_cast<double>(i);
    course.record[i].diffuse_horizontal_w_m2 = 50 + static_cast<double>(i);
  }
  const auto radiation = CourseRadiation::make(course, kBay, kSky);
  ASSERT_TRUE(radiation.ok()) << radiation.status();
  int whole_hours = 0, cut_hours = 0;
  double unplaced = 0;
  for (std::size_t i = 1; i < course.record.size(); ++i) {
    const WeatherRecord& r = course.record[i];
    std::vector<double> edge = {r.unix_s - 3600};
    for (const double t : radiation->sun_crossings())
      if (t > edge[0] && t <= r.unix_s) edge.push_back(t);
    edge.push_back(r.unix_s);
    double direct = 0, up_s = 0;
    for (std::size_t k = 1; k < edge.size(); ++k) {
      const double middle = (edge[k] + edge[k - 1]) / 2, length = edge[k] - edge[k - 1];
      direct += radiation->at(middle).direct_normal_w_m2 * length;
      if (sine_at(middle) > 0) up_s += length;
    }
    if (up_s == 0) {
      EXPECT_EQ(direct, 0);
      unplaced += 3600 * *r.direct_normal_w_m2;
      continue;
    }
    if (up_s < 3600 && *r.direct_normal_w_m2 * 3600 / up_s > 1400) {  // brighter than in space
      unplaced += 3600 * *r.direct_normal_w_m2 - direct;
    } else {
      EXPECT_NEAR(direct / (3600 * *r.direct_normal_w_m2), 1, 1e-9) << i;
      ++(up_s < 3600 ? cut_hours : whole_hours);
    }
    if (up_s < 3600) continue;  // twilight: below
    double diffuse = 0;
    constexpr int kSteps = 60;  // Simpson
    for (int k = 0; k <= kSteps; ++k) {
      const double t = r.unix_s - 3600 + 3600.0 * k / kSteps;
      const auto side = k == 0 ? CourseRadiation::Side::kAfter : CourseRadiation::Side::kBefore;
      diffuse += (k == 0 || k == kSteps ? 1
                  : k % 2 == 1          ? 4
                                        : 2) *
                 radiation->at(t, side).diffuse_horizontal_w_m2 / (3 * kSteps);
    }
    EXPECT_NEAR(diffuse / *r.diffuse_horizontal_w_m2, 1, 1e-9) << i;
    const double a = radiation->at(r.unix_s - 900).direct_normal_w_m2;
    EXPECT_DOUBLE_EQ(a, radiation->at(r.unix_s - 2700).direct_normal_w_m2);
  }
  EXPECT_GE(whole_hours, 13);
  EXPECT_GE(cut_hours, 1);
  EXPECT_NEAR(radiation->unplaced_j_m2() / unplaced, 1, 1e-9);
}

TEST(CourseRadiation, TwilightHasDiffuseLightOfTheRightEnergy) {
  WeatherCourse course = hours(30);
  for (WeatherRecord& r : course.record) r.diffuse_horizontal_w_m2 = 40;
  const auto radiation = CourseRadiation::make(course, kBay, kSky);
  ASSERT_TRUE(radiation.ok());
  for (std::size_t i = 1; i < course.record.size(); ++i) {
    double mean = 0;
    constexpr int kSteps = 20000;  // midpoints: 1e-7 with one kink
    if (i % 3 != 0) continue;
    for (int k = 0; k < kSteps / 10; ++k)
      mean += radiation->at(course.record[i].unix_s - 3600 + 36000 * (k + 0.5) / kSteps)
                  .diffuse_horizontal_w_m2 /
              (kSteps / 10);
    EXPECT_NEAR(mean, 40, 1e-4) << i;
  }
}

TEST(CourseRadiation, NightHasNoSunAndRecordsJump) {
  WeatherCourse course = hours(30);
  for (WeatherRecord& r : course.record) {
    r.direct_normal_w_m2 = 0;
    r.diffuse_horizontal_w_m2 = 0;
  }
  const auto radiation = CourseRadiation::make(course, kBay, kSky);
  ASSERT_TRUE(radiation.ok());
  EXPECT_EQ(radiation->unplaced_j_m2(), 0);
  EXPECT_EQ(radiation->sun_crossings().size(), 3U);  // set, rise, set
  const double t = course.record[5].unix_s;
  EXPECT_EQ(radiation->at(t, CourseRadiation::Side::kBefore).sky_w_m2, 305);
  EXPECT_EQ(radiation->at(t, CourseRadiation::Side::kAfter).sky_w_m2, 306);
  EXPECT_EQ(radiation->at(t - 3600, CourseRadiation::Side::kAfter).sky_w_m2, 305);
  for (WeatherRecord& r : course.record) r.direct_normal_w_m2 = 500;
  const auto bright = CourseRadiation::make(course, kBay, kSky);
  for (double s = course.record[0].unix_s; s < course.record[29].unix_s; s += 300)
    EXPECT_EQ(bright->at(s).direct_normal_w_m2 > 0,
              sine_at(s) > 0 && bright->at(s).direct_normal_w_m2 > 0);
}

// Tests records of instants, and of the model.
TEST(CourseRadiation, InstantsAreLinearAndCloudsTakeTheirShare) {
  WeatherCourse course = hours(30);
  course.radiation_interval_s = 0;
  for (std::size_t i = 0; i < course.record.size(); ++i)
    course.record[i].direct_normal_w_m2 = i % 2 == 0 ? 100 : 300;
  const auto stated = CourseRadiation::make(course, kBay, kSky);
  ASSERT_TRUE(stated.ok());
  const double noon = kMidnight + 43200;
  const std::size_t i = static_cast<std::size_t>((noon - course.record[0].unix_s) / 3600);
  EXPECT_NEAR(stated->at(course.record[i].unix_s + 1800).direct_normal_w_m2, 200, 1e-9);
  EXPECT_NEAR(stated->at(course.record[i].unix_s + 1800).sky_w_m2,
              300 + static_cast<double>(i) + 0.5, 1e-9);

  const auto clouds = [&](double cover) {
    WeatherCourse dry = course;
    for (WeatherRecord& r : dry.record) {
      r.direct_normal_w_m2 = r.diffuse_horizontal_w_m2 = r.sky_w_m2 = std::nullopt;
      r.cloud_cover = cover;
    }
    return CourseRadiation::make(dry, kBay, kSky)->at(noon);
  };
  const Radiation clear = clouds(0), half = clouds(0.5), full = clouds(1);
  const double sine = sine_at(noon);
  const auto global = [&](const Radiation& r) {
    return r.direct_normal_w_m2 * sine + r.diffuse_horizontal_w_m2;
  };
  EXPECT_GT(clear.direct_normal_w_m2, 700);
  EXPECT_NEAR(global(half) / global(clear), 1 - 0.75 * std::pow(0.5, 3.4), 1e-12);
  EXPECT_NEAR(global(full) / global(clear), 0.25, 1e-12);
  EXPECT_EQ(full.direct_normal_w_m2, 0);
  EXPECT_NEAR(half.direct_normal_w_m2 / clear.direct_normal_w_m2,
              (1 - 0.75 * std::pow(0.5, 3.4)) * 0.75, 1e-12);
  const double emissivity = sky_emissivity_prata(285, vapour_pressure_pa(280));
  EXPECT_NEAR(clear.sky_w_m2, emissivity * kStefanBoltzmannWM2K4 * std::pow(285, 4), 1e-9);
  // The base: 6 K colder than the air.
  EXPECT_NEAR(full.sky_w_m2 - clear.sky_w_m2,
              (1 - emissivity) * 0.95 * kStefanBoltzmannWM2K4 * std::pow(279, 4), 1e-9);
  EXPECT_NEAR(half.sky_w_m2, 0.5 * (clear.sky_w_m2 + full.sky_w_m2), 1e-9);
  // A layer of known water.
  SkyAerosol thin = kSky;
  thin.cloud->solar_depth = 2;
  WeatherCourse dry = course;
  for (WeatherRecord& r : dry.record) {
    r.direct_normal_w_m2 = r.diffuse_horizontal_w_m2 = r.sky_w_m2 = std::nullopt;
    r.cloud_cover = 1;
  }
  const Radiation under = CourseRadiation::make(dry, kBay, thin)->at(noon);
  EXPECT_NEAR(under.direct_normal_w_m2, clear.direct_normal_w_m2 * std::exp(-2 / sine), 1e-9);
  EXPECT_NEAR(global(under), global(clear) / (1 + 0.75 * 0.15 * 2), 1e-9);
  // Clouds of which nothing is known.
  thin.cloud = std::nullopt;
  EXPECT_FALSE(CourseRadiation::make(dry, kBay, thin).ok());
}

TEST(DayCourse, IsACosineOfLocalSolarTime) {
  const StatedDay day{280, 290, 15, 278, 101300, 4, 200, 0.3};
  const auto course = day_course(day, kMidnight);
  ASSERT_TRUE(course.ok()) << course.status();
  EXPECT_EQ(course->record.size(), 73U);
  EXPECT_NEAR(weather_at(*course, kMidnight + 15 * 3600).air_k, 290, 1e-9);
  EXPECT_NEAR(weather_at(*course, kMidnight + 3 * 3600).air_k, 280, 1e-9);
  for (int i = 0; i < 240; ++i) {
    const double hour = i / 10.0;
    const double exact = 285 + 5 * std::cos(2 * M_PI * (hour - 15) / 24);
    EXPECT_NEAR(weather_at(*course, kMidnight + 3600 * hour).air_k, exact, 0.005);
    // The next and the last day are the same.
    for (const double days : {-3.0, 1.0, 40.0})
      EXPECT_NEAR(weather_at(*course, kMidnight + 3600 * hour + 86400 * days).air_k,
                  weather_at(*course, kMidnight + 3600 * hour).air_k, 1e-9);
  }
  // The sun is highest at local solar noon: the equation of time is right to a minute.
  const auto radiation = CourseRadiation::make(*course, kBay, kSky);
  ASSERT_TRUE(radiation.ok());
  EXPECT_NEAR(radiation->sun_at(kMidnight + 43200).azimuth_deg, 180, 1);
  ASSERT_EQ(radiation->sun_crossings().size(), 2U);
  EXPECT_NEAR((radiation->sun_crossings()[0] + radiation->sun_crossings()[1]) / 2,
              kMidnight + 43200, 60);
  for (const int month : {1, 2, 4, 5, 7, 9, 11, 12}) {
    const double noon = solar_midnight_unix_s(2026, month, 3, 10) + 43200;
    const auto sun = sun_position(utc_time(noon), 50, 10, 0);
    EXPECT_NEAR(sun->azimuth_deg, 180, 0.3) << month;
  }
  // A day that begins again: both sides of midnight.
  EXPECT_EQ(radiation->at(kMidnight + 86400, CourseRadiation::Side::kAfter).sky_w_m2,
            radiation->at(kMidnight).sky_w_m2);
}

TEST(DayCourse, RefusesWhatCannotBe) {
  const auto error = [](const StatedDay& day) {
    return std::string(day_course(day, kMidnight).status().message());
  };
  EXPECT_THAT(error({280, 290, 15, 281, 101300, 4, 0, 0}), HasSubstr("dew point, 281 K, is above"));
  EXPECT_THAT(error({290, 280, 15, 270, 101300, 4, 0, 0}), HasSubstr("below its minimum"));
  EXPECT_THAT(error({280, 290, 25, 270, 101300, 4, 0, 0}), HasSubstr("warmest hour is 25"));
  EXPECT_THAT(error({280, 290, 15, 270, 101300, 4, 0, 1.5}),
              HasSubstr("1.5: expected a cloud cover from 0 to 1"));
}

TEST(CheckCourse, NamesTheRecord) {
  const auto error = [](auto change) {
    WeatherCourse course = hours(4);
    change(course);
    return std::string(check_course(course).message());
  };
  EXPECT_EQ(error([](WeatherCourse&) {}), "");
  EXPECT_THAT(error([](WeatherCourse& c) { c.record.resize(1); }), HasSubstr("at least two"));
  EXPECT_THAT(error([](WeatherCourse& c) { c.record[2].dew_point_k = 286; }),
              HasSubstr("weather record 2: the dew point, 286 K"));
  EXPECT_THAT(error([](WeatherCourse& c) { c.record[2].air_k = NAN; }),
              HasSubstr("weather record 2: nan K: expected an air temperature"));
  EXPECT_THAT(error([](WeatherCourse& c) { c.record[3].sky_w_m2 = {}; }),
              HasSubstr("weather record 3: states other kinds"));
  EXPECT_THAT(error([](WeatherCourse& c) { c.record[1].diffuse_horizontal_w_m2 = {}; }),
              HasSubstr("not stated together"));
  EXPECT_THAT(error([](WeatherCourse& c) { c.record[2].unix_s -= 3600; }),
              HasSubstr("weather record 2: is not later"));
  EXPECT_THAT(error([](WeatherCourse& c) { c.record[3].unix_s += 60; }),
              HasSubstr("is 3660 s after"));
  EXPECT_THAT(error([](WeatherCourse& c) { c.periodic = true; }), HasSubstr("expected a day"));
}

}  // namespace
}  // namespace irsig
