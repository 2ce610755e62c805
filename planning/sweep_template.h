#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/import/import_mesh.h"
#include "core/scene/mesh.h"
#include "planning/model_frame.h"

namespace irsig {

// Request for a sweep file to begin with, for a user's model. The file runs unchanged; its comments
// list the findings, the assumptions and the first changes to make.
struct TemplateAsked {
  std::string name;        // of the sweep
  std::string model_file;  // as the sweep file names it
  MeshImport how;
  FrameSources from;  // of its unit and axes
  double latitude_deg = 45, longitude_deg = -10;
  bool place_given = false;
  std::string season = "summer";     // winter | spring | summer | autumn
  std::string surroundings = "sea";  // sea | ground
  // Hours of the day, 0 to 23, at every season; empty: noon.
  std::vector<int> hours;
  // A weather file, as the sweep file names it, from which temperatures are computed: a season for
  // each month (1 to 12; empty: all). Empty: temperatures and one season are assumed.
  std::string weather_file;
  std::vector<int> months;
  double height_m = 0;      // of the surface, from the weather file
  double utc_offset_h = 0;  // of the hours; without a weather file the place's
};

// Returns true for a group whose name is that of a hot part: a funnel, an exhaust, an engine.
[[nodiscard]] bool sounds_hot(std::string_view group);

// Returns the numbers of a list such as "1-3,7", in their order.
// INVALID_ARGUMENT: no such list, a number outside least to most, a number twice.
[[nodiscard]] absl::StatusOr<std::vector<int>> numbers_of_list(std::string_view text, int least,
                                                               int most);

// Returns the text of a sweep file for a mesh. INVALID_ARGUMENT: an unknown season.
[[nodiscard]] absl::StatusOr<std::string> sweep_template(const TemplateAsked& asked,
                                                         const Mesh& mesh);

}  // namespace irsig
