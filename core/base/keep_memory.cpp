#include "core/base/keep_memory.h"

#include <malloc.h>

#include <limits>

namespace irsig {

void keep_freed_memory() {
  // glibc maps and unmaps larger blocks each by itself whatever it is told.
  constexpr int kMostInHeapBytes = 32 << 20, kAtOnceBytes = 8 << 20;
  mallopt(M_MMAP_THRESHOLD, kMostInHeapBytes);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_TOP_PAD, kAtOnceBytes);
}

}  // namespace irsig
