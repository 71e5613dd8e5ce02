// assimp 5.2 makes a node per model, in the order of the connections. If a model has pivots, the node is the last of a chain of helpers,
// NAME_$AssimpFbx$_Translation and so on, and if it also has a geometric transform and children, its children are below a second chain that
// undoes that transform. Names repeat, so both trees are walked in parallel.
#include "io/sculpt/assimp_fbx.h"

#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/text/numbers.h"
#include "core/text/scan.h"

namespace cloudbake {

namespace {

std::string_view nameOf(const aiNode& node) { return {node.mName.C_Str(), node.mName.length}; }

// assimp cuts names.
bool isNamed(const aiNode& node, std::string_view name) { return nameOf(node) == name.substr(0, MAXLEN - 1); }

bool isHelperOf(const aiNode& node, std::string_view name, std::string_view kind) {
  const std::string helper = std::string(name) + "_$AssimpFbx$_" + std::string(kind);
  return nameOf(node).starts_with(std::string_view(helper).substr(0, MAXLEN - 1));
}

// The node of a model whose chain begins at `node`, or null.
const aiNode* endOfChain(const aiNode* node, std::string_view name) {
  while (!isNamed(*node, name)) {
    if (!isHelperOf(*node, name, "") || node->mNumChildren != 1 || node->mNumMeshes > 0) return nullptr;
    node = node->mChildren[0];
  }
  return node;
}

// The node that has the nodes of the model's children.
const aiNode* parentOfChildren(const aiNode* node, std::string_view name) {
  while (node->mNumChildren == 1 && isHelperOf(*node->mChildren[0], name, "Geometric")) node = node->mChildren[0];
  return node;
}

}  // namespace

std::optional<std::vector<FbxNode>> matchFbxNodes(const aiScene& scene, const FbxModels& models) {
  struct Visit {
    const aiNode* node;
    size_t model;
    int parent;
  };
  std::vector<Visit> stack;
  const auto push = [&](const aiNode& parent_node, const std::vector<size_t>& children, int parent) {
    if (parent_node.mNumChildren != children.size()) return false;
    for (size_t i = children.size(); i-- > 0;) stack.push_back({parent_node.mChildren[i], children[i], parent});
    return true;
  };
  std::vector<FbxNode> matched;
  if (!push(*scene.mRootNode, models.roots, -1)) return std::nullopt;
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const FbxModel& model = models.models[visit.model];
    const aiNode* node = endOfChain(visit.node, model.name);
    if (!node) return std::nullopt;
    matched.push_back({node, &model, visit.parent});
    if (!push(*parentOfChildren(node, model.name), model.children, int(matched.size()) - 1)) return std::nullopt;
  }
  return matched;
}

std::optional<std::string> withShortNumbers(std::string_view fbx) {
  constexpr size_t kMostRead = 31;
  constexpr std::string_view kOfNumbers = "+-.0123456789eE", kBetween = " ,:\t\r\n{}";
  std::string text;
  size_t copied = 0;
  for (size_t at = 0; (at = fbx.find_first_of(kOfNumbers, at)) != fbx.npos;) {
    const size_t begin = at;
    at = std::min(fbx.find_first_not_of(kOfNumbers, begin), fbx.size());
    const bool is_word =
        begin > 0 && kBetween.find(fbx[begin - 1]) != kBetween.npos && at < fbx.size() && kBetween.find(fbx[at]) != kBetween.npos;
    const auto number = is_word && at - begin > kMostRead ? parseNumber(fbx.substr(begin, at - begin)) : std::nullopt;
    if (!number || !std::isfinite(*number)) continue;
    text.append(fbx.substr(copied, begin - copied)).append(shortestText(*number));
    copied = at;
  }
  if (copied == 0) return std::nullopt;
  return text.append(fbx.substr(copied));
}

}  // namespace cloudbake
