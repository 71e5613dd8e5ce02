// "Procedural Stylized Sky 1" (tajourney): discs, moon and gradient; the horizon line of danielshervheim/unity-stylized-sky.
//   simple disc  m = saturate(max(0, l·v)^a · b)
//   smooth disc  r = √(max((−l·v/2 + 1/2) − radius/100, a/10⁴)),  colour = (b·sun_color/r)²
//   moon         X = up, Y = direction × up, u = X̂·v, v = Ŷ·v, scaled so that the disc fills [0, 1]; times the simple disc
//   horizon      h = saturate(1 − |v.y|)^e
//   gradient     colours keyed by the sun's height (night, dawn, day), from horizon to zenith by √v.y.
// (1 − l·v)/2 is sin²(θ/2) of the angle θ to the sun. A planet of radius R seen from the height h above it ends at the angle
// arccos(R/(R + h)) below level, and v.y is measured from there.
#include "preview/backdrop/sky.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/random.h"
#include "preview/backdrop/noise.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

struct SkyKey {
  float sun_height;
  SkyColors colors;
};

// Linear colours, chosen by eye for toneMap at exposure 1: a fully lit cloud (sun_color + ambient_sky) is just below white, the
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
  return {lerp(a.zenith, b.zenith, t),       lerp(a.horizon, b.horizon, t),         lerp(a.ground, b.ground, t),
          lerp(a.sun_color, b.sun_color, t), lerp(a.ambient_sky, b.ambient_sky, t), lerp(a.ambient_ground, b.ambient_ground, t)};
}

// Sine of the angle by which the horizon is below level.
float horizonDip(float viewer_height) {
  const float cosine = 1 / (1 + viewer_height);
  return std::sqrt(std::max(0.0F, 1 - cosine * cosine));
}

// Sine of the angle at which a disc's mask is 1/2: cos^a · b = 1/2.
float sineOfDiscRadius(const DiscSettings& disc) {
  const float cosine = std::min(1.0F, std::pow(0.5F / disc.gain, 1 / disc.exponent));
  return std::sqrt(std::max(1e-12F, 1 - cosine * cosine));
}

/// A crater on the near half of the moon: bowl and bright wall.
struct Crater {
  Vec3 center;  // unit
  float radius = 0;
};

// Craters anywhere on the visible half, more small ones than large ones.
std::array<Crater, 24> makeCraters() {
  std::array<Crater, 24> craters;
  for (size_t i = 0; i < craters.size(); ++i) {
    const auto draw = [i](uint32_t what) { return uniformFloat(hashDraw(mix64(kGolden64), uint32_t(i), what)); };
    const float z = 0.15F + 0.85F * draw(0), across = std::sqrt(1 - z * z), angle = float(2 * kPi) * draw(1), size = draw(2);
    craters[i] = {{across * std::cos(angle), across * std::sin(angle), z}, 0.03F + 0.16F * size * size * size};
  }
  return craters;
}

// The brightness of the ground in full light: dark plains where a noise is high, with craters over them.
float moonAlbedo(Vec3 place) {
  static const std::array<Crater, 24> kCraters = makeCraters();
  const float plains = fbmValue3(place * 1.7F + Vec3{5, 2, 9}, {.octaves = 5}).value;
  float albedo = lerp(0.95F, 0.45F, smoothStep(0.46F, 0.58F, plains));
  albedo *= 0.9F + 0.2F * fbmValue3(place * 9, {.octaves = 3, .seed = 1}).value;
  for (const Crater& crater : kCraters) {
    const float distance = length(place - crater.center) / crater.radius;
    if (distance > 1.4F) continue;
    const float wall = smoothStep(0.7F, 0.95F, distance) * smoothStep(1.4F, 1, distance);
    const float bowl = smoothStep(0.9F, 0.6F, distance);
    albedo += 0.22F * wall - 0.12F * bowl;
  }
  return saturate(albedo);
}

// The light that spreads from the sun through the haze: for the simple disc a wide, faint glow like that of forward scattering, for the
// smooth disc all of its light.
Vec3 sunGlow(Vec3 view, const SkySettings& settings) {
  const Vec3 sun_color = settings.colors.sun_color;
  if (settings.sun_disc == SunDisc::kSmooth) return smoothDiscColor(view, settings.to_sun, sun_color, settings.smooth_disc);
  const float cosine = std::max(0.0F, dot(view, settings.to_sun)), squared = cosine * cosine, fourth = squared * squared;
  return sun_color * (settings.glow * fourth * fourth * fourth * fourth * fourth * fourth);
}

// Whether a pixel differs visibly from one of its four neighbours.
bool isAtEdge(const Image& image, int x, int y) {
  constexpr float kVisible = 1.0F / 256;
  const Vec3 color = image.at(x, y);
  const auto differs = [&](int other_x, int other_y) {
    if (other_x < 0 || other_y < 0 || other_x >= image.width || other_y >= image.height) return false;
    const Vec3 change = image.at(other_x, other_y) - color;
    return std::max({std::abs(change.x), std::abs(change.y), std::abs(change.z)}) > kVisible;
  };
  return differs(x - 1, y) || differs(x + 1, y) || differs(x, y - 1) || differs(x, y + 1);
}

// The horizon above or below a view.
Vec3 atHorizon(Vec3 view, const SkySettings& settings) {
  const float down = horizonDip(settings.viewer_height), across = std::hypot(view.x, view.z);
  if (!(across > 0)) return view;
  const float scale = std::sqrt(std::max(0.0F, 1 - down * down)) / across;
  return {view.x * scale, -down, view.z * scale};
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

std::vector<float> skyHours() {
  std::vector<float> hours;
  for (const SkyKey& key : kSkyKeys) hours.push_back(key.sun_height);
  hours.push_back(1);
  return hours;
}

SkyColors withAmbientOfSky(SkyColors colors, float sun_height) {
  // Over the upper hemisphere ∫ √y·2y dy = 4/5.
  const Vec3 mean = lerp(colors.horizon, colors.zenith, 0.8F);
  const float luminance = dot(mean, {0.2126F, 0.7152F, 0.0722F});
  colors.ambient_sky = lerp(mean, Vec3{1, 1, 1} * luminance, 0.5F);
  const Vec3 light = colors.sun_color * std::max(0.0F, sun_height) + colors.ambient_sky;
  colors.ground = product({0.15F, 0.16F, 0.15F}, light);
  colors.ambient_ground = colors.ground * 0.4F;
  return colors;
}

float discMask(Vec3 view, Vec3 towards, const DiscSettings& settings) {
  constexpr float kNothing = 200;  // cos^a < e^−200, which no gain makes visible
  const float cosine = std::max(0.0F, dot(towards, view));
  if (settings.exponent * (1 - cosine) > kNothing) return 0;
  return std::min(1.0F, std::pow(cosine, settings.exponent) * settings.gain);
}

Vec3 smoothDiscColor(Vec3 view, Vec3 to_sun, Vec3 sun_color, const SmoothDiscSettings& settings) {
  const float from_sun = -dot(to_sun, view) * 0.5F + 0.5F;
  const float r = std::sqrt(std::max(from_sun - settings.radius * 0.01F, settings.softness * 1e-4F));
  const Vec3 root = sun_color * (settings.gain / r);
  return {root.x * root.x, root.y * root.y, root.z * root.z};
}

std::optional<Vec2> moonUv(Vec3 view, const MoonSettings& settings) {
  const Vec3 direction = settings.direction;
  if (dot(view, direction) <= 0) return std::nullopt;
  const Vec3 y = normalized(cross(direction, settings.up)).value_or(frameAround(direction).tangent), x = cross(y, direction);
  const float scale = 0.5F / sineOfDiscRadius(settings.disc);
  return Vec2{dot(x, view) * scale + 0.5F, dot(y, view) * scale + 0.5F};
}

float moonBrightness(Vec2 uv, float phase_degrees) {
  // The point of a ball that is visible there.
  float x = 2 * uv.x - 1, y = 2 * uv.y - 1;
  const float square = x * x + y * y;
  if (square > 1) x /= std::sqrt(square), y /= std::sqrt(square);
  const Vec3 place{x, y, std::sqrt(std::max(0.0F, 1 - square))};
  // The moon's dust reflects light back to where it came from, so that the moon is evenly bright up to the terminator.
  const float phase = phase_degrees * float(kPi / 180);
  const float lit = smoothStep(-0.02F, 0.18F, dot(place, {0, std::sin(phase), std::cos(phase)}));
  return lit > 0 ? lit * moonAlbedo(place) : 0;
}

float horizonLine(float view_y, float exponent, float viewer_height) {
  return std::pow(saturate(1 - std::abs(view_y + horizonDip(viewer_height))), exponent);
}

Vec3 skyColor(Vec3 view, const SkySettings& settings) {
  const SkyColors& colors = settings.colors;

  // The gradient is above the horizon. Below it, the ground fades into the haze towards the horizon.
  const float height = view.y + horizonDip(settings.viewer_height);
  const float line = horizonLine(view.y, settings.horizon_exponent, settings.viewer_height);
  if (height < 0) return lerp(colors.ground, colors.horizon + sunGlow(atHorizon(view, settings), settings), line);
  const float blue = std::sqrt(std::min(1.0F, height));
  Vec3 color = lerp(lerp(colors.horizon, colors.zenith, blue), colors.horizon, line);

  // Sun and moon add to the gradient and set behind the horizon.
  color += sunGlow(view, settings);
  if (settings.sun_disc == SunDisc::kSimple) color += colors.sun_color * (4 * discMask(view, settings.to_sun, settings.disc));
  if (settings.moon) {
    const float mask = discMask(view, settings.moon->direction, settings.moon->disc);
    if (mask > 1e-4F) color += settings.moon->color * (mask * moonBrightness(*moonUv(view, *settings.moon), settings.moon->phase_degrees));
  }
  return color;
}

Image renderSky(const Camera& camera, const SkySettings& settings, int samples_per_side, SkySampling sampling) {
  const CameraRays rays(camera);
  const auto meanColor = [&](int x, int y, const std::vector<Vec2>& places) {
    Vec3 sum;
    for (const Vec2 place : places) sum += skyColor(rays.at(float(x) + place.x, float(y) + place.y).direction, settings);
    return sum / float(places.size());
  };
  const std::vector<Vec2> all = pixelPlaces(samples_per_side), first = sampling == SkySampling::kAtEdges ? pixelPlaces(1) : all;
  Image image = blankImage(camera.width, camera.height);
  parallelFor(camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) image.at(x, y) = meanColor(x, y, first);
  });
  if (first.size() == all.size()) return image;
  std::vector<std::vector<int>> edges(size_t(camera.height));  // columns of every row, before any of them changes
  parallelFor(camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x)
      if (isAtEdge(image, x, y)) edges[size_t(y)].push_back(x);
  });
  parallelFor(camera.height, [&](int y) {
    for (const int x : edges[size_t(y)]) image.at(x, y) = meanColor(x, y, all);
  });
  return image;
}

}  // namespace cloudbake
