// Poses a scene of assimp as one of its animations has it at a moment.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/sculpt.h"
#include "io/file/read_settings.h"

struct aiMesh;
struct aiNode;
struct aiScene;

namespace cloudbake {

struct AssimpPose {
  double animation_seconds = 0;                                             ///< how long the animation is
  std::map<std::string, std::vector<double>, std::less<>> morph_weights{};  ///< of each target of the meshes of a node, by its name

  /// Moves the vertices and normals of a mesh that `node` draws by its morph targets. `part` has them in the order of the mesh.
  void morph(const aiMesh& mesh, const aiNode& node, SculptPart& part) const;
};

/// Gives the nodes their transforms at a moment. Throws InputError if the file has no animation, or none of that name, if the animation
/// moves nothing that has a mesh, or if several nodes have a name that it moves.
AssimpPose poseByAnimation(const std::filesystem::path& file, const AnimationMoment& moment, aiScene& scene);

}  // namespace cloudbake
