// What a ray meets, for RayScene and for TriangleTree.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/function_ref.h"

namespace cloudbake {

/// A triangle that a ray meets.
struct RayHit {
  float t = 0;       ///< where, in lengths of the ray's direction, ≥ 0
  int32_t sign = 0;  ///< of n·ω, with n by the order of the corners: +1 if the ray leaves through the triangle; 0 if it lies in its plane
  uint32_t triangle = 0;
};

/// How many rays from one place are cast together; with 4 or 16 they take longer.
inline constexpr size_t kRaysTogether = 8;

using HitVisit = FunctionRef<void(const RayHit& hit)>;
/// Gets a triangle and the radius of the search so far, and returns the radius from there on, which must not be larger.
using NearVisit = FunctionRef<float(uint32_t triangle, float radius)>;

}  // namespace cloudbake
