// /proc/meminfo and /proc/self/statm: proc(5). Control groups: Documentation/admin-guide/cgroup-v2.rst and cgroup-v1/memory.rst of Linux.
// What other programs use at the moment does not count, so that the same run is refused today and tomorrow.
#include "core/memory_budget.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// The number behind a word of a file of words and numbers, or the first number for no word.
std::optional<uint64_t> numberIn(const fs::path& file, const std::string& word) {
  std::ifstream in(file);
  std::string found;
  uint64_t number = 0;
  while (!word.empty() && in >> found && found != word) continue;
  if (in >> number) return number;
  return std::nullopt;
}

uint64_t difference(uint64_t all, uint64_t part) { return all > part ? all - part : 0; }

// The limit of the process's group and of those around it. A container may see its own group as the root.
uint64_t limitOfGroups(const fs::path& root) {
  uint64_t limit = kNoMemoryLimit;
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {  // "4:memory:/path" in version 1, "0::/path" in version 2
    const size_t second = line.find(':', line.find(':') + 1);
    if (second == std::string::npos) continue;
    const std::string kind = line.substr(line.find(':'), second - line.find(':') + 1);
    const bool is_first = kind == ":memory:", is_second = kind == "::";
    if (!is_first && !is_second) continue;
    const fs::path top = root / (is_first ? "sys/fs/cgroup/memory" : "sys/fs/cgroup");
    for (fs::path path = fs::path(line.substr(second + 1)).relative_path();; path = path.parent_path()) {
      // The root has no such file, and "max" is no number.
      limit = std::min(limit, numberIn(top / path / (is_first ? "memory.limit_in_bytes" : "memory.max"), "").value_or(kNoMemoryLimit));
      if (path.empty()) break;
    }
  }
  return limit;
}

// WebAssembly, which has no /proc, has 4 GiB.
uint64_t memoryOfMachine(const fs::path& root) {
  const auto kilobytes = numberIn(root / "proc/meminfo", "MemTotal:");
  return kilobytes ? *kilobytes * 1024 : 4ULL << 30;
}

// Fields of /proc/self/statm, in pages: 0 is the address space, 5 the data. Read without memory, because there may be none left.
uint64_t statm(int field) {
  char text[256] = {};
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  const bool is_read = ::read(file, text, sizeof text - 1) > 0;
  ::close(file);
  uint64_t pages = 0;
  char* rest = text;
  for (int i = 0; i <= field && is_read; ++i) pages = std::strtoull(rest, &rest, 10);
  return pages * uint64_t(::sysconf(_SC_PAGESIZE));
}

uint64_t softLimit(int resource) {
  rlimit limit{};
  return ::getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY ? limit.rlim_cur : kNoMemoryLimit;
}

}  // namespace

uint64_t defaultMemoryLimit(const fs::path& root) {
  const uint64_t addresses = softLimit(RLIMIT_AS), data = softLimit(RLIMIT_DATA);
  uint64_t left = std::min(memoryOfMachine(root), limitOfGroups(root));
  if (addresses != kNoMemoryLimit) left = std::min(left, difference(addresses, statm(0)));
  if (data != kNoMemoryLimit) left = std::min(left, difference(data, memoryTaken()));
  return left / 4 * 3;
}

uint64_t memoryTaken() { return statm(5); }

uint64_t memoryAllowed() { return std::min(softLimit(RLIMIT_AS), softLimit(RLIMIT_DATA)); }

}  // namespace cloudbake
