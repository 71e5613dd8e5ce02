#ifndef CLOUDBAKE_SERIAL
#include "core/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

namespace cloudbake {

namespace {

constexpr auto kParallelism = tbb::global_control::max_allowed_parallelism;

thread_local const LoopStop* t_stop = nullptr;

bool isStopped(const LoopStop* stop) { return stop && stop->isRequested(); }

// Where the work of this thread is.
struct Place {
  LoopProgress* progress = nullptr;
  double low = 0, high = 1;
  bool counts = false;
};
thread_local Place t_place;

// Counts the turns of one loop if it is to be counted.
class TurnCounter {
 public:
  explicit TurnCounter(size_t count) : place_(t_place), count_(count) { t_place.counts = false; }
  TurnCounter(const TurnCounter&) = delete;
  TurnCounter& operator=(const TurnCounter&) = delete;
  ~TurnCounter() { t_place.counts = place_.counts; }
  void add(size_t turns) {
    if (!place_.counts || !place_.progress) return;
    const size_t done = done_.fetch_add(turns, std::memory_order_relaxed) + turns;
    place_.progress->reach(place_.low + (place_.high - place_.low) * double(done) / double(count_));
  }

 private:
  const Place place_;
  const size_t count_;
  std::atomic<size_t> done_ = 0;
};

}  // namespace

size_t threadCount() { return std::min(tbb::global_control::active_value(kParallelism), size_t(tbb::this_task_arena::max_concurrency())); }

struct ThreadLimit::Limit {
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads)
    : limit_(new Limit{{kParallelism, threads > 0 ? size_t(threads) : tbb::global_control::active_value(kParallelism)}}) {}
ThreadLimit::~ThreadLimit() = default;

LoopStop::Scope::Scope(const LoopStop& stop) : outer_(t_stop) { t_stop = &stop; }
LoopStop::Scope::~Scope() { t_stop = outer_; }
const LoopStop* LoopStop::current() { return t_stop; }

void throwIfLoopsStop() {
  if (t_stop) t_stop->throwIfRequested();
}

LoopProgress::Scope::Scope(LoopProgress& progress) { t_place = {&progress}; }
LoopProgress::Scope::~Scope() { t_place = {}; }
LoopProgress::Part::Part(double from, double to) : low_(t_place.low), high_(t_place.high) {
  t_place.low = low_ + (high_ - low_) * from;
  t_place.high = low_ + (high_ - low_) * to;
}
LoopProgress::Part::~Part() {
  if (t_place.progress) t_place.progress->reach(t_place.high);
  t_place.low = low_, t_place.high = high_;
}
LoopProgress::Counted::Counted() : outer_(t_place.counts) { t_place.counts = true; }
LoopProgress::Counted::~Counted() { t_place.counts = outer_; }
void LoopProgress::enter(const char* name, double from, double to) {
  t_place.low = from, t_place.high = to;
  reach(from);
  stage_.store(name, std::memory_order_relaxed);
}
void LoopProgress::reach(double share) {
  double old = share_.load(std::memory_order_relaxed);
  while (old < share && !share_.compare_exchange_weak(old, share, std::memory_order_relaxed)) {
  }
}
LoopProgress* LoopProgress::current() { return t_place.progress; }

void runBlocks(size_t count, size_t grain, FunctionRef<void(size_t, size_t)> body) {
  const LoopStop* stop = t_stop;
  TurnCounter counter(count);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, grain), [&](const tbb::blocked_range<size_t>& range) {
    if (isStopped(stop)) return;
    body(range.begin(), range.end());
    counter.add(range.size());
  });
  if (isStopped(stop)) throw LoopStopped();
}

void runInOrder(size_t chunks, size_t slots, FunctionRef<void(size_t)> work, FunctionRef<void(size_t)> add) {
  const LoopStop* stop = t_stop;
  TurnCounter counter(chunks);
  size_t next = 0;
  const auto hand_out = [&](tbb::flow_control& control) {
    if (next == chunks || isStopped(stop)) control.stop();
    return next++;
  };
  const auto do_work = [&](size_t chunk) {
    work(chunk);
    return chunk;
  };
  const auto do_add = [&](size_t chunk) {
    add(chunk);
    counter.add(1);
  };
  tbb::parallel_pipeline(slots, tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order, hand_out) &
                                    tbb::make_filter<size_t, size_t>(tbb::filter_mode::parallel, do_work) &
                                    tbb::make_filter<size_t, void>(tbb::filter_mode::serial_in_order, do_add));
  if (isStopped(stop)) throw LoopStopped();
}

}  // namespace cloudbake
#endif
