#pragma once

#include <map>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "jobs/files/material_files.h"
#include "jobs/text/sweep_file.h"

namespace irsig {

// Puts the bytes of the files that [[temperature_field]] names into file.content. Call it between
// parse_sweep and resolve_sweep. The content is read later, when the mesh is known. Errors
// (INVALID_ARGUMENT, all of them, file:line:column): a file that cannot be read.
[[nodiscard]] absl::Status read_temperature_files(SweepFile& file, const FileReader& read);

// Returns the bytes of the fields' files, by their names.
[[nodiscard]] std::map<std::string, std::string_view> fields_of(const SweepFile& file);

}  // namespace irsig
