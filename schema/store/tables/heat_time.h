#pragma once

#include <optional>
#include <string>

#include "schema/job.pb.h"

namespace irsig {

// Returns the Unix time [s] of an RFC 3339 time. nullopt: the text is not an RFC 3339 time.
[[nodiscard]] std::optional<double> unix_s_of(const std::string& time_utc);

// Returns the index of this time among the run's times, however it is written; nullopt: none.
[[nodiscard]] std::optional<int> time_index_of(const schema::HeatRun& run,
                                               const std::string& time_utc);

}  // namespace irsig
