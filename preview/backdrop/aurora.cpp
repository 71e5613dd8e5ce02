// Our own. Three curtains, one behind the other, each a graph over the azimuth: of the height y = sin(elevation), relative to the lower
// border b and the length of the rays ℓ there, x = (y − b)/ℓ, the light is
//   edge(x) · exp(−2.2x) · ray · patch,    the colour from the lower one to the upper one by x.
// b, ℓ, ray and patch are octaves of value noise on the circle of the azimuth, which has no seam, over the time. They do not depend on y:
// that stretches them along the vertical.
#include "preview/backdrop/aurora.h"

#include <algorithm>
#include <cmath>

#include "core/types.h"
#include "preview/backdrop/noise.h"
#include "preview/shading_math.h"

namespace cloudbake {

Vec3 auroraLight(Vec3 view, float sun_height, const AuroraSettings& settings) {
  const float night = smoothStep(settings.high_height, settings.low_height, sun_height);
  const float low = std::sin(settings.bottom_degrees * float(kPi / 180)), high = std::sin(settings.top_degrees * float(kPi / 180));
  const float across = std::sqrt(view.x * view.x + view.z * view.z), height = (view.y - low) / (high - low);
  if (!(night > 0) || !(height > 0) || height >= 1 || !(across > 1e-4F)) return {};
  const Vec3 around{view.x / across, 0, view.z / across};
  const float time = 0.04F * settings.speed * settings.time_seconds;
  Vec3 light;
  for (int curtain = 0; curtain < 3; ++curtain) {
    // A noise of its own, 0 … 1, for each use.
    const auto noise = [&](uint32_t use, float scale, float rate, int octaves) {
      const Vec3 place = around * (settings.scale * scale) + Vec3{0, rate * time, 0};
      return fbmValue3(place, {.octaves = octaves, .seed = settings.seed + 16U * uint32_t(curtain) + use}).value;
    };
    const float fold = noise(0, 1, 1, 3), patch = smoothStep(0.36F, 0.62F, noise(1, 0.7F, 0.7F, 2));
    if (!(patch > 0)) continue;
    const float border = 0.08F + 0.16F * float(curtain) + 0.5F * (fold - 0.25F);
    const float ray = noise(2, settings.ray_scale, 2, 2);
    const float length = 0.16F + 0.5F * noise(3, 0.25F * settings.ray_scale, 1.3F, 2) * ray;
    const float x = (height - border) / length;
    const float edge = smoothStep(-0.12F, 0.1F, x) * std::exp(-2.2F * std::max(0.0F, x));
    const float bright = patch * edge * (0.25F + 1.5F * ray * ray) * (1 - 0.25F * float(curtain));
    light += lerp(settings.low_color, settings.high_color, smoothStep(0.05F, 0.8F, x)) * bright;
  }
  const float rim = smoothStep(0, 0.08F, height) * smoothStep(1, 0.6F, height);
  return light * (settings.strength * night * rim);
}

// --- Keys ---

const Keys<AuroraSettings>& auroraKeys() {
  using S = AuroraSettings;
  static const Keys<S> keys{
      {"low_color", &S::low_color, 0, kBright, "colour of the lower border of the curtains"},
      {"high_color", &S::high_color, 0, kBright, "colour of the upper ends of their rays"},
      {"bottom", &S::bottom_degrees, 0, 89, "elevation above which the curtains are, degrees"},
      {"top", &S::top_degrees, 1, 90, "elevation below which they are, degrees"},
      {"strength", &S::strength, 0, kBright, "factor of the light"},
      {"speed", &S::speed, 0, 1000, "speed of folds and rays"},
      {"scale", &S::scale, 0.01, 100, "how many folds a curtain has"},
      {"ray_scale", &S::ray_scale, 0.01, 1000, "how many rays a fold has"},
      {"low_height", &S::low_height, -1, 1, "sine of the sun's elevation below which the aurora has its full light"},
      {"high_height", &S::high_height, -1, 1, "sine of the sun's elevation above which there is none"},
      {"seed", &S::seed, 0, kMostSeed, "selects another aurora"},
      {"time", &S::time_seconds, 0, 1e9, "of the scene, seconds", KeyUse::kComputed},
  };
  return keys;
}

}  // namespace cloudbake
