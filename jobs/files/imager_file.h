#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/imager/imager.h"

namespace irsig {

struct ImagerOfFile {
  std::string name;      // the file's own name for it, or its path
  std::string identity;  // all keys that the file states
  Imager imager;
};
// Reads an imager from a TOML file (schema/imager.proto, docs/reference/imager.md).
// INVALID_ARGUMENT, each file:line:column: what is unknown, missing, superfluous or out of bounds.
[[nodiscard]] absl::StatusOr<ImagerOfFile> read_imager(const std::string& path);

}  // namespace irsig
