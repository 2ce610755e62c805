#pragma once

#include <cstddef>
#include <string>

#include "absl/status/statusor.h"
#include "schema/result.pb.h"

namespace irsig {

// What a heat job has left, read: of so many facets. INVALID_ARGUMENT: the bytes are none, or of
// another mesh.
[[nodiscard]] absl::StatusOr<schema::HeatField> read_heat_field(const std::string& bytes,
                                                                std::size_t facets);

}  // namespace irsig
