// glTF 2.0, section 3.7.3: skins. "The node that holds a skinned mesh has no effect": vertices go from bind space to the scene by their
// joints alone.
#include "io/gltf/sculpt/skin.h"

#include <cmath>

#include "core/error.h"
#include "io/gltf/accessor.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// Joints and weights of all sets of a primitive, side by side: #V×(4·sets).
struct Influences {
  size_t per_vertex = 0;
  std::vector<uint32_t> joints;
  std::vector<float> weights;
};

Influences readInfluences(const fs::path& file, const tinygltf::Model& model, const tinygltf::Primitive& primitive, size_t vertices,
                          const std::string& owner) {
  const GltfAccessors accessors{file, model};
  std::vector<std::vector<uint32_t>> joints;
  std::vector<std::vector<float>> weights;
  for (int set = 0;; ++set) {
    const std::string number = std::to_string(set);
    const auto joint = primitive.attributes.find("JOINTS_" + number), weight = primitive.attributes.find("WEIGHTS_" + number);
    const bool has_joints = joint != primitive.attributes.end(), has_weights = weight != primitive.attributes.end();
    if (!has_joints && !has_weights) break;
    if (has_joints != has_weights)
      throw InputError(file.string(), owner + " has " + (has_joints ? "JOINTS_" : "WEIGHTS_") + number + " but no " +
                                          (has_joints ? "WEIGHTS_" : "JOINTS_") + number + "; export the file again");
    joints.push_back(accessors.readIndices(joint->second, owner, 4));
    weights.push_back(accessors.readFloats(weight->second, 4, owner));
    if (joints.back().size() != 4 * vertices || weights.back().size() != 4 * vertices)
      throw InputError(file.string(), owner + " has joints or weights for another number of vertices than " + std::to_string(vertices) +
                                          "; export the file again");
  }
  Influences all{4 * joints.size(), {}, {}};
  for (size_t v = 0; v < vertices; ++v)
    for (size_t set = 0; set < joints.size(); ++set)
      for (size_t i = 4 * v; i < 4 * v + 4; ++i) all.joints.push_back(joints[set][i]), all.weights.push_back(weights[set][i]);
  return all;
}

void checkInfluences(const fs::path& file, const Influences& all, size_t joints, const std::string& owner) {
  const auto vertex = [&](size_t i) { return owner + ": vertex " + std::to_string(i / all.per_vertex); };
  for (size_t i = 0; i < all.joints.size(); ++i) {
    if (all.joints[i] >= joints)
      throw InputError(file.string(), vertex(i) + " uses joint " + std::to_string(all.joints[i]) + " of " + std::to_string(joints) +
                                          "; the file is damaged, export it again");
    if (!(all.weights[i] >= 0) || !std::isfinite(all.weights[i]))
      throw InputError(file.string(), vertex(i) + " has a weight that is negative or not finite; export the file again");
  }
}

void addScaled(Affine& sum, const Affine& m, double weight) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) sum.linear[r][c] += weight * m.linear[r][c];
    sum.offset[r] += weight * m.offset[r];
  }
}

// Whether a map flattens what it maps, up to the rounding of rotations that are stored as floats.
bool isSingular(const Affine& m) {
  constexpr double kFlat = 1e-12;
  double squares = 0;
  for (const auto& row : m.linear)
    for (const double x : row) squares += x * x;
  return !inverted(m) || std::fabs(determinant(m)) <= kFlat * squares * std::sqrt(squares);
}

// Moves a point as `flat` does, but maps vectors by the linear part of `strongest`, or not at all.
Affine unflattened(const Affine& flat, const Affine& strongest, Vec3 p) {
  Affine m = isSingular(strongest) ? Affine{} : strongest;
  const double point[3] = {p.x, p.y, p.z};
  for (int r = 0; r < 3; ++r) {
    m.offset[r] = flat.offset[r];
    for (int c = 0; c < 3; ++c) m.offset[r] += (flat.linear[r][c] - m.linear[r][c]) * point[c];
  }
  return m;
}

Affine matrixAt(const std::vector<float>& floats, size_t index) {
  Affine m;
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 3; ++c) m.linear[r][c] = floats[16 * index + 4 * c + r];
    m.offset[r] = floats[16 * index + 12 + r];
  }
  return m;
}

bool isFiniteMap(const Affine& m) {
  double sum = 0;  // infinite or NaN if one of them is
  for (int r = 0; r < 3; ++r) sum += m.linear[r][0] + m.linear[r][1] + m.linear[r][2] + m.offset[r];
  return std::isfinite(sum);
}

}  // namespace

const std::vector<Affine>& Poser::jointsOf(int skin_index) {
  const auto [entry, is_new] = joints_.try_emplace(skin_index);
  if (!is_new) return entry->second;
  const std::string owner = "skin " + std::to_string(skin_index);
  if (skin_index < 0 || size_t(skin_index) >= model_.skins.size())
    throw InputError(file_.string(), owner + " does not exist; export the file again");
  const tinygltf::Skin& skin = model_.skins[size_t(skin_index)];
  std::vector<float> inverse_bind;
  if (skin.inverseBindMatrices >= 0) {
    inverse_bind = GltfAccessors{file_, model_}.readFloats(skin.inverseBindMatrices, 16, owner);
    if (inverse_bind.size() < 16 * skin.joints.size())
      throw InputError(file_.string(), owner + " has " + std::to_string(skin.joints.size()) + " joints but " +
                                           std::to_string(inverse_bind.size() / 16) + " inverse bind matrices; export the file again");
  }
  if (transforms_.empty()) transforms_ = allTransforms(model_, placed_);
  for (size_t i = 0; i < skin.joints.size(); ++i) {
    const int node = skin.joints[i];
    if (node < 0 || size_t(node) >= transforms_.size() || !transforms_[size_t(node)])
      throw InputError(file_.string(), "joint " + std::to_string(i) + " of " + owner + " is node " + std::to_string(node) +
                                           ", which does not exist or is its own ancestor; export the file again");
    const Affine& joint = *transforms_[size_t(node)];
    entry->second.push_back(inverse_bind.empty() ? joint : compose(joint, matrixAt(inverse_bind, i)));
    if (!isFiniteMap(entry->second.back()))
      throw InputError(file_.string(),
                       "the matrix of joint " + std::to_string(i) + " of " + owner + " is not finite; export the file again");
  }
  return entry->second;
}

std::vector<Affine> Poser::mapsOf(const tinygltf::Primitive& primitive, int skin, const std::vector<Vec3>& positions,
                                  const std::string& owner, Warnings& warnings) {
  const std::vector<Affine>& joints = jointsOf(skin);
  const Influences all = readInfluences(file_, model_, primitive, positions.size(), owner);
  if (all.per_vertex == 0) return {};
  checkInfluences(file_, all, joints.size(), owner);
  std::vector<Affine> maps;
  for (size_t v = 0; v < positions.size(); ++v) {
    const size_t first = v * all.per_vertex, end = first + all.per_vertex;
    double sum = 0;
    size_t strongest = first;
    for (size_t i = first; i < end; ++i) {
      sum += all.weights[i];
      if (all.weights[i] > all.weights[strongest]) strongest = i;
    }
    Affine map{{}, {}};
    for (size_t i = first; i < end; ++i)
      if (all.weights[i] > 0) addScaled(map, joints[all.joints[i]], all.weights[i] / sum);
    const bool is_weightless = !(sum > 0);
    if (is_weightless) map = joints[all.joints[strongest]];
    const bool is_flat = isSingular(map);
    if (is_flat) map = unflattened(map, joints[all.joints[strongest]], positions[v]);
    if (is_weightless || is_flat)
      warnings.add(WarningKind::kJointFallback,
                   file_.string() + ": " + owner + ": vertex " + std::to_string(v) +
                       (is_flat ? " is flattened by its joints: its lobe is stored as its strongest joint turns it, or not turned"
                                : " has no weight: its first joint places it"));
    maps.push_back(map);
  }
  return maps;
}

}  // namespace cloudbake
