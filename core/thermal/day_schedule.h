#pragma once

#include <span>
#include <vector>

#include "absl/status/status.h"

namespace irsig {

// A quantity that repeats every day: a room's temperature, a machine's heat.
struct DaySchedule {
  struct At {
    double utc_s;  // since midnight UTC: [0, 86400)
    double value;
  };
  std::vector<At> at;  // increasing times, one or more
  // Each value holds until the next time; else linear between two times. The last goes on to the
  // first of the next day.
  bool steps = false;
};

// Checks a schedule. INVALID_ARGUMENT: no times, times outside the day or that do not increase,
// values that are not numbers.
[[nodiscard]] absl::Status check_schedule(const DaySchedule& schedule);

// Returns the value at an instant (seconds since 1970 UTC, without leap seconds); at a step's own
// time the new value. The schedule has passed check_schedule().
[[nodiscard]] double value_at(const DaySchedule& schedule, double unix_s);

// Returns the schedule's times between two instants, both excluded, increasing: where it jumps or
// bends.
[[nodiscard]] std::vector<double> times_between(const DaySchedule& schedule, double begin_unix_s,
                                                double end_unix_s);

// Values at knots: of the interval that ends there, and of the one that begins. Linear in the
// intervals. A step at a time that is no knot moves to the nearest knot; a value that begins before
// the first knot or ends after the last is the neighbour's. [knot]
struct ScheduleAtKnot {
  double before, after;
};
[[nodiscard]] std::vector<ScheduleAtKnot> at_knots(const DaySchedule& schedule,
                                                   std::span<const double> knot_unix_s);

}  // namespace irsig
