#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// One view of a sweep: a single condition from a single viewpoint, with a camera's image.
struct SweepEdit {
  std::string name;  // of the new sweep
  // Index of the condition: of [[condition]], if there are any; else of [[season]] and of `time`.
  std::uint32_t condition = 0, season = 0, time = 0;
  std::string time_of_day;             // "13:30Z" in place of the time; empty: as written
  std::optional<double> visibility_m;  // of [air]; absent: as written
  std::vector<std::string> only;       // [effects] mode = "only"; with `choose_effects`
  bool choose_effects = false;
  // [viewpoints] and [image]; absent range: as written.
  struct Camera {
    double azimuth_deg = 0, elevation_deg = 0, range_m = 0, field_of_view_deg = 0;
    double look_at_m[3] = {0, 0, 0};
    std::uint32_t width_px = 0, height_px = 0;
    double pixel_error_percent = 0;
  };
  std::optional<Camera> camera;
  bool without_imager = false;  // [imager] is left out, and a comment on the first line states so
};

// Returns the text of a sweep file with one view of another file, and all other settings of that
// file. Comments are lost. INVALID_ARGUMENT with the place in the file: a syntax error, or
// conditions that are in a separate file or vary.
[[nodiscard]] absl::StatusOr<std::string> edit_sweep(std::string_view text,
                                                     std::string_view file_name,
                                                     const SweepEdit& edit);

}  // namespace irsig
