#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/imager/imager.h"
#include "jobs/text/section_check.h"
#include "schema/imager.pb.h"

namespace irsig {

struct ImagerOfFile {
  std::string name;      // the file's own name for it, or its path
  std::string identity;  // all keys that the file states
  Imager imager;
};
// Reads an imager from a TOML file (schema/imager.proto, docs/reference/imager.md).
// INVALID_ARGUMENT, each file:line:column: what is unknown, missing, superfluous or out of bounds.
[[nodiscard]] absl::StatusOr<ImagerOfFile> read_imager(const std::string& path);

// Reports what is missing, superfluous or contradictory in an imager. Numbers are checked apart
// (check_numbers).
//   path  of the table that holds it: "imager" in a sweep, "" in a file of its own
void check_imager(const schema::ImagerFile& stated, const std::string& path, Findings& findings);

}  // namespace irsig
