#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/scene/import_formats.h"

namespace irsig {

// Reads a file with Assimp, in this process. form: "ply", "stl", "gltf" or "glb". Errors do not
// name the file.
[[nodiscard]] absl::StatusOr<FileMesh> import_float32(std::string_view bytes,
                                                      const std::string& form);

}  // namespace irsig
