// Loops meet every turn once, and results come in order, however many threads there are.
#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <numeric>
#include <thread>
#include <vector>

#include "core/parallel_sort.h"

namespace cloudbake {
namespace {

TEST(Parallel, LoopsMeetEveryTurnOnce) {
  for (const size_t count : {0, 1, 7, 1000}) {
    std::vector<std::atomic<int>> met(count);
    parallelFor(count, [&](size_t i) { ++met[i]; });
    parallelBlocks(count, 16, [&](size_t begin, size_t end) {
      EXPECT_LT(begin, end);
      for (size_t i = begin; i < end; ++i) ++met[i];
    });
    for (const auto& times : met) EXPECT_EQ(times, 2);
  }
  std::atomic<int> sum = 0;
  parallelFor(3, 6, [&](int i) { sum += i; });
  parallelBlocks(-2, 2, 1, [&](int begin, int end) { sum += 100 * (end - begin); });
  EXPECT_EQ(sum, 3 + 4 + 5 + 400);
}

// A block that need not be split is not.
TEST(Parallel, SmallRangesAreOneBlock) {
  std::atomic<int> blocks = 0;
  parallelBlocks(16, 16, [&](size_t begin, size_t end) { blocks += begin == 0 && end == 16; });
  EXPECT_EQ(blocks, 1);
}

TEST(Parallel, ChunksAreAddedInOrder) {
  for (const size_t slot_count : {1, 3, 8})
    for (const size_t chunks : {0, 1, 2, 100}) {
      std::vector<size_t> slots(slot_count), added;
      std::atomic<size_t> in_progress = 0, most = 0;
      parallelInOrder(
          chunks, std::span(slots),
          [&](size_t chunk, size_t& slot) {
            const size_t now = ++in_progress;
            for (size_t seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
            }
            slot = chunk * chunk;
          },
          [&](const size_t& slot) {
            added.push_back(slot);
            --in_progress;
          });
      ASSERT_EQ(added.size(), chunks);
      for (size_t chunk = 0; chunk < chunks; ++chunk) EXPECT_EQ(added[chunk], chunk * chunk);
      EXPECT_LE(most, slot_count);
    }
}

TEST(Parallel, SortsByTheOrderThatIsGiven) {
  std::vector<int> values(10'000);
  std::iota(values.begin(), values.end(), 0);
  for (size_t i = 0; i < values.size(); ++i) std::swap(values[i], values[i * 7919 % values.size()]);
  parallelSort(values.begin(), values.end(), std::greater{});
  for (size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], int(values.size() - 1 - i));
}

// After a stop no turn begins, and every kind of loop throws, also inside others. Other threads are not concerned.
TEST(Parallel, LoopsAreStopped) {
  LoopStop stop;
  std::atomic<int> turns = 0;
  const auto begin = [&] {
    if (++turns == 3) stop.request();
  };
  {
    const LoopStop::Scope scope(stop);
    EXPECT_THROW(parallelFor(1'000'000, [&](int) { begin(); }), LoopStopped);
    EXPECT_LT(turns, 1'000'000);
    turns = 0;
    EXPECT_THROW(parallelBlocks(100, 1, [&](size_t, size_t) { begin(); }), LoopStopped);
    std::vector<int> slots(2);
    EXPECT_THROW(parallelInOrder(
                     100, std::span(slots), [&](size_t, int&) { begin(); }, [&](const int&) { begin(); }),
                 LoopStopped);
    EXPECT_EQ(turns, 0);
    std::thread([&] { parallelFor(5, [&](int) { ++turns; }); }).join();
    EXPECT_EQ(turns, 5);
  }
  parallelFor(5, [&](int) { ++turns; });
  EXPECT_EQ(turns, 10);

  LoopStop inner;
  const LoopStop::Scope scope(inner);
  const auto nested = [&](int i) {
    if (i == 3) inner.request();
    parallelFor(2, [](int) {});
  };
  EXPECT_THROW(parallelFor(100, nested), LoopStopped);
}

// Only counted loops move the share, each within its part; loops inside of them, and those of other threads, do not. It never falls.
TEST(Parallel, ProgressIsThatOfCountedLoops) {
  LoopProgress progress;
  const auto nested = [](int) { parallelFor(10, [](int) {}); };
  {
    const LoopProgress::Scope scope(progress);
    progress.enter("first", 0, 0.5);
    parallelFor(10, [](int) {});
    EXPECT_EQ(progress.share(), 0);
    {
      const LoopProgress::Part half(0, 0.5);
      const LoopProgress::Counted counted;
      std::atomic<double> most = 0;
      std::vector<int> slots(2);
      parallelInOrder(
          4, std::span(slots), [](size_t, int&) {},
          [&, chunk = std::make_shared<int>(0)](const int&) {
            EXPECT_DOUBLE_EQ(progress.share(), 0.0625 * *chunk);
            ++*chunk;
            most = progress.share();
          });
      EXPECT_DOUBLE_EQ(most, 0.1875);
      EXPECT_DOUBLE_EQ(progress.share(), 0.25);
      parallelFor(10, nested);
      EXPECT_DOUBLE_EQ(progress.share(), 0.25);
    }
    {
      const LoopProgress::Part rest(0.5, 1);
      EXPECT_DOUBLE_EQ(progress.share(), 0.25);
    }
    EXPECT_DOUBLE_EQ(progress.share(), 0.5);
    progress.enter("second", 0.5, 1);
    EXPECT_STREQ(progress.stage(), "second");
    const LoopProgress::Counted counted;
    std::thread([&] { parallelFor(5, [](int) {}); }).join();
    EXPECT_DOUBLE_EQ(progress.share(), 0.5);
    parallelBlocks(100, 1, [](size_t, size_t) {});
    EXPECT_DOUBLE_EQ(progress.share(), 1);
    progress.reach(0.7);
    EXPECT_DOUBLE_EQ(progress.share(), 1);
  }
  EXPECT_EQ(LoopProgress::current(), nullptr);
}

TEST(Parallel, OtherWorkAsksWhetherItStops) {
  throwIfLoopsStop();
  LoopStop stop;
  const LoopStop::Scope scope(stop);
  throwIfLoopsStop();
  stop.request();
  EXPECT_THROW(throwIfLoopsStop(), LoopStopped);
}

TEST(Parallel, ALimitHoldsAsLongAsItLives) {
  const size_t all = threadCount();
  {
    const ThreadLimit one(1);
    EXPECT_EQ(threadCount(), 1U);
    const ThreadLimit none(0);
    EXPECT_EQ(threadCount(), 1U);
  }
  EXPECT_EQ(threadCount(), all);
}

}  // namespace
}  // namespace cloudbake
