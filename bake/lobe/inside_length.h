// ℓ(p, ω; L): how much cloud lies along a ray, from samples of a signed distance.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// How a ray is cut into samples.
struct MarchSettings {
  Quadrature quadrature = Quadrature::kCrossing;
  int steps = 100;   ///< S
  float length = 0;  ///< L, in the units of the ray
};

/// Inside length along the ray, in its units. `sdf(Vec3)` is negative inside; any units of its own.
///
/// end        Σⱼ [φ(jΔ) < 0] Δ, j = 1…S, Δ = L/S: the published rule; a chord that starts on the surface loses Δ/2 on average.
/// midpoint   the same at (j − ½)Δ: unbiased, error O(Δ).
/// crossing   per step the inside part of a linear φ: 1, 0, or f = φ₀/(φ₀ − φ₁) from the start to the sign change. Error O(Δ²) in
///            the mean; grazing chords shorter than Δ are missed whole, so O(Δ^1.5) in the root mean square.
template <class Sdf>
float insideLength(const Sdf& sdf, const Ray& ray, const MarchSettings& settings) {
  const float step = settings.length / float(settings.steps);
  const auto at = [&](float j) { return sdf(ray.origin + ray.direction * (j * step)); };

  float steps_inside = 0;
  if (settings.quadrature != Quadrature::kCrossing) {
    const float shift = settings.quadrature == Quadrature::kEnd ? 1.0F : 0.5F;
    for (int j = 0; j < settings.steps; ++j) steps_inside += at(float(j) + shift) < 0 ? 1.0F : 0.0F;
    return steps_inside * step;
  }
  float before = at(0);
  for (int j = 1; j <= settings.steps; ++j) {
    const float after = at(float(j));
    if ((before < 0) == (after < 0)) {
      steps_inside += before < 0 ? 1.0F : 0.0F;
    } else {
      const float fraction = before / (before - after);
      steps_inside += before < 0 ? fraction : 1 - fraction;
    }
    before = after;
  }
  return steps_inside * step;
}

}  // namespace cloudbake
