// The painted chain at full resolution: its steps beside those of preview/mesh_clouds/post.h, on the same channels. Lengths are in heights
// of the picture, so that its size does not change its look.
#pragma once

#include <cstdint>

#include "core/image.h"
#include "core/keys.h"
#include "preview/backdrop/noise.h"
#include "preview/camera.h"
#include "preview/mesh_clouds/channels.h"

namespace cloudbake {

/// Depth carried beyond the clouds: A is the covered mean over the square of half side `radius`, 1 where there is no cloud in it. The other
/// channels do not change.
Image4 spreadDepth(Image4 image, float radius);

/// A blur whose width follows the depth. Two boxes in each direction; σ is 0.82 times their half width.
struct SoftenSettings {
  float near_width = 0.008F, far_width = 0.001F;  ///< half width of the box at A = 0 and from A = 1 on, heights, ≥ 0
};
/// Its keys in a scene file.
const Keys<SoftenSettings>& softenKeys();

/// R, G and B blurred, R and G over what is covered. A does not change.
Image4 soften(Image4 image, const SoftenSettings& settings);

/// The noise that wears clouds away, and the cells between two pixels from which it fades to its mean, and to which.
inline constexpr FbmSettings kErosionNoise{.octaves = 4, .gain = 0.6F};
inline constexpr float kFadingFrom = 0.15F, kFadingTo = 0.5F;

/// How noise wears clouds away where their opacity is under 1.
struct ErodeSettings {
  float shrink = 0.75F;    ///< opacity that the noise takes at its most, 0 … < 1
  float darkening = 0.3F;  ///< of R and G where it takes most, 0 … 1
  uint32_t seed = 0;
};
/// Its keys in a scene file.
const Keys<ErodeSettings>& erodeKeys();

/// Where the noise of `erode` is in the world.
struct NoiseFrame {
  Vec3 origin;
  float size = 1;  ///< of a cell, world units, > 0
};

/// The noise is read at the places that the pixels' depths say: it stays where it is in the world when the camera moves. Where B is 0 or 1,
/// or over kMostCells cells from the frame's origin, nothing changes. Where its cells are too small for the pixels, as far away or where
/// the depth falls from one cloud to another, the noise fades to its mean.
Image4 erode(Image4 image, const Camera& camera, const DepthRange& range, const NoiseFrame& frame, const ErodeSettings& settings);

/// The steps around the distortion; lengths in heights of the picture.
struct PaintedSteps {
  float depth_spread = 0.03F;  ///< how far a cloud's depth extends beyond it, at least as far as it is softened and distorted
  SoftenSettings soften;
  float detail_size = 0.045F;  ///< cells of the noise of `erode`, in longest sides of a cloud, > 0
  ErodeSettings erode;
};
/// Its keys in a scene file.
const Keys<PaintedSteps>& paintedKeys();

}  // namespace cloudbake
