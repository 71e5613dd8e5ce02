// The discs of sun and moon.
#pragma once

#include "core/vec3.h"

namespace cloudbake {

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

}  // namespace cloudbake
