#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/reader.h"
#include "view/query/query.h"
#include "view/report/days.h"

namespace irsig {

struct HourlyValue {
  HourOfDay at;
  QueryRow row;
};
struct HourlyTemperature {
  HourOfDay at;
  StoredTemperature part;
};

// Conditions behind a wall by a build-up's schedule.
struct HourlyInside {
  HourOfDay at;
  std::string season, build_up;
  double unix_s;
  double value;    // K, or W/m2 into the wall
  bool heat_flux;  // which of them
};

// Stored and computed values of one viewpoint of a sweep through the hours of its days.
struct Hours {
  std::string sweep;
  SignatureQuantity quantity;
  // Local mean solar time minus UTC: longitude / 15 deg; nullopt: the sweep has no place, hours are
  // of UTC.
  std::optional<double> solar_offset_h;
  std::vector<HourlyValue> value;              // by day, band and hour
  std::vector<HourlyTemperature> temperature;  // computed ones, by day, part and hour
  // Conditions behind the walls of these parts, from a day's first of these hours to its last, by
  // day, build-up and hour: at both ends and where the schedule bends; where it jumps, twice.
  std::vector<HourlyInside> inside = {};
};

// Returns the values of a query by hour. Errors are those of run_query. NOT_FOUND: nothing matches.
// INVALID_ARGUMENT: several viewpoints or sweeps match, or no day has two times.
// FAILED_PRECONDITION: query.quantity was not stored.
[[nodiscard]] absl::StatusOr<Hours> hours_of(StoreReader& reader, const Query& query);

// Plots hours as a complete SVG document. There is a panel for each day's temperatures, if any: the
// mean of a part's facets, from the coldest to the hottest, and scheduled temperatures behind
// walls. Further panels show the day's scheduled heat into walls, and each band's values (+-2
// numerical errors), one curve per day.
[[nodiscard]] std::string plot_hours(const Hours& hours);

// Writes the numbers of plot_hours(), one line each, in a format of table.h.
[[nodiscard]] absl::Status write_hours(const Hours& hours, std::string_view format,
                                       std::ostream& out);

}  // namespace irsig
