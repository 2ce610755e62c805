#include "core/thermal/day_schedule.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

constexpr double kScheduleDayS = 86400;

double midnight_before(double unix_s) { return std::floor(unix_s / kScheduleDayS) * kScheduleDayS; }

}  // namespace

absl::Status check_schedule(const DaySchedule& schedule) {
  const auto wrong = [](const char* what) { return absl::InvalidArgumentError(what); };
  if (schedule.at.empty()) return wrong("a schedule of the day without times");
  double before_s = -1;
  for (const DaySchedule::At& at : schedule.at) {
    if (!(at.utc_s >= 0 && at.utc_s < kScheduleDayS))
      return wrong("a schedule's time outside the day");
    if (!(at.utc_s > before_s)) return wrong("a schedule's times do not increase");
    if (!std::isfinite(at.value)) return wrong("a schedule's value is no number");
    before_s = at.utc_s;
  }
  return absl::OkStatus();
}

double value_at(const DaySchedule& schedule, double unix_s) {
  const auto& at = schedule.at;
  const double s = unix_s - midnight_before(unix_s);
  const auto after = std::find_if(at.begin(), at.end(), [&](const auto& a) { return a.utc_s > s; });
  const DaySchedule::At& last = after == at.begin() ? at.back() : *(after - 1);
  if (schedule.steps) return last.value;
  const DaySchedule::At& next = after == at.end() ? at.front() : *after;
  const double since_s = s - last.utc_s + (after == at.begin() ? kScheduleDayS : 0),
               between_s = next.utc_s - last.utc_s +
                           (after == at.begin() || after == at.end() ? kScheduleDayS : 0);
  return last.value + since_s / between_s * (next.value - last.value);
}

std::vector<double> times_between(const DaySchedule& schedule, double begin_unix_s,
                                  double end_unix_s) {
  std::vector<double> out;
  for (double midnight = midnight_before(begin_unix_s); midnight < end_unix_s;
       midnight += kScheduleDayS)
    for (const DaySchedule::At& at : schedule.at)
      if (const double t = midnight + at.utc_s; t > begin_unix_s && t < end_unix_s)
        out.push_back(t);
  return out;
}

std::vector<ScheduleAtKnot> at_knots(const DaySchedule& schedule,
                                     std::span<const double> knot_unix_s) {
  std::vector<ScheduleAtKnot> out;
  for (const double t : knot_unix_s) {
    const double value = value_at(schedule, t);
    out.push_back({value, value});
  }
  if (!schedule.steps) return out;
  for (std::size_t k = 0; k + 1 < out.size(); ++k)
    out[k].after = out[k + 1].before =
        value_at(schedule, 0.5 * (knot_unix_s[k] + knot_unix_s[k + 1]));
  if (out.size() > 1) {
    out.front().before = out.front().after;
    out.back().after = out.back().before;
  }
  return out;
}

}  // namespace irsig
