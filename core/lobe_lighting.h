// The lobe formula: everything an engine evaluates per vertex and light. Preview, fit, measure and check all use this header.
//
//   s(l) = max(0, max(0, l·o/2 + 1/2)^k · d + b)        T_lobe(l) = exp(−σ · s(l))
//
// Source: "On Mesh Cloud Rendering" (2019-06-30), after Sea of Thieves (SIGGRAPH 2018). The two max are ours: rounding
// makes l·o/2+1/2 slightly negative at l = −o (pow gives NaN), and a negative b would give T > 1.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/portable_math.h"
#include "core/types.h"

namespace cloudbake {

/// x^k for x ≥ 0. A small integer k is computed by multiplication, so that engines and this code agree to the last bits.
inline float lobePower(float x, float exponent) {
  if (exponent == 3) return x * x * x;
  if (exponent == 4) return (x * x) * (x * x);
  if (exponent >= 0 && exponent <= 16 && exponent == std::floor(exponent)) {
    float result = 1;
    for (int i = 0; i < int(exponent); ++i) result *= x;
    return result;
  }
  return portablePow(x, exponent);
}

/// s(l): how much cloud, in world units, lies between the vertex and the light according to the lobe. `to_light` is a unit vector.
inline float lobeThickness(const Lobe& lobe, Vec3 to_light, LobeShape shape) {
  const float half_cosine = std::max(0.0F, dot(to_light, lobe.direction) * 0.5F + 0.5F);
  return std::max(0.0F, lobePower(half_cosine, shape.exponent) * lobe.thickness + shape.bias);
}

/// T_lobe(l) in [0, 1]. `extinction` is per world unit.
inline float lobeTransmittance(const Lobe& lobe, Vec3 to_light, LobeShape shape, float extinction) {
  return portableExp(-extinction * lobeThickness(lobe, to_light, shape));
}

/// The same for a lamp that is `away` world units from the vertex: no more of the cloud counts than lies before the lamp.
inline float lampTransmittance(const Lobe& lobe, Vec3 to_lamp, float away, LobeShape shape, float extinction) {
  return portableExp(-extinction * std::min(lobeThickness(lobe, to_lamp, shape), away));
}

/// lerp(f, 1, n·l/2 + 1/2): the share of a light that a surface shows. f = 1 is the lobe alone.
inline float surfaceFactor(Vec3 normal, Vec3 to_light, float half_lambert) {
  return half_lambert + (1 - half_lambert) * (dot(normal, to_light) * 0.5F + 0.5F);
}

}  // namespace cloudbake
