// How much memory a run may take, read from systems that are made up, and what is refused.
#include "core/memory_budget.h"

#include <gtest/gtest.h>

#include <cmath>

#include <array>
#include <fstream>

using namespace cloudbake;

namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMiB = 1 << 20;

// A file system with the files of /proc and /sys that are given.
struct System {
  fs::path root = fs::path(testing::TempDir()) / "memory_budget_system";
  System() { fs::remove_all(root); }
  ~System() { fs::remove_all(root); }
  System& add(const fs::path& file, const std::string& text) {
    fs::create_directories((root / file).parent_path());
    std::ofstream(root / file) << text;
    return *this;
  }
  System& machine(uint64_t all) {
    return add("proc/meminfo", "Odd: 7 kB\nMemTotal:       " + std::to_string(all / 1024) + " kB\nMemFree:  1 kB\nMemAvailable: 2 kB\n");
  }
};

std::string refusalOf(const MemoryNeed& need, uint64_t limit, const std::string& file = "") {
  try {
    requireMemory(need, limit, file);
  } catch (const MemoryError& error) {
    EXPECT_EQ(error.code, ExitCode::kInput);
    return error.what();
  }
  return "";
}

}  // namespace

TEST(MemoryBudget, IsThreeQuartersOfWhatTheMachineHas) { EXPECT_EQ(defaultMemoryLimit(System().machine(800 * kMiB).root), 600 * kMiB); }

TEST(MemoryBudget, IsWhatTheControlGroupAllows) {
  System second;
  second.machine(8000 * kMiB).add("proc/self/cgroup", "0::/jobs/one\n");
  second.add("sys/fs/cgroup/jobs/one/memory.max", "max\n").add("sys/fs/cgroup/jobs/memory.max", std::to_string(800 * kMiB));
  second.add("sys/fs/cgroup/jobs/memory.current", std::to_string(500 * kMiB));
  EXPECT_EQ(defaultMemoryLimit(second.root), 600 * kMiB) << "a group around it counts, and what it uses does not";

  System first;
  first.machine(8000 * kMiB).add("proc/self/cgroup", "9:cpu:/a\n4:memory:/a/b\n");
  first.add("sys/fs/cgroup/memory/a/b/memory.limit_in_bytes", std::to_string(800 * kMiB));
  EXPECT_EQ(defaultMemoryLimit(first.root), 600 * kMiB);

  System inside;  // a container whose group is its root
  inside.machine(8000 * kMiB).add("proc/self/cgroup", "0::/../elsewhere\n");
  inside.add("sys/fs/cgroup/memory.max", std::to_string(400 * kMiB));
  EXPECT_EQ(defaultMemoryLimit(inside.root), 300 * kMiB);
}

TEST(MemoryBudget, OfThisMachine) {
  EXPECT_GT(defaultMemoryLimit(), 16 * kMiB);
  EXPECT_GT(memoryTaken(), 100000U);
}

TEST(MemoryBudget, RefusesByNameWithTheNumbers) {
  EXPECT_EQ(refusalOf({"a heap of 5 things", 64.0 * kMiB, "use fewer things"}, 64 * kMiB), "");
  EXPECT_EQ(refusalOf({"a heap of 5 things", 65.0 * kMiB, "use fewer --things"}, 64 * kMiB, "a.glb"),
            "a.glb: a heap of 5 things would take about 65 MiB of memory, over the limit of 64 MiB (--memory): use fewer --things");
  EXPECT_NE(refusalOf({"a heap", NAN, "use less"}, 64 * kMiB), "") << "what cannot be estimated is not taken";
}

TEST(MemoryBudget, NamesTheLargestOfSeveral) {
  const std::array needs{MemoryNeed{"one", 30.0 * kMiB, "shrink one"}, MemoryNeed{"the other", 40.0 * kMiB, "shrink the other"}};
  requireMemory(needs, 70 * kMiB);
  try {
    requireMemory(needs, 69 * kMiB);
    FAIL();
  } catch (const MemoryError& error) {
    EXPECT_STREQ(
        error.what(),
        "the other would take about 40 MiB of memory, and 70 MiB with what is needed beside it, over the limit of 69 MiB (--memory): "
        "shrink the other");
  }
}

TEST(MemoryBudget, TextsOfSizesAndCounts) {
  EXPECT_EQ(memoryText(2900), "3 kB");
  EXPECT_EQ(memoryText(20.4 * kMiB), "20 MiB");
  EXPECT_EQ(memoryText(2.5 * kGiB), "2.5 GiB");
  EXPECT_EQ(memoryText(12345 * kGiB), "12345 GiB");
  EXPECT_EQ(countText(2000000000), "2000000000");
  EXPECT_EQ(countText(1e20), "1e+20");
}

TEST(MemoryBudget, AFailedAllocationNamesItsStageAndItsNumbers) {
  AllocationFailure failure(3ULL << 30);
  failure.taken = 100 * kMiB;
  failure.allowed = 1000 * kMiB;
  const auto run = [&](const auto& thrown) {
    try {
      inStage("the soup", "use a smaller bowl", [&]() -> int { throw thrown; });
    } catch (const MemoryError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(run(failure),
            "not enough memory for the soup: 3.0 GiB more were asked for when 100 MiB were taken, of at most 1000 MiB (--memory): use a "
            "smaller bowl");
  failure.allowed = std::numeric_limits<uint64_t>::max();
  EXPECT_EQ(
      run(failure),
      "not enough memory for the soup: 3.0 GiB more were asked for when 100 MiB were taken, and the system has no more: use a smaller "
      "bowl");
  EXPECT_EQ(run(std::bad_alloc()), "not enough memory for the soup: use a smaller bowl");
  EXPECT_EQ(inStage("the soup", "", [] { return 7; }), 7);
}

// The outer names do not replace the inner ones.
TEST(MemoryBudget, TheInnermostStageIsNamed) {
  try {
    inStage("a meal", "eat less", [] { inStage("the soup", "use a smaller bowl", []() -> int { throw std::bad_alloc(); }); });
    FAIL();
  } catch (const MemoryError& error) {
    EXPECT_STREQ(error.what(), "not enough memory for the soup: use a smaller bowl");
  }
}

TEST(MemoryBudget, NamingTheFileKeepsTheKind) {
  EXPECT_THROW(namingFile("a.obj", [] { requireMemory({"it", 2, "no"}, 1); }), MemoryError);
  try {
    namingFile("a.obj", [] { requireMemory({"it", 2, "no"}, 1); });
  } catch (const Error& error) {
    EXPECT_EQ(error.file, "a.obj");
  }
}
