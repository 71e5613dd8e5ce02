// "Procedural Stylized Sky 1" (tajourney), its simple sun disc, with the horizon line of danielshervheim/unity-stylized-sky:
//   disc      m = saturate(max(0, l·v)^a · b)
//   horizon   h = saturate(1 − |v.y|)^e
//   gradient  colours keyed by the sun's height (night, dawn, day), from horizon to zenith by √v.y.
// A planet seen from the height h (in its radii) ends at the angle arccos(1/(1+h)) below level; v.y counts from there.
#include "preview/sky.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cloudbake {

namespace {

Vec3 mix(Vec3 a, Vec3 b, float t) { return a + (b - a) * t; }

struct SkyKey {
  float sun_height;
  SkyColors colors;
};

// Linear, chosen by eye for toneMap at exposure 1: a fully lit cloud (sun_color + ambient_sky) comes out just below white, the
// day's sky stays darker than that and its blue tints the shadows, and a low sun turns red.
constexpr std::array<SkyKey, 4> kSkyKeys{{
    // zenith, horizon, ground, sun_color, ambient_sky, ambient_ground
    {-0.20F,
     {{0.003F, 0.006F, 0.018F},
      {0.010F, 0.016F, 0.036F},
      {0.003F, 0.005F, 0.009F},
      {0.030F, 0.042F, 0.075F},
      {0.008F, 0.013F, 0.028F},
      {0.003F, 0.004F, 0.009F}}},
    {0.00F,
     {{0.040F, 0.070F, 0.200F},
      {0.560F, 0.210F, 0.100F},
      {0.050F, 0.038F, 0.048F},
      {1.050F, 0.340F, 0.110F},
      {0.065F, 0.080F, 0.180F},
      {0.020F, 0.020F, 0.052F}}},
    {0.15F,
     {{0.032F, 0.090F, 0.290F},
      {0.480F, 0.320F, 0.210F},
      {0.070F, 0.065F, 0.072F},
      {1.150F, 0.640F, 0.300F},
      {0.078F, 0.118F, 0.240F},
      {0.024F, 0.032F, 0.068F}}},
    {0.35F,
     {{0.016F, 0.070F, 0.270F},
      {0.220F, 0.370F, 0.550F},
      {0.050F, 0.080F, 0.105F},
      {1.080F, 0.960F, 0.780F},
      {0.090F, 0.150F, 0.270F},
      {0.028F, 0.045F, 0.082F}}},
}};

SkyColors mixColors(const SkyColors& a, const SkyColors& b, float t) {
  return {mix(a.zenith, b.zenith, t),       mix(a.horizon, b.horizon, t),         mix(a.ground, b.ground, t),
          mix(a.sun_color, b.sun_color, t), mix(a.ambient_sky, b.ambient_sky, t), mix(a.ambient_ground, b.ambient_ground, t)};
}

}  // namespace

SkyColors skyColorsForSun(float sun_height) {
  for (size_t i = 1; i < kSkyKeys.size(); ++i) {
    const SkyKey &low = kSkyKeys[i - 1], &high = kSkyKeys[i];
    if (sun_height < high.sun_height) {
      const float t = std::max(0.0F, (sun_height - low.sun_height) / (high.sun_height - low.sun_height));
      return mixColors(low.colors, high.colors, t);
    }
  }
  return kSkyKeys.back().colors;
}

Vec3 skyColor(Vec3 view, const SkySettings& settings) {
  // Height above the horizon, which sinks for a viewer high above the planet: sin(dip) = √(1 − cos²(dip)).
  const float cosine_dip = 1 / (1 + settings.viewer_height);
  const float height = view.y + std::sqrt(std::max(0.0F, 1 - cosine_dip * cosine_dip));
  const SkyColors& colors = settings.colors;

  // Gradient above; below, the ground fades into the haze towards the horizon.
  const float line = std::pow(std::clamp(1 - std::abs(height), 0.0F, 1.0F), settings.horizon_exponent);
  if (height < 0) return mix(colors.ground, colors.horizon, line);
  const float blue = std::sqrt(std::min(1.0F, height));
  Vec3 color = mix(mix(colors.horizon, colors.zenith, blue), colors.horizon, line);

  // The disc adds to the gradient and sets behind the horizon.
  const float towards_sun = std::max(0.0F, dot(view, settings.to_sun));
  const float disc = std::min(1.0F, std::pow(towards_sun, settings.disc_exponent) * settings.disc_gain);
  // A wide, faint glow around it, as forward scattering in the haze makes.
  const float glow = settings.glow * std::pow(towards_sun, 24.0F);
  return color + colors.sun_color * (4 * disc + glow);
}

}  // namespace cloudbake
