// The lock is of flock(2): it ends with its process, however that ends. Where a file system has no locks, files are written without them,
// and nothing is ever taken for abandoned.
#include "io/file/temporary_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <random>
#include <string>
#include <utility>

#include "io/file/write_file.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr int kMostTries = 100;

// The files of this process, where a signal handler finds them. A path is set before the file is made and cleared after it is gone.
struct Slot {
  std::atomic<bool> taken{false}, live{false};
  std::array<char, PATH_MAX> path{};
};
std::array<Slot, 64> slots;
static_assert(std::atomic<bool>::is_always_lock_free);

// The slot that now holds this path; −1 if there is none.
int takeSlot(const std::string& path) {
  if (path.size() >= PATH_MAX) return -1;
  for (size_t i = 0; i < slots.size(); ++i) {
    if (slots[i].taken.exchange(true)) continue;
    std::memcpy(slots[i].path.data(), path.c_str(), path.size() + 1);
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
std::string namePrefix() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return ".cloudbake-" + hashBytes(std::string("a temporary file of ") + host.data()).substr(0, 8) + "-";
}

std::string newName() {
  std::random_device draw;
  return namePrefix() + fmt::format("{:08x}{:08x}", draw(), draw());
}

bool isTemporaryName(const std::string& name, const std::string& prefix) {
  return name.size() == prefix.size() + 16 && name.starts_with(prefix) &&
         name.find_first_not_of("0123456789abcdef", prefix.size()) == name.npos;
}

int lockNow(int file) {
  while (::flock(file, LOCK_EX | LOCK_NB) != 0)
    if (errno != EINTR) return errno;
  return 0;
}

// Whether the path still leads to this open file.
bool isNamed(int file, const fs::path& path) {
  struct stat ours {
  }, named{};
  return ::fstat(file, &ours) == 0 && ::lstat(path.c_str(), &named) == 0 && ours.st_dev == named.st_dev && ours.st_ino == named.st_ino;
}

bool isAbandoned(int file, const fs::path& path) {
  struct stat status {};
  return ::fstat(file, &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == ::geteuid() && status.st_nlink == 1 &&
         lockNow(file) == 0 && isNamed(file, path);
}

}  // namespace

TemporaryFile::TemporaryFile(const fs::path& folder, mode_t mode) {
  for (int i = 0; i < kMostTries; ++i) {
    path_ = folder / newName();
    slot_ = takeSlot(path_.string());
    file_.number = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    error_ = file_.number < 0 ? errno : 0;
    if (error_ != 0 && error_ != EEXIST) break;
    // Before it was locked, another process may have locked it, taken it for abandoned and removed it.
    if (error_ == 0 && lockNow(file_.number) != EWOULDBLOCK && isNamed(file_.number, path_)) return;
    forget();
  }
  if (error_ == 0) error_ = EAGAIN;
  freeSlot(std::exchange(slot_, -1));
}

TemporaryFile::~TemporaryFile() { forget(); }

void TemporaryFile::forget() {
  if (file_.number >= 0) ::unlink(path_.c_str());
  freeSlot(std::exchange(slot_, -1));
  file_.close();
}

int TemporaryFile::renameTo(const fs::path& target) {
  if (::rename(path_.c_str(), target.c_str()) != 0) return errno;
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
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    if (file.number >= 0 && isAbandoned(file.number, path)) ::unlink(path.c_str());
  }
}

void removeTemporaryFiles() noexcept {
  for (const Slot& slot : slots)
    if (slot.live) ::unlink(slot.path.data());
}

}  // namespace cloudbake
