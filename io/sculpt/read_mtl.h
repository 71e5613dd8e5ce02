// Reads the material libraries of an OBJ. Only for io/sculpt/*.cpp.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/sculpt.h"
#include "io/file/read_settings.h"

namespace cloudbake {

/// The names after each `mtllib` of an OBJ, in their order: the rest of the line.
std::vector<std::string> materialLibraries(std::string_view obj);

/// The libraries that these names mean. A line is one name, or names between blanks if there is no file of the whole name.
std::vector<std::filesystem::path> libraryPaths(const std::filesystem::path& obj, std::string_view bytes, bool allow_outside);

/// The names of the images that a material library uses, in the order of the file.
std::vector<std::string> texturesOfLibrary(std::string_view mtl);

/// The materials of these names, in their order, from the libraries of an OBJ. Their images are appended to sculpt.images. A material that
/// no library defines has only its name. docs/converting_sculpts.md says how values become those of glTF.
/// Counts kMaterialIgnored (libraries that cannot be read, values that are not kept), kTextureIgnored, kImageNotEmbedded.
void readMaterials(const std::filesystem::path& obj, std::string_view bytes, const std::vector<std::string>& names,
                   const ReadSettings& settings, Sculpt& sculpt, Warnings& warnings);

}  // namespace cloudbake
