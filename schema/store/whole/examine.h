#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// A fault of a database, or a sign of its age.
struct StoreFinding {
  enum class Kind {
    kDamaged,  // differs from the written content
    kMissing,  // not computed (yet)
    kOld,      // of an earlier version of irsig or of the sweep
  } kind;
  std::string what;
};

// Examines a database completely: SQLite's own checks, references between tables, assets by their
// hashes, invalid numbers, sums, spectra and images; then missing and outdated content. Returns the
// first few findings of each kind of damage; empty: none. physics_version: of this program. Errors:
// those of opening the database.
[[nodiscard]] absl::StatusOr<std::vector<StoreFinding>> examine(const std::string& path,
                                                                int physics_version);

// Outcome of accepting a file whose header asks for a journal.
struct AcceptedFile {
  std::vector<StoreFinding> findings;
  bool damaged = false;                // it stays as it is
  bool made_plain = false;             // false, and not damaged: it was one plain file already
  std::uint64_t sweeps = 0, rows = 0;  // that it holds
};

// Examines a file like examine(), even if its journal is missing (schema/store/whole_file.h). If
// nothing is damaged, the file becomes one plain file with its present content. An existing journal
// is folded in. FAILED_PRECONDITION: a program is writing to it. INVALID_ARGUMENT: it has several
// hard links.
[[nodiscard]] absl::StatusOr<AcceptedFile> accept_file(const std::string& path,
                                                       int physics_version);

}  // namespace irsig
