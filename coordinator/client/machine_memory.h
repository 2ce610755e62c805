#pragma once

namespace irsig {

// Returns the memory [bytes] that one process may still allocate: limited by the machine, by the
// containers around this process, and by the limits that it passes on to its children.
[[nodiscard]] double usable_memory_bytes();

}  // namespace irsig
