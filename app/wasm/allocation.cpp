// The operators throw AllocationFailure, which knows how much was asked for, in place of std::bad_alloc ([new.delete.single]).
#include "app/allocation.h"

#include <algorithm>
#include <cstdlib>
#include <new>

#include "core/memory_budget.h"
#include "core/wasm/host.h"

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

namespace cloudbake {

void keepLargeBlocks() {}  // nothing is given back

void limitMemory(uint64_t bytes) { cloudbake_limit_memory(double(memoryTaken()) + double(bytes)); }

}  // namespace cloudbake
