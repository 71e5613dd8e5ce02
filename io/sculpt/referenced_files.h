// Lists the other files that a sculpt refers to.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "io/file/read_settings.h"

namespace cloudbake {

/// Whether a file of this name may be a sculpt of a format that can refer to other files.
bool canReferToFiles(const std::filesystem::path& file);

/// The files that a sculpt refers to: buffers and images of a glTF, material libraries of an OBJ and their textures, and the textures
/// beside a sculpt of another format. Their paths begin with the sculpt's folder, in the order of the file. A file that the reader would
/// refuse (io/file/neighbour.h) is left out; one that does not exist is not. For a damaged file, those that can be found.
std::vector<std::filesystem::path> referencedFiles(const std::filesystem::path& sculpt, std::string_view bytes,
                                                   const ReadSettings& settings);

}  // namespace cloudbake
