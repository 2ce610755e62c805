#include "core/thermal/weather_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/file_errors.h"
#include "core/thermal/clear_sky.h"
#include "core/thermal/sun_sine.h"

namespace irsig {
namespace {

using Q = WeatherQuantity;
using Row = WeatherFile::Row;
constexpr std::size_t at(Q q) { return static_cast<std::size_t>(q); }
constexpr double kHourS = 3600, kDayS = 86400;
constexpr double kGapS = 3 * kHourS;
// Rounding of what stations report in tenths of a degree, and in whole percents.
constexpr double kDewPointSlackK = 0.15;

std::string round_deg(double deg) {
  return absl::StrCat(std::abs(std::round(10 * deg) / 10), " deg");
}

double great_circle_deg(const WeatherPlace& a, const WeatherPlace& b) {
  const double north = std::sin(kRadPerDeg * (a.latitude_deg - b.latitude_deg) / 2);
  const double east = std::sin(kRadPerDeg * (a.longitude_deg - b.longitude_deg) / 2);
  const double h = north * north + std::cos(kRadPerDeg * a.latitude_deg) *
                                       std::cos(kRadPerDeg * b.latitude_deg) * east * east;
  return 2 * std::asin(std::sqrt(std::min(1.0, h))) / kRadPerDeg;
}

// A row that is used, and when.
struct Used {
  const Row* row;
  double unix_s;
};

class CourseMaker {
 public:
  CourseMaker(const WeatherFile& file, const CourseWanted& wanted)
      : file_(file), wanted_(wanted), errors_(file.name), sine_(wanted.place) {}

  absl::StatusOr<FileCourse> make() {
    check_place();
    const std::vector<Used> used = file_.any_year ? rows_of_hours() : rows_of_times();
    if (errors_.any()) return errors_.status();
    check_year();
    if (wanted_.radiation) choose_sunlight(used);
    for (const Used& u : used) {
      if (errors_.full()) break;
      out_.course.record.push_back(record(u));
    }
    warn_of_no_sunlight();
    out_.course.periodic = wanted_.periodic;
    const bool any = out_.course.record.empty() || direct_ || sky_;
    out_.course.radiation_interval_s = any ? file_.radiation_interval_s : 0;
    if (errors_.any()) return errors_.status();
    if (wanted_.periodic) {
      WeatherRecord first = out_.course.record.back();
      first.unix_s -= kDayS;
      out_.course.record.insert(out_.course.record.begin(), first);
    }
    if (odd_.count > 0)
      out_.warning.push_back(absl::StrCat(
          file_.name, ": global radiation differs from diffuse and direct radiation in ",
          odd_.count, " of ", used.size(), " records, most in line ", odd_.line, ": ",
          std::round(odd_.global), " and ", std::round(odd_.sum), " W/m2"));
    if (odd_sky_.count > 0)
      out_.warning.push_back(absl::StrCat(
          file_.name, ": the sky's radiation is not that of any sky above such air (", kColdestSky,
          " to ", kWarmestSky, " of a black one) in ", odd_sky_.count, " of ", used.size(),
          " records, first in line ", odd_sky_.line, ": ", std::round(odd_sky_.w_m2),
          " W/m2, of a black one ", std::round(odd_sky_.black_w_m2)));
    // Whatever else is wrong is wrong with the file as a whole.
    if (const absl::Status status = check_course(out_.course); !status.ok())
      return placed_problem(absl::StrCat(file_.name, ":", used.front().row->line, ":1"),
                            absl::StrCat("from here: ", status.message()));
    return std::move(out_);
  }

 private:
  // NaN: missing, or impossible.
  [[nodiscard]] double value(const Row& row, Q q) const {
    const double v = row.value[at(q)];
    const bool none = row.impossible[at(q)] || (q == Q::kSky && v == 0);
    return none ? std::numeric_limits<double>::quiet_NaN() : v;
  }
  // Reports a missing value that is there as a number that no weather has; returns true if it did.
  bool add_impossible(const Row& row, Q q) {
    if (!row.impossible[at(q)]) return false;
    const auto in_file = [&](double si) {
      return absl::SixDigits((si - file_.offset[at(q)]) / file_.factor[at(q)]);
    };
    const WeatherLimit& limit = limit_of(q);
    const double si = row.value[at(q)];
    const auto fits = [&](double x) { return x >= limit.least && x <= limit.most; };
    // A number that another unit makes plausible.
    const bool named = !file_.any_year;  // columns have names, which say the unit
    const bool degrees = named && (q == Q::kAir || q == Q::kDewPoint);
    const bool kelvin = file_.offset[at(q)] == 0;
    const bool celsius = degrees && kelvin && fits(si + 273.15);
    const bool in_kelvin = degrees && !kelvin && fits(si - 273.15);
    const bool hectopascals = named && q == Q::kPressure && fits(100 * si);
    const bool pascals = named && q == Q::kPressure && fits(si / 100);
    add(row, q,
        absl::StrCat(in_file(si), ": expected ", limit.name, " from ", in_file(limit.least), " to ",
                     in_file(limit.most),
                     celsius        ? ": is it in degrees Celsius? Then name the column ..._c"
                     : in_kelvin    ? ": is it in kelvins? Then name the column ..._k"
                     : hectopascals ? ": is it in hPa? Then name the column pressure_hpa"
                     : pascals      ? ": is it in Pa? Then name the column pressure_pa"
                                    : ""));
    return true;
  }
  void add(const Row& row, Q q, const std::string& what) {
    errors_.add(row.line, row.column[at(q)], what);
  }
  [[nodiscard]] std::string time_text(double unix_s) const {
    const std::string local =
        format_rfc3339_utc(utc_time(unix_s + kHourS * file_.utc_offset_h)).substr(0, 16);
    const double hours = std::abs(file_.utc_offset_h);
    const int minutes = static_cast<int>(std::lround(60 * hours));
    const auto two = [](int x) { return absl::StrCat(absl::Dec(x, absl::kZeroPad2)); };
    return minutes == 0 ? local + "Z"
                        : absl::StrCat(local, file_.utc_offset_h < 0 ? "-" : "+", two(minutes / 60),
                                       ":", two(minutes % 60));
  }

  void check_place() {
    if (!file_.place) return;
    const double apart_deg = great_circle_deg(*file_.place, wanted_.place);
    if (apart_deg > 1)
      errors_.add(
          1, 1,
          absl::StrCat("the file is of latitude ", file_.place->latitude_deg, ", longitude ",
                       file_.place->longitude_deg,
                       ", the sweep's [place] is latitude_deg = ", wanted_.place.latitude_deg,
                       ", longitude_deg = ", wanted_.place.longitude_deg, ": ",
                       round_deg(apart_deg), " apart, expected at most 1 deg"));
    const double higher_m = file_.place->height_m - wanted_.place.height_m;
    if (std::abs(higher_m) > 300)
      errors_.add(1, 1,
                  absl::StrCat("the file is of ", file_.place->height_m,
                               " m of height, the sweep's place.height_m = ",
                               wanted_.place.height_m, ": expected at most 300 m apart"));
  }

  // Sunlight that a file does not know may stand there as 0.
  void warn_of_no_sunlight() {
    constexpr double kHighDeg = 10;
    double highest = -1;
    for (const WeatherRecord& r : out_.course.record) {
      if (!r.direct_normal_w_m2 || *r.direct_normal_w_m2 > 0 || *r.diffuse_horizontal_w_m2 > 0)
        return;
      highest = std::max(highest, sine_.of(r.unix_s));
    }
    if (highest > std::sin(kHighDeg * kRadPerDeg))
      out_.warning.push_back(absl::StrCat(
          file_.name, ": no sunlight in any record, though the sun rises to ",
          round_deg(std::asin(std::min(1.0, highest)) / kRadPerDeg),
          ": leave the columns of sunlight away where it is not known, and it is computed"));
  }

  void check_year() {
    if (file_.one_year == 0) return;
    const int year = utc_time(wanted_.from_unix_s + kHourS * file_.utc_offset_h).year;
    if (year != file_.one_year && year + 1 != file_.one_year)
      out_.warning.push_back(absl::StrCat(file_.name, ": the weather of ", file_.one_year,
                                          " stands for that of ", year));
  }

  // EPW, TMY3: an hour of each wanted day, whatever the year.
  std::vector<Used> rows_of_hours() {
    std::map<int, const Row*> of_hour;
    for (const Row& row : file_.row) of_hour[row.hour_of_year] = &row;
    const double offset_s = kHourS * file_.utc_offset_h;
    double first = std::ceil((wanted_.from_unix_s + offset_s) / kHourS) * kHourS;
    double last = std::ceil((wanted_.to_unix_s + offset_s) / kHourS) * kHourS;
    if (wanted_.periodic) {
      last = first + kDayS;
      first += kHourS;
    } else if (first > wanted_.from_unix_s + offset_s || first == last) {
      first -= kHourS;
    }
    std::vector<Used> out;
    for (double local = first; local <= last && !errors_.full(); local += kHourS) {
      const UtcTime begin = utc_time(local - kHourS);
      const auto found = of_hour.find(10000 * begin.month + 100 * begin.day + begin.hour + 1);
      if (found != of_hour.end()) {
        out.push_back({found->second, local - offset_s});
        continue;
      }
      const bool leap = begin.month == 2 && begin.day == 29;
      errors_.add(
          file_.row.back().line, 1,
          absl::StrCat("no record of month ", begin.month, ", day ", begin.day, ", hour ",
                       begin.hour + 1, ", which ", needs(),
                       leap ? "; typical years have no 29 February, expected another date" : ""));
      if (leap) break;
    }
    return out;
  }

  [[nodiscard]] std::string needs() const {
    return absl::StrCat("the time from ", time_text(wanted_.from_unix_s), " to ",
                        time_text(wanted_.to_unix_s), " needs");
  }

  std::vector<Used> rows_of_times() {
    const auto& rows = file_.row;
    const auto later = [](double t, const Row& r) { return t < r.local_s; };
    const auto earlier = [](const Row& r, double t) { return r.local_s < t; };
    // The last at or before the begin, the first at or after the end.
    auto first = std::upper_bound(rows.begin(), rows.end(), wanted_.from_unix_s, later);
    auto last = std::lower_bound(rows.begin(), rows.end(), wanted_.to_unix_s, earlier);
    if (wanted_.periodic) {
      first = std::lower_bound(rows.begin(), rows.end(), wanted_.from_unix_s, earlier);
      if (first != rows.end())
        last = std::lower_bound(first, rows.end(), first->local_s + kDayS, earlier);
      if (first == rows.end() || last == rows.end() ||
          std::abs(last->local_s - first->local_s - kDayS) > 1e-3 ||
          first->local_s > wanted_.from_unix_s + kGapS) {
        errors_.add(
            rows.back().line, 1,
            absl::StrCat("no day of records that ends 24 h after it begins, from ",
                         time_text(wanted_.from_unix_s), " on: a day that repeats needs one"));
        return {};
      }
      ++first;
    } else {
      if (first == rows.begin())
        errors_.add(rows.front().line, 1,
                    absl::StrCat("the file begins at ", time_text(rows.front().local_s), ", but ",
                                 needs(), " earlier records"));
      if (last == rows.end())
        errors_.add(rows.back().line, 1,
                    absl::StrCat("the file ends at ", time_text(rows.back().local_s), ", but ",
                                 needs(), " later records"));
      if (errors_.any()) return {};
      --first;
      if (first == last && last + 1 != rows.end()) ++last;
      if (first == last && first != rows.begin()) --first;
    }
    std::vector<Used> out;
    for (auto row = first; row <= last; ++row) {
      if (!out.empty() && row->local_s - out.back().unix_s > kGapS)
        errors_.add(row->line, 1,
                    absl::StrCat("a gap of ", (row->local_s - out.back().unix_s) / kHourS,
                                 " h before this record, expected at most ", kGapS / kHourS,
                                 " h where weather is needed"));
      out.push_back({&*row, row->local_s});
    }
    return out;
  }

  // Returns true if all records have a kind of radiation, false if none has it.
  bool is_there(const std::vector<Used>& used, Q q) {
    if (!file_.has[at(q)]) return false;
    const auto missing = [&](const Used& u) { return std::isnan(value(*u.row, q)); };
    const auto count = std::count_if(used.begin(), used.end(), missing);
    if (count == 0) return true;
    const bool impossible = std::any_of(used.begin(), used.end(),
                                        [&](const Used& u) { return u.row->impossible[at(q)]; });
    if (static_cast<std::size_t>(count) == used.size() && !impossible) {
      if (std::any_of(used.begin(), used.end(),
                      [&](const Used& u) { return u.row->value[at(q)] == 0; }))
        out_.warning.push_back(absl::StrCat(
            file_.name, ": long-wave radiation of 0 W/m2 from line ", used.front().row->line,
            " on, which no sky has: taken as missing, and computed from the air and its clouds"));
      return false;
    }
    for (const Used& u : used)
      if (missing(u) && !errors_.full() && !add_impossible(*u.row, q))
        add(*u.row, q,
            absl::StrCat("radiation is missing at ", time_text(u.unix_s),
                         ", expected it in all records of ", time_text(used.front().unix_s), " to ",
                         time_text(used.back().unix_s), " or in none"));
    return false;
  }

  void choose_sunlight(const std::vector<Used>& used) {
    sky_ = is_there(used, Q::kSky);
    direct_ = is_there(used, Q::kDirectNormal);
    diffuse_ = is_there(used, Q::kDiffuseHorizontal);
    global_ = is_there(used, Q::kGlobalHorizontal);
    if (direct_ + diffuse_ + global_ == 1)
      errors_.add(used.front().row->line, 1,
                  "one kind of sunlight alone is there, expected two of direct, diffuse and global "
                  "radiation");
    if (direct_ + diffuse_ + global_ < 2) direct_ = diffuse_ = global_ = false;
  }

  double needed(const Used& u, Q q, const char* what) {
    const double v = value(*u.row, q);
    if (std::isnan(v) && !add_impossible(*u.row, q))
      add(*u.row, q, absl::StrCat(what, " is missing at ", time_text(u.unix_s)));
    return v;
  }

  WeatherRecord record(const Used& u) {
    const Row& row = *u.row;
    WeatherRecord r;
    r.unix_s = u.unix_s;
    r.air_k = needed(u, Q::kAir, "the air's temperature");
    r.pressure_pa = needed(u, Q::kPressure, "the air's pressure");
    r.wind_m_s = needed(u, Q::kWind, "the wind's speed");
    r.dew_point_k = dew_point(u, r.air_k);
    if (wanted_.wind_from_deg && !file_.has[at(Q::kWindFrom)])
      r.wind_from_deg = *wanted_.wind_from_deg;
    else if (wanted_.radiation || wanted_.wind_direction)
      // No direction of no wind.
      r.wind_from_deg = r.wind_m_s == 0 && std::isnan(value(row, Q::kWindFrom))
                            ? 0
                            : needed(u, Q::kWindFrom, "the wind's direction");
    if (!file_.has[at(Q::kCloudCover)] || (wanted_.cloud_cover && wanted_.cloud_cover_wins))
      r.cloud_cover = wanted_.cloud_cover.value_or(0);
    else if (wanted_.radiation && !(direct_ && sky_) && !(diffuse_ && global_ && sky_))
      r.cloud_cover = needed(u, Q::kCloudCover, "the cloud cover");
    else if (!std::isnan(value(row, Q::kCloudCover)))
      r.cloud_cover = value(row, Q::kCloudCover);
    if (sky_) r.sky_w_m2 = sky(u, r.air_k);
    if (direct_ || diffuse_) sunlight(u, r);
    return r;
  }

  // Limits of the sky's radiation over a black one's: half of it in the driest air of polar winter,
  // more than it where an inversion makes the sky a few kelvin warmer than the air beneath.
  static constexpr double kColdestSky = 0.4, kWarmestSky = 1.2;
  double sky(const Used& u, double air_k) {
    const double w_m2 = value(*u.row, Q::kSky),
                 black_w_m2 = kStefanBoltzmannWM2K4 * std::pow(air_k, 4);
    if (!(w_m2 >= kSkyOfBlackLimit.least * black_w_m2 &&
          w_m2 <= kSkyOfBlackLimit.most * black_w_m2)) {
      add(*u.row, Q::kSky,
          absl::StrCat(w_m2, " W/m2 is the long-wave radiation of no sky above air of ", air_k,
                       " K, expected ", std::ceil(kSkyOfBlackLimit.least * black_w_m2), " to ",
                       std::floor(kSkyOfBlackLimit.most * black_w_m2), " W/m2"));
      return w_m2;
    }
    if (!(w_m2 >= kColdestSky * black_w_m2 && w_m2 <= kWarmestSky * black_w_m2) &&
        odd_sky_.count++ == 0)
      odd_sky_ = {1, u.row->line, w_m2, black_w_m2};
    return w_m2;
  }

  double dew_point(const Used& u, double air_k) {
    const Row& row = *u.row;
    double dew_k = value(row, Q::kDewPoint);
    Q of = Q::kDewPoint;
    if (std::isnan(dew_k) &&
        (add_impossible(row, Q::kDewPoint) ||
         (std::isnan(value(row, Q::kHumidity)) && add_impossible(row, Q::kHumidity))))
      return air_k;
    if (std::isnan(dew_k) && !std::isnan(value(row, Q::kHumidity))) {
      of = Q::kHumidity;
      const double percent = value(row, Q::kHumidity);
      if (percent <= 0) {
        add(row, of, "a relative humidity of 0, expected more: there is no such air outdoors");
        return air_k;
      }
      dew_k = dew_point_k(percent / 100 * vapour_pressure_pa(air_k));
    } else if (std::isnan(dew_k)) {
      add(row, file_.has[at(Q::kDewPoint)] ? of : Q::kHumidity,
          absl::StrCat("dew point and relative humidity are missing at ", time_text(u.unix_s)));
    }
    if (dew_k > air_k + kDewPointSlackK)
      add(row, of,
          absl::StrCat("the dew point, ", dew_k, " K, is above the air's temperature, ", air_k,
                       " K, at ", time_text(u.unix_s)));
    return std::min(dew_k, air_k);
  }

  void sunlight(const Used& u, WeatherRecord& r) {
    const Row& row = *u.row;
    const double length_s = file_.radiation_interval_s, begin = u.unix_s - length_s;
    // The interval's fraction with sun, and the mean sine of the sun's elevation.
    double up = 1, mean_sine = 0;
    const double stated = value(row, direct_ ? Q::kDirectNormal : Q::kGlobalHorizontal);
    if (stated == 0) {
      // No need to ask for the sun.
    } else if (length_s > 0) {
      const SunSine::Above above = sine_.above(begin, u.unix_s, 0);
      up = above.length_s / length_s;
      mean_sine = above.integral_s / length_s;
    } else {
      mean_sine = std::max(0.0, sine_.of(u.unix_s));
    }
    const double direct = value(row, Q::kDirectNormal), diffuse = value(row, Q::kDiffuseHorizontal),
                 global = value(row, Q::kGlobalHorizontal);
    // Normal irradiance is the same while the sun is up.
    const double horizontal = direct_ ? (up > 0 ? direct / up * mean_sine : 0) : global - diffuse;
    if ((direct_ ? direct : horizontal) > 1)
      check_night(u, direct_ ? Q::kDirectNormal : Q::kGlobalHorizontal,
                  direct_ ? direct : horizontal);
    static const double kLow = std::sin(1 * kRadPerDeg);
    if (direct_) {
      r.direct_normal_w_m2 = direct;
      r.diffuse_horizontal_w_m2 = diffuse_ ? diffuse : std::max(0.0, global - horizontal);
    } else {
      const bool low = mean_sine < kLow;
      r.direct_normal_w_m2 = low ? 0 : std::max(0.0, horizontal) * up / mean_sine;
      r.diffuse_horizontal_w_m2 = low ? std::max(diffuse, global) : diffuse;
      if (*r.direct_normal_w_m2 > kDirectLimit.most)
        add(row, Q::kGlobalHorizontal,
            absl::StrCat("global radiation of ", global, " W/m2 and diffuse radiation of ", diffuse,
                         " W/m2 at ", time_text(u.unix_s), " mean direct radiation of ",
                         std::round(*r.direct_normal_w_m2), " W/m2, more than in space"));
    }
    if (direct_ && diffuse_ && global_) {
      const double sum = diffuse + horizontal, apart = std::abs(sum - global);
      if (apart > 20 && apart > 0.1 * global) {
        ++odd_.count;
        if (apart > std::abs(odd_.sum - odd_.global)) odd_ = {odd_.count, row.line, global, sum};
      }
    }
  }

  void check_night(const Used& u, Q q, double w_m2) {
    const double begin = u.unix_s - file_.radiation_interval_s;
    const double highest =
        std::max({sine_.of(begin), sine_.of((begin + u.unix_s) / 2), sine_.of(u.unix_s)});
    if (highest >= -std::sin(6 * kRadPerDeg)) return;
    add(*u.row, q,
        absl::StrCat(
            "direct radiation of ", w_m2, " W/m2 at ", time_text(u.unix_s), ", when the sun is ",
            round_deg(std::asin(highest) / kRadPerDeg),
            " below the horizon at the sweep's place: the hours are wrong, by their "
            "offset from UTC",
            file_.any_year ? absl::StrCat(" (the file's: ", file_.utc_offset_h, " h)") : "",
            ", or the place is"));
  }

  const WeatherFile& file_;
  const CourseWanted& wanted_;
  FileErrors errors_;
  SunSine sine_;
  bool direct_ = false, diffuse_ = false, global_ = false, sky_ = false;
  FileCourse out_;
  struct {
    int count;
    std::size_t line;
    double global, sum;
  } odd_ = {0, 0, 0, 0};
  struct {  // skies that none is
    std::size_t count, line;
    double w_m2, black_w_m2;
  } odd_sky_ = {0, 0, 0, 0};
};

}  // namespace

const WeatherLimit& limit_of(WeatherQuantity quantity) {
  static const std::array<WeatherLimit, kWeatherQuantities> limits = {
      kAirLimit,   kDewPointLimit, kHumidityLimit, kPressureLimit, kWindLimit, kWindFromLimit,
      kCloudLimit, kDirectLimit,   kDiffuseLimit,  kGlobalLimit,   kSkyLimit};
  return limits[at(quantity)];
}

absl::StatusOr<FileCourse> course_of(const WeatherFile& file, const CourseWanted& wanted) {
  return CourseMaker(file, wanted).make();
}

}  // namespace irsig
