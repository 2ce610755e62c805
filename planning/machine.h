#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "coordinator/client/machine_memory.h"
#include "runner/job_memory.h"

namespace irsig {

// Cores that this process may use, which a container or a batch system may have restricted.
[[nodiscard]] std::uint32_t usable_cores();

// Describes the memory needed: "about 1.35 GB with 1 worker, 2.5 GB with 2 (16.1 MB for each of 72
// conditions)".
[[nodiscard]] std::string memory_text(const JobMemory& memory, std::uint64_t conditions,
                                      std::uint32_t workers);

// Checks that so many workers have enough memory. RESOURCE_EXHAUSTED: they need more than
// usable_bytes; the message states how many conditions would fit with this number of workers and
// with one.
[[nodiscard]] absl::Status check_memory(const JobMemory& memory, std::uint64_t conditions,
                                        std::uint32_t workers, double usable_bytes);

}  // namespace irsig
