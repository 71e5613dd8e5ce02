// glTF 2.0, section 3.5: scenes, the hierarchy of nodes and their transforms. KHR_node_visibility (Khronos): a node that is not visible
// hides its descendants too. An animation of its visibility (KHR_animation_pointer) does not count.
#include "io/gltf/nodes.h"

#include "core/error.h"
#include "core/quaternion.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// A node's local transform: its matrix (column-major), or T·R·S.
Affine localTransform(const tinygltf::Node& node) {
  Affine m;
  if (node.matrix.size() == 16) {
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 3; ++c) m.linear[r][c] = node.matrix[4 * c + r];
      m.offset[r] = node.matrix[12 + r];
    }
    return m;
  }
  if (node.rotation.size() == 4) m = rotationBy({node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3]});
  for (size_t c = 0; c < 3; ++c) {
    if (node.scale.size() == 3)
      for (size_t r = 0; r < 3; ++r) m.linear[r][c] *= node.scale[c];
    if (node.translation.size() == 3) m.offset[c] = node.translation[c];
  }
  return m;
}

// The nodes that are no other node's child.
std::vector<int> rootsOf(const tinygltf::Model& model) {
  const int count = int(model.nodes.size());
  std::vector<bool> is_child(model.nodes.size());
  for (const tinygltf::Node& node : model.nodes)
    for (const int child : node.children)
      if (child >= 0 && child < count) is_child[size_t(child)] = true;
  std::vector<int> roots;
  for (int node = 0; node < count; ++node)
    if (!is_child[size_t(node)]) roots.push_back(node);
  return roots;
}

// The number of the scene that is baked; nothing if the file has no scenes.
std::optional<size_t> chosenScene(const fs::path& file, const tinygltf::Model& model, std::optional<int> index) {
  const size_t count = model.scenes.size();
  if (index && (*index < 0 || size_t(*index) >= count))
    throw InputError(file.string(), "there is no scene " + std::to_string(*index) + ": the file has " + std::to_string(count) +
                                        (count > 1    ? " scenes, 0 to " + std::to_string(count - 1)
                                         : count == 1 ? " scene, 0"
                                                      : " scenes") +
                                        "; give one of them, or leave --scene-index out");
  if (count == 0) return std::nullopt;
  const int scene = index ? *index : model.defaultScene < 0 ? 0 : model.defaultScene;
  if (size_t(scene) >= count) throw InputError(file.string(), "the default scene does not exist; export the file again");
  return size_t(scene);
}

bool hides(const tinygltf::Node& node) {
  const auto found = node.extensions.find("KHR_node_visibility");
  return found != node.extensions.end() && found->second.Has("visible") && !found->second.Get("visible").Get<bool>();
}

}  // namespace

std::string nodeLabel(const tinygltf::Model& model, int node) {
  const std::string& name = model.nodes[size_t(node)].name;
  return "node " + std::to_string(node) + (name.empty() ? "" : " ('" + name + "')");
}

std::vector<PlacedNode> walkScene(const fs::path& file, const tinygltf::Model& model, std::optional<int> index) {
  const int count = int(model.nodes.size());
  const std::optional<size_t> scene = chosenScene(file, model, index);
  const std::vector<int> roots = scene ? model.scenes[*scene].nodes : rootsOf(model);
  std::vector<PlacedNode> placed, stack;
  for (size_t i = roots.size(); i-- > 0;) stack.push_back({roots[i], {}, false});
  std::vector<bool> met(model.nodes.size());
  while (!stack.empty()) {
    const PlacedNode visit = stack.back();
    stack.pop_back();
    if (visit.node < 0 || visit.node >= count)
      throw InputError(file.string(),
                       "the scene uses node " + std::to_string(visit.node) + " of " + std::to_string(count) + "; export the file again");
    if (met[size_t(visit.node)])
      throw InputError(file.string(), nodeLabel(model, visit.node) + " is its own ancestor or has two parents; export the file again");
    met[size_t(visit.node)] = true;
    const tinygltf::Node& node = model.nodes[size_t(visit.node)];
    const Affine to_scene = compose(visit.to_scene, localTransform(node));
    const bool hidden = visit.hidden || hides(node);
    placed.push_back({visit.node, to_scene, hidden});
    for (size_t i = node.children.size(); i-- > 0;) stack.push_back({node.children[i], to_scene, hidden});
  }
  return placed;
}

void countOtherScenes(const fs::path& file, const tinygltf::Model& model, const std::vector<PlacedNode>& placed, Warnings& warnings) {
  std::vector<bool> met(model.nodes.size());
  for (const PlacedNode& one : placed) met[size_t(one.node)] = true;
  for (size_t scene = 0; scene < model.scenes.size(); ++scene) {
    std::vector<int> stack = model.scenes[scene].nodes;
    while (!stack.empty()) {
      const int index = stack.back();
      stack.pop_back();
      if (index < 0 || size_t(index) >= model.nodes.size() || met[size_t(index)]) continue;
      met[size_t(index)] = true;
      const tinygltf::Node& node = model.nodes[size_t(index)];
      stack.insert(stack.end(), node.children.begin(), node.children.end());
      if (node.mesh >= 0)
        warnings.add(WarningKind::kOtherScene, file.string() + ": " + nodeLabel(model, index) + " is only in scene " +
                                                   std::to_string(scene) + ", gets no lobes and shades nothing; --scene-index " +
                                                   std::to_string(scene) + " bakes that scene instead");
    }
  }
}

std::vector<std::optional<Affine>> allTransforms(const tinygltf::Model& model, const std::vector<PlacedNode>& placed) {
  std::vector<std::optional<Affine>> transforms(model.nodes.size());
  for (const PlacedNode& one : placed) transforms[size_t(one.node)] = one.to_scene;
  std::vector<PlacedNode> stack;
  for (const int root : rootsOf(model)) stack.push_back({root, {}, false});
  std::vector<bool> met(model.nodes.size());
  while (!stack.empty()) {
    const PlacedNode visit = stack.back();
    stack.pop_back();
    if (visit.node < 0 || size_t(visit.node) >= model.nodes.size() || met[size_t(visit.node)]) continue;
    met[size_t(visit.node)] = true;
    const tinygltf::Node& node = model.nodes[size_t(visit.node)];
    std::optional<Affine>& own = transforms[size_t(visit.node)];
    if (!own) own = compose(visit.to_scene, localTransform(node));
    for (const int child : node.children) stack.push_back({child, *own, false});
  }
  return transforms;
}

}  // namespace cloudbake
