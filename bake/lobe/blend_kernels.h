// The inner loop of blended lobes, with the SIMD instructions of the CPU. All targets sum the same eight lanes, so they give the same bits.
#pragma once

#include <array>
#include <cstddef>

#include "core/types.h"

namespace cloudbake {

/// Lobes with their places and normals, in rows of `count`, a multiple of 8. Those that fill up the last lanes are beyond reach.
struct NearLobes {
  const float *x = nullptr, *y = nullptr, *z = nullptr, *normal_x = nullptr, *normal_y = nullptr, *normal_z = nullptr;
  const float *o_x = nullptr, *o_y = nullptr, *o_z = nullptr, *thickness = nullptr;
  size_t count = 0;
};

/// Weights fall to 0 at a distance and at a cosine between normals.
struct BlendReach {
  float distance = 0, cosine = 0;
};

/// Sums of the weights w = (1 − r²/reach²)⁴ (n·n' − cosine)².
struct BlendSums {
  float weight = 0, thickness = 0;  ///< Σ w, Σ w d
  Vec3 vector, direction;           ///< Σ w d o, Σ w o
};
BlendSums sumNear(const NearLobes& near, Vec3 at, Vec3 normal, const BlendReach& reach);

}  // namespace cloudbake
