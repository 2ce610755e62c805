#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geo/sun.h"
#include "core/thermal/weather_course.h"
#include "jobs/text/section_check.h"

namespace irsig {

// Seasons that differ only in name and time: the hours of a table's day. They share one course of
// weather, and the temperatures computed from it.
struct SeasonGroup {
  std::vector<int> season;
  std::vector<double> unix_s;  // of all their conditions, increasing
  std::optional<WeatherCourse> course;
  std::vector<Problem> warning;  // of the weather file
};

// Groups seasons. instants: [season][time]. Seasons with a weather file or a day have courses; with
// [heat] all seasons have. Errors in a weather file are reported at its own lines. With [heat] and
// a history of days, a course begins that many days before the first condition.
[[nodiscard]] std::vector<SeasonGroup> season_groups(
    const SweepFile& file, const std::vector<std::vector<UtcTime>>& instants, Findings& findings);

// Returns a season whose missing surface weather is taken from the course at an instant. Statements
// of the season that contradict the course are reported.
[[nodiscard]] schema::Season with_weather_of(const WeatherCourse& course, double unix_s,
                                             const schema::Season& season, int season_index,
                                             Findings& findings);

}  // namespace irsig
