// Code shared by the readers and the writer of glTF.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/sculpt.h"
#include "io/gltf/asset_info.h"

namespace cloudbake {

/// The bytes of each buffer of a document.
using GltfBuffers = std::vector<std::vector<unsigned char>>;

/// A primitive as {mesh, primitive}.
using GltfPrimitive = std::pair<int, int>;

/// A primitive of a part, and how many of the part's triangles are its own.
struct GltfStretch {
  int primitive = 0;
  size_t triangles = 0;
};

/// The place of a SculptPart in the document: primitives of one mesh that have the same vertices, under one node. Their triangles follow
/// each other in the part.
struct GltfPlace {
  int node = 0, mesh = 0;
  std::vector<GltfStretch> stretches;

  GltfPrimitive first() const { return {mesh, stretches.front().primitive}; }
};

/// The document as in the file, including the order of keys, so that unknown content is preserved.
struct GltfDocument {
  std::filesystem::path file;
  Json json;
  GltfBuffers buffers;                        ///< wherever they were stored
  std::vector<GltfPlace> places;              ///< per SculptPart
  std::map<size_t, std::string> image_files;  ///< bytes of image files beside the document, by image index
  // The findings of removeEarlierBake.
  bool was_baked = false;
  int earlier_set = -1;  ///< the first of the UV sets that were removed; −1: none
  int white_texture = -1;
  std::set<size_t> free_accessors, free_views;  ///< stubs to be replaced
};

/// Lobes and levels of detail differ per node, so a mesh that several nodes use is copied for each node but the first. Returns the mesh of
/// each part.
std::vector<int> separateMeshes(const GltfDocument& document, Json& json);

/// The primitive of a document.
Json& primitiveOf(Json& json, GltfPrimitive place);
const Json& primitiveOf(const Json& json, GltfPrimitive place);

/// The accessors that attributes, morph targets, indices, skins, animations and instances use. Primitives in `left_out` do not count.
std::set<size_t> accessorsInUse(const Json& json, const std::set<GltfPrimitive>& left_out = {});

/// Types of components and targets of buffer views, as glTF numbers them.
inline constexpr int kFloat = 5126, kUnsignedInt = 5125, kUnsignedShort = 5123, kVertexTarget = 34962, kIndexTarget = 34963;

constexpr uint32_t kGlbMagic = 0x46546C67, kGlbJsonChunk = 0x4E4F534A, kGlbBinaryChunk = 0x004E4942;

/// The two chunks of a GLB, or the text of a .gltf with an empty binary chunk.
struct GlbChunks {
  std::string_view json, binary;
};
/// Throws InputError if the container is damaged.
GlbChunks splitGlb(const std::filesystem::path& file, std::string_view bytes);
/// A GLB of the two chunks, the binary one in pieces, padded as the specification requires. Throws InputError beyond 4 GiB.
std::string joinGlb(const std::filesystem::path& file, std::string_view json, std::span<const std::string_view> binary);
inline std::string joinGlb(const std::filesystem::path& file, std::string_view json, std::string_view binary) {
  return joinGlb(file, json, std::span(&binary, 1));
}

/// Whether the bytes are a document of a layout, as far as their metadata show; false for a damaged file.
bool isGltfOfLayout(std::string_view bytes, const char* layout);

/// The bytes of an image of this name in the binary chunk; nothing if no image has it. Throws InputError if they reach beyond the chunk,
/// and Json::exception for metadata of other types.
std::optional<std::string_view> imageIn(const std::filesystem::path& file, const GlbChunks& chunks, const Json& json, const char* name);

/// A vector as three numbers, printed as `shortest` does, and back. Throws Json::exception.
Json numbersOf(Vec3 v);
Vec3 vectorOf(const Json& json);

/// The name of the material that a bake gives to parts without a material.
inline constexpr const char* kOwnMaterialName = "cloud";

/// The name of the vertex attribute that stores the coefficients 4 i to 4 i + 3 of the transmittance's spherical harmonics.
inline std::string harmonicsName(int i) { return "_TRANSMITTANCE_SH_" + std::to_string(i); }

/// The name of a UV set's attribute.
inline std::string uvSetName(int set) { return "TEXCOORD_" + std::to_string(set); }

}  // namespace cloudbake
