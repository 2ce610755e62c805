#include "core/thermal/weather_course.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/base/table.h"
#include "core/thermal/clear_sky.h"
#include "core/thermal/condensation.h"
#include "core/thermal/sun_sine.h"

namespace irsig {
namespace {

constexpr double kCourseDayS = 86400;
constexpr double kSolarConstantWM2 = 1361;  // [kopp2011], as clear_sky.h
const double kTwilight = std::sin(6 * kRadPerDeg);

absl::Status wrong(std::size_t record, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("weather record ", record, ": ", what));
}

absl::Status check_number(std::size_t i, double value, const WeatherLimit& limit,
                          const char* unit) {
  if (value >= limit.least && value <= limit.most) return absl::OkStatus();
  return wrong(i, absl::StrCat(value, unit, ": expected ", limit.name, " from ", limit.least,
                               " to ", limit.most, unit));
}

absl::Status check_record(const WeatherRecord& r, std::size_t i) {
  for (const auto& [value, limit, unit] : {std::tuple{r.air_k, kAirLimit, " K"},
                                           {r.dew_point_k, kDewPointLimit, " K"},
                                           {r.pressure_pa, kPressureLimit, " Pa"},
                                           {r.wind_m_s, kWindLimit, " m/s"},
                                           {r.wind_from_deg, kWindFromLimit, " deg"},
                                           {r.cloud_cover, kCloudLimit, ""}})
    RETURN_IF_ERROR(check_number(i, value, limit, unit));
  for (const auto& [value, limit] : {std::pair{r.direct_normal_w_m2, kDirectLimit},
                                     {r.diffuse_horizontal_w_m2, kDiffuseLimit},
                                     {r.sky_w_m2, kSkyLimit}})
    RETURN_IF_ERROR(value ? check_number(i, *value, limit, " W/m2") : absl::OkStatus());
  if (r.dew_point_k > r.air_k)
    return wrong(i, absl::StrCat("the dew point, ", r.dew_point_k, " K, is above the air's ",
                                 r.air_k, " K"));
  if (r.direct_normal_w_m2.has_value() != r.diffuse_horizontal_w_m2.has_value())
    return wrong(i, "direct and diffuse radiation are not stated together");
  return absl::OkStatus();
}

absl::Status check_close(const WeatherCourse& course) {
  WeatherRecord first = course.record.front();
  const WeatherRecord& last = course.record.back();
  const double day_s = last.unix_s - first.unix_s;
  if (std::abs(day_s - kCourseDayS) > 1e-3)
    return absl::InvalidArgumentError(
        absl::StrCat("a periodic course of ", day_s, " s, expected a day"));
  const auto values = [](const WeatherRecord& r) {
    return std::tuple(r.air_k, r.dew_point_k, r.pressure_pa, r.wind_m_s, r.wind_from_deg,
                      r.cloud_cover, r.direct_normal_w_m2, r.diffuse_horizontal_w_m2, r.sky_w_m2);
  };
  if (values(first) != values(last))
    return absl::InvalidArgumentError(
        "a periodic course whose last record is not the first, a day later");
  return absl::OkStatus();
}

// Returns the index of the first record at or after `at` (side before) or after it, within the
// course.
std::size_t index_after(const WeatherCourse& course, double at, CourseRadiation::Side side) {
  const auto& records = course.record;
  const auto earlier = [](const WeatherRecord& r, double t) { return r.unix_s < t; };
  const auto later = [](double t, const WeatherRecord& r) { return t < r.unix_s; };
  const auto found = side == CourseRadiation::Side::kBefore
                         ? std::lower_bound(records.begin(), records.end(), at, earlier)
                         : std::upper_bound(records.begin(), records.end(), at, later);
  return std::min(static_cast<std::size_t>(found - records.begin()), records.size() - 1);
}

// The records around an instant of the course, and where between them it is.
struct Between {
  const WeatherRecord &a, &b;
  double fraction;

  [[nodiscard]] double of(double WeatherRecord::*field) const {
    return (1 - fraction) * a.*field + fraction * b.*field;
  }
  [[nodiscard]] std::optional<double> of(std::optional<double> WeatherRecord::*field) const {
    if (!(a.*field) || !(b.*field)) return std::nullopt;
    return (1 - fraction) * *(a.*field) + fraction * *(b.*field);
  }
};
Between between(const WeatherCourse& course, double at) {
  const std::size_t upper =
      std::max<std::size_t>(1, index_after(course, at, CourseRadiation::Side::kBefore));
  const WeatherRecord &a = course.record[upper - 1], &b = course.record[upper];
  return {a, b, std::clamp((at - a.unix_s) / (b.unix_s - a.unix_s), 0.0, 1.0)};
}

double direction_deg(const Between& at) {
  double east = 0, north = 0;
  for (const auto& [r, weight] : {std::pair{at.a, 1 - at.fraction}, {at.b, at.fraction}}) {
    east += weight * r.wind_m_s * std::sin(r.wind_from_deg * kRadPerDeg);
    north += weight * r.wind_m_s * std::cos(r.wind_from_deg * kRadPerDeg);
  }
  // Opposite winds cancel, and a calm has none.
  if (std::hypot(east, north) <= 1e-9 * at.of(&WeatherRecord::wind_m_s))
    return at.fraction < 0.5 ? at.a.wind_from_deg : at.b.wind_from_deg;
  const double deg = std::atan2(east, north) / kRadPerDeg;
  return deg < 0 ? deg + 360 : deg;
}

double humidity_percent(const WeatherRecord& now) {
  return 100 * vapour_pressure_pa(now.dew_point_k) / vapour_pressure_pa(now.air_k);
}

// Fraction of an interval: if less of it is in twilight, the diffuse part of its mean is spread
// evenly.
constexpr double kLeastShare = 0.1;

}  // namespace

absl::Status check_course(const WeatherCourse& course) {
  const auto& records = course.record;
  if (records.size() < 2)
    return absl::InvalidArgumentError(
        absl::StrCat("a course of ", records.size(), " records, expected at least two"));
  if (!(course.radiation_interval_s >= 0 && course.radiation_interval_s <= 3 * 3600))
    return absl::InvalidArgumentError(absl::StrCat(
        "radiation is the mean over ", course.radiation_interval_s, " s, expected 0 to 10800 s"));
  for (std::size_t i = 0; i < records.size(); ++i) {
    RETURN_IF_ERROR(check_record(records[i], i));
    if (records[i].direct_normal_w_m2.has_value() != records[0].direct_normal_w_m2.has_value() ||
        records[i].sky_w_m2.has_value() != records[0].sky_w_m2.has_value())
      return wrong(i, "states other kinds of radiation than the first one");
    if (i == 0) continue;
    const double step_s = records[i].unix_s - records[i - 1].unix_s;
    if (!(step_s > 0)) return wrong(i, "is not later than the one before it");
    const bool means =
        course.radiation_interval_s > 0 && (records[i].direct_normal_w_m2 || records[i].sky_w_m2);
    if (means && std::abs(step_s - course.radiation_interval_s) > 1e-3)
      return wrong(i, absl::StrCat("is ", step_s,
                                   " s after the one before it, but its radiation "
                                   "is the mean over ",
                                   course.radiation_interval_s, " s"));
  }
  return course.periodic ? check_close(course) : absl::OkStatus();
}

double within_course(const WeatherCourse& course, double unix_s) {
  if (!course.periodic) return unix_s;
  const double first = course.record.front().unix_s, last = course.record.back().unix_s;
  if (unix_s >= first && unix_s <= last) return unix_s;
  const double since = std::fmod(unix_s - first, last - first);
  return first + (since < 0 ? since + (last - first) : since);
}

WeatherRecord weather_at(const WeatherCourse& course, double unix_s) {
  const Between at = between(course, within_course(course, unix_s));
  WeatherRecord out;
  out.unix_s = unix_s;
  out.air_k = at.of(&WeatherRecord::air_k);
  out.dew_point_k = std::min(out.air_k, at.of(&WeatherRecord::dew_point_k));
  out.pressure_pa = at.of(&WeatherRecord::pressure_pa);
  out.wind_m_s = at.of(&WeatherRecord::wind_m_s);
  out.wind_from_deg = direction_deg(at);
  out.cloud_cover = at.of(&WeatherRecord::cloud_cover);
  return out;
}

absl::StatusOr<CourseRadiation> CourseRadiation::make(WeatherCourse course,
                                                      const WeatherPlace& place,
                                                      const SkyAerosol& sky) {
  RETURN_IF_ERROR(check_course(course));
  for (const double t :
       {course.record.front().unix_s - course.radiation_interval_s, course.record.back().unix_s})
    if (const auto sun =
            sun_position(utc_time(t), place.latitude_deg, place.longitude_deg, place.height_m);
        !sun.ok())
      return sun.status();
  const auto asks_for_cloud = [](const WeatherRecord& r) {
    return r.cloud_cover > 0 && (!r.sky_w_m2 || !r.direct_normal_w_m2);
  };
  if (!sky.cloud && std::any_of(course.record.begin(), course.record.end(), asks_for_cloud))
    return absl::InvalidArgumentError("a course has a cloud cover, but no layer of cloud is known");
  CourseRadiation out;
  out.place_ = place;
  out.sky_ = sky;
  const SunSine sine(place);
  for (std::size_t i = 1; i < course.record.size(); ++i)
    for (const double t : sine.crossings(course.record[i - 1].unix_s, course.record[i].unix_s, 0))
      out.crossing_.push_back(t);
  const double length_s = course.radiation_interval_s;
  if (length_s > 0 && course.record[0].direct_normal_w_m2) {
    for (const WeatherRecord& r : course.record) {
      const double begin = r.unix_s - length_s;
      const double energy = *r.direct_normal_w_m2 * length_s;
      const double up_s = energy > 0 ? sine.above(begin, r.unix_s, 0).length_s : 0;
      const double in_space = extraterrestrial_w_m2(std::fmod(r.unix_s / kCourseDayS, 365.2425) +
                                                    1);  // 0.5 %: a limit of what can be
      Spread& s = out.spread_.emplace_back();
      s.direct = up_s > 0 ? std::min(energy / up_s, in_space) : 0;
      // The first record of a periodic course is its last one.
      if (!course.periodic || out.spread_.size() > 1)
        out.unplaced_j_m2_ += energy > s.direct * up_s * (1 + 1e-12) ? energy - s.direct * up_s : 0;
      const SunSine::Above light = *r.diffuse_horizontal_w_m2 > 0
                                       ? sine.above(begin, r.unix_s, -kTwilight)
                                       : SunSine::Above{};
      s.diffuse_constant = light.length_s < kLeastShare * length_s;
      s.diffuse =
          *r.diffuse_horizontal_w_m2 * (s.diffuse_constant ? 1 : length_s / light.integral_s);
    }
  }
  out.course_ = std::move(course);
  return out;
}

SunPosition CourseRadiation::sun_at(double unix_s) const {
  const auto sun = sun_position(utc_time(within_course(course_, unix_s)), place_.latitude_deg,
                                place_.longitude_deg, place_.height_m);
  return sun.ok() ? *sun : SunPosition{};  // make() has asked for the first and the last
}

double base_height_m(const CloudAbove& cloud, const WeatherRecord& now) {
  return cloud.base_m ? *cloud.base_m : condensed_base_m(now.air_k, humidity_percent(now));
}

double base_temperature_k(const CloudAbove& cloud, const WeatherRecord& now) {
  constexpr double kBentM = 2000;  // core/atmosphere/air_profile.h, bend_to_surface
  const double base_m = base_height_m(cloud, now);
  if (!cloud.base_m || cloud.base_of_risen_air)
    return risen_air_k(now.air_k, humidity_percent(now), now.pressure_pa, base_m);
  const double there_k = interpolate(
      cloud.air_k, locate(cloud.height_m, std::clamp(base_m, 0.0, cloud.height_m.back())));
  return there_k + (now.air_k - cloud.air_k.front()) * std::max(0.0, 1 - base_m / kBentM);
}

namespace {

struct CloudedSun {
  double global, beam;  // fractions that pass
};
CloudedSun through_cloud(double depth, double sine) {
  constexpr double kAsymmetry = 0.85;
  return {1 / (1 + 0.75 * (1 - kAsymmetry) * depth), std::exp(-depth / std::max(sine, 1e-3))};
}

}  // namespace

Radiation CourseRadiation::at(double unix_s, Side side) const {
  double t = within_course(course_, unix_s);
  // The next day begins where a day ends.
  const double first = course_.record.front().unix_s, last = course_.record.back().unix_s;
  if (course_.periodic && t == last && side == Side::kAfter) t = first;
  const SunPosition sun = sun_at(t);
  const double sine = std::cos(sun.zenith_deg * kRadPerDeg);
  const bool up = sine > 0;
  const std::size_t i = index_after(course_, t, side);
  const WeatherRecord& interval = course_.record[i];
  const Between at = between(course_, t);
  const WeatherRecord now = weather_at(course_, t);

  Radiation out{};
  if (!spread_.empty()) {
    const Spread& s = spread_[i];
    out.direct_normal_w_m2 = up ? s.direct : 0;
    out.diffuse_horizontal_w_m2 =
        s.diffuse_constant ? s.diffuse : s.diffuse * std::max(0.0, sine + kTwilight);
  } else if (interval.direct_normal_w_m2) {
    out.direct_normal_w_m2 = up ? *at.of(&WeatherRecord::direct_normal_w_m2) : 0;
    out.diffuse_horizontal_w_m2 = *at.of(&WeatherRecord::diffuse_horizontal_w_m2);
  } else if (up) {
    const ClearSkyIrradiance clear = clear_sky_irradiance(
        {.sun_zenith_deg = sun.zenith_deg,
         .extraterrestrial_w_m2 = kSolarConstantWM2 / (sun.distance_au * sun.distance_au),
         .pressure_pa = now.pressure_pa,
         .ozone_cm = sky_.ozone_cm,
         .precipitable_water_cm =
             precipitable_water_cm(now.air_k, vapour_pressure_pa(now.dew_point_k)),
         .aerosol_depth_380 = sky_.depth_380,
         .aerosol_depth_500 = sky_.depth_500,
         .ground_albedo = sky_.albedo});
    const double n = now.cloud_cover, direct = clear.direct_normal_w_m2 * sine;
    if (n > 0 && sky_.cloud && sky_.cloud->solar_depth) {
      const CloudedSun under = through_cloud(*sky_.cloud->solar_depth, sine);
      const double global = (direct + clear.diffuse_horizontal_w_m2) * (1 - n + n * under.global);
      out.direct_normal_w_m2 = clear.direct_normal_w_m2 * (1 - n + n * under.beam);
      out.diffuse_horizontal_w_m2 = std::max(0.0, global - out.direct_normal_w_m2 * sine);
    } else {
      const double passed = 1 - 0.75 * std::pow(n, 3.4);
      const double global = (direct + clear.diffuse_horizontal_w_m2) * passed;
      out.direct_normal_w_m2 = clear.direct_normal_w_m2 * passed * (1 - n * n);
      out.diffuse_horizontal_w_m2 = global - direct * passed * (1 - n * n);
    }
    out.low_sun = clear.low_sun;
  }
  if (interval.sky_w_m2) {
    out.sky_w_m2 =
        course_.radiation_interval_s > 0 ? *interval.sky_w_m2 : *at.of(&WeatherRecord::sky_w_m2);
  } else {
    const double emissivity =
        std::min(1.0, sky_emissivity_prata(now.air_k, vapour_pressure_pa(now.dew_point_k)));
    out.sky_w_m2 = emissivity * kStefanBoltzmannWM2K4 * std::pow(now.air_k, 4);
    double passed = 1 - emissivity;
    if (sky_.fog_emissivity > 0) {
      out.sky_w_m2 += passed * sky_.fog_emissivity * kStefanBoltzmannWM2K4 *
                      std::pow(now.air_k - sky_.fog_colder_k, 4);
      passed *= 1 - sky_.fog_emissivity;
    }
    if (now.cloud_cover > 0 && sky_.cloud) {
      out.sky_w_m2 += now.cloud_cover * passed * sky_.cloud->emissivity * kStefanBoltzmannWM2K4 *
                      std::pow(base_temperature_k(*sky_.cloud, now), 4);
    }
  }
  return out;
}

double solar_midnight_unix_s(int year, int month, int day, double longitude_deg) {
  const double midnight = unix_seconds({year, month, day, 0, 0, 0});
  const double since_new_year = (midnight - unix_seconds({year, 1, 1, 0, 0, 0})) / kCourseDayS;
  const double g = 2 * std::numbers::pi * since_new_year / 365;
  const double equation_of_time_s = 229.18 * 60 *
                                    (0.000075 + 0.001868 * std::cos(g) - 0.032077 * std::sin(g) -
                                     0.014615 * std::cos(2 * g) - 0.040849 * std::sin(2 * g));
  return midnight - longitude_deg * 240 - equation_of_time_s;
}

absl::StatusOr<WeatherCourse> day_course(const StatedDay& day, double midnight_unix_s) {
  if (!(day.air_max_k >= day.air_min_k))
    return absl::InvalidArgumentError(absl::StrCat(
        "the air's maximum, ", day.air_max_k, " K, is below its minimum, ", day.air_min_k, " K"));
  if (!(day.warmest_hour >= 0 && day.warmest_hour <= 24))
    return absl::InvalidArgumentError(
        absl::StrCat("the warmest hour is ", day.warmest_hour, ", expected 0 to 24"));
  if (day.dew_point_k > day.air_min_k)
    return absl::InvalidArgumentError(absl::StrCat("the dew point, ", day.dew_point_k,
                                                   " K, is above the air's minimum, ",
                                                   day.air_min_k, " K: water would leave the air"));
  WeatherCourse course;
  course.periodic = true;
  constexpr int kRecords = 72;
  for (int i = 0; i <= kRecords; ++i) {
    WeatherRecord& r = course.record.emplace_back();
    const double hour = 24.0 * (i % kRecords) / kRecords;
    const double wave = std::cos(2 * std::numbers::pi * (hour - day.warmest_hour) / 24);
    r.unix_s = midnight_unix_s + kCourseDayS * i / kRecords;
    r.air_k =
        std::clamp((day.air_max_k + day.air_min_k) / 2 + (day.air_max_k - day.air_min_k) / 2 * wave,
                   day.air_min_k, day.air_max_k);
    r.dew_point_k = day.dew_point_k;
    r.pressure_pa = day.pressure_pa;
    r.wind_m_s = day.wind_m_s;
    r.wind_from_deg = day.wind_from_deg;
    r.cloud_cover = day.cloud_cover;
  }
  RETURN_IF_ERROR(check_course(course));
  return course;
}

}  // namespace irsig
