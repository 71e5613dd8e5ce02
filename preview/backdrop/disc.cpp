#include "preview/backdrop/disc.h"

#include <algorithm>
#include <cmath>

namespace cloudbake {

namespace {

// r² of the smooth disc, on its plateau and at a view.
float plateauSquare(const SmoothDiscSettings& settings) { return settings.softness * 1e-4F; }
float smoothDiscSquare(Vec3 view, Vec3 towards, const SmoothDiscSettings& settings) {
  return std::max(-dot(towards, view) * 0.5F + 0.5F - settings.radius * 0.01F, plateauSquare(settings));
}

}  // namespace

float discMask(Vec3 view, Vec3 towards, const DiscSettings& settings) {
  constexpr float kNothing = 200;  // cos^a < e^−200, which no gain makes visible
  const float cosine = std::max(0.0F, dot(towards, view));
  if (settings.exponent * (1 - cosine) > kNothing) return 0;
  return std::min(1.0F, std::pow(cosine, settings.exponent) * settings.gain);
}

Vec3 smoothDiscColor(Vec3 view, Vec3 towards, Vec3 color, const SmoothDiscSettings& settings) {
  const Vec3 root = color * (settings.gain / std::sqrt(smoothDiscSquare(view, towards, settings)));
  return {root.x * root.x, root.y * root.y, root.z * root.z};
}

float smoothDiscShare(Vec3 view, Vec3 towards, const SmoothDiscSettings& settings) {
  return plateauSquare(settings) / smoothDiscSquare(view, towards, settings);
}

// --- Keys ---

const Keys<SmoothDiscSettings>& smoothDiscKeys() {
  using S = SmoothDiscSettings;
  static const Keys<S> keys{
      {"smooth_radius", &S::radius, 0, 100, "radius of the smooth disc: r = √max((1 − l·v)/2 − radius/100, a/10⁴)"},
      {"smooth_softness", &S::softness, 1e-3, 1e4, "a of the smooth disc"},
      {"smooth_gain", &S::gain, 0, kBright, "b of the smooth disc, (b·c/r)² with the colour c of the sun or the moon"},
  };
  return keys;
}

}  // namespace cloudbake
