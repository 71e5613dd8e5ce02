// A small picture of an asset for reports.
#pragma once

#include <filesystem>
#include <string>

namespace cloudbake {

/// A baked asset lit with the lobe formula, 240 × 160, as a PNG. Throws as readFileBytes and decodeGlb do.
std::string thumbnailOf(const std::filesystem::path& asset);

}  // namespace cloudbake
