// Reads the numbers of glTF accessors. Every offset is checked before it is used. Only for io/gltf.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/types.h"
#include "io/gltf/tinygltf.h"

namespace cloudbake {

/// Reads accessors of one parsed file. `owner` is the reader's subject in messages. All functions throw InputError if an accessor is
/// damaged.
struct GltfAccessors {
  const std::filesystem::path& file;
  const tinygltf::Model& model;

  /// #count×components floats. Normalised integers become 0 … 1 or −1 … 1, other integers keep their value, and sparse accessors are
  /// expanded.
  std::vector<float> readFloats(int accessor, int components, const std::string& owner) const;
  /// The same of three components.
  std::vector<Vec3> readVectors(int accessor, const std::string& owner) const;
  /// #count×components unsigned integers.
  std::vector<uint32_t> readIndices(int accessor, const std::string& owner, int components = 1) const;
  /// Three of them at a time. Their number must be a multiple of three.
  std::vector<Triangle> readTriangles(int accessor, const std::string& owner) const;
};

}  // namespace cloudbake
