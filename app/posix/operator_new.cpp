// The operators throw AllocationFailure, which knows how much was asked for, in place of std::bad_alloc ([new.delete.single]). Sanitizers
// have their own, and reserve terabytes. Inlined, one of a pair without the other looks like a mistake to GCC.
#include <algorithm>
#include <cstdlib>
#include <new>

#include "core/memory_budget.h"

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

[[gnu::noinline]] void* operator new(std::size_t bytes) {
  if (void* block = std::malloc(std::max<std::size_t>(bytes, 1))) return block;
  throw cloudbake::AllocationFailure(bytes);
}

[[gnu::noinline]] void* operator new(std::size_t bytes, std::align_val_t alignment) {
  const auto step = std::size_t(alignment);
  if (void* block = std::aligned_alloc(step, std::max(step, (bytes + step - 1) / step * step))) return block;
  throw cloudbake::AllocationFailure(bytes);
}

[[gnu::noinline]] void operator delete(void* block) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, std::size_t) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, std::align_val_t) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, std::size_t, std::align_val_t) noexcept { std::free(block); }

#endif
