#include "app/allocation.h"

#include "core/memory_budget.h"
#include "core/wasm/host.h"

namespace cloudbake {

void keepLargeBlocks() {}  // nothing is given back

void limitMemory(uint64_t bytes) { cloudbake_limit_memory(double(memoryTaken()) + double(bytes)); }

}  // namespace cloudbake
