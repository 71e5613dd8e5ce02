#include "core/memory_budget.h"

#include <fmt/format.h>

#include <algorithm>

namespace cloudbake {

namespace fs = std::filesystem;

std::string memoryText(double bytes) {
  if (bytes >= kGiB) return fmt::format("{:.{}f} GiB", bytes / kGiB, bytes < 100 * kGiB ? 1 : 0);
  if (bytes >= 1 << 20) return fmt::format("{:.0f} MiB", bytes / (1 << 20));
  return fmt::format("{:.0f} kB", bytes / 1000);
}

std::string countText(double count) { return count < 1e15 ? fmt::format("{:.0f}", count) : fmt::format("{:.3g}", count); }

void requireMemory(const MemoryNeed& need, uint64_t limit, const std::string& file) { requireMemory(std::span(&need, 1), limit, file); }

void requireMemory(std::span<const MemoryNeed> needs, uint64_t limit, const std::string& file) {
  double bytes = 0;
  for (const MemoryNeed& need : needs) bytes += need.bytes;
  if (bytes <= double(limit)) return;
  const MemoryNeed& largest =
      *std::max_element(needs.begin(), needs.end(), [](const MemoryNeed& a, const MemoryNeed& b) { return a.bytes < b.bytes; });
  const std::string beside = bytes > largest.bytes ? ", and " + memoryText(bytes) + " with what is needed beside it" : "";
  throw MemoryError(file, fmt::format("{} would take about {} of memory{}, over the limit of {} (--memory): {}", largest.what,
                                      memoryText(largest.bytes), beside, memoryText(double(limit)), largest.cure));
}

void requireMemoryForFile(const fs::path& file, uint64_t limit) {
  std::error_code none;  // its reader reports what is wrong
  const auto bytes = double(fs::file_size(file, none));
  if (!none) requireMemory({"reading its " + countText(bytes) + " bytes", 2 * bytes, "use a smaller file"}, limit, file.string());
}

MemoryError outOfMemory(const std::string& stage, const std::string& cure, const AllocationFailure* failure) {
  std::string text = "not enough memory for " + stage;
  if (failure)
    text += fmt::format(": {} more were asked for when {} were taken, {}", memoryText(double(failure->asked)),
                        memoryText(double(failure->taken)),
                        failure->allowed == kNoMemoryLimit ? "and the system has no more"
                                                           : "of at most " + memoryText(double(failure->allowed)) + " (--memory)");
  return {"", text + ": " + cure};
}

}  // namespace cloudbake
