#pragma once

#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "view/query/refine.h"

namespace irsig {

// Returns the result of refine(), for people.
[[nodiscard]] std::vector<std::string> notes_on(const Refinement& found,
                                                std::span<const SignatureField> fields,
                                                SignatureQuantity quantity, double relative_error);

// Writes the proposed viewpoints: as lines for a sweep file ("text"), or in a format of table.h.
[[nodiscard]] absl::Status write_proposed(const Refinement& found,
                                          std::span<const SignatureField> fields,
                                          std::string_view format, std::ostream& out);

// Writes for each viewpoint its value and the value interpolated from the other viewpoints of its
// field.
[[nodiscard]] absl::Status write_left_out(std::span<const SignatureField> fields, FieldKind kind,
                                          std::string_view format, std::ostream& out);

}  // namespace irsig
