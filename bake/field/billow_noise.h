// Cellular noise with round bumps and creases between them, like the surface of a cumulus.
#pragma once

#include <cstdint>

#include "core/vec3.h"

namespace cloudbake {

/// Settings of the bumps on the surface of a cloud.
struct BillowNoise {
  float amplitude = 0;  ///< largest distance that the surface is pushed outwards, world units, ≥ 0; 0 = no noise
  float size = 0;       ///< spacing of the largest bumps, world units, > 0 if the amplitude is
  int octaves = 3;      ///< 1 … 8; each octave has bumps of half the spacing and half the height
  uint64_t seed = 1;
};

constexpr int kMostOctaves = 8;

struct NoiseSample {
  float value;    ///< 0 … 1
  Vec3 gradient;  ///< derivative by x; on a crease, that of the nearest bump; 0 where no bump reaches
};

/// The noise at x, |x| < 2⁵⁰, with bumps of spacing 1 and 1 … 8 octaves. It has the same bits on every CPU.
NoiseSample billow(Vec3 x, int octaves, uint64_t seed);

/// A bound that |∇n| never reaches.
double billowSlope(int octaves);

}  // namespace cloudbake
