// The inner loops of the fit, with the SIMD instructions of the CPU. All targets sum the same eight lanes, so they give the same bits.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/types.h"

namespace cloudbake {

/// Directions to lights with their weights, in rows of `count`, a multiple of 8. Those that fill up the last lanes have weight 0.
struct FitLights {
  const float *x = nullptr, *y = nullptr, *z = nullptr, *weight = nullptr;
  size_t count = 0;
};

/// A lobe s = max(0, h^k d + b), h = max(0, l·o/2 + 1/2), in optical depths.
struct FitLobe {
  Vec3 direction, tangent, bitangent;
  float exponent = 0, bias = 0, thickness = 0;
};

/// The sums over lights and σ that a step needs, with T = exp(−σs), the residual r = T − target, and the slopes of s along both tangents
/// and log d.
struct FitSums {
  double error = 0;                  ///< Σ w r²
  std::array<double, 3> gradient{};  ///< Σ w r ∇T: u, v, w
  std::array<double, 6> hessian{};   ///< Σ w ∇T∇Tᵀ: uu uv uw vv vw ww
};

/// `targets`: #σ × count; each σ is relative to the unit of the optical depths. `scratch` has room for
/// (4 + #σ) × count.
FitSums sumFit(const FitLights& lights, const FitLobe& lobe, std::span<const float> extinctions, const float* targets, float* scratch);

/// exp(−σℓ) of `count` lengths, a multiple of 8, for every σ: #σ × count floats. Lengths below 0 count as 0. An optical depth is ℓ · unit ·
/// σ.
void transmittanceRows(const float* lengths, size_t count, float unit, std::span<const float> extinctions, float* rows);

}  // namespace cloudbake
