#include "pipeline/batch/schedule.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

#include "core/parallel.h"
#include "tests/pipeline/batch/batch_helpers.h"
#include "tests/wait.h"

namespace cloudbake {
namespace {

constexpr uint64_t kPlenty = 1 << 30;

struct Watch {
  std::mutex mutex;
  std::vector<size_t> order;
  uint64_t memory = 0, most_memory = 0;
  size_t running = 0, most_running = 0;

  void begin(size_t i, uint64_t bytes) {
    const std::lock_guard lock(mutex);
    order.push_back(i);
    most_memory = std::max(most_memory, memory += bytes);
    most_running = std::max(most_running, ++running);
  }
  void end(uint64_t bytes) {
    const std::lock_guard lock(mutex);
    memory -= bytes;
    --running;
  }
};

// The first jobs wait until as many as `together` run at once.
void runWatched(const std::vector<Job>& jobs, uint64_t memory, Watch& watch, size_t together = 1) {
  const std::atomic<int> stop{0};
  Meeting meeting(together);
  runJobs(jobs, memory, stop, [&](size_t i) {
    watch.begin(i, jobs[i].memory);
    EXPECT_TRUE(meeting.come()) << "job " << i << " stays alone";
    tbb::parallel_for(0, 64, [](int) { spin(10'000); });
    watch.end(jobs[i].memory);
  });
}

TEST(ScheduleTest, ThreadsAreThoseOfTheLimitAndOfTheArena) {
  tbb::task_arena one(1), two(2);
  EXPECT_EQ(one.execute([] { return threadCount(); }), 1U);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(two.execute([] { return threadCount(); }), 1U);
}

TEST(ScheduleTest, EveryJobRunsOnceAndNoMoreAtOnceThanThreads) {
  std::vector<Job> jobs(100, {1, 1});
  Watch watch;
  withThreads(4, [&] { runWatched(jobs, kPlenty, watch, 2); });
  std::sort(watch.order.begin(), watch.order.end());
  std::vector<size_t> all(jobs.size());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(watch.order, all);
  EXPECT_LE(watch.most_running, 4U);
  EXPECT_GE(watch.most_running, 2U);
}

TEST(ScheduleTest, MemoryIsKept) {
  std::vector<Job> jobs;
  for (uint64_t i = 0; i < 60; ++i) jobs.push_back({double(i % 7), 10 + i % 25});
  Watch watch;
  withThreads(4, [&] { runWatched(jobs, 50, watch, 2); });
  EXPECT_EQ(watch.order.size(), jobs.size());
  EXPECT_LE(watch.most_memory, 50U);
  EXPECT_GE(watch.most_running, 2U);
}

TEST(ScheduleTest, WhatFitsNowhereRunsAlone) {
  const std::vector<Job> jobs{{1, 10}, {2, 1000}, {1, 10}, {1, 10}};
  Watch watch;
  withThreads(4, [&] { runWatched(jobs, 50, watch); });
  EXPECT_EQ(watch.order.size(), jobs.size());
  EXPECT_EQ(watch.most_memory, 1000U);
}

TEST(ScheduleTest, TheDearestGoesFirst) {
  const std::vector<Job> jobs{{1, 1}, {3, 1}, {2, 1}, {9, 1}};
  Watch watch;
  withThreads(1, [&] { runWatched(jobs, kPlenty, watch); });
  EXPECT_EQ(watch.order, (std::vector<size_t>{3, 1, 2, 0}));
}

TEST(ScheduleTest, NoneBeginsAfterStop) {
  const std::vector<Job> jobs(50, {1, 1});
  std::atomic<int> stop{0}, begun{0};
  withThreads(2, [&] {
    runJobs(jobs, kPlenty, stop, [&](size_t) {
      const int number = ++begun;
      if (number == 10) stop = 2;
      if (number > 10) {
        EXPECT_TRUE(comesTrue([&] { return stop != 0; }));
      }
    });
  });
  EXPECT_GE(begun, 10);
  EXPECT_LE(begun, 12);
}

// A thread that waits for the inner loop of a job must not take up another job: it would nest, with its memory on top.
TEST(ScheduleTest, JobsDoNotNest) {
  const std::vector<Job> jobs(3000, {1, 1});
  const std::atomic<int> stop{0};
  std::atomic<int> nested{0};
  thread_local int depth = 0;
  withThreads(4, [&] {
    runJobs(jobs, kPlenty, stop, [&](size_t) {
      if (depth++ > 0) ++nested;
      tbb::parallel_for(
          0, 4, [](int) { std::this_thread::yield(); }, tbb::simple_partitioner());
      --depth;
    });
  });
  EXPECT_EQ(nested, 0);
}

}  // namespace
}  // namespace cloudbake
