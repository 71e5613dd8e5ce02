// Lobe impostors: pictures of a cloud from all sides, whose pixels keep the lobe instead of a colour, so that any light can shine on them.
// The frames of an atlas are seen from directions on an octahedron (R. Brucks, "Octahedral Impostors", 2018, after Cigolle and others, "A
// Survey of Efficient Representations for Independent Unit Vectors", JCGT 2014). shaders/functions/impostor.glsl is the same for engines.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/types.h"

namespace cloudbake {

/// What the lobes of an impostor show.
enum class ImpostorOf {
  kVolume,  ///< the light of the volume, as it is seen along the view
  kMesh     ///< the lobes of the mesh's surface
};

/// Lengths are scene units, directions have scene axes.
struct ImpostorInfo {
  int views = 9;   ///< N: the atlas has N × N frames, ≥ 2
  int frame = 64;  ///< pixels to a side of a frame
  ImpostorOf of = ImpostorOf::kVolume;
  Vec3 center;             ///< of the ball that each frame shows
  float radius = 1;        ///< of that ball; the frame is as wide as the ball
  Box box;                 ///< of the cloud
  float exponent = 3;      ///< k and b
  float extinction = 0;    ///< σ
  float thickest = 0;      ///< d of the value 1
  bool gains = false;      ///< the sun's term is that of a fit to a volume, which the painted look brightens
  std::string input_hash;  ///< XXH3-128 of the asset's bytes, hexadecimal
  int level = 0;           ///< of an impostor that is a level of detail of an asset: as in AssetInfo, also the next two
  int switch_pixels = 0;
  std::string level_of;  ///< input_hash of that asset
};

/// What a texel has beside its opacity and depth. Light from l shows lit · exp(−σ max(0, l·o/2 + ½)^k d): the lobe formula with
/// b = −ln(lit) / σ.
struct TexelLobe {
  Lobe lobe;
  float lit = 1;  ///< 0 … 1
};

/// What light a texel shows from a unit direction to the light, 0 … 1.
float texelLight(const TexelLobe& texel, Vec3 to_light, float exponent, float extinction);

/// The two pictures of an atlas, and their mip levels: means of 2 × 2 texels, down to kLeastFrame texels to a side of a frame. Frame (i, j)
/// is i frames from the left and j from the top. All values are 0 … 1; those of the pictures are in steps of 1/255.
struct Impostor {
  ImpostorInfo info;
  std::vector<Image> lobe;  ///< o as a point of an octahedron's map (2 values), √(d / thickest)
  std::vector<Image> rest;  ///< lit; opacity; depth, 0 nearest to the eye and 1 farthest from it in the ball
};
inline constexpr int kLeastFrame = 4;
/// The most pixels to a side of an atlas: those of the largest picture that GPUs take.
inline constexpr int kLargestAtlas = 16384;

/// An atlas without mip levels, in which nothing is seen.
Impostor blankImpostor(const ImpostorInfo& info);
/// Makes the mip levels anew.
void addMipLevels(Impostor& impostor);

/// The cloud's box, without lobes, which has the impostor: what scenes place. Its k, b and σ are those of the impostor.
BakedMesh boxWithImpostor(Impostor impostor);

/// The direction to the eye from which frame (i, j) of N × N is seen; a unit vector. The middle of the octahedron's map is +Y, its corners
/// are −Y, +X is right and +Z down.
Vec3 frameDirection(int i, int j, int views);

/// A frame and how much it counts.
struct FrameWeight {
  int i = 0, j = 0;
  float weight = 0;
};
/// The three frames around a direction to the eye (a unit vector); the weights are ≥ 0 and have the sum 1.
std::array<FrameWeight, 3> framesAround(Vec3 to_eye, int views);

/// The axes of a frame's picture.
struct FrameAxes {
  Vec3 right, up, to_eye;
};
FrameAxes frameAxes(Vec3 to_eye);
/// A direction in these axes.
inline Vec3 inView(const FrameAxes& axes, Vec3 direction) {
  return {dot(axes.right, direction), dot(axes.up, direction), dot(axes.to_eye, direction)};
}

/// A direction o as two values of 0 … 1, and back. The middle of the map is the direction away from the eye, so that its folds, over which
/// filters cannot mix, are at directions to the eye, which o seldom has.
Vec2 encodedDirection(Vec3 direction, const FrameAxes& axes);
Vec3 decodedDirection(Vec2 encoded, const FrameAxes& axes);

}  // namespace cloudbake
