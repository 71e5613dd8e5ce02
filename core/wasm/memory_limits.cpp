// A memory of WebAssembly has at most 4 GiB. What it has grown to stays taken.
#include <unistd.h>

#include <algorithm>

#include "core/memory_budget.h"
#include "core/wasm/host.h"

namespace cloudbake {

namespace {

constexpr double kMost = double(4ULL << 30);

}  // namespace

uint64_t defaultMemoryLimit(const std::filesystem::path& /*root*/) { return uint64_t(std::min(kMost, cloudbake_machine_memory())) / 4 * 3; }

uint64_t memoryTaken() { return uintptr_t(::sbrk(0)); }

uint64_t memoryAllowed() {
  const double limit = cloudbake_memory_limit();
  return limit < kMost - (1 << 16) ? uint64_t(limit) : kNoMemoryLimit;
}

}  // namespace cloudbake
