// How reports show an asset: a small picture, and a page that shows it live.
#pragma once

#include <filesystem>
#include <string>

#include "core/image.h"
#include "core/memory_budget.h"

namespace cloudbake {

/// A baked asset lit with the lobe formula, kThumbnailWidth × kThumbnailHeight, in sRGB. Throws as readFileBytes and decodeGlb do.
Image drawThumbnail(const std::filesystem::path& asset, uint64_t memory_limit = kMemoryLimit);
/// The same as a JPEG.
std::string thumbnailOf(const std::filesystem::path& asset, uint64_t memory_limit = kMemoryLimit);

/// The page of `cloudbake view ASSET --look plain`, which begins with the look, sun and side of the thumbnail. Throws as readFileBytes,
/// decodeGlb and liveScene do.
std::string liveViewOf(const std::filesystem::path& asset, uint64_t memory_limit = kMemoryLimit);

}  // namespace cloudbake
