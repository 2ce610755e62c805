#pragma once

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "schema/result.pb.h"

namespace irsig {

// Reads a heat job's output for this number of facets. INVALID_ARGUMENT: the bytes are not such an
// output, or belong to another mesh.
[[nodiscard]] absl::StatusOr<schema::HeatField> read_heat_field(const std::string& bytes,
                                                                std::size_t facets);

}  // namespace irsig
