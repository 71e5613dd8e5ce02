// Whole files in, whole files out: the one way to write a result, and what identifies an input.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace cloudbake {

/// Replaces `target` by `bytes` in one step: a reader sees the old file or the whole new one, also after a power cut.
/// Throws IoError; the old file is then as it was and no temporary file is left behind. What a killed process leaves (`.cloudbake-*`) is
/// used and removed by the next write of the same target.
void writeFileAtomically(const std::filesystem::path& target, std::span<const std::byte> bytes);
void writeFileAtomically(const std::filesystem::path& target, std::string_view text);

/// Makes a folder and those above it, where they are missing. Throws IoError.
void createFolder(const std::filesystem::path& folder);

/// All bytes of a file. Throws IoError where it is missing, a folder or unreadable.
std::string readFileBytes(const std::filesystem::path& file);

/// Whether `named` lies in the folder of `file`, or below it, after all links: what a file from elsewhere may name.
bool liesBeside(const std::filesystem::path& file, const std::filesystem::path& named);

/// XXH3-128 of the bytes: 32 hexadecimal digits, the canonical (big-endian) form that `xxhsum -H2` prints.
std::string hashBytes(std::string_view bytes);

}  // namespace cloudbake
