// What assimp 5.2 reads wrong in formats of XML (Collada, and those of 3D printing), found in the file itself: refused, or counted.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/warnings.h"

namespace cloudbake {

/// The XML of the model of a 3MF. Throws InputError if it is not found, or is larger than `limit` bytes.
std::string modelOf3mf(const std::filesystem::path& file, std::string_view bytes, uint64_t limit);

/// Throws InputError for what assimp would leave out or place wrongly: parts in other files of the package, extensions that are required,
/// invalid transforms. Counts kMaterialIgnored and kTextureIgnored.
void check3mf(const std::filesystem::path& file, std::string_view model, Warnings& warnings);

/// Throws InputError for a Collada source that has fewer values than are read from it, because assimp 5.2 reads on behind its end.
void checkCollada(const std::filesystem::path& file, std::string_view xml);

/// Throws InputError for instances that are turned, because assimp 5.2 moves them instead.
void checkAmf(const std::filesystem::path& file, std::string_view xml);

}  // namespace cloudbake
