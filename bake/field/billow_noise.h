// Cellular noise as round bumps with creases between them: what the surface of a cumulus looks like.
#pragma once

#include <cstdint>

#include "core/vec3.h"

namespace cloudbake {

/// Bumps on the surface of a cloud.
struct BillowNoise {
  float amplitude = 0;  ///< farthest that the surface is pushed outwards, world units, ≥ 0; 0 = no noise
  float size = 0;       ///< spacing of the largest bumps, world units, > 0 where there is an amplitude
  int octaves = 3;      ///< 1 … 8: each adds bumps of half the spacing and half the height
  uint64_t seed = 1;
};

constexpr int kMostOctaves = 8;

struct NoiseSample {
  float value;    ///< 0 … 1
  Vec3 gradient;  ///< by x; that of the nearest bump on a crease, 0 where no bump reaches
};

/// Noise with bumps of spacing 1 at x, |x| < 2⁵⁰, for 1 … 8 octaves. The same bits on every CPU.
NoiseSample billow(Vec3 x, int octaves, uint64_t seed);

/// What |∇n| stays under everywhere.
double billowSlope(int octaves);

}  // namespace cloudbake
