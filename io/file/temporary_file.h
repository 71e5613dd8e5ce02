// Files that are written beside their target and then take its place.
#pragma once

#include <cstdint>
#include <filesystem>

#include "io/file/descriptor.h"

namespace cloudbake {

/// A new, empty file of a name that nothing else has, `.cloudbake-HOST-NUMBER`. It is locked while its process lives, so that no other
/// process takes it for one that a killed process left. It is removed with this object, unless it was renamed.
class TemporaryFile {
 public:
  /// A new file with these permissions, less what the umask forbids. If it cannot be made, descriptor() is −1 and error() says why.
  TemporaryFile(const std::filesystem::path& folder, uint32_t permissions);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile();

  int descriptor() const { return file_.number; }
  int error() const { return error_; }  ///< an errno
  /// Gives the file its name. Returns 0 or an errno.
  int renameTo(const std::filesystem::path& target);

 private:
  void forget();

  std::filesystem::path path_;
  Descriptor file_;
  int error_ = 0, slot_ = -1;
};

/// Removes what killed processes of this user left in a folder on this machine: regular files of such a name that have no other name and
/// that no process has locked.
void removeAbandonedFiles(const std::filesystem::path& folder);

/// Removes all temporary files of this process, for a signal that ends it: it calls only what a signal handler may call. What is written
/// by more than 64 threads at once stays until the next run.
void removeTemporaryFiles() noexcept;

}  // namespace cloudbake
