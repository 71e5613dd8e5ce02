// The numbers behind glTF accessors, every offset checked before it is used. Only for io/gltf_*.cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/gltf/tinygltf.h"

namespace cloudbake {

/// Reads accessors of one parsed file. `owner` names what is read, for messages. All throw InputError where an accessor is damaged.
struct GltfAccessors {
  const std::filesystem::path& file;
  const tinygltf::Model& model;

  /// #count×components floats; normalised integers become 0 … 1 or −1 … 1, plain ones keep their value; sparse ones are filled in.
  std::vector<float> readFloats(int accessor, int components, const std::string& owner) const;
  /// Unsigned integers.
  std::vector<uint32_t> readIndices(int accessor, const std::string& owner) const;
};

}  // namespace cloudbake
