#pragma once

#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/land/objects/land_objects.h"

namespace irsig {

// Reads places of objects from CSV with the columns east_m, north_m and, if stated, heading_deg and
// scale, in any order, below a line with their names. INVALID_ARGUMENT, file:line:column of up to
// ten: an unknown or missing column, a cell that is no number, a scale that is not above 0, more
// than kMostLandObjects lines, none.
//   scale  of places whose file has no column of that name
[[nodiscard]] absl::StatusOr<std::vector<ObjectPlace>> read_places(std::string_view text,
                                                                   std::string_view file_name,
                                                                   double scale);

}  // namespace irsig
