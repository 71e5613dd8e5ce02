// Reads baked GLBs with the base colours of their sculpts, for pictures.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/types.h"
#include "core/warnings.h"
#include "io/file/read_settings.h"

namespace cloudbake {

/// As decodeGlb, and with BakedMesh::colors: baseColorFactor · baseColorTexture at the vertex · COLOR_0 of glTF. A vertex of several
/// materials has the colour of the first one. A colour or texture that cannot be read is white and counts as kTextureIgnored; nothing is
/// thrown because of it.
BakedMesh decodeColoredGlb(const std::filesystem::path& file, std::string_view bytes, Warnings& warnings,
                           const ReadSettings& settings = {});

}  // namespace cloudbake
