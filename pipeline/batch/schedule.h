// Runs jobs in parallel, as many at once as threads and memory allow.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace cloudbake {

struct Job {
  double cost_seconds = 0;  ///< the most expensive job goes first
  uint64_t memory = 0;      ///< bytes, at most
};

/// Runs `body(i)` for every job on threads of the calling TBB arena, with no more jobs at once than the arena has threads or than fit into
/// `memory` together. A job that does not fit by itself runs alone. Loops inside a job use idle threads, and a thread that waits in such a
/// loop does not start another job. Once `stop` is set, no job is started. `body` must not throw.
void runJobs(std::span<const Job> jobs, uint64_t memory, const std::atomic<int>& stop, const std::function<void(size_t)>& body);

}  // namespace cloudbake
