#pragma once

namespace irsig {

// Returns the memory that one process may still take: of the machine, of the containers around this
// one, and within the limits that it hands on to its children. [bytes]
[[nodiscard]] double usable_memory_bytes();

}  // namespace irsig
