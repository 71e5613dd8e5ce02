// The discs of sun and moon.
#pragma once

#include "core/keys.h"
#include "core/vec3.h"

namespace cloudbake {

/// How a disc is drawn: by its mask, or as a plateau that falls off over the sky.
enum class DiscKind { kSimple, kSmooth };

/// m = saturate(max(0, l·v)^exponent · gain): 1 inside the angle arccos(gain^(−1/exponent)), then a soft rim.
struct DiscSettings {
  float exponent = 1000;  ///< a: how sharp the rim is, ≥ 1
  float gain = 250;       ///< b: how large the disc is, ≥ 0; 0 = no disc. The radius is √(2·ln(b)/a)
};

/// The published disc has a radius of 6 degrees. The default of our pictures is half as large, because the large disc looks like a second
/// cloud beside a cloud that fills the view.
constexpr DiscSettings kPublishedDisc{}, kSmallDisc{4000, 250};

/// The disc's mask, 0 … 1. Unit vectors.
float discMask(Vec3 view, Vec3 towards, const DiscSettings& settings);

/// r = √(max((1 − l·v)/2 − radius/100, a/10⁴)), colour = (b·color/r)²: a plateau that falls off over the whole sky.
struct SmoothDiscSettings {
  float radius = 0.05F;  ///< ≥ 0; the plateau ends at the angle 2·arcsin(√(radius/100 + a/10⁴)): 3 degrees
  float softness = 2;    ///< a, > 0
  float gain = 0.06F;    ///< b, ≥ 0
};
/// Its keys in a scene file.
const Keys<SmoothDiscSettings>& smoothDiscKeys();

/// The smooth disc's colour, finite. Unit vectors.
Vec3 smoothDiscColor(Vec3 view, Vec3 towards, Vec3 color, const SmoothDiscSettings& settings);

/// How much of the plateau's light the smooth disc has: 1 on the plateau, less around it.
float smoothDiscShare(Vec3 view, Vec3 towards, const SmoothDiscSettings& settings);

}  // namespace cloudbake
