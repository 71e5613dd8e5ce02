// The pose of skinned meshes, as their joints have it in the file. Only for io/gltf.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/affine.h"
#include "core/warnings.h"
#include "io/gltf/nodes.h"
#include "io/gltf/tinygltf.h"

namespace cloudbake {

/// Poses the primitives of one file. Matrices of joints are computed once per skin.
class Poser {
 public:
  Poser(const std::filesystem::path& file, const tinygltf::Model& model, const std::vector<PlacedNode>& placed)
      : file_(file), model_(model), placed_(placed) {}

  /// Bind space → scene space of every vertex of a primitive: Σ w·(transform of the joint)·(inverse bind matrix), with weights that sum
  /// to 1. A vertex without any weight is placed by its first joint. A vertex whose map is singular gets the linear part of its strongest
  /// joint (else none), and an offset that leaves it where the joints put it. Both count kJointFallback. Empty if the primitive has no
  /// joints and weights. Throws InputError for a damaged skin, an index out of range, or a weight that is negative or not finite.
  std::vector<Affine> mapsOf(const tinygltf::Primitive& primitive, int skin, const std::vector<Vec3>& positions, const std::string& owner,
                             Warnings& warnings);

 private:
  const std::vector<Affine>& jointsOf(int skin);

  const std::filesystem::path& file_;
  const tinygltf::Model& model_;
  const std::vector<PlacedNode>& placed_;
  std::vector<std::optional<Affine>> transforms_;
  std::map<int, std::vector<Affine>> joints_;
};

}  // namespace cloudbake
