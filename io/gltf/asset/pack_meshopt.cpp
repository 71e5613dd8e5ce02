// Orders, filters and codecs of meshoptimizer. EXT_meshopt_compression (Khronos) wants version 0 of its codec of vertices and version 1 of
// that of indices.
#include <meshoptimizer.h>

#include <algorithm>

#include "io/gltf/asset/pack.h"

namespace cloudbake {

std::vector<uint32_t> orderedForCodec(std::span<const uint32_t> triangles, size_t vertices, std::vector<uint32_t>& new_places) {
  std::vector<uint32_t> ordered(triangles.size());
  meshopt_optimizeVertexCacheStrip(ordered.data(), triangles.data(), triangles.size(), vertices);
  new_places.resize(vertices);
  size_t used = meshopt_optimizeVertexFetchRemap(new_places.data(), ordered.data(), ordered.size(), vertices);
  for (uint32_t& place : new_places)
    if (place == UINT32_MAX) place = uint32_t(used++);  // no triangle uses it
  return ordered;
}

std::string compressedVertices(std::string_view bytes, size_t count, size_t stride) {
  std::string compressed(meshopt_encodeVertexBufferBound(count, stride), '\0');
  compressed.resize(
      meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(compressed.data()), compressed.size(), bytes.data(), count, stride));
  return compressed;
}

std::string filteredNormals(std::span<const float> normals) {
  constexpr int kBits = 8;
  std::vector<float> four;
  for (size_t i = 0; i + 2 < normals.size(); i += 3) four.insert(four.end(), {normals[i], normals[i + 1], normals[i + 2], 0});
  std::string filtered(four.size(), '\0');
  meshopt_encodeFilterOct(filtered.data(), four.size() / 4, 4, kBits, four.data());
  return filtered;
}

std::string compressedTriangles(std::span<const uint32_t> triangles, size_t vertices) {
  static const bool is_version_set = (meshopt_encodeIndexVersion(1), true);
  (void)is_version_set;
  std::string compressed(meshopt_encodeIndexBufferBound(triangles.size(), vertices), '\0');
  compressed.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(compressed.data()), compressed.size(), triangles.data(),
                                              triangles.size()));
  return compressed;
}

}  // namespace cloudbake
