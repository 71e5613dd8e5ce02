// Searches on several processors.
#pragma once

#include <cstddef>
#include <mutex>

#include "core/parallel.h"

namespace cloudbake {

/// The first i below `count` for which test(i) holds, or `count`. No test may throw.
template <class Test>
size_t firstWhere(size_t count, const Test& test) {
  constexpr size_t kGrain = 1 << 14;
  size_t first = count;
  std::mutex mutex;
  parallelBlocks(count, kGrain, [&](size_t begin, size_t end) {
    size_t i = begin;
    while (i < end && !test(i)) ++i;
    if (i == end) return;
    const std::lock_guard lock(mutex);
    first = std::min(first, i);
  });
  return first;
}

}  // namespace cloudbake
