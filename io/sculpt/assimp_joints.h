// The pose that joints give the meshes of a scene.
#pragma once

#include <filesystem>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/sculpt.h"
#include "core/warnings.h"

struct aiMesh;
struct aiNode;
struct aiScene;

namespace cloudbake {

/// Own space → the space below the root.
Affine belowRoot(const aiNode& node);

class JointPoses {
 public:
  /// Finds the joints in a scene whose nodes have unique names (Collada: ids). `by_blender`: Blender has written the file.
  void find(const aiScene& scene, bool by_blender);
  /// Moves the vertices and normals of mesh `index`, which `node` draws, to where its joints put them. Returns whether it did: not if a
  /// joint is no node of the scene. Counts kJointFallback for vertices without weights.
  bool pose(unsigned index, const aiMesh& mesh, const aiNode& node, SculptPart& part, const std::filesystem::path& file,
            Warnings& warnings) const;

 private:
  std::vector<std::vector<std::optional<Affine>>> joints_;  // per mesh and bone: from the mesh to the space of the root
  bool by_blender_ = false;
};

}  // namespace cloudbake
