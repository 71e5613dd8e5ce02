// Jobs in parallel, as many at once as threads and memory allow.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace cloudbake {

/// Threads that loops may use here: what the arena has and --threads allows.
size_t threadCount();

struct Job {
  double cost_seconds = 0;  ///< the dearest goes first
  uint64_t memory = 0;      ///< bytes, at most
};

/// Runs `body(i)` for every job, from threads of the calling TBB arena; no more at once than it has threads, or than fit into `memory`
/// together. A job that alone does not fit runs alone. Loops inside a job spread over threads that are idle, and a thread that waits in one
/// takes up no other job. Once `stop` is set, no job is started. `body` must not throw.
void runJobs(std::span<const Job> jobs, uint64_t memory, const std::atomic<int>& stop, const std::function<void(size_t)>& body);

}  // namespace cloudbake
