#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {

// Checks that a result is the result of a heat job. Its times are the requested times, and its
// arrays have a number for each time and facet. Temperatures are positive and have an error; a
// missing temperature is NaN, and so is its error. Each part without a stated temperature occurs
// once at each time, with its coldest, mean and hottest temperature in this order. The seed is the
// seed of the sweep. INVALID_ARGUMENT otherwise; the message names the field.
[[nodiscard]] absl::Status check_heat_result(const schema::JobResult& result,
                                             const std::string& job_key, const schema::HeatRun& run,
                                             std::uint64_t seed);

}  // namespace irsig
