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

void runBlocks(size_t count, size_t grain, FunctionRef<void(size_t, size_t)> body) {
  const LoopStop* stop = t_stop;
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, grain), [&body, stop](const tbb::blocked_range<size_t>& range) {
    if (!isStopped(stop)) body(range.begin(), range.end());
  });
  if (isStopped(stop)) throw LoopStopped();
}

void runInOrder(size_t chunks, size_t slots, FunctionRef<void(size_t)> work, FunctionRef<void(size_t)> add) {
  const LoopStop* stop = t_stop;
  size_t next = 0;
  const auto hand_out = [&](tbb::flow_control& control) {
    if (next == chunks || isStopped(stop)) control.stop();
    return next++;
  };
  const auto do_work = [&](size_t chunk) {
    work(chunk);
    return chunk;
  };
  const auto do_add = [&](size_t chunk) { add(chunk); };
  tbb::parallel_pipeline(slots, tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order, hand_out) &
                                    tbb::make_filter<size_t, size_t>(tbb::filter_mode::parallel, do_work) &
                                    tbb::make_filter<size_t, void>(tbb::filter_mode::serial_in_order, do_add));
  if (isStopped(stop)) throw LoopStopped();
}

}  // namespace cloudbake
#endif
