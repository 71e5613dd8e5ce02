// COLLADA 1.4.1, "Skinning a skeleton": a vertex v of a skin lies at  Σ w · joint · inverse bind matrix · bind shape matrix · v,  with
// weights w that sum to 1. The transform of the node that draws the skin has no part in it, so it is undone: the output's node has it.
// assimp's offset matrix of a bone is the product of the two matrices on the right. Blender (to 3.4) writes the bind shape matrix relative
// to the armature, but the inverse bind matrices relative to the scene, so that its skins are off by the armature's transform.
#include "io/sculpt/assimp_joints.h"

#include <assimp/scene.h>

#include <string>

#include "io/sculpt/assimp_types.h"

namespace cloudbake {

namespace {

void addScaled(Affine& sum, const Affine& map, double by) {
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 3; ++c) sum.linear[r][c] += by * map.linear[r][c];
    sum.offset[r] += by * map.offset[r];
  }
}

}  // namespace

Affine belowRoot(const aiNode& node) {
  Affine map;
  for (const aiNode* n = &node; n->mParent; n = n->mParent) map = compose(toAffine(n->mTransformation), map);
  return map;
}

void JointPoses::find(const aiScene& scene, bool by_blender) {
  by_blender_ = by_blender;
  std::unordered_map<std::string, const aiNode*> nodes;  // null: not unique
  std::vector<const aiNode*> stack{scene.mRootNode};
  while (!stack.empty()) {
    const aiNode* node = stack.back();
    stack.pop_back();
    const auto [entry, added] = nodes.try_emplace(node->mName.C_Str(), node);
    if (!added) entry->second = nullptr;
    stack.insert(stack.end(), node->mChildren, node->mChildren + node->mNumChildren);
  }
  joints_.resize(scene.mNumMeshes);
  for (unsigned m = 0; m < scene.mNumMeshes; ++m)
    for (unsigned b = 0; b < scene.mMeshes[m]->mNumBones; ++b) {
      const aiBone& bone = *scene.mMeshes[m]->mBones[b];
      const auto found = nodes.find(bone.mName.C_Str());
      joints_[m].push_back(found == nodes.end() || !found->second
                               ? std::nullopt
                               : std::optional(compose(belowRoot(*found->second), toAffine(bone.mOffsetMatrix))));
    }
}

bool JointPoses::pose(unsigned index, const aiMesh& mesh, const aiNode& node, SculptPart& part, const std::filesystem::path& file,
                      Warnings& warnings) const {
  const Affine own = belowRoot(node);
  const auto undone = inverted(own);
  if (!mesh.HasBones() || !undone || index >= joints_.size() || joints_[index].size() != mesh.mNumBones) return false;
  for (const auto& joint : joints_[index])
    if (!joint) return false;
  const Affine none{{}, {}};
  std::vector<Affine> maps(part.positions.size(), none);
  std::vector<double> weights(part.positions.size(), 0);
  for (unsigned b = 0; b < mesh.mNumBones; ++b)
    for (unsigned w = 0; w < mesh.mBones[b]->mNumWeights; ++w) {
      const aiVertexWeight& weight = mesh.mBones[b]->mWeights[w];
      if (weight.mVertexId >= maps.size()) return false;
      addScaled(maps[weight.mVertexId], *joints_[index][b], weight.mWeight);
      weights[weight.mVertexId] += weight.mWeight;
    }
  uint64_t loose = 0;
  for (size_t v = 0; v < maps.size(); ++v) {
    if (!(weights[v] > 0)) {
      ++loose;
      continue;
    }
    Affine map = none;
    addScaled(map, maps[v], 1 / weights[v]);
    map = compose(*undone, map);
    part.positions[v] = transformPoint(map, part.positions[v]);
    if (!part.normals.empty()) part.normals[v] = normalized(transformVector(normalMap(map), part.normals[v])).value_or(Vec3{});
  }
  warnings.add(WarningKind::kTransformGuessed,
               file.string() + ": Blender has left the armature's transform out of the skin; apply it before the export",
               by_blender_ && (own.linear != Affine().linear || own.offset != Affine().offset));
  warnings.add(WarningKind::kJointFallback, file.string() + ": vertices without weights stay where they are stored", loose);
  return true;
}

}  // namespace cloudbake
