#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/thermal/day_schedule.h"
#include "core/thermal/scene/scene_heat_request.h"
#include "core/thermal/weather_course.h"

namespace irsig {

struct HeatKnotsRequest {
  WeatherCourse course;
  GroundBoundary beneath;
  SkyAerosol sky;
  WeatherPlace place;
  double heading_deg = 0, speed_m_s = 0;  // of the target, whose own motion adds to the wind
  std::vector<double> time_unix_s;        // wanted
  std::vector<DaySchedule> inside;        // of walls
  double step_s = 0;
};

// The weather of one computation of temperatures at its knots.
struct HeatKnots {
  std::vector<double> knot_s;  // an odd count: SceneHeatRequest
  std::vector<HeatWeather> at;
  std::size_t day_knots = 0;
  std::vector<std::size_t> output_of_time;  // [time_unix_s] index into output_knot
  std::vector<std::size_t> output_knot;     // increasing
  GroundBoundary beneath;
  std::vector<std::string> warning;
};

// Chooses the knots: the times wanted, changes inside walls, sunrise and sunset, jumps (means over
// hours) and bends (instants under broken cloud) of the records, the end of the first day; between
// them at most step_s. A time within a minute of a wanted one counts as that one.
// INVALID_ARGUMENT: as CourseRadiation::make; the course is shorter than a day before the first
// time.
[[nodiscard]] absl::StatusOr<HeatKnots> heat_knots(const HeatKnotsRequest& request);

}  // namespace irsig
