#pragma once

#include "absl/status/status.h"
#include "jobs/files/material_files.h"
#include "jobs/text/sweep_file.h"

namespace irsig {

// Reads condition_file and writes the conditions out as seasons (condition_table.h). Then puts the
// text of every profile_file and modtran_file of [air] and [[season]] into file.content, and the
// text of each weather_file once, under weather_file_key(). Call it between parse_sweep and
// resolve_sweep, which refuses a file that was not read. Errors (INVALID_ARGUMENT, all of them,
// file:line:column): a file that cannot be read or is larger than 8 MB, at its key; errors in its
// text, at its own lines.
[[nodiscard]] std::string weather_file_key(const std::string& weather_file);
[[nodiscard]] absl::Status read_weather_files(SweepFile& file, const FileReader& read);

}  // namespace irsig
