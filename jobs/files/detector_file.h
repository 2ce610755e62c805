#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/detector/detector.h"

namespace irsig {

// A detector from a TOML file (schema/detector.proto, docs/reference/bands.md) and the CSV that the
// file names, relative to it. Without a response file the response of `nei` is empty: 1 at every
// wavelength. INVALID_ARGUMENT, each file:line:column: a key that is unknown, missing, superfluous
// or out of bounds.
struct DetectorOfFile {
  std::string name;  // the file's own word for it, or its path
  Detector detector;
};
[[nodiscard]] absl::StatusOr<DetectorOfFile> read_detector(const std::string& path);

}  // namespace irsig
