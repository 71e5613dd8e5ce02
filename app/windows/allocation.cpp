// The operators throw AllocationFailure in place of std::bad_alloc ([new.delete.single]). Windows has no limit of one process for itself
// that every version keeps, so large blocks are compared with the limit here; small ones are most of what is asked for and little of what
// is taken. Inlined, one of a pair without the other looks like a mistake to GCC.
#include "app/allocation.h"

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

#include "core/memory_budget.h"

namespace {

constexpr std::size_t kLarge = 1 << 20;  // bytes
std::atomic<uint64_t> limit{cloudbake::kNoMemoryLimit};

void checkLimit(std::size_t bytes) {
  if (bytes < kLarge || limit == cloudbake::kNoMemoryLimit) return;
  if (const uint64_t most = limit; bytes > most || cloudbake::memoryTaken() > most - bytes) throw cloudbake::AllocationFailure(bytes);
}

}  // namespace

[[gnu::noinline]] void* operator new(std::size_t bytes) {
  checkLimit(bytes);
  if (void* block = std::malloc(std::max<std::size_t>(bytes, 1))) return block;
  throw cloudbake::AllocationFailure(bytes);
}

[[gnu::noinline]] void* operator new(std::size_t bytes, std::align_val_t alignment) {
  checkLimit(bytes);
  if (void* block = ::_aligned_malloc(std::max<std::size_t>(bytes, 1), std::size_t(alignment))) return block;
  throw cloudbake::AllocationFailure(bytes);
}

[[gnu::noinline]] void operator delete(void* block) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, std::size_t) noexcept { std::free(block); }
[[gnu::noinline]] void operator delete(void* block, std::align_val_t) noexcept { ::_aligned_free(block); }
[[gnu::noinline]] void operator delete(void* block, std::size_t, std::align_val_t) noexcept { ::_aligned_free(block); }

namespace cloudbake {

void keepLargeBlocks() {}  // Windows keeps them by itself

void limitMemory(uint64_t bytes) { limit = memoryTaken() + bytes; }

}  // namespace cloudbake
