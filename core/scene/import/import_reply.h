#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/scene/import/import_formats.h"

namespace irsig {

// Encodes the reply of irsig-import to the process that started it: a mesh, or the error. Numbers
// have the machine's own form: both ends are of one build and on one machine.
[[nodiscard]] std::string encode_reply(const absl::StatusOr<FileMesh>& result);

// Trusts nothing that another process writes. DATA_LOSS where
// it is no complete reply; else the mesh, with finite vertices and indices in range, or
// INVALID_ARGUMENT with what the other process found wrong with the file.
[[nodiscard]] absl::StatusOr<FileMesh> decode_reply(std::string_view reply);

}  // namespace irsig
