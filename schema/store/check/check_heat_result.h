#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "schema/job.pb.h"
#include "schema/result.pb.h"

namespace irsig {

// INVALID_ARGUMENT, naming the field, unless the result is that of a heat job: the field's times
// are those asked for, its arrays have a number for each time and facet, temperatures are positive
// and have an error, or are absent (not a number) together with it; each part that states no
// temperature comes once at each time, its coldest, mean and hottest in this order; its seed is
// that of its sweep.
[[nodiscard]] absl::Status check_heat_result(const schema::JobResult& result,
                                             const std::string& job_key, const schema::HeatRun& run,
                                             std::uint64_t seed);

}  // namespace irsig
