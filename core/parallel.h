// Loops over several processors: the one way of this code to use them. The turns of a loop depend on nothing that another turn changes, and
// what is summed is summed in a fixed order, so results are the same for any number of threads. With CLOUDBAKE_SERIAL, the build for
// WebAssembly, there is one thread and no library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#ifndef CLOUDBAKE_SERIAL
#include <atomic>

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

/// Is thrown by a loop that was stopped. It is no error: it ends a run that nobody waits for any more.
struct LoopStopped {};

#ifndef CLOUDBAKE_SERIAL
/// Stops the loops of one thread from another: a program asks for it when its user no longer wants the result.
class LoopStop {
 public:
  /// As long as it lives, the loops of this thread obey `stop`. Those of its turns that have begun come to their end.
  class Scope {
   public:
    explicit Scope(const LoopStop& stop) : outer_(current()) { current() = &stop; }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope() { current() = outer_; }

   private:
    const LoopStop* outer_;
  };
  void request() { requested_.store(true, std::memory_order_relaxed); }
  bool isRequested() const { return requested_.load(std::memory_order_relaxed); }
  void throwIfRequested() const {
    if (isRequested()) throw LoopStopped();
  }
  /// The LoopStop that the loops of this thread obey; null if there is none.
  static const LoopStop*& current() {
    thread_local const LoopStop* stop = nullptr;
    return stop;
  }

 private:
  std::atomic<bool> requested_ = false;
};
#endif

/// Calls body(i) for every i in [first, last).
template <class Index, class Body>
void parallelFor(Index first, Index last, const Body& body) {
#ifdef CLOUDBAKE_SERIAL
  for (Index i = first; i < last; ++i) body(i);
#else
  const LoopStop* stop = LoopStop::current();
  tbb::parallel_for(first, last, [&body, stop](Index i) {
    if (!stop || !stop->isRequested()) body(i);
  });
  if (stop) stop->throwIfRequested();
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
  const LoopStop* stop = LoopStop::current();
  tbb::parallel_for(tbb::blocked_range<Index>(first, last, grain), [&body, stop](const tbb::blocked_range<Index>& range) {
    if (!stop || !stop->isRequested()) body(range.begin(), range.end());
  });
  if (stop) stop->throwIfRequested();
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
  const LoopStop* stop = LoopStop::current();
  size_t next = 0;
  const auto hand_out = [&](tbb::flow_control& control) {
    if (next == chunks || (stop && stop->isRequested())) control.stop();
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
  if (stop) stop->throwIfRequested();
#endif
}

}  // namespace cloudbake
