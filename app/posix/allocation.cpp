#include "app/allocation.h"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>

#include "core/memory_budget.h"
#include "core/parallel.h"

namespace cloudbake {

void keepLargeBlocks() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
}

// The stack of a thread counts as data from its first moment (RLIMIT_DATA, setrlimit(2)).
void limitMemory([[maybe_unused]] uint64_t bytes) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  rlimit stack{}, data{};
  if (::getrlimit(RLIMIT_STACK, &stack) != 0 || ::getrlimit(RLIMIT_DATA, &data) != 0) return;
  const rlim_t of_threads = stack.rlim_cur == RLIM_INFINITY ? 0 : stack.rlim_cur * threadCount();
  data.rlim_cur = std::min<rlim_t>(data.rlim_max, memoryTaken() + bytes + of_threads);
  ::setrlimit(RLIMIT_DATA, &data);
#endif
}

}  // namespace cloudbake
