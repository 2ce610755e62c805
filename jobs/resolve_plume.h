#pragma once

#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "jobs/files/material_files.h"
#include "jobs/text/section_check.h"
#include "schema/job.pb.h"

namespace irsig {

// Returns true if the sweep's hot gas rises from a funnel and so depends on the weather of each
// condition.
[[nodiscard]] bool has_funnel_plume(const schema::Sweep& sweep);

// Puts the bytes of the file that [plume] names into file.content. Call it between parse_sweep and
// resolve_sweep. The content is read later, when the scene is made. INVALID_ARGUMENT
// (file:line:column): a file that cannot be read.
[[nodiscard]] absl::Status read_plume_file(SweepFile& file, const FileReader& read);
// Returns the bytes of the plume's file. Empty: there is none.
[[nodiscard]] std::string_view plume_bytes(const SweepFile& file);

// Checks [plume] and the settings that sweeps with it may not have; write_plume_defaults() writes
// its defaults.
void check_plume(const schema::Sweep& sweep, Findings& findings);
void write_plume_defaults(schema::Sweep& sweep);

// The weather of a condition as far as a funnel's plume depends on it.
struct PlumeWeather {
  double wind_speed_m_s = 0, wind_from_deg = 0;  // clockwise from true north
};
// Writes ResolvedSweep.plume and the plume of each condition; weather: [condition]. Writes nothing
// for a sweep without [plume].
void resolve_plumes(const SweepFile& file, const std::vector<PlumeWeather>& weather,
                    schema::ResolvedSweep& resolved, Findings& findings);

// Like resolve_plumes(), for a resolved sweep from another process.
void check_resolved_plumes(const schema::ResolvedSweep& resolved, Findings& findings);

}  // namespace irsig
