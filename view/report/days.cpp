#include "view/report/days.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <utility>

#include "core/base/status_macros.h"
#include "core/geo/sun.h"

namespace irsig {
namespace {

constexpr double kHour_s = 3600, kDay_s = 24 * kHour_s;

absl::StatusOr<double> unix_s_of(const std::string& time_utc) {
  ASSIGN_OR_RETURN(const auto time, parse_rfc3339(time_utc));
  return unix_seconds(time);
}

}  // namespace

std::optional<double> solar_offset_h(const schema::Sweep& sweep) {
  if (!sweep.place().has_latitude_deg()) return std::nullopt;
  return sweep.place().longitude_deg() / 15;
}

Days::Days(double offset_h) : offset_s_(offset_h * kHour_s) {}

absl::Status Days::add(const std::string& season, const std::string& time_utc) {
  ASSIGN_OR_RETURN(const auto time, unix_s_of(time_utc));
  times_[season].insert(time + offset_s_);
  return absl::OkStatus();
}

HourOfDay Days::place(const std::string& season, const std::string& time_utc) const {
  return place(season, *unix_s_of(time_utc));
}

HourOfDay Days::place(const std::string& season, double unix_s) const {
  const double time = unix_s + offset_s_;
  const std::set<double>& times = times_.at(season);
  const double first = *times.begin(), last = *times.rbegin();
  const bool one_day = last - first <= kDay_s;
  const double midnight_s = std::floor((one_day ? (first + last) / 2 : time) / kDay_s) * kDay_s;
  std::string day = season;
  if (!one_day) day += ' ' + format_rfc3339_utc(utc_time(midnight_s)).substr(0, 10);
  return {std::move(day), (time - midnight_s) / kHour_s};
}

absl::Status check_one_viewpoint(const std::vector<QueryRow>& rows, std::string_view remedy) {
  for (const QueryRow& r : rows) {
    const StoredSignature &a = rows.front().signature, &b = r.signature;
    if (a.sweep != b.sweep || a.aspect_azimuth_deg != b.aspect_azimuth_deg ||
        a.aspect_elevation_deg != b.aspect_elevation_deg || a.range_m != b.range_m)
      return absl::InvalidArgumentError(
          fmt::format("a plot over the hours shows one viewpoint of one sweep: choose it with {}, "
                      "the range with --at-range-m and the sweep with --sweep",
                      remedy));
  }
  return absl::OkStatus();
}

absl::Status check_two_times(const std::vector<HourOfDay>& hours) {
  std::map<std::string, std::set<double>> times;
  for (const HourOfDay& at : hours) times[at.day].insert(at.hour);
  std::vector<std::string> found;
  for (const auto& [day, of_day] : times) {
    if (of_day.size() > 1) return absl::OkStatus();
    found.push_back(day);
  }
  return absl::InvalidArgumentError(
      fmt::format("a plot over the hours needs two times or more of a day, and there is one alone "
                  "of each: {}",
                  fmt::join(found, ", ")));
}

}  // namespace irsig
