// Which other files a sculpt draws on.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace cloudbake {

/// Files that a sculpt names besides itself: buffers and images of a glTF, material libraries of an OBJ; beside the sculpt, in their
/// order, whether they exist or not. Of a damaged file what can be found.
std::vector<std::filesystem::path> referencedFiles(const std::filesystem::path& sculpt, std::string_view bytes);

}  // namespace cloudbake
