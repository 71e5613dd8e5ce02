// Where the libraries are that belong to the program (late/).
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace cloudbake {

/// The absolute path of a library of cloudbake: beside the program or the library that this code is linked into, or in the folder for
/// libraries of their build or installation. None if it is not there. No other folder is searched.
std::optional<std::filesystem::path> ownLibrary(std::string_view name);

}  // namespace cloudbake
