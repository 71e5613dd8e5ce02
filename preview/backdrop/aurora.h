// The aurora of the night: curtains of light with rays along the vertical, which move with the time.
#pragma once

#include <cstdint>

#include "core/keys.h"
#include "core/vec3.h"

namespace cloudbake {

struct AuroraSettings {
  Vec3 low_color{0.09F, 0.95F, 0.42F};             ///< at the lower border of a curtain, linear
  Vec3 high_color{0.55F, 0.16F, 0.85F};            ///< where it fades out
  float bottom_degrees = 7, top_degrees = 55;      ///< elevations between which the curtains are; bottom < top
  float strength = 0.4F;                           ///< factor of the light, ≥ 0
  float speed = 1;                                 ///< of the folds and rays, ≥ 0
  float scale = 1.6F;                              ///< how many folds a curtain has around the viewer, > 0
  float ray_scale = 20;                            ///< how many rays a fold has, > 0
  float low_height = -0.22F, high_height = -0.1F;  ///< sines of the sun's elevation between which it fades; low < high
  uint32_t seed = 0;
  float time_seconds = 0;
};
/// Its keys in a scene file.
const Keys<AuroraSettings>& auroraKeys();

/// The light of the aurora along a unit vector under a sun of this height, linear and finite; 0 below `bottom` and above `top`.
Vec3 auroraLight(Vec3 view, float sun_height, const AuroraSettings& settings);

}  // namespace cloudbake
