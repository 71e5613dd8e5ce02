// Fits spherical harmonics (core/harmonics.h) to light from all directions, at vertices or at any other points.
#pragma once

#include <span>
#include <vector>

#include "core/vec3.h"

namespace cloudbake {

/// Least-squares coefficients of a light: #points × (order + 1)², point by point. `values` are #points × #directions, row by row, over
/// directions of equal solid angle. `order` is 1 … 3. At least 2·(order + 1)² directions are needed.
std::vector<float> fitHarmonics(std::span<const Vec3> directions, std::span<const float> values, int order);

}  // namespace cloudbake
