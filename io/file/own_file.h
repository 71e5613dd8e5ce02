// Which files cloudbake may replace without being asked: those that it has written itself.
#pragma once

#include <filesystem>

namespace cloudbake {

/// Whether a path leads to a regular file that does not have the words of cloudbake (core/text/maker.h). An empty file counts as nobody's,
/// and one that cannot be read as somebody else's.
bool isForeignFile(const std::filesystem::path& file);

}  // namespace cloudbake
