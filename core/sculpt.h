// Sculpts, as they are passed between stages: parts in their own spaces, whatever the file format was.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// One part of a sculpt, in its own space: a glTF primitive under one node, or a mesh of another format.
struct SculptPart {
  std::string name;
  std::vector<Vec3> positions;      ///< #V
  std::vector<Vec3> normals;        ///< #V, or empty
  std::vector<Vec2> uvs;            ///< #V, or empty; glTF's convention (v grows downwards). Unused if the source is glTF
  std::vector<Triangle> triangles;  ///< #F
  Affine to_scene;                  ///< own space → scene space
  int object = 0;                   ///< parts of one object (a node of glTF, FBX, …) share a number
  bool repaired = false;            ///< triangles and normals differ from those in the file
  /// #V, or empty. Joints place every vertex of a skinned part by a map of its own, which then replaces `to_scene`.
  std::vector<Affine> vertex_to_scene{};

  /// Own space → scene space at a vertex.
  const Affine& toScene(size_t vertex) const { return vertex_to_scene.empty() ? to_scene : vertex_to_scene[vertex]; }
  /// Whether a triangle of own vertices is turned inside out on its way to the scene.
  bool isMirrored(const Triangle& triangle) const;
};

/// The parsed glTF that a sculpt was read from, kept whole for the output. io/gltf defines it.
struct GltfDocument;

/// A sculpt as read from its file. Its parts occlude each other. Vertices have the order and count of the file.
struct Sculpt {
  std::vector<SculptPart> parts;
  std::shared_ptr<const GltfDocument> gltf;  ///< set if the source is glTF
  std::string frame_note{};                  ///< unit and up axis, and where they come from
};

/// All parts in scene space as one mesh, which is what is baked. Vertices are in the order of the parts. Triangles of a mirrored part
/// are flipped, so that they face outwards again. Missing normals are computed (angle-weighted), so every vertex has one.
SurfaceMesh surfaceInScene(const Sculpt& sculpt);

/// A text for the report, e.g. "0.01 m per unit, +Z up (as the file says)".
std::string frameText(double metres_per_unit, char up, bool up_is_negative, const char* source);

}  // namespace cloudbake
