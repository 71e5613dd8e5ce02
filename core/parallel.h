// Loops over several processors: the one way of this code to use them. The turns of a loop depend on nothing that another turn changes, and
// what is summed is summed in a fixed order, so results are the same for any number of threads. The threads are TBB's, whose headers only
// core/parallel.cpp needs: it gets the address of a loop's body and calls it once for every block of turns. With CLOUDBAKE_SERIAL, the
// module for JavaScript, there is one thread and no library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>
#ifndef CLOUDBAKE_SERIAL
#include <atomic>

#include "core/function_ref.h"
#endif

namespace cloudbake {

/// Is thrown by a loop that was stopped. It is no error: it ends a run that nobody waits for any more.
struct LoopStopped {};

#ifdef CLOUDBAKE_SERIAL

inline size_t threadCount() { return 1; }

class ThreadLimit {
 public:
  explicit ThreadLimit(int /*threads*/) {}
};

inline void throwIfLoopsStop() {}

class LoopStop {
 public:
  bool isRequested() const { return false; }
  static const LoopStop* current() { return nullptr; }
};

class LoopProgress {
 public:
  struct Part {
    Part(double /*from*/, double /*to*/) {}
  };
  struct Counted {
    Counted() {}
  };
  static LoopProgress* current() { return nullptr; }
  void enter(const char* /*stage*/, double /*from*/, double /*to*/) {}
};

#else

/// How many threads a loop that begins here may use.
size_t threadCount();

/// As long as it lives, loops use at most so many threads; 0 adds no limit.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();

 private:
  struct Limit;
  std::unique_ptr<Limit> limit_;
};

/// Stops the loops of one thread from another: a program asks for it when its user no longer wants the result.
class LoopStop {
 public:
  /// As long as it lives, the loops of this thread obey `stop`. Those of its turns that have begun come to their end.
  class Scope {
   public:
    explicit Scope(const LoopStop& stop);
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope();

   private:
    const LoopStop* outer_;
  };
  void request() { requested_.store(true, std::memory_order_relaxed); }
  bool isRequested() const { return requested_.load(std::memory_order_relaxed); }
  void throwIfRequested() const {
    if (isRequested()) throw LoopStopped();
  }
  /// What the loops of this thread obey; null if nobody stops them.
  static const LoopStop* current();

 private:
  std::atomic<bool> requested_ = false;
};

/// For long work that is no loop of this header: throws LoopStopped if the loops of this thread are to stop.
void throwIfLoopsStop();

/// Tells another thread how far the work of one thread has come: its stage, and a share from 0 to 1 that never falls.
class LoopProgress {
 public:
  /// As long as it lives, the loops of this thread are part of `progress`.
  class Scope {
   public:
    explicit Scope(LoopProgress& progress);
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope();
  };
  /// As long as it lives, what this thread does is the share from `from` to `to` of what it did before; then this share is done.
  class Part {
   public:
    Part(double from, double to);
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;
    ~Part();

   private:
    double low_, high_;
  };
  /// As long as it lives, every loop of this thread takes the share on from its beginning to its end, turn by turn. Loops inside such a
  /// loop do not count.
  class Counted {
   public:
    Counted();
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
    ~Counted();

   private:
    bool outer_;
  };
  /// A stage begins, from one share of all the work to another. `name` must live as long as the program.
  void enter(const char* name, double from, double to);
  double share() const { return share_.load(std::memory_order_relaxed); }
  const char* stage() const { return stage_.load(std::memory_order_relaxed); }
  /// Raises the share.
  void reach(double share);
  /// What the loops of this thread are part of; null if nobody asks.
  static LoopProgress* current();

 private:
  std::atomic<double> share_ = 0;
  std::atomic<const char*> stage_ = "";
};

/// parallelBlocks and parallelInOrder without types.
void runBlocks(size_t count, size_t grain, FunctionRef<void(size_t begin, size_t end)> body);
void runInOrder(size_t chunks, size_t slots, FunctionRef<void(size_t chunk)> work, FunctionRef<void(size_t chunk)> add);

#endif

/// Calls body(begin, end) for blocks that together are [first, last). A block of `grain` or fewer is not split.
template <class Index, class Body>
void parallelBlocks(Index first, Index last, [[maybe_unused]] size_t grain, const Body& body) {
  if (!(first < last)) return;
#ifdef CLOUDBAKE_SERIAL
  body(first, last);
#else
  runBlocks(size_t(last - first), grain, [&](size_t begin, size_t end) { body(Index(first + Index(begin)), Index(first + Index(end))); });
#endif
}
template <class Body>
void parallelBlocks(size_t count, size_t grain, const Body& body) {
  parallelBlocks(size_t(0), count, grain, body);
}

/// Calls body(i) for every i in [first, last).
template <class Index, class Body>
void parallelFor(Index first, Index last, const Body& body) {
#ifdef CLOUDBAKE_SERIAL
  for (Index i = first; i < last; ++i) body(i);
#else
  parallelBlocks(first, last, 1, [&body, stop = LoopStop::current()](Index begin, Index end) {
    for (Index i = begin; i < end && !(stop && stop->isRequested()); ++i) body(i);
  });
#endif
}
template <class Index, class Body>
void parallelFor(Index count, const Body& body) {
  parallelFor(Index(0), count, body);
}

/// Calls body(i) for every i below `count`, also after one has thrown. Then it throws what the first one by number has thrown, so that the
/// error is the same for any number of threads.
template <class Body>
void parallelForAll(size_t count, const Body& body) {
  std::vector<std::exception_ptr> errors(count);
  parallelFor(count, [&](size_t i) {
    try {
      body(i);
    } catch (...) {
      errors[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
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
  runInOrder(
      chunks, slots.size(), [&](size_t chunk) { work(chunk, slots[chunk % slots.size()]); },
      [&](size_t chunk) { add(slots[chunk % slots.size()]); });
#endif
}

}  // namespace cloudbake
