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
// INVALID_ARGUMENT, each file:line:column: a key that is unknown, missing, superfluous or out of
// bounds.
[[nodiscard]] absl::StatusOr<ImagerOfFile> read_imager(const std::string& path);

// Reports missing, superfluous and contradictory keys of an imager. Numbers are checked separately
// (check_numbers). path: of the table that holds the imager: "imager" in a sweep, "" in a separate
// file.
void check_imager(const schema::ImagerFile& stated, const std::string& path, Findings& findings);

}  // namespace irsig
