#pragma once

#include <cstdint>
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

// What became of a file whose header asks for a journal.
struct AcceptedFile {
  std::vector<StoreFinding> findings;
  bool damaged = false;                // it stays as it is
  bool made_plain = false;             // false, and not damaged: it was one plain file already
  std::uint64_t sweeps = 0, rows = 0;  // that it holds
};

// The same examination, also of a file whose journal is missing (schema/store/whole_file.h); if
// nothing is damaged, it becomes one plain file: what it holds now is the database. A journal that
// is there is folded in. FAILED_PRECONDITION: somebody writes it. INVALID_ARGUMENT: it has several
// hard links.
[[nodiscard]] absl::StatusOr<AcceptedFile> accept_file(const std::string& path,
                                                       int physics_version);

}  // namespace irsig
