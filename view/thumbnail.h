#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "view/query.h"

namespace irsig {

// Writes the stored image of the only row to a file; its ending (.png or .exr) says which.
// INVALID_ARGUMENT: another ending, no row, an interpolated one, or several (they are listed);
// NOT_FOUND: stored without image.
[[nodiscard]] absl::Status write_thumbnail(StoreReader& reader, const std::vector<QueryRow>& rows,
                                           const std::string& path);

}  // namespace irsig
