// What files need of the system, in one form for all systems: posix/system_file.cpp and windows/system_file.cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace cloudbake {

enum class FileKind { kFile, kFolder, kPipe, kSocket, kCharacterDevice, kDevice };

/// What the system knows of a file.
struct FileStatus {
  FileKind kind = FileKind::kFile;
  uint64_t device = 0, number = 0;  ///< together they tell files of this machine apart
  uint64_t size = 0;                ///< bytes
  int64_t changed = 0;              ///< nanoseconds, of the contents
  uint32_t permissions = 0;         ///< bits of chmod(2)
  uint64_t names = 0;               ///< links to it
  bool is_own = false;              ///< it belongs to the user of this process
  bool isSameFile(const FileStatus& other) const { return device == other.device && number == other.number; }
};

/// Of the file that a path leads to. If there is none, errno says why.
std::optional<FileStatus> statusOf(const std::filesystem::path& path);
/// Of a link itself, if the path is one.
std::optional<FileStatus> statusOfName(const std::filesystem::path& path);
std::optional<FileStatus> statusOf(int descriptor);

/// 0, or the errno that says why a file may not be written.
int whyNotWritable(const std::filesystem::path& path);

// These return a descriptor that other programs do not inherit, or -1, and errno says why.

/// A file to read. Unless it `may_wait`, opening does not wait for the other end of a pipe.
int openToRead(const std::filesystem::path& path, bool may_wait);
/// A pipe or a device to write to.
int openToWrite(const std::filesystem::path& path);
/// A new file to read and write, whose name was free, with these permissions less what the umask forbids. It can get another name or none
/// while it is open.
int openNew(const std::filesystem::path& path, uint32_t permissions);
/// A regular file that may be locked and may lose its name while it is open. No link is followed.
int openNamed(const std::filesystem::path& path);
/// A file to lock, which is made if it is missing.
int openLockFile(const std::filesystem::path& path);

enum class LockKind { kShared, kExclusive };
/// Locks an open file until it is closed or the process ends, without waiting. Returns 0, EWOULDBLOCK if another process has locked it, or
/// the errno of another failure: some file systems have no locks.
int lockNow(int descriptor, LockKind kind);

/// Gives a file permissions. Returns 0 or an errno.
int setPermissions(int descriptor, uint32_t permissions);
/// Waits until what was written to a file is on the disk. Returns 0 or an errno.
int syncFile(int descriptor);
/// The same for the names in a folder.
int syncFolder(const std::filesystem::path& folder);
/// Gives a file another name in the same folder. What had that name is replaced. Returns 0 or an errno.
int renameFile(const std::filesystem::path& from, const std::filesystem::path& to);
/// Removes a name, as a signal handler may. `path` ends in a zero.
void removeName(const std::filesystem::path::value_type* path) noexcept;

/// The name of this machine.
std::string hostName();

}  // namespace cloudbake
