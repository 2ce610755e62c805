#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace irsig {

// Reads a model file whole, as read_user_file does. A .gltf whose buffers are files beside it comes
// back with their bytes inside ("data:" URIs), so that what is stored of a model is one text. Such a
// file must be named relative to the model's folder and lie in it. INVALID_ARGUMENT, without the
// model's name: what cannot be had, and of which buffer.
[[nodiscard]] absl::StatusOr<std::string> read_model_file(const std::string& path,
                                                          std::uint64_t most_bytes);

// The same of a model that another file names, relative to the folder of that one.
[[nodiscard]] absl::StatusOr<std::string> read_model_beside(const std::string& naming_file,
                                                            const std::string& name,
                                                            std::uint64_t most_bytes);

}  // namespace irsig
