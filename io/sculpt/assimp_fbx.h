// Which node of assimp is which model of an FBX.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/sculpt/fbx_models.h"

struct aiNode;
struct aiScene;

namespace cloudbake {

/// A model in the tree of the scene. A model that is connected to several parents is there several times.
struct FbxNode {
  const aiNode* node;  ///< the one that has the model's meshes
  const FbxModel* model;
  int parent;  ///< index of a node before this one; −1 = the scene
};

/// All models in the scene, depth first. Nothing if the trees of assimp and of the file differ.
std::optional<std::vector<FbxNode>> matchFbxNodes(const aiScene& scene, const FbxModels& models);

/// The text of an FBX in which no number is longer than 31 characters, which is all that assimp reads of one. Nothing if none has to be
/// shortened.
std::optional<std::string> withShortNumbers(std::string_view fbx);

}  // namespace cloudbake
