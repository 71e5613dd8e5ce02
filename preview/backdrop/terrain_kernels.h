// The octaves of the terrain's ground at many places at once: the same bits on every CPU.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cloudbake {

struct ErodedOctaves {
  int count = 0;
  float gain = 0.5F;
  double lacunarity = 2;
  uint32_t seed = 0, seed_step = 0;  ///< of the first octave, and from one to the next
};

/// The arrays of erodedSums are as long as a multiple of this.
constexpr size_t kPlacesTogether = 16;

/// Σᵢ gainⁱ n(pᵢ)/(1 + |Σⱼ≤ᵢ ∇n(pⱼ)|²), pᵢ₊₁ = lacunarity · M pᵢ, of `count` places in cells, a multiple of kPlacesTogether.
void erodedSums(const double* x, const double* y, size_t count, const ErodedOctaves& octaves, float* sums);

}  // namespace cloudbake
