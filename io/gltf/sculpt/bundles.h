// Primitives of a glTF that share their vertices: many exporters write one large vertex buffer and a primitive per material or piece. Only
// for io/gltf/sculpt.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/gltf/document.h"
#include "io/gltf/nodes.h"
#include "io/gltf/tinygltf.h"

namespace cloudbake {

/// The numbers of primitives of a mesh that have the same vertices: the same data in every attribute and morph target, and the same
/// extensions. They become one part.
using GltfBundle = std::vector<int>;

struct GltfBundles {
  std::vector<int> first_alike;                    ///< per accessor: the first one with the same data
  std::vector<std::vector<GltfBundle>> of_meshes;  ///< per mesh, in the order of their first primitives

  /// A number for the vertices of a primitive; −1 if the accessor does not exist.
  int positionsOf(const tinygltf::Primitive& primitive) const;
};

/// The bundles of all meshes. Primitives without a surface are in none.
GltfBundles findBundles(const tinygltf::Model& model);

/// Whether a primitive has positions and consists of triangles.
bool hasSurface(const tinygltf::Primitive& primitive);

/// The names of a primitive's extensions that may refer to its vertices.
std::vector<std::string> vertexExtensions(const tinygltf::Primitive& primitive);

/// A bundle that uses few of its vertices.
struct FewVertices {
  int mesh = 0;
  GltfBundle bundle;
  size_t vertices = 0;                           ///< of the accessors
  std::vector<uint32_t> kept;                    ///< the vertices that the bundle uses, ascending
  std::vector<std::vector<uint32_t>> indices{};  ///< per primitive of the bundle, as numbers in `kept`
};

/// The bundles that use at most half of their vertices while other bundles, or other nodes with the same mesh, are drawn with the same
/// positions: each would be baked with all of them. `draws` is the number of drawings per mesh. None if more than `limit` bytes would be
/// needed to find them. A bundle with damaged indices is left to its reader.
std::vector<FewVertices> fewOfShared(const std::filesystem::path& file, const tinygltf::Model& model, const GltfBundles& bundles,
                                     const std::vector<uint64_t>& draws, uint64_t limit);

/// Gives such bundles accessors of the vertices that they use. The document has its buffers. Throws InputError for a damaged attribute.
void giveOwnVertices(GltfDocument& document, const std::vector<FewVertices>& few);

}  // namespace cloudbake
