#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/base/run_subprocess.h"
#include "core/scene/import/import_formats.h"

namespace irsig {

// Returns the path of the importing program, beside this executable.
[[nodiscard]] std::string importer_program();

// Runs `program` (irsig-import) on a glTF or GLB file and returns the mesh that it found, or
// INVALID_ARGUMENT with what is wrong with the file: that the program crashed on it or met a limit
// included. INTERNAL: the program could not be run, or somebody else killed it. May be called from
// several threads at once.
[[nodiscard]] absl::StatusOr<FileMesh> import_subprocess(const std::string& program,
                                                         std::string_view bytes,
                                                         const std::string& file_name);

}  // namespace irsig
