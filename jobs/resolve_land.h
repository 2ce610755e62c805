#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "jobs/files/material_files.h"
#include "jobs/text/section_check.h"
#include "schema/job.pb.h"

namespace irsig {

// Puts the bytes of the files that [land] names into file.content. Call it between parse_sweep and
// resolve_sweep. INVALID_ARGUMENT (file:line:column): files that cannot be read. Their content is
// checked where the scene is made (runner/sweep_land.h).
[[nodiscard]] absl::Status read_land_files(SweepFile& file, const FileReader& read);

// Returns the bytes of these files by the keys that name them: "land.heights".
[[nodiscard]] std::map<std::string, std::string_view> land_bytes(const SweepFile& file);

// Returns true if the sweep file states a material's temperature in a season: its own, or the
// season's.
[[nodiscard]] bool is_stated(const schema::Season& season, const schema::LandMaterial& material);
// Returns the materials of the land whose temperatures are computed in a season, by their index.
[[nodiscard]] std::vector<int> computed_land(const schema::Sweep& sweep,
                                             const schema::Season& season);

// Checks [land], the tables that it needs, and land_temperature_k of seasons.
void check_land(const schema::Sweep& sweep, Findings& findings);
void write_land_defaults(schema::Sweep& sweep);

// Resolves the materials of the land in the same way as materials of parts (resolve_part_material).
void resolve_land_materials(std::vector<std::string>& known, schema::Sweep& sweep,
                            Findings& findings);

// Writes Condition.land_temperature_k.
void take_land_temperatures(const schema::Sweep& sweep, const schema::Season& season,
                            schema::Condition& condition);

// Writes ResolvedSweep.land and removes the names of files from ResolvedSweep.sweep.land.
void resolve_land(const SweepFile& file, schema::ResolvedSweep& resolved);

// Returns [land] of a resolved sweep as a file states it, with the names of its files.
[[nodiscard]] schema::Land land_as_written(const schema::ResolvedSweep& resolved);

// Checks the output of resolve_land() and take_land_temperatures() in a resolved sweep from another
// process.
void check_resolved_land(const schema::ResolvedSweep& resolved, Findings& findings);

}  // namespace irsig
