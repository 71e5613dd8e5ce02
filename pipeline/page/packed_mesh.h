// Vertices and triangles for the page of `view`, rounded to what a picture needs and packed. viewer/packed_mesh.js unpacks them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/types.h"
#include "io/gltf/asset_info.h"

namespace cloudbake {

/// Collects arrays, one after the other. Each is stored by planes: the first bytes of all values, then the second ones, and so on.
class MeshPacker {
 public:
  /// Rounds positions to multiples of a step from the lowest corner of their box, and returns `low` and `step`. The step is 2⁻²⁰ of the
  /// longest side: a cloud of 1,000 pixels is off by 0.0005 pixels.
  Json addPositions(std::span<const Vec3> positions);
  /// Unit vectors, off by at most 0.008 degrees; one of length 0 becomes +Z. Returns the number of steps along an axis of their projection.
  int addDirections(std::span<const Vec3> directions);
  /// Floats with 15 significant bits: each is off by at most 2⁻¹⁵ of itself.
  void addRounded(std::span<const float> values);
  /// Floats as they are.
  void addFloats(const std::vector<float>& values);
  /// Whole numbers, each as its difference from the one at the same place of the vector of `width` numbers before.
  void addWhole(const std::vector<uint32_t>& values, size_t width);
  /// Three vertices per triangle.
  void addTriangles(const std::vector<uint32_t>& vertices);
  void addBytes(std::span<const uint8_t> bytes);
  /// Everything, deflated, as base 64.
  std::string packed() const;

 private:
  std::string bytes_;
};

}  // namespace cloudbake
