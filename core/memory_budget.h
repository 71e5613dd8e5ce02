// How much memory a run may take, and the one place that refuses more. Sizes are estimated before memory is taken for them, and an
// allocation that fails all the same is reported with what it was for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <new>
#include <span>
#include <string>

#include "core/error.h"

namespace cloudbake {

/// The limit of settings for which no front end has set one, bytes.
inline constexpr uint64_t kMemoryLimit = 8ULL << 30;
inline constexpr double kGiB = 1 << 30;

/// Three quarters of what this process may take, bytes: of the least of what the machine has, its control group allows, and `ulimit`
/// leaves. `root` is where /proc and /sys are.
uint64_t defaultMemoryLimit(const std::filesystem::path& root = "/");

/// A limit that there is not.
inline constexpr uint64_t kNoMemoryLimit = std::numeric_limits<uint64_t>::max();

/// Bytes of data that this process has taken; 0 if the system does not say.
uint64_t memoryTaken();
/// The most that it may take by its own limits (setrlimit(2)); kNoMemoryLimit if there is none.
uint64_t memoryAllowed();

/// "2.5 GiB", "20 MiB", "3 kB".
std::string memoryText(double bytes);
/// A count that was asked for, all digits of it: "100000"; "1e+20" for one that no machine could hold.
std::string countText(double count);

/// Something that takes memory.
struct MemoryNeed {
  std::string what;  ///< with its number: "a picture of 4096x4096 pixels"
  double bytes = 0;  ///< estimated
  std::string cure;  ///< which option or key to lower
};
/// Throws MemoryError, of `file` if there is one, if it needs more than `limit` bytes.
void requireMemory(const MemoryNeed& need, uint64_t limit, const std::string& file = "");
/// The same for all that is needed at the same time. The error names the largest of them.
void requireMemory(std::span<const MemoryNeed> needs, uint64_t limit, const std::string& file = "");

/// The same for reading a whole file, which takes at least twice its size.
void requireMemoryForFile(const std::filesystem::path& file, uint64_t limit);

/// Memory that was asked for and refused. The numbers are those of that moment, because memory is freed before anybody catches the error.
struct AllocationFailure : std::bad_alloc {
  explicit AllocationFailure(size_t bytes) : asked(bytes), taken(memoryTaken()), allowed(memoryAllowed()) {}
  const char* what() const noexcept override { return "not enough memory"; }
  uint64_t asked, taken, allowed;  ///< bytes
};
/// The error for memory that ran out in a stage, with the numbers if they are known. `cure` says what needs less.
MemoryError outOfMemory(const std::string& stage, const std::string& cure, const AllocationFailure* failure = nullptr);

/// Runs `body`, a stage of a run. Memory that runs out in it becomes outOfMemory.
template <class Body>
auto inStage(const char* stage, const char* cure, const Body& body) {
  try {
    return body();
  } catch (const AllocationFailure& failure) {
    throw outOfMemory(stage, cure, &failure);
  } catch (const std::bad_alloc&) {
    throw outOfMemory(stage, cure);
  }
}

}  // namespace cloudbake
