#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/scene/import_formats.h"

namespace irsig {

// What irsig-import may take for a file of so many bytes before the kernel ends it. Memory is the
// space of addresses. A model of 25 MB takes 0.4 s and 8 bytes of memory a byte
// (docs/decisions/0021); so nothing but a damaged file, or one made to do harm, comes near.
struct ImportLimits {
  std::uint64_t memory_bytes;
  std::uint64_t cpu_s;   // of the processor
  std::uint64_t wall_s;  // of the clock: whatever else the machine does
};
[[nodiscard]] ImportLimits import_limits(std::uint64_t file_bytes);

// The program that imports, beside this executable.
[[nodiscard]] std::string importer_program();

// Runs `program` (irsig-import) on a file of the form "ply", "stl", "gltf" or "glb" and returns the
// mesh that it found, or INVALID_ARGUMENT with what is wrong with the file: that the program
// crashed on it or met a limit included. INTERNAL: the program could not be run, or somebody else
// killed it. May be called from several threads at once.
[[nodiscard]] absl::StatusOr<FileMesh> import_apart(const std::string& program,
                                                    std::string_view bytes,
                                                    const std::string& form);

}  // namespace irsig
