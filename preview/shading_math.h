// Small functions for shading.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/vec3.h"

namespace cloudbake {

inline float lerp(float a, float b, float t) { return a + (b - a) * t; }
inline Vec3 lerp(Vec3 a, Vec3 b, float t) { return a + (b - a) * t; }

/// Component by component.
inline Vec3 quotient(Vec3 a, Vec3 b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }

/// Of a linear colour with the primaries of sRGB (ITU-R BT.709).
inline float luminanceOf(Vec3 color) { return dot(color, {0.2126F, 0.7152F, 0.0722F}); }

/// The filmic curve of K. Narkowicz (a x² + b x)/(c x² + d x + e), "ACES Filmic Tone Mapping Curve" (2016).
struct FilmCurve {
  static constexpr float kA = 2.51F, kB = 0.03F, kC = 2.43F, kD = 0.59F, kE = 0.14F;
};

inline float saturate(float x) { return std::clamp(x, 0.0F, 1.0F); }

/// Hermite's step from 0 at `a` to 1 at `b`; reversed where a > b. a ≠ b.
inline float smoothStep(float a, float b, float x) {
  const float t = saturate((x - a) / (b - a));
  return t * t * (3 - 2 * t);
}

/// The phase function of L. Henyey and J. Greenstein, "Diffuse radiation in the galaxy" (1941), times 4π: 1 for g = 0, with a mean of 1
/// over the sphere for every g. `cosine` is of the angle between the light's direction before and after, −1 < g < 1.
inline float henyeyGreenstein(float cosine, float asymmetry) {
  const float square = 1 + asymmetry * asymmetry - 2 * asymmetry * cosine;
  return (1 - asymmetry * asymmetry) / (square * std::sqrt(square));
}

}  // namespace cloudbake
