// The parts of a new glTF document that describe a sculpt of another format: its materials with their images, and its nodes. Only for
// write.cpp.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "core/sculpt.h"
#include "io/gltf/asset_info.h"

namespace cloudbake {

/// Appends "materials", and "textures", "samplers" and "images" if a material uses them. `add_image` stores the bytes of an image and
/// returns its buffer view. A material for parts without one is appended last, if there are such parts.
void writeMaterials(const Sculpt& sculpt, const std::function<int(std::string_view)>& add_image, Json& json);

/// How a node is written. glTF requires a matrix to be a product of translation, rotation and scale. A node with a sheared transform, and
/// one under a node that was moved, becomes a root; if its place in the scene is sheared too, its vertices must be moved to scene space.
struct PlacedSculptNode {
  int parent = -1;
  Affine local;
  bool in_scene_space = false;  ///< the vertices of its parts are stored in scene space, and `local` is the identity
};

/// One per node; parents come before their children. Counts kHierarchyChanged.
std::vector<PlacedSculptNode> placeNodes(const std::vector<SculptNode>& nodes, Warnings& warnings);

/// Appends "nodes" and the scene's roots. `mesh_of_node` is −1 for a node without a mesh.
void writeNodes(const std::vector<SculptNode>& nodes, const std::vector<PlacedSculptNode>& placed, const std::vector<int>& mesh_of_node,
                Json& json);

}  // namespace cloudbake
