#include "schema/store/tables/heat_time.h"

#include <cmath>

#include "absl/time/time.h"

namespace irsig {

std::optional<double> unix_s_of(const std::string& time_utc) {
  absl::Time time;
  std::string error;
  if (!absl::ParseTime(absl::RFC3339_full, time_utc, &time, &error)) return std::nullopt;
  return absl::ToDoubleSeconds(time - absl::UnixEpoch());
}

std::optional<int> time_index_of(const schema::HeatRun& run, const std::string& time_utc) {
  for (int i = 0; i < run.time_utc_size(); ++i)
    if (run.time_utc(i) == time_utc) return i;
  // A fraction of a second that went through a double of seconds since 1970.
  constexpr double kSame_s = 1e-6;
  const std::optional<double> wanted = unix_s_of(time_utc);
  for (int i = 0; wanted && i < run.time_utc_size(); ++i)
    if (const auto time = unix_s_of(run.time_utc(i)); time && std::abs(*time - *wanted) <= kSame_s)
      return i;
  return std::nullopt;
}

}  // namespace irsig
