// Packs a baked GLB: positions, normals and lobes as integers (docs/asset_format.md, "Packed").
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/sculpt.h"
#include "io/gltf/gltf_settings.h"

namespace cloudbake {

/// The bytes of a GLB of encodeGlb in the layout "lobe-packed". `info` is its metadata; the layout, density_max, the seal and the
/// certificate are replaced. `kept_views`: of an artist's document, how many buffer views it had;
/// they and all accessors keep their numbers. Counts
/// kPartNotPacked. Throws InputError if T may change by more than kMostPackedError.
std::string packGlb(const std::filesystem::path& file, std::string_view glb, const AssetInfo& info, PackForm form,
                    std::optional<size_t> kept_views, Warnings& warnings);

// The rest is what strip.cpp and pack_meshopt.cpp have for pack.cpp.

/// The triangles as one strip, joined by triangles with two equal corners. Empty if that would take more indices than they have.
std::vector<uint32_t> stripOf(std::span<const uint32_t> triangles, size_t vertices);

/// The triangles in an order that suits the codec; and in `new_places`, per vertex, its place in the order of their use.
std::vector<uint32_t> orderedForCodec(std::span<const uint32_t> triangles, size_t vertices, std::vector<uint32_t>& new_places);

/// Normals, #V × 3, as the filter OCTAHEDRAL of EXT_meshopt_compression stores them in four bytes each.
std::string filteredNormals(std::span<const float> normals);

/// The bytes of the codecs of EXT_meshopt_compression.
std::string compressedVertices(std::string_view bytes, size_t count, size_t stride);
std::string compressedTriangles(std::span<const uint32_t> triangles, size_t vertices);

}  // namespace cloudbake
