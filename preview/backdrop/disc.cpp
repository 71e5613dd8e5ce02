#include "preview/backdrop/disc.h"

#include <algorithm>
#include <cmath>

namespace cloudbake {

float discMask(Vec3 view, Vec3 towards, const DiscSettings& settings) {
  constexpr float kNothing = 200;  // cos^a < e^−200, which no gain makes visible
  const float cosine = std::max(0.0F, dot(towards, view));
  if (settings.exponent * (1 - cosine) > kNothing) return 0;
  return std::min(1.0F, std::pow(cosine, settings.exponent) * settings.gain);
}

}  // namespace cloudbake
