#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geo/sun.h"
#include "core/thermal/weather_course.h"
#include "jobs/text/section_check.h"

namespace irsig {

// Seasons that say the same but for name and time: the hours of a table's day. They share the
// weather as it goes on, and the temperatures that are computed from it.
struct SeasonGroup {
  std::vector<int> season;
  std::vector<double> unix_s;  // of all their conditions, increasing
  std::optional<WeatherCourse> course;
  std::vector<Problem> warning;  // of the weather file
};

// instants: [season][time]. Courses of seasons with a weather file or a day, and with [heat] of
// all; what is wrong with a weather file is reported at its own lines. With [heat] and a history of
// days a course begins so long before the first condition.
[[nodiscard]] std::vector<SeasonGroup> season_groups(
    const SweepFile& file, const std::vector<std::vector<UtcTime>>& instants, Findings& findings);

// A season with the surface weather of an instant of its course in the place of what it does not
// say; what it says and the course contradicts is reported.
[[nodiscard]] schema::Season with_weather_of(const WeatherCourse& course, double unix_s,
                                             const schema::Season& season, int season_index,
                                             Findings& findings);

}  // namespace irsig
