#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/scene/import/import_mesh.h"
#include "core/scene/mesh.h"
#include "planning/model_frame.h"

namespace irsig {

// A sweep file to begin with, for a model of one's own: it runs as it is, and says in comments what
// was found, what was assumed, and what to change first.
struct TemplateAsked {
  std::string name;        // of the sweep
  std::string model_file;  // as the sweep file names it
  MeshImport how;
  FrameSources from;  // of its unit and axes
  double latitude_deg = 45, longitude_deg = -10;
  bool place_given = false;
  std::string season = "summer";     // winter | spring | summer | autumn
  std::string surroundings = "sea";  // sea | ground
};

// INVALID_ARGUMENT: an unknown season.
[[nodiscard]] absl::StatusOr<std::string> sweep_template(const TemplateAsked& asked,
                                                         const Mesh& mesh);

}  // namespace irsig
