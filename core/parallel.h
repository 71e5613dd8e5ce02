// Loops over several processors: the one way of this code to use them. The turns of a loop depend on nothing that another turn changes, and
// what is summed is summed in a fixed order, so results are the same for any number of threads. With CLOUDBAKE_SERIAL, the build for
// WebAssembly, there is one thread and no library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#ifndef CLOUDBAKE_SERIAL
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#endif

namespace cloudbake {

/// How many threads a loop that begins here may use.
inline size_t threadCount() {
#ifdef CLOUDBAKE_SERIAL
  return 1;
#else
  const size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::min(allowed, size_t(tbb::this_task_arena::max_concurrency()));
#endif
}

/// As long as it lives, loops use at most so many threads; 0 adds no limit.
class ThreadLimit {
 public:
#ifdef CLOUDBAKE_SERIAL
  explicit ThreadLimit(int /*threads*/) {}
#else
  explicit ThreadLimit(int threads)
      : limit_(tbb::global_control::max_allowed_parallelism,
               threads > 0 ? size_t(threads) : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)) {}

 private:
  tbb::global_control limit_;
#endif
};

/// Calls body(i) for every i in [first, last).
template <class Index, class Body>
void parallelFor(Index first, Index last, const Body& body) {
#ifdef CLOUDBAKE_SERIAL
  for (Index i = first; i < last; ++i) body(i);
#else
  tbb::parallel_for(first, last, body);
#endif
}
template <class Index, class Body>
void parallelFor(Index count, const Body& body) {
  parallelFor(Index(0), count, body);
}

/// Calls body(begin, end) for blocks that together are [first, last). A block of `grain` or fewer is not split.
template <class Index, class Body>
void parallelBlocks(Index first, Index last, [[maybe_unused]] size_t grain, const Body& body) {
#ifdef CLOUDBAKE_SERIAL
  if (first < last) body(first, last);
#else
  tbb::parallel_for(tbb::blocked_range<Index>(first, last, grain),
                    [&body](const tbb::blocked_range<Index>& range) { body(range.begin(), range.end()); });
#endif
}
template <class Body>
void parallelBlocks(size_t count, size_t grain, const Body& body) {
  parallelBlocks(size_t(0), count, grain, body);
}

/// Sorts values among which no two are equal.
template <class Iterator, class Less>
void parallelSort(Iterator begin, Iterator end, const Less& less) {
#ifdef CLOUDBAKE_SERIAL
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

/// For every chunk below `chunks`, calls work(chunk, slot) on any thread, then add(slot), one chunk after the other in their order. No slot
/// holds two chunks at a time, so at most so many chunks are in progress as there are slots; there must be one.
template <class Slot, class Work, class Add>
void parallelInOrder(size_t chunks, std::span<Slot> slots, const Work& work, const Add& add) {
#ifdef CLOUDBAKE_SERIAL
  for (size_t chunk = 0; chunk < chunks; ++chunk) {
    work(chunk, slots[0]);
    add(slots[0]);
  }
#else
  size_t next = 0;
  const auto hand_out = [&](tbb::flow_control& control) {
    if (next == chunks) control.stop();
    return next++;
  };
  const auto do_work = [&](size_t chunk) {
    work(chunk, slots[chunk % slots.size()]);
    return chunk;
  };
  const auto do_add = [&](size_t chunk) { add(slots[chunk % slots.size()]); };
  tbb::parallel_pipeline(slots.size(), tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order, hand_out) &
                                           tbb::make_filter<size_t, size_t>(tbb::filter_mode::parallel, do_work) &
                                           tbb::make_filter<size_t, void>(tbb::filter_mode::serial_in_order, do_add));
#endif
}

}  // namespace cloudbake
