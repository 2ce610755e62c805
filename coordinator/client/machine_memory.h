#pragma once

#include <cstdint>

namespace irsig {

// Memory that so many processes may still take together: of the machine, of the containers around
// this process, and of the limits that it hands on to each of its children. [bytes]
[[nodiscard]] double usable_memory_bytes(std::uint32_t processes);

}  // namespace irsig
