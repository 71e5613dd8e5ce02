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

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// A file descriptor that closes itself.
struct Descriptor {
  explicit Descriptor(int opened) : number(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
  const int number;
};

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

// Returns 0 or the errno of the failed call.
int writeAndSync(const Descriptor& file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.number, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(size_t(written));
  }
  return ::fsync(file.number) == 0 ? 0 : errno;
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

}  // namespace

void writeFileAtomically(const fs::path& target, std::span<const std::byte> bytes) {
  if (fs::is_directory(target)) failWriting(target, EISDIR);
  if (fs::exists(target) && ::access(target.c_str(), W_OK) != 0) failWriting(target, errno);
  const fs::path temporary = temporaryFor(target);
  const Descriptor file(openLocked(temporary));
  if (file.number < 0) failWriting(target, errno);
  int error = ::fchmod(file.number, modeFor(target)) == 0 ? 0 : errno;
  if (error == 0) error = writeAndSync(file, bytes);
  if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    failWriting(target, error);
  }

  // The rename itself must reach the disk too. Some file systems cannot fsync a folder (EINVAL); the rename is still valid then.
  const Descriptor directory(::open(temporary.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.number >= 0 && ::fsync(directory.number) != 0 && errno != EINVAL) failWriting(target, errno);
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

std::string readFileBytes(const fs::path& file) {
  const Descriptor source(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (source.number < 0)
    throw IoError(file.string(), std::string("cannot read: ") + std::strerror(errno) +
                                     (errno == ENOENT ? "; check the name and the folder" : "; check the permissions"));
  struct stat status {};
  if (::fstat(source.number, &status) != 0) throw IoError(file.string(), std::string("cannot read: ") + std::strerror(errno));
  if (S_ISDIR(status.st_mode)) throw IoError(file.string(), "cannot read: this is a folder; name a file in it");

  std::string bytes(size_t(status.st_size), '\0');
  size_t filled = 0;
  for (;;) {
    if (filled == bytes.size()) bytes.resize(bytes.size() + 65536);  // for pipes, and for files that grew
    const ssize_t count = ::read(source.number, bytes.data() + filled, bytes.size() - filled);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw IoError(file.string(), std::string("cannot read: ") + std::strerror(errno) + "; check the disk");
    if (count == 0) break;
    filled += size_t(count);
  }
  bytes.resize(filled);
  return bytes;
}

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
