// A file is replaced atomically, as POSIX allows it: create a temporary file in the same folder, write, fsync, rename, fsync the
// folder (rename(2); T. Pillai et al., "All File Systems Are Not Created Equal", OSDI 2014, explains why both fsyncs are needed).
#include "io/file/write_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/error.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// The cure in the message for an errno.
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

fs::path folderOf(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

// What a running process has opened, such as /dev/stdout, is no file of a folder, even if it leads to one. Other paths in /dev may be: a
// file in /dev/shm is one.
bool isOfProcess(const fs::path& target) {
  const std::string text = fs::absolute(target).lexically_normal().string();
  return text == "/dev/stdout" || text == "/dev/stderr" || text.starts_with("/dev/fd/") || text.starts_with("/proc/");
}

// "a pipe", for messages.
const char* kindOf(mode_t mode) {
  return S_ISDIR(mode) ? "a folder" : S_ISFIFO(mode) ? "a pipe" : S_ISSOCK(mode) ? "a socket" : S_ISREG(mode) ? "a file" : "a device";
}

// Whether a path leads to a pipe or a device: nothing in it could be replaced. Throws IoError if it is nothing that may be written.
bool isStream(const fs::path& target) {
  struct stat status {};
  if (::stat(target.c_str(), &status) != 0) {
    if (errno != ENOENT) failWriting(target, errno);
    return false;
  }
  if (S_ISDIR(status.st_mode)) failWriting(target, EISDIR);
  if (::access(target.c_str(), W_OK) != 0) failWriting(target, errno);
  if (S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode) || isOfProcess(target)) return true;
  if (!S_ISREG(status.st_mode))
    throw IoError(target.string(), fmt::format("cannot write: this is {}; choose another name", kindOf(status.st_mode)));
  return false;
}

// Of the temporary file: a new file gets what the umask leaves. One that replaces a file is nobody else's until it has its permissions.
mode_t firstModeFor(const fs::path& target) { return ::access(target.c_str(), F_OK) == 0 ? 0600 : 0666; }

// Writes a byte into a folder and takes it back. Returns an errno.
int probe(const fs::path& folder) {
  removeAbandonedFiles(folder);
  const TemporaryFile file(folder, 0600);
  return file.error() != 0 ? file.error() : writeAll(file.descriptor(), std::string_view("?"));
}

// Gives a file the permissions of the one that it replaces. Returns an errno.
int copyMode(const fs::path& from, int to) {
  struct stat status {};
  if (::stat(from.c_str(), &status) != 0) return 0;
  return ::fchmod(to, status.st_mode & 07777) == 0 ? 0 : errno;
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

PendingFile::PendingFile(const fs::path& target) : target_(target) {
  if (isStream(target)) {
    stream_.number = ::open(target.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (stream_.number < 0) failWriting(target, errno);
    return;
  }
  replaced_ = followLinks(target);
  file_.emplace(folderOf(replaced_), firstModeFor(replaced_));
  const int error = file_->error() != 0 ? file_->error() : copyMode(replaced_, file_->descriptor());
  if (error != 0) failWriting(target_, error);
}

void PendingFile::write(std::string_view bytes) {
  if (const int error = writeAll(file_ ? file_->descriptor() : stream_.number, bytes); error != 0) failWriting(target_, error);
}

void PendingFile::commit() {
  if (!file_) return stream_.close();
  int error = ::fsync(file_->descriptor()) == 0 ? 0 : errno;
  if (error == 0) error = file_->renameTo(replaced_);
  if (error != 0) failWriting(target_, error);

  // The rename itself must reach the disk too. Some file systems cannot fsync a folder (EINVAL); the rename is still valid then.
  const Descriptor directory(::open(folderOf(replaced_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.number >= 0 && ::fsync(directory.number) != 0 && errno != EINVAL) failWriting(target_, errno);
}

void writeFileAtomically(const fs::path& target, std::string_view bytes) {
  PendingFile file(target);
  file.write(bytes);
  file.commit();
}

void probeTargets(std::span<const fs::path> targets) {
  std::set<fs::path> probed;
  for (const fs::path& target : targets) {
    if (isStream(target)) continue;
    const fs::path folder = folderOf(followLinks(target));
    if (!probed.insert(folder).second) continue;
    if (const int error = probe(folder); error != 0) failWriting(target, error);
  }
}

void probeFolder(const fs::path& folder) {
  fs::path existing = fs::absolute(folder).lexically_normal();
  std::error_code error;
  while (!fs::exists(fs::symlink_status(existing, error)) && existing.has_relative_path()) existing = existing.parent_path();
  if (const int failure = probe(existing); failure != 0) failWriting(folder, failure);
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
