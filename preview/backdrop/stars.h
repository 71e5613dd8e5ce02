// Stars of the night: points that stand still in a sky that turns.
#pragma once

#include <cstdint>

#include "core/keys.h"
#include "core/vec3.h"

namespace cloudbake {

struct StarSettings {
  int count = 6000;                                ///< over the whole sky, about; 100 … 1000000
  float brightness = 0.6F;                         ///< of the brightest ones, linear, ≥ 0; ten times as many have a fifth of it
  float size_degrees = 0.09F;                      ///< diameter at which a star has fallen to half its brightness, > 0
  float tint = 0.5F;                               ///< 0 = all white, 1 = from orange to blue
  float low_height = -0.2F, high_height = -0.05F;  ///< sines of the sun's elevation between which they fade; low < high
  uint32_t seed = 0;
  Vec3 pole{0, 0.70710678F, -0.70710678F};  ///< unit: the axis about which the sky turns
  float turn_degrees = 0;                   ///< about that axis, counter-clockwise for who looks along it from its tip
  float day_turn_degrees = 0;               ///< added to it: the turn of the hour
};
/// Its keys in a scene file.
const Keys<StarSettings>& starKeys();

/// The light of the stars along a unit vector under a sun of this height; 0 below the horizon.
Vec3 starLight(Vec3 view, float sun_height, const StarSettings& settings);

}  // namespace cloudbake
