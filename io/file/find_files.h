// Finds the files that match a pattern or lie in a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string_view>
#include <vector>

namespace cloudbake {

/// Whether a name has the form of a pattern: `*` stands for any characters, `?` for one byte, `[a-z]` for one byte of these, `[!a-z]` for
/// one of the others, and a backslash takes the meaning from the next byte.
bool matchesPattern(std::string_view pattern, std::string_view name);

/// Whether the text contains `*`, `?` or `[`.
bool isPattern(std::string_view text);

/// The files that match a pattern, sorted by their bytes. `*`, `?` and `[…]` match within a name (matchesPattern); `**` matches any
/// folders. Only a dot matches the dot at the start of a name. `**` does not follow links to folders. If a file has exactly the pattern's
/// name, only that file is returned. Adds the searched folders to `folders`. Throws IoError for a folder that cannot be read.
std::vector<std::filesystem::path> filesMatching(const std::filesystem::path& pattern, std::set<std::filesystem::path>& folders);

/// The part of a pattern before its first component with `*`, `?` or `[`.
std::filesystem::path fixedFolder(const std::filesystem::path& pattern);

/// The files in a folder and below it, sorted by their bytes. Names that begin with a dot and the folder `excluded` are skipped. Otherwise
/// as above.
std::vector<std::filesystem::path> filesBelow(const std::filesystem::path& folder, const std::filesystem::path& excluded,
                                              std::set<std::filesystem::path>& folders);

}  // namespace cloudbake
