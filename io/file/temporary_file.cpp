// The lock of a file ends with its process, however that ends. Where a file system has no locks, files are written without them,
// and nothing is ever taken for abandoned.
#include "io/file/temporary_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <random>
#include <string>
#include <utility>

#include "io/file/system_file.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr int kMostTries = 100;
constexpr size_t kLongestPath = 4096;

// The files of this process, where a signal handler finds them. A path is set before the file is made and cleared after it is gone.
struct Slot {
  std::atomic<bool> taken{false}, live{false};
  std::array<fs::path::value_type, kLongestPath> path{};
};
std::array<Slot, 64> slots;
static_assert(std::atomic<bool>::is_always_lock_free);

// The slot that now holds this path; −1 if there is none.
int takeSlot(const fs::path::string_type& path) {
  if (path.size() >= kLongestPath) return -1;
  for (size_t i = 0; i < slots.size(); ++i) {
    if (slots[i].taken.exchange(true)) continue;
    std::copy_n(path.c_str(), path.size() + 1, slots[i].path.data());
    slots[i].live = true;
    return int(i);
  }
  return -1;
}

void freeSlot(int slot) {
  if (slot < 0) return;
  slots[size_t(slot)].live = false;
  slots[size_t(slot)].taken = false;
}

// What the names of this machine's temporary files begin with. Nobody calls a file like this by chance.
std::string namePrefix() { return ".cloudbake-" + hashBytes("a temporary file of " + hostName()).substr(0, 8) + "-"; }

std::string newName() {
  std::random_device draw;
  return namePrefix() + fmt::format("{:08x}{:08x}", draw(), draw());
}

bool isTemporaryName(const std::string& name, const std::string& prefix) {
  return name.size() == prefix.size() + 16 && name.starts_with(prefix) &&
         name.find_first_not_of("0123456789abcdef", prefix.size()) == name.npos;
}

// Whether the path still leads to this open file.
bool isNamed(int file, const fs::path& path) {
  const auto ours = statusOf(file), named = statusOfName(path);
  return ours && named && ours->isSameFile(*named);
}

bool isAbandoned(int file, const fs::path& path) {
  const auto status = statusOf(file);
  return status && status->kind == FileKind::kFile && status->is_own && status->names == 1 && lockNow(file, LockKind::kExclusive) == 0 &&
         isNamed(file, path);
}

}  // namespace

TemporaryFile::TemporaryFile(const fs::path& folder, uint32_t permissions) {
  for (int i = 0; i < kMostTries; ++i) {
    path_ = folder / newName();
    slot_ = takeSlot(path_.native());
    file_.number = openNew(path_, permissions);
    error_ = file_.number < 0 ? errno : 0;
    if (error_ != 0 && error_ != EEXIST) break;
    // Before it was locked, another process may have locked it, taken it for abandoned and removed it.
    if (error_ == 0 && lockNow(file_.number, LockKind::kExclusive) != EWOULDBLOCK && isNamed(file_.number, path_)) return;
    forget();
  }
  if (error_ == 0) error_ = EAGAIN;
  freeSlot(std::exchange(slot_, -1));
}

TemporaryFile::~TemporaryFile() { forget(); }

void TemporaryFile::forget() {
  if (file_.number >= 0) removeName(path_.c_str());
  freeSlot(std::exchange(slot_, -1));
  file_.close();
}

int TemporaryFile::renameTo(const fs::path& target) {
  if (const int failure = renameFile(path_, target); failure != 0) return failure;
  freeSlot(std::exchange(slot_, -1));
  file_.close();
  return 0;
}

void removeAbandonedFiles(const fs::path& folder) {
  const std::string prefix = namePrefix();
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& path = entry->path();
    if (!isTemporaryName(path.filename().string(), prefix)) continue;
    const Descriptor file(openNamed(path));
    if (file.number >= 0 && isAbandoned(file.number, path)) removeName(path.c_str());
  }
}

void removeTemporaryFiles() noexcept {
  for (const Slot& slot : slots)
    if (slot.live) removeName(slot.path.data());
}

}  // namespace cloudbake
