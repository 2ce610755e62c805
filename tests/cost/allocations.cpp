#include "tests/cost/allocations.h"

#include <cstdlib>
#include <new>

namespace {
thread_local irsig::Allocations asked;
}  // namespace

namespace irsig {
Allocations allocations() { return asked; }
}  // namespace irsig

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

bool irsig::counts_allocations() { return false; }

#else

bool irsig::counts_allocations() { return true; }

namespace {
void* allocated(std::size_t bytes, std::size_t alignment) {
  ++asked.count;
  asked.bytes += bytes;
  void* at = alignment <= alignof(std::max_align_t)
                 ? std::malloc(bytes > 0 ? bytes : 1)
                 : std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (at == nullptr) throw std::bad_alloc();
  return at;
}
}  // namespace

void* operator new(std::size_t bytes) { return allocated(bytes, 1); }
void* operator new[](std::size_t bytes) { return allocated(bytes, 1); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return allocated(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
  return allocated(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* at) noexcept { std::free(at); }
void operator delete[](void* at) noexcept { std::free(at); }
void operator delete(void* at, std::size_t) noexcept { std::free(at); }
void operator delete[](void* at, std::size_t) noexcept { std::free(at); }
void operator delete(void* at, std::align_val_t) noexcept { std::free(at); }
void operator delete[](void* at, std::align_val_t) noexcept { std::free(at); }
void operator delete(void* at, std::size_t, std::align_val_t) noexcept { std::free(at); }
void operator delete[](void* at, std::size_t, std::align_val_t) noexcept { std::free(at); }

#endif
