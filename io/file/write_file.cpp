// A file is replaced atomically, as POSIX allows it: create a temporary file in the same folder, write, fsync, rename, fsync the
// folder (rename(2); T. Pillai et al., "All File Systems Are Not Created Equal", OSDI 2014, explains why both fsyncs are needed).
#include "io/file/write_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <set>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/error.h"
#include "io/file/system_file.h"

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
#ifdef EDQUOT
    case EDQUOT:
#endif
      return "free some space or choose another disk";
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

// For messages.
const char* textOf(FileKind kind) {
  switch (kind) {
    case FileKind::kFile: return "a file";
    case FileKind::kFolder: return "a folder";
    case FileKind::kPipe: return "a pipe";
    case FileKind::kSocket: return "a socket";
    default: return "a device";
  }
}

// Whether a path leads to a pipe or a device: nothing in it could be replaced. Throws IoError if it is nothing that may be written.
bool isStream(const fs::path& target) {
  const auto status = statusOf(target);
  if (!status) {
    if (errno != ENOENT) failWriting(target, errno);
    return false;
  }
  if (status->kind == FileKind::kFolder) failWriting(target, EISDIR);
  if (const int failure = whyNotWritable(target); failure != 0) failWriting(target, failure);
  if (status->kind == FileKind::kPipe || status->kind == FileKind::kCharacterDevice || isOfProcess(target)) return true;
  if (status->kind != FileKind::kFile)
    throw IoError(target.string(), fmt::format("cannot write: this is {}; choose another name", textOf(status->kind)));
  return false;
}

// Of the temporary file: a new file gets what the umask leaves. One that replaces a file is nobody else's until it has its permissions.
uint32_t firstPermissionsFor(const fs::path& target) { return statusOf(target) ? 0600 : 0666; }

// Writes a byte into a folder and takes it back. Returns an errno.
int probe(const fs::path& folder) {
  removeAbandonedFiles(folder);
  const TemporaryFile file(folder, 0600);
  return file.error() != 0 ? file.error() : writeAll(file.descriptor(), std::string_view("?"));
}

// Gives a file the permissions of the one that it replaces. Returns an errno.
int copyPermissions(const fs::path& from, int to) {
  const auto status = statusOf(from);
  return status ? setPermissions(to, status->permissions) : 0;
}

[[noreturn]] void failReading(const fs::path& file, int error) {
  throw IoError(file.string(), std::string("cannot read: ") + std::strerror(error) +
                                   (error == ENOENT ? "; check the name and the folder" : "; check the permissions"));
}

std::string readAll(const fs::path& file, bool may_be_pipe) {
  // The kind is checked before the file is opened, because opening a pipe waits for its writer, and opening a device may do anything.
  const auto status = statusOf(file);
  if (!status) failReading(file, errno);
  const FileKind kind = status->kind;
  if (kind != FileKind::kFile && !(may_be_pipe && (kind == FileKind::kPipe || kind == FileKind::kCharacterDevice)))
    throw IoError(file.string(),
                  fmt::format("cannot read: this is {}; name a file{}", textOf(kind), kind == FileKind::kFolder ? " in it" : ""));
  const auto check_size = [&](uint64_t size) {
    if (size > kMaxFileBytes)
      throw InputError(file.string(), fmt::format("the file is larger than {} GiB, the limit; name a smaller one", kMaxFileBytes >> 30));
  };
  check_size(status->size);
  const Descriptor source(openToRead(file, may_be_pipe));
  if (source.number < 0) failReading(file, errno);

  std::string bytes(size_t(status->size) + 1, '\0');  // one more, so that the end is met without a longer copy
  size_t filled = 0;
  for (;;) {
    if (filled == bytes.size()) bytes.resize(bytes.size() + 65536);  // for pipes, and for files that grew
    const long count = readSome(source.number, std::as_writable_bytes(std::span(bytes).subspan(filled)));
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
    stream_.number = openToWrite(target);
    if (stream_.number < 0) failWriting(target, errno);
    return;
  }
  replaced_ = followLinks(target);
  file_.emplace(folderOf(replaced_), firstPermissionsFor(replaced_));
  const int error = file_->error() != 0 ? file_->error() : copyPermissions(replaced_, file_->descriptor());
  if (error != 0) failWriting(target_, error);
}

void PendingFile::write(std::string_view bytes) {
  if (const int error = writeAll(file_ ? file_->descriptor() : stream_.number, bytes); error != 0) failWriting(target_, error);
}

void PendingFile::commit() {
  if (!file_) return stream_.close();
  int error = syncFile(file_->descriptor());
  if (error == 0) error = file_->renameTo(replaced_);
  if (error == 0) error = syncFolder(folderOf(replaced_));  // the rename itself must reach the disk too
  if (error != 0) failWriting(target_, error);
}

void writeFileAtomically(const fs::path& target, std::string_view bytes) {
  PendingFile file(target);
  file.write(bytes);
  file.commit();
}

void writeFilesTogether(std::span<const FileBytes> files) {
  std::vector<std::unique_ptr<PendingFile>> pending;
  for (const FileBytes& one : files) {
    pending.push_back(std::make_unique<PendingFile>(one.file));
    pending.back()->write(one.bytes);
  }
  for (const auto& file : pending) file->commit();
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
