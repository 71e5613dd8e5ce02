// Noise on the integer lattice, with analytic derivatives: value noise in 2D and 3D, gradient noise in 2D, and their octaves.
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

/// Selects a noise. With a period > 0 it repeats exactly every `period` cells along each axis.
struct NoiseSettings {
  uint32_t seed = 0;
  int period = 0;  ///< 0: never repeats; else 1 … 2^20
};

/// Cells from the origin beyond which float has little precision left between lattice points.
inline constexpr float kMostCells = 0x1p20F;

/// Value noise, in [0, 1]: hashes at the lattice points, interpolated by a quintic; value and gradient are continuous. |p| < 2^30 per
/// component; kMostCells limits what is of use.
Noise2 valueNoise2(Vec2 p, const NoiseSettings& settings = {});
Noise3 valueNoise3(Vec3 p, const NoiseSettings& settings = {});

/// Gradient noise, in [−1, 1] and 0 at the lattice points: unit gradients at the lattice points, interpolated by a quintic.
Noise2 gradientNoise2(Vec2 p, const NoiseSettings& settings = {});

/// Octaves of a noise n: Σ gainⁱ n(2ⁱ p + shiftᵢ) / Σ gainⁱ, so that the range is that of n. Each octave has its own seed and shift.
/// |p|·2^octaves and period·2^octaves stay below 2^30.
struct FbmSettings {
  int octaves = 4;    ///< 1 … 16
  float gain = 0.5F;  ///< > 0
  uint32_t seed = 0;  ///< of the first octave
  int period = 0;     ///< of the first octave, in its cells: the sum repeats with it. 0: never repeats
};

Noise2 fbmValue2(Vec2 p, const FbmSettings& settings = {});
Noise3 fbmValue3(Vec3 p, const FbmSettings& settings = {});
/// Only the values of fbmValue2 and fbmValue3, the same to the bit, at about half the cost. Once the octaves so far rule out a value under
/// `limit`, the rest is left out: the result is then under the noise's value, but not under the limit.
float fbmValueOnly2(Vec2 p, const FbmSettings& settings = {});
float fbmValueOnly3(Vec3 p, const FbmSettings& settings = {}, float limit = INFINITY);

Noise2 fbmGradient2(Vec2 p, const FbmSettings& settings = {});

}  // namespace cloudbake
