#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// Limits of an importing program for a file of a given size, beyond which the kernel ends the
// program. Memory is address space. A model of 25 MB takes 0.4 s and 8 bytes of memory a byte
// (docs/decisions/0021), so that only damaged or malicious files reach the limits.
struct ApartLimits {
  std::uint64_t memory_bytes;
  std::uint64_t cpu_s;   // of the processor
  std::uint64_t wall_s;  // of the clock: whatever else the machine does
};
[[nodiscard]] ApartLimits apart_limits(std::uint64_t file_bytes);

// Returns the path of a program in the folder of this executable.
[[nodiscard]] std::string program_beside(const std::string& name);

// Starts a program, sends it `bytes` on its standard input and returns what it wrote on its
// standard output, if it ended well (answer_subprocess.h is the other side). INVALID_ARGUMENT says
// what is wrong with the bytes: that the program crashed on them or met a limit. INTERNAL: it could
// not be run, said nothing, or somebody else killed it. May be called from several threads at once.
[[nodiscard]] absl::StatusOr<std::string> run_subprocess(const std::string& program,
                                                         const std::vector<std::string>& arguments,
                                                         std::string_view bytes,
                                                         const ApartLimits& limits);

}  // namespace irsig
