// Lists the other files that a sculpt refers to.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace cloudbake {

/// The files that a sculpt refers to: buffers and images of a glTF, material libraries of an OBJ. Paths are relative to the sculpt's
/// folder, in the order of the file, whether they exist or not. For a damaged file, those that can be found.
std::vector<std::filesystem::path> referencedFiles(const std::filesystem::path& sculpt, std::string_view bytes);

}  // namespace cloudbake
