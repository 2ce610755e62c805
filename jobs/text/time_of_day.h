#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace irsig {

// The time of day in full, "10:30:00+09:00", from "10:30+09:00". If the text is not a time of day
// or has no offset: an empty string and the error.
struct TimeOfDay {
  std::string text, wrong;
};
[[nodiscard]] TimeOfDay time_of_day(const std::string& text);

// A full time of day on no date.
struct DayTime {
  double local_s, utc_s;  // since midnight: [0, 86400)
  double offset_s;        // of local time from UTC
};
// Parses a time of day. INVALID_ARGUMENT: no day has this time ("25:00:00Z").
[[nodiscard]] absl::StatusOr<DayTime> day_time(const std::string& text);

}  // namespace irsig
