// Rationale: the sun's place decides which facets it lights and where glints are seen; a wrong
// convention (UT1, leap
//   seconds, azimuth sense, refraction) is an error of 0.04 deg to 180 deg that no radiometric test
//   would notice.
// Expected: 5e-7 deg against ERFA's own figures (given to 1e-7 deg); 0.00025 deg against NREL's
// SPA, an independent algorithm whose
//   stated uncertainty is 0.0003 deg. The angle is between unit vectors: near the zenith an azimuth
//   is ill-conditioned.
// Source: tests/physics/values/sun.csv (27 places and times: poles, antimeridian, leap second,
// below the horizon, years
//   beyond the leap-second table).
#include "core/geo/sun.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/constants.h"
#include "tests/physics/reference_table.h"

namespace irsig {
namespace {

using testing::HasSubstr;

Vec<Enu> direction(double azimuth_deg, double zenith_deg) {
  const double a = azimuth_deg * kRadPerDeg;
  const double z = zenith_deg * kRadPerDeg;
  return {std::sin(z) * std::sin(a), std::sin(z) * std::cos(a), std::cos(z)};
}

// Accurate for small angles, where the arc cosine of a dot product is not.
double angle_deg(Vec<Enu> a, Vec<Enu> b) {
  return std::atan2(length(cross(a, b)), dot(a, b)) / kRadPerDeg;
}

TEST(Sun, AgreesWithErfaAndSpa) {
  const ReferenceTable table("sun.csv");
  ASSERT_GE(table.size(), 27u);
  double worst_erfa = 0.0;
  double worst_vector = 0.0;
  double worst_spa = 0.0;
  double worst_distance = 0.0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    SCOPED_TRACE(table.text(i, "case") + " " + table.text(i, "name"));
    const auto utc = parse_rfc3339(table.text(i, "time"));
    ASSERT_TRUE(utc.ok()) << utc.status();
    const auto sun = sun_position(*utc, table.number(i, "latitude_deg"),
                                  table.number(i, "longitude_deg"), table.number(i, "height_m"));
    ASSERT_TRUE(sun.ok()) << sun.status();
    const auto expected =
        direction(table.number(i, "erfa_azimuth_deg"), table.number(i, "erfa_zenith_deg"));
    const Vec<Enu> vector{table.number(i, "east"), table.number(i, "north"), table.number(i, "up")};
    const auto spa =
        direction(table.number(i, "spa_azimuth_deg"), table.number(i, "spa_zenith_deg"));
    const double to_erfa = angle_deg(sun->direction, expected);
    const double to_spa = angle_deg(sun->direction, spa);
    EXPECT_LE(to_erfa, 5e-7);
    EXPECT_LE(to_spa, 0.00025);
    EXPECT_LE(angle_deg(sun->direction, vector), 5e-7);
    EXPECT_NEAR(length(sun->direction), 1.0, 1e-15);
    EXPECT_LE(angle_deg(sun->direction, direction(sun->azimuth_deg, sun->zenith_deg)), 1e-12);
    EXPECT_GE(sun->azimuth_deg, 0.0);
    EXPECT_LT(sun->azimuth_deg, 360.0);
    const double distance_error = std::abs(sun->distance_au / table.number(i, "distance_au") - 1.0);
    EXPECT_LE(distance_error, 2e-10);  // 10 digits given, and ours
    EXPECT_NEAR(std::sin(sun->angular_radius_deg * kRadPerDeg) * sun->distance_au * 149597870.7,
                695700.0, 1e-6);
    worst_erfa = std::max(worst_erfa, to_erfa);
    worst_spa = std::max(worst_spa, to_spa);
    worst_vector = std::max(worst_vector, angle_deg(sun->direction, vector));
    worst_distance = std::max(worst_distance, distance_error);
  }
  std::printf(
      "largest angle to ERFA's azimuth and zenith %.2g deg, to its vector %.2g deg, to SPA %.2g "
      "deg; "
      "distance %.2g in %zu cases\n",
      worst_erfa, worst_vector, worst_spa, worst_distance, table.size());
}

// With UT1 = UTC the hour angle stands still for the leap second: 23:59:60 is one second after
// 23:59:59, and 00:00:00 has the direction that 23:59:60 had (one second is 0.0042 deg).
TEST(Sun, LeapSecondIsATimeOfItsOwn) {
  const auto at = [](const char* text) {
    return sun_position(parse_rfc3339(text).value(), 35, 135, 0).value().direction;
  };
  const auto before = at("2016-12-31T23:59:59Z");
  const auto leap = at("2016-12-31T23:59:60Z");
  const auto after = at("2017-01-01T00:00:00Z");
  EXPECT_NEAR(angle_deg(before, leap), 360.0 / 86164 * std::cos(23.0 * kRadPerDeg), 1e-4);
  EXPECT_LE(angle_deg(leap, after), 2e-5);
  EXPECT_EQ(leap, at("2017-01-01T08:59:60+09:00"));
}

TEST(Sun, RefusesPlacesAndTimesThatDoNotExist) {
  const UtcTime noon{2025, 6, 21, 12, 0, 0};
  EXPECT_FALSE(sun_position(noon, 90.001, 0, 0).ok());
  EXPECT_FALSE(sun_position(noon, NAN, 0, 0).ok());
  EXPECT_FALSE(sun_position(noon, 0, 361, 0).ok());
  EXPECT_FALSE(sun_position(noon, 0, 0, INFINITY).ok());
  EXPECT_FALSE(sun_position({2025, 2, 30, 0, 0, 0}, 0, 0, 0).ok());
  EXPECT_FALSE(sun_position({2025, 6, 21, 24, 0, 0}, 0, 0, 0).ok());
  EXPECT_FALSE(sun_position({2025, 6, 30, 23, 59, 60.5}, 0, 0, 0).ok());
}

TEST(Time, OffsetsAreTurnedIntoUtc) {
  const auto utc = [](const char* text) { return format_rfc3339_utc(parse_rfc3339(text).value()); };
  EXPECT_EQ(utc("2025-12-21T10:30:00+09:00"), "2025-12-21T01:30:00Z");
  EXPECT_EQ(utc("2025-01-01t03:00:00+05:45"), "2024-12-31T21:15:00Z");
  EXPECT_EQ(utc("2024-02-28 20:00:00-04:30"), "2024-02-29T00:30:00Z");
  EXPECT_EQ(utc("2023-02-28T23:59:59-00:01"), "2023-03-01T00:00:59Z");
  EXPECT_EQ(utc("2000-03-01T00:00:00+00:01"), "2000-02-29T23:59:00Z");
  EXPECT_EQ(utc("2025-12-21T01:30:00.250z"), "2025-12-21T01:30:00.25Z");
  EXPECT_EQ(utc("2025-12-21T01:30:59.9999999999Z"), "2025-12-21T01:30:59.9999999999Z");
  EXPECT_EQ(utc("2016-12-31T23:59:60.5Z"), "2016-12-31T23:59:60.5Z");
  EXPECT_EQ(utc("2017-01-01T08:59:60+09:00"), "2016-12-31T23:59:60Z");
  EXPECT_EQ(utc("1972-06-30T23:59:60Z"), "1972-06-30T23:59:60Z");
}

TEST(Time, WhatIsNotATimeIsRefusedWithItsReason) {
  const auto why = [](const char* text) {
    const auto time = parse_rfc3339(text);
    EXPECT_FALSE(time.ok()) << text;
    return std::string(time.status().message());
  };
  EXPECT_THAT(why("2025-12-21T10:30:00"), HasSubstr("no offset"));
  EXPECT_THAT(why("2025-12-21T10:30:00+0900"), HasSubstr("expected RFC 3339"));
  EXPECT_THAT(why("2025-12-21T10:30:00+09:00 "), HasSubstr("expected RFC 3339"));
  EXPECT_THAT(why("2025-12-21T10:30:00.Z"), HasSubstr("expected RFC 3339"));
  EXPECT_THAT(why("2025-12-21T10:3Z"), HasSubstr("expected RFC 3339"));
  EXPECT_THAT(why("2025-12-21"), HasSubstr("expected RFC 3339"));
  EXPECT_THAT(why(""), HasSubstr("expected RFC 3339"));
  EXPECT_THAT(why("25-12-21T10:30:00Z"), HasSubstr("expected RFC 3339"));
  EXPECT_THAT(why("2025-12-21T10:30:+5Z"), HasSubstr("expected RFC 3339"));
  EXPECT_THAT(why("2025-12-21T10:30:00+24:00"), HasSubstr("offset"));
  EXPECT_THAT(why("2025-13-01T00:00:00Z"), HasSubstr("month"));
  EXPECT_THAT(why("2025-02-29T00:00:00Z"), HasSubstr("day must be between 01 and 28"));
  EXPECT_THAT(why("2025-12-21T24:00:00Z"), HasSubstr("hour"));
  EXPECT_THAT(why("2025-12-21T23:60:00Z"), HasSubstr("minute"));
  EXPECT_THAT(why("2016-12-31T23:59:61Z"), HasSubstr("second"));
  EXPECT_THAT(why("2015-12-31T23:59:60Z"), HasSubstr("no leap second"));
  EXPECT_THAT(why("2016-12-31T22:59:60Z"), HasSubstr("no leap second"));
  EXPECT_THAT(why("2016-12-31T23:59:60+09:00"), HasSubstr("no leap second"));
  EXPECT_THAT(why("2049-12-31T23:59:60Z"), HasSubstr("no leap second"));
}

}  // namespace
}  // namespace irsig
