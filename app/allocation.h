// The limit of the program's memory, and the error that an allocation beyond it throws.
#pragma once

#include <cstdint>

namespace cloudbake {

/// Lets the system refuse allocations of this process beyond `bytes`, as the last resort if no estimate foresaw them.
void limitMemory(uint64_t bytes);

/// For pictures, which are tens of megabytes that come and go: blocks of this size are kept when they are freed, so that the system need
/// not clear their pages every time.
void keepLargeBlocks();

}  // namespace cloudbake
