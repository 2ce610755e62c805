#pragma once

#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/geo/sun.h"

namespace irsig {

// The weather at the surface as it goes on, in SI. Times: seconds since 1970 UTC, without leap
// seconds. Equations and sources: docs/explanation/methods/thermal.md, "Weather".

// Limits of weather, whoever states it: the coldest and warmest air ever measured (184 and 330 K)
// with a margin, the pressure of inhabited mountains and of the deepest highs, the strongest wind
// of some minutes (85 m/s), sunlight outside the air at perihelion (1407 W/m2); diffuse and global
// sunlight, to which clouds may add. The sky's long-wave radiation is also limited as a fraction of
// the emission of a black sky as warm as the air: clear nights on the driest mountains have 0.5,
// fog that is 20 K warmer than the air below it 1.3 (files: weather_file.h).
struct WeatherLimit {
  const char* name;
  double least, most;
};
inline constexpr WeatherLimit kAirLimit{"an air temperature", 180, 340},
    kDewPointLimit{"a dew point", 120, 340}, kHumidityLimit{"a relative humidity", 0, 110},
    kPressureLimit{"an air pressure", 5e4, 1.1e5}, kWindLimit{"a wind speed", 0, 100},
    kWindFromLimit{"a wind direction", -360, 360}, kCloudLimit{"a cloud cover", 0, 1},
    kDirectLimit{"direct normal radiation", 0, 1420}, kDiffuseLimit{"diffuse radiation", 0, 1420},
    kGlobalLimit{"global radiation", 0, 1800}, kSkyLimit{"long-wave radiation", 15, 1000},
    kSkyOfBlackLimit{"long-wave radiation over that of a black sky", 0.3, 1.5};

struct WeatherRecord {
  double unix_s = 0;
  double air_k = 0;
  double dew_point_k = 0;
  double pressure_pa = 0;
  double wind_m_s = 0;
  double wind_from_deg = 0;  // clockwise from true north
  double cloud_cover = 0;    // [0, 1]
  // Stated by all records of a course or by none; the first two together. Absent: a model's.
  std::optional<double> direct_normal_w_m2, diffuse_horizontal_w_m2;
  std::optional<double> sky_w_m2;  // long-wave, horizontal
};

struct WeatherCourse {
  std::vector<WeatherRecord> record;
  // Radiation is the mean over so long before its record; 0: of its instant.
  double radiation_interval_s = 0;
  bool periodic = false;  // the last record is the first, a day later
};

// Checks a course. INVALID_ARGUMENT names the record (from 0) and its fault: fewer than two
// records, times that do not increase, a dew point above the air, numbers that no weather has (the
// limits above), radiation in some records only, means over other intervals than those between
// records or of more than 3 h, a periodic course that does not close.
[[nodiscard]] absl::Status check_course(const WeatherCourse& course);

// Returns the instant within the course that stands for this one: of a periodic course that of its
// day, else the same.
[[nodiscard]] double within_course(const WeatherCourse& course, double unix_s);

// Interpolates the weather linearly in time between records, the wind's direction by the vector
// between them (0.5 m/s from north and 0.5 m/s from south: the nearer record's). A periodic course
// continues for ever; before and after another one stand its first and last record. CourseRadiation
// has the radiation.
[[nodiscard]] WeatherRecord weather_at(const WeatherCourse& course, double unix_s);

// Geodetic.
struct WeatherPlace {
  double latitude_deg, longitude_deg, height_m;
};

// A layer of cloud that covers a part of the sky, for the long-wave radiation and the sunlight that
// no weather states.
struct CloudAbove {
  // Temperature of the air by height above the surface, in some weather: that of another weather is
  // shifted by the difference at the surface, less and less up to 2 km. An absent base
  // has the temperature of air that has risen from the surface (risen_air_k).
  std::vector<double> height_m, air_k;  // heights increase from 0
  std::optional<double> base_m;         // absent: condensed_base_m
  double emissivity = 1;                // of the layer, long-wave
  std::optional<double> solar_depth;    // optical, straight up; absent: [kasten1980]
  bool base_of_risen_air = false;       // of a stated base; else it has the air's temperature
};

// Inputs of the clear-sky model that weather does not state (clear_sky.h).
struct SkyAerosol {
  double depth_380, depth_500;  // vertical aerosol optical depths at 380 and 500 nm
  double ozone_cm;
  double albedo;  // of sea or ground, to sunlight: [0, 1]
  // Layer of the cover that a course has; required if any record has one.
  std::optional<CloudAbove> cloud = {};
  // Fog: what it does not let pass of the sky's long-wave radiation, [0, 1], and by how much it is
  // colder than the air at the ground. 0: there is none.
  double fog_emissivity = 0, fog_colder_k = 0;
};

struct Radiation {
  double direct_normal_w_m2;       // 0 while the sun's centre is below the horizon
  double diffuse_horizontal_w_m2;  // of the whole sky
  double sky_w_m2;                 // long-wave, horizontal
  bool low_sun;  // sunlight by the model, below 5 deg of elevation, where it is not tested
};

// The radiation of a course at any instant.
//
// Means over intervals are spread so that each keeps its energy (to 1e-9,
// tests/unit/weather_course_test.cpp): the direct normal irradiance is the same as long as the sun
// is up, so that the direct horizontal one goes with the sine of its elevation; the diffuse one
// goes with sine + sin 6 deg, so that twilight has some; long-wave is constant. They jump at
// records. Of instants: linear between records.
//
// Without sunlight in the course: [bird1981] for a clear sky; G = G_clear (1 - 0.75 N^3.4)
// [kasten1980] under clouds of cover N, with the diffuse share k + (1 - k) N^2, k that of the clear
// sky (0.3 in the paper's): direct = direct_clear (1 - 0.75 N^3.4) (1 - N^2). Without long-wave
// radiation: [prata1996], and what it lets pass of a cloud's emission:
//   sky = e sigma T_air^4 + N (1 - e) e_cloud sigma T_base^4,
// in fog
//   sky = e sigma T_air^4 + (1 - e) (e_fog sigma T_fog^4 + (1 - e_fog) N e_cloud sigma T_base^4).
// A cloud of known water lets pass 1 / (1 + 0.75 (1 - 0.85) depth) of global sunlight, and
// exp(-depth / sine) of the beam.
class CourseRadiation {
 public:
  // Copies the course, which must pass check_course(). INVALID_ARGUMENT: it does not, the place or
  // the time has no sun, or a cover has no layer.
  [[nodiscard]] static absl::StatusOr<CourseRadiation> make(WeatherCourse course,
                                                            const WeatherPlace& place,
                                                            const SkyAerosol& sky);

  // Side of a record's own time: the interval that ends there, or the one that begins.
  enum class Side { kBefore, kAfter };
  [[nodiscard]] Radiation at(double unix_s, Side side = Side::kBefore) const;

  // Returns the sun of the radiation, at within_course(unix_s).
  [[nodiscard]] SunPosition sun_at(double unix_s) const;

  // Instants within the course when the sun's centre rises or sets, increasing.
  [[nodiscard]] const std::vector<double>& sun_crossings() const { return crossing_; }

  // Returns the direct radiation that no sun could bring: of records in whose interval the sun is
  // not up, or above the horizon for so short that it would be brighter than in space. Normal to
  // it, all records.
  [[nodiscard]] double unplaced_j_m2() const { return unplaced_j_m2_; }

 private:
  struct Spread {
    double direct;   // normal irradiance while the sun is up
    double diffuse;  // per weight of the diffuse part; or the irradiance itself
    bool diffuse_constant;
  };

  WeatherCourse course_;
  WeatherPlace place_{};
  SkyAerosol sky_{};
  std::vector<Spread> spread_;  // of each record; empty: none states means
  std::vector<double> crossing_;
  double unplaced_j_m2_ = 0;
};

// Returns the height and the temperature of a cloud's base in the given weather. [m, K]
[[nodiscard]] double base_height_m(const CloudAbove& cloud, const WeatherRecord& now);
[[nodiscard]] double base_temperature_k(const CloudAbove& cloud, const WeatherRecord& now);

// Returns the instant of 0 h local (true) solar time on a date, by the equation of time of
// [spencer1971]: 1 minute.
[[nodiscard]] double solar_midnight_unix_s(int year, int month, int day, double longitude_deg);

// A day that is stated: air between two temperatures as a cosine about its warmest hour, all else
// constant. Records every 20 minutes, between which a straight line is 0.1 % of the amplitude from
// the cosine; periodic, beginning at local solar midnight.
struct StatedDay {
  double air_min_k, air_max_k;
  double warmest_hour;  // of local solar time: [0, 24]
  double dew_point_k, pressure_pa, wind_m_s, wind_from_deg, cloud_cover;
};
// Makes a course from a stated day. INVALID_ARGUMENT: a maximum below the minimum, a dew point
// above the minimum, or as check_course.
[[nodiscard]] absl::StatusOr<WeatherCourse> day_course(const StatedDay& day,
                                                       double midnight_unix_s);

}  // namespace irsig
