// Sources: POSIX.1-2017; flock(2), whose locks end with their process, however that ends.
#include "io/file/system_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>

#include "io/file/descriptor.h"

namespace cloudbake {

namespace {

FileKind kindOfMode(mode_t mode) {
  if (S_ISREG(mode)) return FileKind::kFile;
  if (S_ISDIR(mode)) return FileKind::kFolder;
  if (S_ISFIFO(mode)) return FileKind::kPipe;
  if (S_ISSOCK(mode)) return FileKind::kSocket;
  return S_ISCHR(mode) ? FileKind::kCharacterDevice : FileKind::kDevice;
}

// The answer of a call of the stat family.
std::optional<FileStatus> statusFrom(int outcome, const struct stat& status) {
  if (outcome != 0) return std::nullopt;
  constexpr int64_t kPerSecond = 1'000'000'000;
  return FileStatus{.kind = kindOfMode(status.st_mode),
                    .device = uint64_t(status.st_dev),
                    .number = uint64_t(status.st_ino),
                    .size = uint64_t(status.st_size),
                    .changed = status.st_mtim.tv_sec * kPerSecond + status.st_mtim.tv_nsec,
                    .permissions = uint32_t(status.st_mode & 07777),
                    .names = uint64_t(status.st_nlink),
                    .is_own = status.st_uid == ::geteuid()};
}

int failureOf(int outcome) { return outcome == 0 ? 0 : errno; }

}  // namespace

std::optional<FileStatus> statusOf(const std::filesystem::path& path) {
  struct stat status {};
  const int outcome = ::stat(path.c_str(), &status);
  return statusFrom(outcome, status);
}

std::optional<FileStatus> statusOfName(const std::filesystem::path& path) {
  struct stat status {};
  const int outcome = ::lstat(path.c_str(), &status);
  return statusFrom(outcome, status);
}

std::optional<FileStatus> statusOf(int descriptor) {
  struct stat status {};
  const int outcome = ::fstat(descriptor, &status);
  return statusFrom(outcome, status);
}

int whyNotWritable(const std::filesystem::path& path) { return failureOf(::access(path.c_str(), W_OK)); }

int openToRead(const std::filesystem::path& path, bool may_wait) {
  return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | (may_wait ? 0 : O_NONBLOCK));
}

int openToWrite(const std::filesystem::path& path) { return ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY); }

int openNew(const std::filesystem::path& path, uint32_t permissions) {
  return ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode_t(permissions));
}

int openNamed(const std::filesystem::path& path) { return ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC); }

int openLockFile(const std::filesystem::path& path) { return ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666); }

int lockNow(int descriptor, LockKind kind) {
  while (::flock(descriptor, (kind == LockKind::kShared ? LOCK_SH : LOCK_EX) | LOCK_NB) != 0)
    if (errno != EINTR) return errno;
  return 0;
}

int setPermissions(int descriptor, uint32_t permissions) { return failureOf(::fchmod(descriptor, mode_t(permissions))); }

int syncFile(int descriptor) { return failureOf(::fsync(descriptor)); }

// Some file systems cannot do that (EINVAL); a rename is still valid then.
int syncFolder(const std::filesystem::path& folder) {
  const Descriptor directory(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  const int failure = directory.number < 0 ? 0 : failureOf(::fsync(directory.number));
  return failure == EINVAL ? 0 : failure;
}

int renameFile(const std::filesystem::path& from, const std::filesystem::path& to) {
  return failureOf(std::rename(from.c_str(), to.c_str()));
}

void removeName(const char* path) noexcept { ::unlink(path); }

std::string hostName() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

}  // namespace cloudbake
