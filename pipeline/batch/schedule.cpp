// The thread that ends a job starts the jobs that now fit, so that no thread blocks while it waits for memory. Isolation keeps a thread
// that waits for the inner loop of one job from starting another job, whose memory and stack would come on top (oneTBB, "Work Isolation").
#include "pipeline/batch/schedule.h"

#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <vector>

#include "core/parallel.h"

namespace cloudbake {

namespace {

class Schedule {
 public:
  Schedule(std::span<const Job> jobs, uint64_t memory, const std::atomic<int>& stop, const std::function<void(size_t)>& body)
      : jobs_(jobs), memory_(memory), stop_(stop), body_(body), waiting_(jobs.size()) {
    std::iota(waiting_.begin(), waiting_.end(), 0);
    std::stable_sort(waiting_.begin(), waiting_.end(), [&](size_t a, size_t b) { return jobs_[a].cost_seconds > jobs_[b].cost_seconds; });
  }

  void run() {
    startWhatFits();
    group_.wait();
  }

 private:
  void startWhatFits() {
    const std::lock_guard lock(mutex_);
    for (auto next = waiting_.begin(); next != waiting_.end() && stop_ == 0 && running_ < threads_;) {
      const size_t i = *next;
      if (running_ > 0 && taken_ + jobs_[i].memory > memory_) {
        ++next;
        continue;
      }
      next = waiting_.erase(next);
      taken_ += jobs_[i].memory;
      ++running_;
      group_.run([this, i] {
        tbb::this_task_arena::isolate([&] { body_(i); });
        end(i);
      });
    }
  }

  void end(size_t i) {
    {
      const std::lock_guard lock(mutex_);
      taken_ -= jobs_[i].memory;
      --running_;
    }
    startWhatFits();
  }

  std::span<const Job> jobs_;
  const uint64_t memory_;
  const std::atomic<int>& stop_;
  const std::function<void(size_t)>& body_;
  std::vector<size_t> waiting_;
  const size_t threads_ = threadCount();
  uint64_t taken_ = 0;
  size_t running_ = 0;
  std::mutex mutex_;
  tbb::task_group group_;
};

}  // namespace

void runJobs(std::span<const Job> jobs, uint64_t memory, const std::atomic<int>& stop, const std::function<void(size_t)>& body) {
  Schedule(jobs, memory, stop, body).run();
}

}  // namespace cloudbake
