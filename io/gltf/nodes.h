// The nodes of a glTF: where a scene places them. Only for io/gltf.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/affine.h"
#include "core/warnings.h"
#include "io/gltf/document.h"
#include "io/gltf/tinygltf.h"

namespace cloudbake {

struct PlacedNode {
  int node;
  Affine to_scene;
  bool hidden = false;  ///< KHR_node_visibility hides it or an ancestor
};

/// The scene's nodes, depth first. The scene is `index`, else the default scene, else scene 0, else all root nodes. Throws InputError if
/// the scene or a node does not exist, or if a node is its own ancestor or has two parents.
std::vector<PlacedNode> walkScene(const std::filesystem::path& file, const tinygltf::Model& model, std::optional<int> index);

/// Counts kOtherScene for every node with a mesh that some scene draws, but not the one whose nodes are `placed`.
void countOtherScenes(const std::filesystem::path& file, const tinygltf::Model& model, const std::vector<PlacedNode>& placed,
                      Warnings& warnings);

/// Own space → scene space of every node, whether a scene draws it or not. Nothing for nodes that are their own ancestors. `placed`, the
/// result of walkScene, takes precedence.
std::vector<std::optional<Affine>> allTransforms(const tinygltf::Model& model, const std::vector<PlacedNode>& placed);

/// "node 3 ('arm')".
std::string nodeLabel(const tinygltf::Model& model, int node);

}  // namespace cloudbake
