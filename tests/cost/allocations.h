#pragma once

#include <cstdint>

namespace irsig {

// Allocations count what operator new was asked for in this thread, since it began. They stay 0 in
// a program with sanitizers, which have an operator new of their own.
struct Allocations {
  std::uint64_t count = 0, bytes = 0;
};
[[nodiscard]] Allocations allocations();
[[nodiscard]] bool counts_allocations();

}  // namespace irsig
