#include "core/thermal/scene/heat_knots.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/geo/sun.h"

namespace irsig {
namespace {

// Times that must be knots, increasing, each at least a second from the next but for those wanted;
// then so many between that each distance is at most the step, in even numbers.
std::vector<double> knots_between(const std::vector<double>& wanted,
                                  const std::vector<double>& other, double step_s) {
  constexpr double kTogetherS = 1;
  std::set<double> apart(wanted.begin(), wanted.end());
  for (const double t : other)
    if (const auto near = apart.upper_bound(t - kTogetherS);
        near == apart.end() || *near >= t + kTogetherS)
      apart.insert(t);
  const std::vector<double> fixed(apart.begin(), apart.end());
  std::vector<double> out = {fixed.front()};
  for (std::size_t i = 1; i < fixed.size(); ++i) {
    const double gap = fixed[i] - fixed[i - 1];
    const auto pieces = 2 * static_cast<int>(std::ceil(gap / (2 * step_s) - 1e-9));
    for (int k = 1; k < pieces; ++k) out.push_back(fixed[i - 1] + gap * k / pieces);
    out.push_back(fixed[i]);
  }
  return out;
}

// Returns true if straight lines between knots would miss this record of instants.
bool bends_at(const std::vector<WeatherRecord>& record, std::size_t i, double step_s) {
  if (i == 0 || i + 1 >= record.size()) return false;
  constexpr double kBendWM2 = 2, kBendK = 0.2, kBendWindMS = 0.5, kBendCover = 0.02;
  const auto missed = [&](double before, double here, double after) {
    const double rises = (here - before) / (record[i].unix_s - record[i - 1].unix_s),
                 goes_on = (after - here) / (record[i + 1].unix_s - record[i].unix_s);
    return 0.25 * step_s * std::abs(goes_on - rises);
  };
  const auto of = [&](double WeatherRecord::*value) {
    return missed(record[i - 1].*value, record[i].*value, record[i + 1].*value);
  };
  const auto of_stated = [&](std::optional<double> WeatherRecord::*value) {
    if (!(record[i - 1].*value) || !(record[i].*value) || !(record[i + 1].*value)) return 0.0;
    return missed(*(record[i - 1].*value), *(record[i].*value), *(record[i + 1].*value));
  };
  return of_stated(&WeatherRecord::direct_normal_w_m2) > kBendWM2 ||
         of_stated(&WeatherRecord::diffuse_horizontal_w_m2) > kBendWM2 ||
         of_stated(&WeatherRecord::sky_w_m2) > kBendWM2 || of(&WeatherRecord::air_k) > kBendK ||
         of(&WeatherRecord::wind_m_s) > kBendWindMS || of(&WeatherRecord::cloud_cover) > kBendCover;
}

HeatWeather weather_at_knot(const HeatKnotsRequest& request, const CourseRadiation& radiation,
                            double unix_s) {
  const WeatherRecord w = weather_at(request.course, unix_s);
  const SunPosition sun = radiation.sun_at(unix_s);
  const auto side = [&](CourseRadiation::Side which) {
    const Radiation r = radiation.at(unix_s, which);
    return HeatRadiation{r.direct_normal_w_m2, r.diffuse_horizontal_w_m2, r.sky_w_m2};
  };
  // The wind that a moving target feels.
  const double from = w.wind_from_deg * kRadPerDeg, heading = request.heading_deg * kRadPerDeg;
  const Vec<Enu> wind = -w.wind_m_s * Vec<Enu>{std::sin(from), std::cos(from), 0},
                 own = request.speed_m_s * Vec<Enu>{std::sin(heading), std::cos(heading), 0},
                 felt = wind - own;
  const double speed = length(felt);
  return {w.air_k,
          speed,
          speed > 0 ? body_from_enu((-1 / speed) * felt, request.heading_deg) : Vec<Body>{1, 0, 0},
          body_from_enu(sun.direction, request.heading_deg),
          sun.angular_radius_deg * kRadPerDeg,
          side(CourseRadiation::Side::kBefore),
          side(CourseRadiation::Side::kAfter),
          HumidAir{w.dew_point_k, w.pressure_pa}};
}

}  // namespace

absl::StatusOr<HeatKnots> heat_knots(const HeatKnotsRequest& request) {
  const WeatherCourse& course = request.course;
  HeatKnots out;
  out.beneath = request.beneath;
  ASSIGN_OR_RETURN(const auto radiation, CourseRadiation::make(course, request.place, request.sky));

  std::vector<double> wanted;
  for (const double unix_s : request.time_unix_s) wanted.push_back(within_course(course, unix_s));
  std::vector<double> fixed = wanted;
  std::sort(fixed.begin(), fixed.end());
  fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
  constexpr double kDayS = 86400;
  const double begin_s = course.record.front().unix_s,
               end_s = course.periodic ? begin_s + kDayS : fixed.back(),
               day_end_s = begin_s + kDayS;
  if (day_end_s > course.record.back().unix_s + 1)
    return absl::InvalidArgumentError("the weather before the first time is shorter than a day");
  std::vector<double> must = fixed;
  for (const double t : {begin_s, day_end_s, std::max(end_s, day_end_s)})
    if (std::find(must.begin(), must.end(), t) == must.end()) must.push_back(t);
  std::vector<double> other;
  for (const DaySchedule& schedule : request.inside) {
    const auto times = times_between(schedule, begin_s, std::max(end_s, day_end_s));
    other.insert(other.end(), times.begin(), times.end());
  }
  const std::vector<double>& crossings = radiation.sun_crossings();
  other.insert(other.end(), crossings.begin(), crossings.end());
  // Records where the course jumps or bends, and those that are closer together than steps: what
  // happens between knots is not known to the solver, and every second knot must see them too.
  const double step_s = request.step_s;
  const std::vector<WeatherRecord>& record = course.record;
  for (std::size_t i = 0; i < record.size(); ++i) {
    const bool close = (i > 0 && record[i].unix_s - record[i - 1].unix_s < step_s) ||
                       (i + 1 < record.size() && record[i + 1].unix_s - record[i].unix_s < step_s);
    if (course.radiation_interval_s > 0 || close || bends_at(record, i, step_s))
      other.push_back(record[i].unix_s);
  }
  std::erase_if(other, [&](double t) { return t <= begin_s || t >= std::max(end_s, day_end_s); });
  out.knot_s = knots_between(must, other, step_s);
  for (const double t : out.knot_s) out.at.push_back(weather_at_knot(request, radiation, t));
  const auto knot_of = [&](double t) {
    return static_cast<std::size_t>(std::lower_bound(out.knot_s.begin(), out.knot_s.end(), t) -
                                    out.knot_s.begin());
  };
  out.day_knots = knot_of(day_end_s);
  for (const double t : fixed) out.output_knot.push_back(knot_of(t));
  for (const double t : wanted)
    out.output_of_time.push_back(
        static_cast<std::size_t>(std::lower_bound(fixed.begin(), fixed.end(), t) - fixed.begin()));
  if (radiation.unplaced_j_m2() > 0)
    out.warning.push_back(absl::StrCat("weather: ", std::lround(radiation.unplaced_j_m2()),
                                       " J/m2 of direct sunlight while no sun is up"));
  return out;
}

}  // namespace irsig
