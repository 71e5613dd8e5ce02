// Converts the materials of a scene that assimp has read. Only for io/sculpt/read_assimp.cpp.
#pragma once

#include <assimp/scene.h>

#include <filesystem>

#include "core/sculpt.h"
#include "io/file/read_settings.h"

namespace cloudbake {

/// Replaces the materials of the parts, which are indices into scene.mMaterials, by indices into sculpt.materials, with those that parts
/// use in order of first use, and their images. The default material of assimp becomes none. Counts kTextureIgnored, kImageNotEmbedded.
void keepMaterials(const std::filesystem::path& file, const aiScene& scene, const ReadSettings& settings, Sculpt& sculpt,
                   Warnings& warnings);

}  // namespace cloudbake
