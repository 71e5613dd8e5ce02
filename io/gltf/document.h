// What the readers and the writer of glTF share; nobody outside io/gltf_*.cpp includes it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf/asset_info.h"
#include "io/gltf/gltf.h"

namespace cloudbake {

/// Where a SculptPart stands in the document.
struct GltfPlace {
  int node = 0, mesh = 0, primitive = 0;
};

/// The document as the file has it, key order included: whatever we do not know survives.
struct GltfDocument {
  std::filesystem::path file;
  Json json;
  std::vector<std::string> buffers;           ///< bytes of each buffer, wherever they were stored
  std::vector<GltfPlace> places;              ///< per SculptPart
  std::map<size_t, std::string> image_files;  ///< bytes of images that lie beside the file, by image
};

constexpr uint32_t kGlbMagic = 0x46546C67, kGlbJsonChunk = 0x4E4F534A, kGlbBinaryChunk = 0x004E4942;

/// The two chunks of a GLB, or the text of a .gltf and nothing.
struct GlbChunks {
  std::string_view json, binary;
};
/// Throws InputError where the container is damaged.
GlbChunks splitGlb(const std::filesystem::path& file, std::string_view bytes);
/// A GLB of the two chunks, padded as the specification says. Throws InputError past 4 GiB.
std::string joinGlb(const std::filesystem::path& file, std::string_view json, std::string_view binary);

/// MIME type by an image's first bytes, as glTF and its extensions know it; empty for others.
std::string_view imageMimeType(std::string_view bytes);

/// %41 → A, as RFC 3986 writes it.
std::string percentDecoded(std::string_view uri);

/// Name of the vertex attribute that holds coefficients 4 i to 4 i + 3 of the transmittance's spherical harmonics.
inline std::string harmonicsName(int i) { return "_TRANSMITTANCE_SH_" + std::to_string(i); }

}  // namespace cloudbake
