// Which files a pattern or a folder stands for.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string_view>
#include <vector>

namespace cloudbake {

/// Whether the text holds `*`, `?` or `[`.
bool isPattern(std::string_view text);

/// Files that a pattern names, sorted by their bytes: `*`, `?` and `[…]` within a name as in fnmatch(3), `**` for any folders. Names that
/// begin with a dot are met only by a dot; links to folders are not followed by `**`. A file of exactly that name goes before the pattern.
/// Adds the folders that were looked into. Throws IoError for a folder that cannot be read.
std::vector<std::filesystem::path> filesMatching(const std::filesystem::path& pattern, std::set<std::filesystem::path>& folders);

/// The part of a pattern before its first component with `*`, `?` or `[`.
std::filesystem::path fixedFolder(const std::filesystem::path& pattern);

/// Files in a folder and below it, sorted by their bytes; what begins with a dot and `excluded` (a folder) are left out. As above else.
std::vector<std::filesystem::path> filesBelow(const std::filesystem::path& folder, const std::filesystem::path& excluded,
                                              std::set<std::filesystem::path>& folders);

}  // namespace cloudbake
