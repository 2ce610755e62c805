#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "planning/accuracy_source.h"

namespace irsig {

struct ErrorCheckAsked {
  std::uint64_t views = 0;    // 0: all that have rows
  double times = 100;         // as many samples as the rows' own runs
  std::uint32_t workers = 0;  // threads; 0: one for each core
};

// Traces the views of a database again, much longer and with other random numbers, and prints how
// far stored values are from that, in stored standard errors and numerical errors. within: no value
// is beyond 5 numerical errors. INVALID_ARGUMENT: no rows. FAILED_PRECONDITION: of another version.
[[nodiscard]] absl::Status check_database_errors(AccuracySource& source,
                                                 const ErrorCheckAsked& asked, bool& within);

}  // namespace irsig
