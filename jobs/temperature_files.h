#pragma once

#include <string>

#include "absl/status/status.h"
#include "jobs/material_files.h"
#include "jobs/sweep_file.h"

namespace irsig {

// Puts the bytes of the files that [[temperature_field]] names into file.content. Call it between
// parse_sweep and resolve_sweep. Errors (INVALID_ARGUMENT, all of them, file:line:column): a file
// that cannot be read. What is in it is read where the mesh is known.
[[nodiscard]] absl::Status read_temperature_files(SweepFile& file, const FileReader& read);

// Of a field, by its name. Empty: there is none.
[[nodiscard]] std::string field_bytes(const SweepFile& file, const std::string& name);

}  // namespace irsig
