// Sculpts, as they are passed between stages: parts in their own spaces, whatever the file format was.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// A node of a sculpt's hierarchy: an object, a group, or an empty.
struct SculptNode {
  std::string name;
  int parent = -1;  ///< index of a node before this one; −1 = the scene
  Affine local;     ///< own space → the parent's space
};

/// An image as its file stores it.
struct SculptImage {
  std::string name;
  std::string bytes;
  std::string mime_type;  ///< "image/png" or "image/jpeg"
};

enum class TextureWrap { kRepeat, kClamp, kMirror };

/// A use of an image by a material. `offset` and `scale` are those of KHR_texture_transform.
struct SculptTexture {
  int image = -1;  ///< index into Sculpt::images; −1 = no texture
  int uv_set = 0;
  TextureWrap wrap = TextureWrap::kRepeat;
  Vec2 offset{0, 0}, scale{1, 1};
};

/// A material of glTF's metallic-roughness model. Colours are linear.
struct SculptMaterial {
  std::string name;
  std::array<float, 4> base_color{1, 1, 1, 1};  ///< 0 … 1
  std::array<float, 3> emission{0, 0, 0};       ///< ≥ 0, may exceed 1
  float metallic = 0, roughness = 1;            ///< 0 … 1
  bool double_sided = false;
  bool blended = false;  ///< the alpha of the colour or its texture makes it transparent
  float normal_scale = 1;
  SculptTexture base_color_texture, metallic_roughness_texture, normal_texture, occlusion_texture, emissive_texture;
};

/// One part of a sculpt, in its own space: glTF primitives of the same vertices, or the triangles of one node and one material.
struct SculptPart {
  std::string name;
  std::vector<Vec3> positions;      ///< #V
  std::vector<Vec3> normals;        ///< #V, or empty
  std::vector<Vec2> uvs;            ///< #V, or empty; glTF's convention (v grows downwards). Unused if the source is glTF
  std::vector<Triangle> triangles;  ///< #F
  Affine to_scene;                  ///< own space → scene space
  int object = 0;                   ///< parts of one object (a node of glTF, FBX, …) share a number
  bool repaired = false;            ///< triangles and normals differ from those in the file
  // Unused if the source is glTF:
  int node = -1;                               ///< index into Sculpt::nodes; −1 = a node of its own in the scene
  int material = -1;                           ///< index into Sculpt::materials; −1 = none
  std::vector<std::array<float, 4>> colors{};  ///< #V, or empty
  std::vector<std::vector<Vec2>> more_uvs{};   ///< UV sets 1 and up, #V each
  /// #V, or empty. Joints place every vertex of a skinned part by a map of its own, which then replaces `to_scene`.
  std::vector<Affine> vertex_to_scene{};
  std::string fixed{};  ///< why no vertices can be added between others ("is skinned"); empty if they can
  /// The last vertices, which --refine added: each lies halfway between two vertices before it, and so do all its attributes.
  /// Directions of these may lie between two others in turn: they get unit length only after all are blended (directionBetween).
  std::vector<std::array<uint32_t, 2>> midpoints{};

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
  // Contents of the output besides the parts. Empty if the source is glTF.
  std::vector<SculptNode> nodes{};
  std::vector<SculptMaterial> materials{};
  std::vector<SculptImage> images{};
  double animation_seconds = 0;  ///< how long the animation is by which the sculpt was posed (ReadSettings::moment)
};

/// A sculpt of one part, in scene space.
inline Sculpt sculptOf(std::string name, SurfaceMesh mesh) {
  Sculpt sculpt;
  sculpt.parts.push_back({std::move(name), std::move(mesh.positions), std::move(mesh.normals), {}, std::move(mesh.triangles), {}});
  return sculpt;
}

/// The part of every vertex, in the order of the parts.
std::vector<uint32_t> partsOfVertices(const Sculpt& sculpt);

/// All parts in scene space as one mesh, which is what is baked. Vertices are in the order of the parts. Triangles of a mirrored part
/// are flipped, so that they face outwards again. Missing normals are computed (angle-weighted), so every vertex has one.
SurfaceMesh surfaceInScene(const Sculpt& sculpt);

/// A text for the report, e.g. "0.01 m per unit, +Z up (as the file says)".
std::string frameText(double metres_per_unit, char up, bool up_is_negative, const char* source);
/// Whether such a text says that the unit or the axis was given by the user: "(as given)".
bool isFrameGiven(std::string_view frame_text);

}  // namespace cloudbake
