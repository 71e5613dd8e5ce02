// assimp 5.2 hands over the keys of an FBX with their values, but without their interpolation: between them, translations, scales and
// weights are blended linearly and rotations by slerp. Its times begin at 0, where the stack of the animation begins, unless there is no
// such time and only morphs are animated. A channel names a node, or a node, '*' and the number of a geometry; a key of morphs has the
// weights of some of the targets.
#include "io/sculpt/assimp_animation.h"

#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <span>

#include "core/error.h"
#include "core/quaternion.h"
#include "io/file/animations.h"
#include "io/sculpt/assimp_types.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr double kTicksPerSecond = 24;  // if an animation does not say

// Two keys and how far a time is on its way from the first to the second, 0 to 1.
template <class Key>
struct Between {
  const Key &from, &to;
  double share;
};
template <class Key>
Between<Key> keysAround(std::span<const Key> keys, double time) {
  const auto after = std::upper_bound(keys.begin(), keys.end(), time, [](double now, const Key& key) { return now < key.mTime; });
  if (after == keys.begin()) return {keys.front(), keys.front(), 0};
  if (after == keys.end()) return {keys.back(), keys.back(), 0};
  const Key& before = *(after - 1);
  return {before, *after, (time - before.mTime) / (after->mTime - before.mTime)};
}

std::array<double, 3> blendedVector(std::span<const aiVectorKey> keys, double time, double otherwise) {
  if (keys.empty()) return {otherwise, otherwise, otherwise};
  const auto [from, to, share] = keysAround(keys, time);
  std::array<double, 3> blended;
  for (unsigned i = 0; i < 3; ++i) blended[i] = (1 - share) * from.mValue[i] + share * to.mValue[i];
  return blended;
}

Quaternion blendedRotation(std::span<const aiQuatKey> keys, double time) {
  const auto unit = [](const aiQuaternion& q) { return normalized(Quaternion{q.x, q.y, q.z, q.w}).value_or(Quaternion{0, 0, 0, 1}); };
  if (keys.empty()) return {0, 0, 0, 1};
  const auto [from, to, share] = keysAround(keys, time);
  return slerp(unit(from.mValue), unit(to.mValue), share);
}

std::span<const aiVectorKey> positionsOf(const aiNodeAnim& channel) { return {channel.mPositionKeys, channel.mNumPositionKeys}; }
std::span<const aiVectorKey> scalesOf(const aiNodeAnim& channel) { return {channel.mScalingKeys, channel.mNumScalingKeys}; }
std::span<const aiQuatKey> rotationsOf(const aiNodeAnim& channel) { return {channel.mRotationKeys, channel.mNumRotationKeys}; }
std::span<const aiMeshMorphKey> keysOf(const aiMeshMorphAnim& channel) { return {channel.mKeys, channel.mNumKeys}; }

aiMatrix4x4 transformAt(const aiNodeAnim& channel, double time) {
  Affine m = rotationBy(blendedRotation(rotationsOf(channel), time));
  const std::array<double, 3> scale = blendedVector(scalesOf(channel), time, 1);
  for (auto& row : m.linear)
    for (size_t c = 0; c < 3; ++c) row[c] *= scale[c];
  m.offset = blendedVector(positionsOf(channel), time, 0);
  aiMatrix4x4 matrix;
  for (unsigned r = 0; r < 3; ++r) {
    for (unsigned c = 0; c < 3; ++c) matrix[r][c] = ai_real(m.linear[r][c]);
    matrix[r][3] = ai_real(m.offset[r]);
  }
  return matrix;
}

// The weights of each target, as keys of its own.
struct WeightKey {
  double mTime, weight;
};
std::vector<std::vector<WeightKey>> weightKeys(const aiMeshMorphAnim& channel) {
  std::vector<std::vector<WeightKey>> targets;
  for (const aiMeshMorphKey& key : keysOf(channel))
    for (unsigned i = 0; i < key.mNumValuesAndWeights; ++i) {
      targets.resize(std::max(targets.size(), size_t(key.mValues[i]) + 1));
      targets[key.mValues[i]].push_back({key.mTime, key.mWeights[i]});
    }
  return targets;
}

std::vector<double> weightsAt(const aiMeshMorphAnim& channel, double time) {
  std::vector<double> weights;
  for (const std::vector<WeightKey>& keys : weightKeys(channel)) {
    weights.push_back(0);
    if (keys.empty()) continue;
    const auto [from, to, share] = keysAround(std::span(keys), time);
    weights.back() = (1 - share) * from.weight + share * to.weight;
  }
  return weights;
}

template <class Key>
bool isConstant(std::span<const Key> keys) {
  return std::ranges::all_of(keys, [&](const Key& key) { return key.mValue == keys.front().mValue; });
}
bool isConstant(const aiNodeAnim& channel) {
  return isConstant(positionsOf(channel)) && isConstant(rotationsOf(channel)) && isConstant(scalesOf(channel));
}
bool isConstant(const aiMeshMorphAnim& channel) {
  return std::ranges::all_of(weightKeys(channel), [](const std::vector<WeightKey>& keys) {
    return std::ranges::all_of(keys, [&](const WeightKey& key) { return key.weight == keys.front().weight; });
  });
}

std::string nodeOf(const aiMeshMorphAnim& channel) {
  const std::string name = channel.mName.C_Str();
  return name.substr(0, name.rfind('*'));
}

// The nodes of a scene by name, and the names of those that place a mesh or a bone, or that are above one that does.
struct Nodes {
  std::multimap<std::string, aiNode*> by_name;
  std::set<std::string> placing;

  explicit Nodes(const aiScene& scene) {
    std::vector<aiNode*> stack{scene.mRootNode}, drawn;
    while (!stack.empty()) {
      aiNode* node = stack.back();
      stack.pop_back();
      by_name.emplace(node->mName.C_Str(), node);
      if (node->mNumMeshes > 0) drawn.push_back(node);
      stack.insert(stack.end(), node->mChildren, node->mChildren + node->mNumChildren);
    }
    for (unsigned m = 0; m < scene.mNumMeshes; ++m)
      for (unsigned b = 0; b < scene.mMeshes[m]->mNumBones; ++b) {
        const auto [first, last] = by_name.equal_range(scene.mMeshes[m]->mBones[b]->mName.C_Str());
        for (auto found = first; found != last; ++found) drawn.push_back(found->second);
      }
    for (const aiNode* node : drawn)
      for (; node && placing.emplace(node->mName.C_Str()).second;) node = node->mParent;
  }
};

// The time of a moment in the ticks of an animation.
double ticksAt(const aiAnimation& animation, double seconds, double& animation_seconds) {
  double start = 0, end = animation.mDuration;
  if (!(end > 0)) {
    start = std::numeric_limits<double>::max(), end = std::numeric_limits<double>::lowest();
    const auto take = [&](const auto& keys) {
      if (!keys.empty()) start = std::min(start, keys.front().mTime), end = std::max(end, keys.back().mTime);
    };
    for (unsigned i = 0; i < animation.mNumChannels; ++i)
      take(positionsOf(*animation.mChannels[i])), take(rotationsOf(*animation.mChannels[i])), take(scalesOf(*animation.mChannels[i]));
    for (unsigned i = 0; i < animation.mNumMorphMeshChannels; ++i) take(keysOf(*animation.mMorphMeshChannels[i]));
  }
  const double per_second = animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : kTicksPerSecond;
  animation_seconds = std::max(0.0, (end - start) / per_second);
  return start + seconds * per_second;
}

}  // namespace

void AssimpPose::morph(const aiMesh& mesh, const aiNode& node, SculptPart& part) const {
  const auto found = morph_weights.find(std::string_view(node.mName.C_Str()));
  if (found == morph_weights.end()) return;
  for (size_t t = 0; t < std::min(found->second.size(), size_t(mesh.mNumAnimMeshes)); ++t) {
    const aiAnimMesh& target = *mesh.mAnimMeshes[t];
    const auto weight = float(found->second[t]);
    if (weight == 0 || target.mNumVertices != mesh.mNumVertices) continue;
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      if (target.HasPositions()) part.positions[v] += toVec3(target.mVertices[v] - mesh.mVertices[v]) * weight;
      if (target.HasNormals() && !part.normals.empty()) part.normals[v] += toVec3(target.mNormals[v] - mesh.mNormals[v]) * weight;
    }
  }
}

AssimpPose poseByAnimation(const fs::path& file, const AnimationMoment& moment, aiScene& scene) {
  std::vector<std::string> names;
  for (unsigned i = 0; i < scene.mNumAnimations; ++i) names.emplace_back(scene.mAnimations[i]->mName.C_Str());
  const size_t index = chosenAnimation(file, names, moment.animation);
  const aiAnimation& animation = *scene.mAnimations[index];
  const Nodes nodes(scene);
  AssimpPose pose;
  const double time = ticksAt(animation, moment.seconds, pose.animation_seconds);
  bool moves = false;
  const auto nodeNamed = [&](const std::string& name) -> aiNode* {
    const auto [first, last] = nodes.by_name.equal_range(name);
    if (first != last && std::next(first) != last)
      throw InputError(file.string(), "several of its nodes are named '" + name + "', so that it is not known which one its animation '" +
                                          names[index] + "' moves: give them different names and export it again");
    return first == last ? nullptr : first->second;
  };
  for (unsigned i = 0; i < animation.mNumChannels; ++i) {
    const aiNodeAnim& channel = *animation.mChannels[i];
    const std::string name = channel.mNodeName.C_Str();
    aiNode* node = nodeNamed(name);
    if (!node) continue;  // of a helper that stays where it is
    moves |= nodes.placing.contains(name) && !isConstant(channel);
    node->mTransformation = transformAt(channel, time);
  }
  for (unsigned i = 0; i < animation.mNumMorphMeshChannels; ++i) {
    const aiMeshMorphAnim& channel = *animation.mMorphMeshChannels[i];
    const std::string name = nodeOf(channel);
    if (!nodeNamed(name)) continue;
    moves |= nodes.placing.contains(name) && !isConstant(channel);
    pose.morph_weights[name] = weightsAt(channel, time);
  }
  if (!moves) refuseStillAnimation(file, names, index);
  return pose;
}

}  // namespace cloudbake
