// Reads and writes whole files. All results are written by this code. It also computes the hash that identifies an input.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/file/temporary_file.h"

namespace cloudbake {

/// A file that is written piece by piece. `commit` replaces `target` atomically by what was written: a reader sees either the old file or
/// the complete new one, even after a power cut. If `target` is a link, the file that it leads to is replaced and the link stays. A pipe or
/// a character device such as /dev/null is written to as the pieces come. Without a commit nothing is replaced and no temporary file
/// remains. All functions throw IoError, also for any other kind of file.
class PendingFile {
 public:
  explicit PendingFile(const std::filesystem::path& target);
  void write(std::string_view bytes);
  void commit();

 private:
  std::filesystem::path target_, replaced_;
  std::optional<TemporaryFile> file_;
  Descriptor stream_;
};

/// Replaces `target` by `bytes`, as PendingFile does.
void writeFileAtomically(const std::filesystem::path& target, std::string_view bytes);

/// A file and its bytes.
struct FileBytes {
  std::filesystem::path file;
  std::string_view bytes;
};
/// The same for files that belong together: all are written before one is replaced, so that a full disk does not leave some of them beside
/// older ones. They are replaced in their order.
void writeFilesTogether(std::span<const FileBytes> files);

/// Throws IoError if one of these files could not be written now, so that nobody computes in vain, and for a folder that is missing.
/// Nothing is changed, but temporary files that killed processes left in the folders are removed.
void probeTargets(std::span<const std::filesystem::path> targets);
/// The same for a file in a folder that may still have to be created.
void probeFolder(const std::filesystem::path& folder);

/// Creates a folder and its missing parent folders. Throws IoError.
void createFolder(const std::filesystem::path& folder);

/// The file that a path leads to through links, whether it exists or not. A loop of links is returned as it is.
std::filesystem::path followLinks(const std::filesystem::path& path);

/// All bytes of a regular file. Throws IoError if it is missing, a folder, a pipe, a device or a socket (none is opened), or unreadable,
/// and InputError if it is larger than kMaxFileBytes.
std::string readFileBytes(const std::filesystem::path& file);
inline constexpr uint64_t kMaxFileBytes = 8ULL << 30;

/// Reads all bytes of a file, as readFileBytes does.
using FileReader = std::function<std::string(const std::filesystem::path&)>;

/// All bytes of a regular file or a pipe, such as `<(find …)` of a shell. Otherwise as above.
std::string readFileOrPipe(const std::filesystem::path& file);

/// Whether `named` lies in the folder of `file` or below it, after resolving links. A file may refer to such files only.
bool liesBeside(const std::filesystem::path& file, const std::filesystem::path& named);

/// XXH3-128 of the bytes as 32 hexadecimal digits, in the canonical (big-endian) form that `xxhsum -H2` prints.
std::string hashBytes(std::string_view bytes);

}  // namespace cloudbake
