#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace irsig {

// Reads a model file whole, as read_user_file does. A .gltf whose buffers are files beside it comes
// back with their bytes inside ("data:" URIs), so that the stored model is one text. Such a file
// must be named relative to the model's folder and lie in it. INVALID_ARGUMENT, without the model's
// name: a buffer that cannot be read, and its place in the model.
[[nodiscard]] absl::StatusOr<std::string> read_model_file(const std::string& path,
                                                          std::uint64_t most_bytes);

// Like read_model_file(), for a model that another file names, relative to the folder of the naming
// file.
[[nodiscard]] absl::StatusOr<std::string> read_model_beside(const std::string& naming_file,
                                                            const std::string& name,
                                                            std::uint64_t most_bytes);

}  // namespace irsig
