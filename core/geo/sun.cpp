#include "core/geo/sun.h"

#include <erfa.h>

#include <array>
#include <cmath>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

// Metres above the ellipsoid: from below the deepest sea to the geostationary orbit.
constexpr double kHeightMinM = -12e3;
constexpr double kHeightMaxM = 4e7;

constexpr double kDayS = 86400.0;

absl::Status check_place(double latitude_deg, double longitude_deg, double height_m) {
  if (!(latitude_deg >= -90.0 && latitude_deg <= 90.0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("latitude ", latitude_deg, " deg: expected -90 to 90"));
  }
  if (!(longitude_deg >= -180.0 && longitude_deg <= 360.0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("longitude ", longitude_deg, " deg: expected -180 to 360"));
  }
  if (!(height_m >= kHeightMinM && height_m <= kHeightMaxM)) {
    return absl::InvalidArgumentError(
        absl::StrCat("height ", height_m, " m: expected ", kHeightMinM, " to ", kHeightMaxM));
  }
  return absl::OkStatus();
}

// Barycentric, from a UTC date that ERFA has accepted.                 [au/day]
std::array<double, 3> sun_velocity(double utc1, double utc2) {
  double tai1 = 0.0;
  double tai2 = 0.0;
  double tt1 = 0.0;
  double tt2 = 0.0;
  eraUtctai(utc1, utc2, &tai1, &tai2);
  eraTaitt(tai1, tai2, &tt1, &tt2);
  double heliocentric_earth[2][3];
  double barycentric_earth[2][3];
  eraEpv00(tt1, tt2, heliocentric_earth, barycentric_earth);  // TT for TDB: 2 ms
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = barycentric_earth[1][i] - heliocentric_earth[1][i];
  return out;
}

}  // namespace

absl::StatusOr<SunPosition> sun_position(const UtcTime& utc, double latitude_deg,
                                         double longitude_deg, double height_m) {
  RETURN_IF_ERROR(check_place(latitude_deg, longitude_deg, height_m));
  // Quasi Julian date: a day with a leap second has 86401 seconds, so that 23:59:60 has a date of
  // its own.
  double date1 = 0.0;
  double date2 = 0.0;
  const int read = eraDtf2d("UTC", utc.year, utc.month, utc.day, utc.hour, utc.minute, utc.second,
                            &date1, &date2);
  if (read < 0 || (read & 2) != 0) {  // +1, a dubious year, is accepted
    return absl::InvalidArgumentError(
        absl::StrCat("time ", format_rfc3339_utc(utc), " does not exist in UTC"));
  }

  // The Earth, the observer on it and the rotation from the celestial to the local frame. Pressure
  // 0: no air.
  constexpr double kDut1S = 0.0;
  constexpr double kPolarMotionRad = 0.0;
  constexpr double kPressureHpa = 0.0;
  constexpr double kCelsius = 0.0;
  constexpr double kHumidity = 0.0;
  constexpr double kRefractionUm = 0.55;  // of no effect at pressure 0
  eraASTROM place;
  double equation_of_origins_rad = 0.0;
  if (eraApco13(date1, date2, kDut1S, longitude_deg * kRadPerDeg, latitude_deg * kRadPerDeg,
                height_m, kPolarMotionRad, kPolarMotionRad, kPressureHpa, kCelsius, kHumidity,
                kRefractionUm, &place, &equation_of_origins_rad) < 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("time ", format_rfc3339_utc(utc), " is outside the range of ERFA"));
  }

  // The vector goes from the observer to the place of the sun's centre when the light left it.
  // place.eh points from the centre's present place to the observer, place.em is their distance in
  // au. (Within a light time, 8 minutes, the sun moves by 7 km around the solar system's centre of
  // mass: 3e-6 deg.) Aberration and the rotation to the horizon follow; the sun does not deflect
  // the light of its own centre.
  const auto sun_au_day = sun_velocity(date1, date2);
  const double light_time_day = place.em * kAstronomicalUnitM / kLightSpeedMS / kDayS;
  double towards_sun[3];
  for (int i = 0; i < 3; ++i) {
    towards_sun[i] =
        -place.em * place.eh[i] - sun_au_day[static_cast<std::size_t>(i)] * light_time_day;
  }
  const double distance_au = eraPm(towards_sun);
  double right_ascension_rad = 0.0;
  double declination_rad = 0.0;
  eraC2s(towards_sun, &right_ascension_rad, &declination_rad);
  double cirs_right_ascension_rad = 0.0;
  double cirs_declination_rad = 0.0;
  eraAtciqz(right_ascension_rad, declination_rad, &place, &cirs_right_ascension_rad,
            &cirs_declination_rad);
  double azimuth_rad = 0.0;
  double zenith_rad = 0.0;
  double hour_angle_rad = 0.0;
  double observed_declination_rad = 0.0;
  double observed_right_ascension_rad = 0.0;
  eraAtioq(cirs_right_ascension_rad, cirs_declination_rad, &place, &azimuth_rad, &zenith_rad,
           &hour_angle_rad, &observed_declination_rad, &observed_right_ascension_rad);

  const double azimuth_deg = azimuth_rad / kRadPerDeg;
  const double sin_zenith = std::sin(zenith_rad);
  return SunPosition{.azimuth_deg = azimuth_deg < 360.0 ? azimuth_deg : 0.0,
                     .zenith_deg = zenith_rad / kRadPerDeg,
                     .distance_au = distance_au,
                     .angular_radius_deg =
                         std::asin(kSolarRadiusM / (distance_au * kAstronomicalUnitM)) / kRadPerDeg,
                     .direction = {sin_zenith * std::sin(azimuth_rad),
                                   sin_zenith * std::cos(azimuth_rad), std::cos(zenith_rad)}};
}

}  // namespace irsig
