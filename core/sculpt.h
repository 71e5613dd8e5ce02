// Sculpts as they cross stages: parts in their own spaces, whatever format they came from.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// One drawn piece of a sculpt, in its own space: a glTF primitive under one node, or a mesh of another format.
struct SculptPart {
  std::string name;
  std::vector<Vec3> positions;      ///< #V
  std::vector<Vec3> normals;        ///< #V, or empty
  std::vector<Vec2> uvs;            ///< #V, or empty; glTF's convention (v grows downwards). Unused where the source is glTF
  std::vector<Triangle> triangles;  ///< #F
  Affine to_scene;                  ///< own space → scene space
  int object = 0;                   ///< parts of one object (a node of glTF, FBX, …) share a number
  bool repaired = false;            ///< triangles and normals are no longer the file's
};

/// The parsed glTF that a sculpt came from, kept whole for the output (io/gltf.cpp knows its inside).
struct GltfDocument;

/// A sculpt as read: parts that occlude each other, vertex order and count as in the file.
struct Sculpt {
  std::vector<SculptPart> parts;
  std::shared_ptr<const GltfDocument> gltf;  ///< set where the source is glTF
  std::string frame_note{};                  ///< unit and up axis, and who says so
};

/// All parts in scene space as one mesh, vertices in order of the parts: what is baked. Triangles of a mirrored part are turned
/// round, so that they face outwards again. Missing normals are computed (angle-weighted); none are left out.
SurfaceMesh surfaceInScene(const Sculpt& sculpt);

/// "0.01 m per unit, +Z up (as the file says)": for the report.
std::string frameText(double metres_per_unit, char up, bool up_is_negative, const char* source);

}  // namespace cloudbake
