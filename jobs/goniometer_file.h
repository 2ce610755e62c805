#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "jobs/text/sweep_file.h"
#include "schema/goniometer.pb.h"

namespace irsig {

// A parsed goniometer file. `scene` has its model, materials, parts and bands as those of a sweep,
// so that the readers and checks of a sweep (read_material_files, resolve_target) apply to both; it
// also has the places of keys in the file.
struct GoniometerFile {
  schema::Goniometer spec;
  SweepFile scene;
};

// Reads a goniometer from TOML. Errors: those of parse_sweep.
[[nodiscard]] absl::StatusOr<GoniometerFile> parse_goniometer(std::string_view text,
                                                              std::string_view file_name);

// Resolved form: every default written out, angles as lists, bands as limits with a response.
struct ResolvedGoniometer {
  schema::Goniometer spec;
  schema::ResolvedSweep scene;
};

// Checks the meaning of a goniometer; reports all errors at once, in the order of the file.
// model_bytes: content of the model file.
[[nodiscard]] absl::StatusOr<ResolvedGoniometer> resolve_goniometer(const GoniometerFile& file,
                                                                    std::string_view model_bytes);

}  // namespace irsig
