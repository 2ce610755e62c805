#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/geo/frames.h"

namespace irsig {

// An instant of UTC as calendar fields, so that a leap second (second 60) can be named.
struct UtcTime {
  int year, month, day, hour, minute;
  double second;  // [0, 61)
};

// Parses RFC 3339 with offset: "2025-12-21T10:30:00+09:00", "2016-12-31T23:59:60Z". A time without
// offset is an error.
[[nodiscard]] absl::StatusOr<UtcTime> parse_rfc3339(std::string_view text);
[[nodiscard]] std::string format_rfc3339_utc(
    const UtcTime& time);  // "2025-12-21T01:30:00Z"; fractions only if any

// Seconds since 1970-01-01T00:00:00Z without leap seconds (a leap second counts as the next one).
[[nodiscard]] double unix_seconds(const UtcTime& time);
// Inverts unix_seconds(), for years 0 to 9999; to 0.2 us, as fine as such a double is in our
// century.
[[nodiscard]] UtcTime utc_time(double unix_s);

struct SunPosition {
  double azimuth_deg;  // clockwise from true north [0, 360); at the poles: from longitude_deg's
                       // meridian
  double zenith_deg;   // airless, topocentric
  double distance_au;
  double angular_radius_deg;  // asin(695700 km / distance)
  Vec<Enu> direction;         // unit vector towards the sun
};

// Computes the position of the sun's centre: ERFA, UT1 = UTC, no polar motion, no refraction;
// parallax, light
// time and aberration included.                                                            [erfa]
//   latitude_deg [-90, 90], longitude_deg [-180, 360] east, height_m [-12e3, 4e7] above WGS 84
//
// Accuracy (tests/physics/sun_test.cpp): agrees with ERFA's own figures to their last digit (1e-7
// deg, 5e-11 of the distance) and with NREL's SPA, an independent algorithm, to 0.00014 deg. UT1 =
// UTC itself is worth up to 0.004 deg of hour angle. Limits: times outside ERFA's leap-second table
// are computed with its nearest value; ERFA's Earth is good to 0.002 arc seconds in 1900-2100 and
// not checked outside.
[[nodiscard]] absl::StatusOr<SunPosition> sun_position(const UtcTime& utc, double latitude_deg,
                                                       double longitude_deg, double height_m);

}  // namespace irsig
