#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// Allowed cost of a case: that of the default run (all cases together take less than 90 s on two
// cores), or the counts that docs/evidence/validation.md quotes (1e8 rays, 1e9 terms).
enum class Effort { kShort, kFull };

// Largest error of a case. An error is never negative; NaN exceeds every bound. A case without a
// single check has proved nothing, and fails.
struct Finding {
  double worst_error = 0;
  double bound = 0;
  std::uint64_t checks = 0;
  std::string where;  // arguments of the worst error, or the counted items

  [[nodiscard]] bool holds() const { return checks > 0 && worst_error <= bound; }
};

// One hard case: the compared quantities, and the reason for the bound. `run` uses the public
// interface of core alone; an error status means that the case could not be made, which counts as
// failed.
struct HardCase {
  std::string group;
  std::string name;
  std::string what;    // the error's definition, its unit in []
  std::string reason;  // the bound's
  absl::StatusOr<Finding> (*run)(Effort effort);

  [[nodiscard]] std::string id() const { return group + "/" + name; }
};

// Returns all hard cases, by group, in a fixed order.
[[nodiscard]] std::vector<HardCase> hard_cases();

}  // namespace irsig
