// ℓ(p, ω; L): the length of cloud along a ray, from samples of a signed distance.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// How a ray is sampled.
struct MarchSettings {
  Quadrature quadrature = Quadrature::kCrossing;
  int steps = 100;   ///< S
  float length = 0;  ///< L, in the units of the ray
};

/// The inside length along the ray, in its units. `sdf(Vec3)` is negative inside; its values may have any unit.
///
/// end        Σⱼ [φ(jΔ) < 0] Δ, j = 1…S, Δ = L/S. This is the published rule; a chord that starts on the surface loses Δ/2 on average.
/// midpoint   the same sum at (j − ½)Δ. It is unbiased, with an error of O(Δ).
/// crossing   per step the inside part of a linear φ: 1, 0, or f = φ₀/(φ₀ − φ₁) from the start to the sign change. The mean error is O(Δ²).
///            Grazing chords shorter than Δ are missed completely, so the root mean square error is O(Δ^1.5).
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
