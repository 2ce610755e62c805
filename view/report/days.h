#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "schema/sweep.pb.h"
#include "view/query/query.h"

namespace irsig {

// A place on the axis of hours. A season whose times span more than 24 h has several days, each
// named by its date.
struct HourOfDay {
  std::string day;  // "winter", "winter 2025-01-29"
  double hour;  // since the midnight of the season's middle time; below 0 or above 24: beyond it
};

// Returns local mean solar time minus UTC: longitude / 15 deg; nullopt: the sweep has no place,
// hours are of UTC.
[[nodiscard]] std::optional<double> solar_offset_h(const schema::Sweep& sweep);

// Sorts the times of each season into days. All times are added before the first is placed.
class Days {
 public:
  // Creates days without times. offset_h: displayed time minus UTC [h].
  explicit Days(double offset_h);

  // Adds a time of a season. INVALID_ARGUMENT: time_utc is not an RFC 3339 time.
  absl::Status add(const std::string& season, const std::string& time_utc);

  // Returns the day and hour of a time. The season and time must have been added.
  [[nodiscard]] HourOfDay place(const std::string& season, const std::string& time_utc) const;
  [[nodiscard]] HourOfDay place(const std::string& season, double unix_s) const;

 private:
  double offset_s_;
  std::map<std::string, std::set<double>> times_;
};

// Returns INVALID_ARGUMENT if rows are of several viewpoints or sweeps.
//   remedy  the options that choose a viewpoint, for the message
[[nodiscard]] absl::Status check_one_viewpoint(const std::vector<QueryRow>& rows,
                                               std::string_view remedy);

// Returns INVALID_ARGUMENT if no day has two hours.
[[nodiscard]] absl::Status check_two_times(const std::vector<HourOfDay>& hours);

}  // namespace irsig
