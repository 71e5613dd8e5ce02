// Noise on the integer lattice with analytic derivatives: value noise in 2D and 3D, gradient noise in 2D, and their octaves.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/vec3.h"

namespace cloudbake {

struct Noise2 {
  float value = 0;
  Vec2 gradient;  ///< ∂value/∂x, ∂value/∂y
};

struct Noise3 {
  float value = 0;
  Vec3 gradient;
};

/// Which noise of all. With a period > 0 it repeats exactly every `period` cells along each axis.
struct NoiseSettings {
  uint32_t seed = 0;
  int period = 0;  ///< 0: never repeats; else 1 … 2^20
};

/// Value noise, in [0, 1]: hashes at the lattice points, joined by a quintic; value and gradient are continuous. |p| < 2^30 per
/// component; above 2^20 float has few places left between lattice points.
Noise2 valueNoise2(Vec2 p, const NoiseSettings& settings = {});
Noise3 valueNoise3(Vec3 p, const NoiseSettings& settings = {});

/// Gradient noise, in [−1, 1] and 0 at the lattice points: unit gradients at the lattice points, joined by a quintic.
Noise2 gradientNoise2(Vec2 p, const NoiseSettings& settings = {});

/// Octaves of a noise n: Σ gainⁱ n(2ⁱ p + shiftᵢ) / Σ gainⁱ, so that the range stays n's. Each octave has a seed and a shift of its own.
/// |p|·2^octaves and period·2^octaves stay below 2^30.
struct FbmSettings {
  int octaves = 4;    ///< 1 … 16
  float gain = 0.5F;  ///< > 0
  uint32_t seed = 0;  ///< of the first octave
  int period = 0;     ///< of the first octave, in its cells: the sum repeats with it. 0: never repeats
};

Noise2 fbmValue2(Vec2 p, const FbmSettings& settings = {});
Noise3 fbmValue3(Vec3 p, const FbmSettings& settings = {});
/// The values of fbmValue2 and fbmValue3 alone, to the bit, at about half the cost. Where the octaves so far leave no value under `limit`,
/// the rest is left out: then what comes back is under the noise's value, and not under the limit.
float fbmValueOnly2(Vec2 p, const FbmSettings& settings = {});
float fbmValueOnly3(Vec3 p, const FbmSettings& settings = {}, float limit = INFINITY);

Noise2 fbmGradient2(Vec2 p, const FbmSettings& settings = {});

}  // namespace cloudbake
