// A file is replaced atomically, as POSIX allows it: create a temporary file in the same folder, write, fsync, rename, fsync the
// folder (rename(2); T. Pillai et al., "All File Systems Are Not Created Equal", OSDI 2014, explains why both fsyncs are needed).
// The temporary file's name is derived from the target's, so that the next process reuses the file of a killed one. A lock (flock(2), which
// ends with its process) prevents two processes from using it at the same time.
#include "io/file/write_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/error.h"
#include "io/file/process.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// The cure that the user is told for an errno.
const char* cureFor(int error) {
  switch (error) {
    case ENOENT: return "create the folder first";
    case ENOTDIR: return "part of the path is a file; choose another folder";
    case EACCES:
    case EPERM: return "choose a folder you may write to, or change its permissions";
    case EROFS: return "the disk is mounted read-only; choose another folder";
    case ENOSPC:
    case EDQUOT: return "free some space or choose another disk";
    case EISDIR: return "a folder has this name; choose another name";
    case ENAMETOOLONG: return "choose a shorter name";
    default: return "check the disk and try again";
  }
}

[[noreturn]] void failWriting(const fs::path& target, int error) {
  throw IoError(target.string(), std::string("cannot write: ") + std::strerror(error) + "; " + cureFor(error));
}

fs::path temporaryFor(const fs::path& target) {
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  return folder / (".cloudbake-" + hashBytes(target.filename().string()).substr(0, 16));
}

// Opens an empty file of that name that no other process writes to. The process that held the lock before may have renamed or removed the
// file; then it tries again.
int openLocked(const fs::path& temporary) {
  for (;;) {
    const int file = ::open(temporary.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (file < 0) return file;
    while (::flock(file, LOCK_EX) != 0 && errno == EINTR) {
    }
    struct stat ours {
    }, named{};
    const bool is_same = ::fstat(file, &ours) == 0 && ::lstat(temporary.c_str(), &named) == 0 && ours.st_ino == named.st_ino;
    if (is_same && ::ftruncate(file, 0) == 0) return file;
    ::close(file);
    if (is_same) return -1;
  }
}

// The permissions of the file that is replaced, or those that the umask gives a new file.
mode_t modeFor(const fs::path& target) {
  struct stat status {};
  if (::stat(target.c_str(), &status) == 0) return status.st_mode & 07777;
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return 0666 & ~mask;
}

// Writes to a pipe or a device as it is: nothing in it could be replaced.
void writeInto(const fs::path& target, std::span<const std::byte> bytes) {
  const Descriptor stream(::open(target.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
  if (stream.number < 0) failWriting(target, errno);
  const int error = writeAll(stream.number, bytes);
  if (error != 0) failWriting(target, error);
}

// What a running process has opened, such as /dev/stdout, is no file of a folder, even if it leads to one. Other paths in /dev may be: a
// file in /dev/shm is one.
bool isOfProcess(const fs::path& target) {
  const std::string text = fs::absolute(target).lexically_normal().string();
  return text == "/dev/stdout" || text == "/dev/stderr" || text.starts_with("/dev/fd/") || text.starts_with("/proc/");
}

void replaceFile(const fs::path& target, std::span<const std::byte> bytes) {
  const fs::path temporary = temporaryFor(target);
  const Descriptor file(openLocked(temporary));
  if (file.number < 0) failWriting(target, errno);
  int error = ::fchmod(file.number, modeFor(target)) == 0 ? 0 : errno;
  if (error == 0) error = writeAll(file.number, bytes);
  if (error == 0 && ::fsync(file.number) != 0) error = errno;
  if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    failWriting(target, error);
  }

  // The rename itself must reach the disk too. Some file systems cannot fsync a folder (EINVAL); the rename is still valid then.
  const Descriptor directory(::open(temporary.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.number >= 0 && ::fsync(directory.number) != 0 && errno != EINVAL) failWriting(target, errno);
}

// "a pipe", for messages.
const char* kindOf(mode_t mode) {
  return S_ISDIR(mode) ? "a folder" : S_ISFIFO(mode) ? "a pipe" : S_ISSOCK(mode) ? "a socket" : S_ISREG(mode) ? "a file" : "a device";
}

[[noreturn]] void failReading(const fs::path& file, int error) {
  throw IoError(file.string(), std::string("cannot read: ") + std::strerror(error) +
                                   (error == ENOENT ? "; check the name and the folder" : "; check the permissions"));
}

std::string readAll(const fs::path& file, bool may_be_pipe) {
  // The kind is checked before the file is opened, because opening a pipe waits for its writer, and opening a device may do anything.
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) failReading(file, errno);
  if (!S_ISREG(status.st_mode) && !(may_be_pipe && (S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode))))
    throw IoError(file.string(),
                  fmt::format("cannot read: this is {}; name a file{}", kindOf(status.st_mode), S_ISDIR(status.st_mode) ? " in it" : ""));
  const auto check_size = [&](uint64_t size) {
    if (size > kMaxFileBytes)
      throw InputError(file.string(), fmt::format("the file is larger than {} GiB, the limit; name a smaller one", kMaxFileBytes >> 30));
  };
  check_size(uint64_t(status.st_size));
  const Descriptor source(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | (may_be_pipe ? 0 : O_NONBLOCK)));
  if (source.number < 0) failReading(file, errno);

  std::string bytes(size_t(status.st_size) + 1, '\0');  // one more, so that the end is met without a longer copy
  size_t filled = 0;
  for (;;) {
    if (filled == bytes.size()) bytes.resize(bytes.size() + 65536);  // for pipes, and for files that grew
    const ssize_t count = ::read(source.number, bytes.data() + filled, bytes.size() - filled);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw IoError(file.string(), std::string("cannot read: ") + std::strerror(errno) + "; check the disk");
    if (count == 0) break;
    filled += size_t(count);
    check_size(filled);
  }
  bytes.resize(filled);
  return bytes;
}

}  // namespace

void writeFileAtomically(const fs::path& target, std::span<const std::byte> bytes) {
  struct stat status {};
  if (::stat(target.c_str(), &status) != 0) {
    if (errno != ENOENT) failWriting(target, errno);
    return replaceFile(followLinks(target), bytes);
  }
  if (S_ISDIR(status.st_mode)) failWriting(target, EISDIR);
  if (::access(target.c_str(), W_OK) != 0) failWriting(target, errno);
  if (S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode) || isOfProcess(target)) return writeInto(target, bytes);
  if (!S_ISREG(status.st_mode))
    throw IoError(target.string(), fmt::format("cannot write: this is {}; choose another name", kindOf(status.st_mode)));
  replaceFile(followLinks(target), bytes);
}

void writeFileAtomically(const fs::path& target, std::string_view text) {
  writeFileAtomically(target, std::as_bytes(std::span(text.data(), text.size())));
}

void createFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw IoError(folder.string(), "cannot create the folder: " + error.message() + "; choose another folder, or change its permissions");
}

fs::path followLinks(const fs::path& path) {
  constexpr int kMostLinks = 40;  // as Linux follows
  fs::path target = path;
  for (int i = 0; i < kMostLinks; ++i) {
    std::error_code error;
    const fs::path next = fs::read_symlink(target, error);
    if (error) return target;
    target = target.parent_path() / next;
  }
  return path;
}

std::string readFileBytes(const fs::path& file) { return readAll(file, false); }

std::string readFileOrPipe(const fs::path& file) { return readAll(file, true); }

bool liesBeside(const fs::path& file, const fs::path& named) {
  std::error_code error;
  const fs::path folder = fs::weakly_canonical(fs::absolute(file).parent_path(), error);
  if (error) return false;
  const fs::path resolved = fs::weakly_canonical(fs::absolute(named), error);
  return !error && std::mismatch(folder.begin(), folder.end(), resolved.begin(), resolved.end()).first == folder.end();
}

std::string hashBytes(std::string_view bytes) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits(bytes.data(), bytes.size()));
  std::string digits;
  for (const unsigned char byte : canonical.digest) digits += fmt::format("{:02x}", byte);
  return digits;
}

}  // namespace cloudbake
