#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/thermal/weather_course.h"

namespace irsig {

// Quantities in columns of weather files, in SI; the two last but one lines of the enum are
// radiation.
enum class WeatherQuantity : std::uint8_t {
  kAir,         // K
  kDewPoint,    // K
  kHumidity,    // %, over water
  kPressure,    // Pa
  kWind,        // m/s
  kWindFrom,    // deg
  kCloudCover,  // [0, 1]
  kDirectNormal,
  kDiffuseHorizontal,
  kGlobalHorizontal,
  kSky,  // W/m2
};
inline constexpr std::size_t kWeatherQuantities = 11;

// Returns the limits of a quantity in any weather.
[[nodiscard]] const WeatherLimit& limit_of(WeatherQuantity quantity);

// Rows as a file has them, checked as numbers only.
struct WeatherFile {
  struct Row {
    std::size_t line = 0;
    double local_s = 0;  // EPW, TMY3: the end of its hour in local standard time, in the row's own
                         // year, seconds since 1970; CSV: unix time
    int hour_of_year = 0;  // EPW, TMY3: 10000 month + 100 day + hour (1 to 24)
    std::array<double, kWeatherQuantities> value{};     // NaN: missing
    std::array<bool, kWeatherQuantities> impossible{};  // beyond what any weather has
    std::array<std::uint32_t, kWeatherQuantities> column{};
  };
  std::string name;
  std::vector<Row> row;  // in the order of the file, which is that of time (in any_year: of a year)
  std::array<bool, kWeatherQuantities> has{};  // whether there is such a column
  // Its unit: SI = factor x what the file has + offset.
  std::array<double, kWeatherQuantities> factor{}, offset{};
  std::optional<WeatherPlace> place;  // EPW, TMY3
  double utc_offset_h = 0;            // EPW, TMY3: of local standard time
  bool any_year = false;  // EPW, TMY3: rows are those of a month, day and hour, in whatever year
  int one_year = 0;       // of any_year: the year of all rows; 0: they have different ones
  double radiation_interval_s = 0;
};

// Reads a weather file:
// - EPW (a name that ends in .epw): its lines LOCATION and DATA PERIODS (one record an hour), and
//   records of hours; others of its header lines are not read;
// - TMY3 [wilcox2008] (.csv whose second line begins with "Date (MM/DD/YYYY)");
// - CSV (.csv): '#' starts a remark, the first other line names the columns: time (RFC 3339 with
//   its offset); air_temperature_k | air_temperature_c; dew_point_k | dew_point_c |
//   relative_humidity_percent; pressure_pa | pressure_hpa; wind_speed_m_s; and where known
//   wind_from_deg, cloud_cover, direct_normal_w_m2, diffuse_horizontal_w_m2,
//   global_horizontal_w_m2, sky_w_m2, of which two of the three of sunlight make sense. With any
//   radiation a remark "# radiation_interval_s: 3600" says that it is the mean over so long before
//   each time; 0: of the time itself.
// A missing value is an empty cell; NA, NaN, null; the code of EPW or TMY3; 99, 999 and so on to
// 999999, of either sign and with or without .9, where no weather has such a number. Numbers that
// no weather has (weather_course.h) matter only in records that are used: course_of().
//
// INVALID_ARGUMENT, "file:line:column: ..." a line, the first ten: what is no such file, cells that
// are no numbers, unknown columns, rows out of order or there twice.
[[nodiscard]] absl::StatusOr<WeatherFile> read_weather_file(std::string_view text,
                                                            const std::string& file_name);

// The part of a file to be read.
struct CourseWanted {
  double from_unix_s = 0, to_unix_s = 0;  // periodic: of the day that begins at from_unix_s
  bool periodic = false;
  WeatherPlace place{};
  bool radiation = false;  // and the wind's direction
  bool wind_direction = false;
  // Values where the file has no column for them; absent: an error (where the quantity is wanted),
  // and 0.
  std::optional<double> wind_from_deg, cloud_cover;
  bool cloud_cover_wins = false;  // over the file's
};
struct FileCourse {
  WeatherCourse course;
  std::vector<std::string> warning;  // "file: what"
};

// Returns the file's weather from the last record at or before the begin to the first at or after
// the end; of any_year the records of month, day and hour. Periodic: the records of the 24 hours
// after the begin, before which the last of them is repeated, a day earlier.
//
// Of global and one of direct and diffuse radiation follows the other, by the mean sine of the
// sun's elevation over the interval; what is direct while that is below that of 1 deg counts as
// diffuse.
//
// Long-wave radiation of 0 is missing: no sky has it. Where it is missing in all records it is
// computed, with a warning.
//
// INVALID_ARGUMENT, "file:line:column: ..." a line, the first ten: numbers that no weather has, in
// records that are used; a place more than 1 deg (of a
// great circle) or 300 m of height away; hours that the file does not have (29 February; gaps above
// 3 h); values that are missing where they are needed; a dew point more than 0.15 K above the air;
// direct radiation above 1 W/m2 while the sun stays more than 6 deg below the horizon.
// Warnings: sunlight of 0 in all records while the sun is more than 10 deg high; global radiation
// that differs from diffuse + direct by more than 10 % and 20 W/m2; all rows of one year that is
// another than the one wanted.
[[nodiscard]] absl::StatusOr<FileCourse> course_of(const WeatherFile& file,
                                                   const CourseWanted& wanted);

}  // namespace irsig
