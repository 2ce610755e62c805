#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "jobs/text/sweep_file.h"
#include "schema/goniometer.pb.h"

namespace irsig {

// A parsed goniometer file. Its model, materials, parts and bands also stand as those of a sweep
// in `scene`, so that what reads and checks a sweep's (read_material_files, resolve_target) serves
// both; places in the file are kept there too.
struct GoniometerFile {
  schema::Goniometer spec;
  SweepFile scene;
};

// Reads a goniometer from TOML. Errors: those of parse_sweep.
[[nodiscard]] absl::StatusOr<GoniometerFile> parse_goniometer(std::string_view text,
                                                              std::string_view file_name);

// Complete: every default written out, angles as lists, bands as limits with a response.
struct ResolvedGoniometer {
  schema::Goniometer spec;
  schema::ResolvedSweep scene;
};

// Checks the meaning; all errors at once, in the order of the file. A model file's content is
// `model_bytes`.
[[nodiscard]] absl::StatusOr<ResolvedGoniometer> resolve_goniometer(const GoniometerFile& file,
                                                                    std::string_view model_bytes);

}  // namespace irsig
