#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// What is wrong with a database, or old.
struct StoreFinding {
  enum class Kind {
    kDamaged,  // not what was written
    kMissing,  // not computed (yet)
    kOld,      // of an earlier version of irsig or of the sweep
  } kind;
  std::string what;
};

// Reads all of it: SQLite's own checks, references between tables, assets by their hashes, numbers
// that are none, sums, spectra, images; then what is missing and what is old. Of damage of one kind
// the first few are named. Nothing found: empty.
//   physics_version  of this program
// Errors: those of opening it.
[[nodiscard]] absl::StatusOr<std::vector<StoreFinding>> examine(const std::string& path,
                                                                int physics_version);

}  // namespace irsig
