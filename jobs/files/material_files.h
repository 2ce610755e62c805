#pragma once

#include <functional>
#include <string>

#include "absl/status/statusor.h"
#include "jobs/text/sweep_file.h"

namespace irsig {

// The content of a file by the name that the sweep file gives it (relative to the sweep file).
using FileReader = std::function<absl::StatusOr<std::string>(const std::string& name)>;

// Replaces emissivity_file, optical_constants_file, brdf_file ... of every material by the table in
// the file, so that the sweep is complete without the file. Errors about the table's range refer to
// the key that names the file. Call it between parse_sweep and resolve_sweep, which refuses a file
// that was not read. A key that does not belong there is left for resolve_sweep to report. Errors
// (INVALID_ARGUMENT, all of them, file:line:column): a file that cannot be read, at its key; errors
// in its text, at its own lines.
[[nodiscard]] absl::Status read_material_files(SweepFile& file, const FileReader& read);

}  // namespace irsig
