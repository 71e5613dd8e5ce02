// Reads and writes whole files. All results are written by this code. It also computes the hash that identifies an input.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace cloudbake {

/// Replaces `target` by `bytes` atomically: a reader sees either the old file or the complete new one, even after a power cut.
/// Throws IoError; then the old file is unchanged and no temporary file remains. The temporary file of a killed process (`.cloudbake-*`) is
/// reused and removed by the next write of the same target.
void writeFileAtomically(const std::filesystem::path& target, std::span<const std::byte> bytes);
void writeFileAtomically(const std::filesystem::path& target, std::string_view text);

/// Creates a folder and its missing parent folders. Throws IoError.
void createFolder(const std::filesystem::path& folder);

/// All bytes of a file. Throws IoError if it is missing, a folder, or unreadable.
std::string readFileBytes(const std::filesystem::path& file);

/// Whether `named` lies in the folder of `file` or below it, after resolving links. A file may refer to such files only.
bool liesBeside(const std::filesystem::path& file, const std::filesystem::path& named);

/// XXH3-128 of the bytes as 32 hexadecimal digits, in the canonical (big-endian) form that `xxhsum -H2` prints.
std::string hashBytes(std::string_view bytes);

}  // namespace cloudbake
