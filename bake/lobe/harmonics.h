// Fits spherical harmonics (core/harmonics.h) to the transmittance, at vertices or at any other points.
#pragma once

#include <span>
#include <vector>

#include "core/vec3.h"

namespace cloudbake {

/// Least-squares coefficients of T = exp(−σℓ): #points × (order + 1)², point by point. `lengths` holds ℓ in world units, #points ×
/// #directions row by row, over directions of equal solid angle. `order` is 1 … 3, `extinction` > 0 per world unit.
/// At least 2·(order + 1)² directions are needed.
std::vector<float> transmittanceHarmonics(std::span<const Vec3> directions, std::span<const float> lengths, int order, float extinction);

}  // namespace cloudbake
