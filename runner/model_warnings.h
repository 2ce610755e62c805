#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/base/problems.h"
#include "core/signature/view/prepared_scene.h"
#include "schema/job.pb.h"

namespace irsig {

// Position of a model, as far as a sweep or a user states it.
struct Placement {
  double unit_m = 1;
  bool placed = false;       // draft_m or offset_m is stated
  std::string surroundings;  // "sea", "ground"; else nothing is said about where it stands
  bool atmosphere = false;   // real air, whose properties change with height
};
struct PlacementNote {
  std::string key;  // of the sweep file: "model.unit_m"
  std::string text;
};
// Returns notes on size, axes and, over a sea or ground, the floating or standing position: facts
// that suggest a wrong key.
[[nodiscard]] std::vector<PlacementNote> placement_notes(const Mesh& mesh,
                                                         const Placement& placement);

// Returns the fraction of the facets' area below z = 0, by their middles: 0 to 1.
[[nodiscard]] double fraction_below_surface(const Mesh& mesh);

// Checks that a part of the target rises above the sea or ground where above_surface_m is lowest.
// INVALID_ARGUMENT: none does, so that the target would be invisible.
[[nodiscard]] absl::Status check_above_surface(const schema::ResolvedSweep& sweep,
                                               const Mesh& mesh);

// Checks model.offset_m. INVALID_ARGUMENT: it moves the target from its reference point by more
// than the target's size and more than 1 % of the shortest range. An offset beyond the size but
// within 1 % gives a warning.
[[nodiscard]] absl::Status check_offset(const schema::ResolvedSweep& sweep, const Mesh& mesh);

// Returns warnings for people about a model from a file, each at the key that may be wrong:
//   - one-sided parts with facets of open shells, unless the sweep states
//     model.accepted_backface_fraction
//   - a size that suggests another unit, or axes that suggest others
//   - over a sea or ground, the floating or standing position
// For generated models too: sensors nearer than the target's reach, and an offset larger than the
// target.
[[nodiscard]] std::vector<Problem> model_warnings(const schema::ResolvedSweep& sweep,
                                                  const SceneSpec& scene);

}  // namespace irsig
