// The memory of the program: its limit, and what is thrown where it is refused.
#pragma once

#include <cstdint>

namespace cloudbake {

/// Lets the system refuse what this process takes beyond `bytes`, as the last resort for what no estimate foresaw.
void limitMemory(uint64_t bytes);

}  // namespace cloudbake
