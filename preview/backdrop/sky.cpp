// "Procedural Stylized Sky 1" (tajourney): discs and gradient; the horizon line of danielshervheim/unity-stylized-sky.
//   simple disc  m = saturate(max(0, l·v)^a · b)
//   smooth disc  r = √(max((−l·v/2 + 1/2) − radius/100, a/10⁴)),  colour = (b·sun_color/r)²
//   horizon      h = saturate(1 − |v.y|)^e
//   gradient     colours keyed by the sun's height (night, dawn, day), from low sky to zenith by √v.y.
// (1 − l·v)/2 is sin²(θ/2) of the angle θ to the sun. A planet of radius R seen from the height h above it ends at the angle
// arccos(R/(R + h)) below level, and v.y is measured from there.
// The key light is our own: the tone of its luminance is at most (e − a)/(b − a) of white's, with the sun's elevation e above the horizon,
// and a and b where its light ends and is full.
#include "preview/backdrop/sky.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/srgb.h"
#include "preview/backdrop/sky_hours.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

SkyColors mixColors(const SkyColors& a, const SkyColors& b, float t) {
  return {lerp(a.zenith, b.zenith, t),       lerp(a.horizon, b.horizon, t),         lerp(a.ground, b.ground, t),
          lerp(a.sun_color, b.sun_color, t), lerp(a.ambient_sky, b.ambient_sky, t), lerp(a.ambient_ground, b.ambient_ground, t),
          lerp(a.low_sky, b.low_sky, t)};
}

// Sine of the angle by which the horizon is below level.
float horizonDip(float viewer_height) {
  const float cosine = 1 / (1 + viewer_height);
  return std::sqrt(std::max(0.0F, 1 - cosine * cosine));
}

float degreesOf(float sine) { return std::asin(std::clamp(sine, -1.0F, 1.0F)) * float(180 / kPi); }

// How toneMap shows a grey light at exposure 1, and the light that it shows so.
float toneOf(float light) {
  return srgbOfLinear(
      std::min(1.0F, light * (FilmCurve::kA * light + FilmCurve::kB) / (light * (FilmCurve::kC * light + FilmCurve::kD) + FilmCurve::kE)));
}
float lightOfTone(float tone) {
  const float y = linearOfSrgb(tone), a = FilmCurve::kA - FilmCurve::kC * y, b = FilmCurve::kB - FilmCurve::kD * y;
  return (std::sqrt(b * b + 4 * a * FilmCurve::kE * y) - b) / (2 * a);
}

// The colour, so dark that its luminance shows as this tone at most.
Vec3 dimmedTo(float tone, Vec3 color) {
  const float luminance = luminanceOf(color), most = lightOfTone(tone);
  return luminance > most ? color * (most / luminance) : color;
}

// The direction to the light of a sun at this elevation above the horizon: to the sun, or to the twilight above the place where it sets.
Vec3 towardsLight(Vec3 to_sun, float elevation, float dip) {
  constexpr float kTurn = 3, kLowest = 1.5F;  // degrees
  if (elevation >= kTurn) return to_sun;
  const float raised = kLowest + (kTurn - kLowest) * std::exp((elevation - kTurn) / (kTurn - kLowest));
  const float radians = (raised - dip) * float(kPi / 180);
  const Vec3 level = normalized(Vec3{to_sun.x, 0, to_sun.z}).value_or(Vec3{0, 0, 1});
  return {level.x * std::cos(radians), std::sin(radians), level.z * std::cos(radians)};
}

// The light that spreads from the sun through the haze: for the simple disc a wide, faint glow like that of forward scattering, for the
// smooth disc all of its light.
Vec3 sunGlow(Vec3 view, const SkySettings& settings) {
  const Vec3 sun_color = settings.colors.sun_color;
  if (settings.sun_disc == DiscKind::kSmooth) return smoothDiscColor(view, settings.to_sun, sun_color, settings.smooth_disc);
  const float cosine = std::max(0.0F, dot(view, settings.to_sun)), squared = cosine * cosine, fourth = squared * squared;
  return sun_color * (settings.glow * fourth * fourth * fourth * fourth * fourth * fourth);
}

// The same of a moon with a smooth disc, which has no other light.
Vec3 moonGlow(Vec3 view, const std::optional<MoonSettings>& moon) {
  return moon && moon->disc_kind == DiscKind::kSmooth ? moonColor(view, *moon) : Vec3{};
}

// How much of the light of a star the moon hides.
float moonCover(Vec3 view, const std::optional<MoonSettings>& moon) {
  if (!moon) return 0;
  return moon->disc_kind == DiscKind::kSmooth ? smoothDiscShare(view, moon->direction, moon->smooth_disc)
                                              : discMask(view, moon->direction, moon->disc);
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

const SkyRamp& defaultSkyRamp() {
  static const SkyRamp ramp{{std::begin(kSkyHours), std::end(kSkyHours)}, true, true, true};
  return ramp;
}

SkyColors skyColorsForSun(float sun_height, const SkyRamp& ramp) {
  const auto high =
      std::find_if(ramp.hours.begin() + 1, ramp.hours.end(), [&](const SkyHour& hour) { return sun_height < hour.sun_height; });
  if (high == ramp.hours.end()) return ramp.hours.back().colors;
  const SkyHour& low = *(high - 1);
  const float t = std::max(0.0F, (sun_height - low.sun_height) / (high->sun_height - low.sun_height));
  return mixColors(low.colors, high->colors, t);
}

std::vector<float> skyHours(const SkyRamp& ramp) {
  std::vector<float> hours{0, 1};
  for (const SkyHour& hour : ramp.hours) hours.push_back(hour.sun_height);
  std::sort(hours.begin(), hours.end());
  hours.erase(std::unique(hours.begin(), hours.end()), hours.end());
  return hours;
}

SkyColors withAmbientOfSky(SkyColors colors, float sun_height) {
  // Over the upper hemisphere ∫ √y·2y dy = 4/5.
  const Vec3 mean = lerp(colors.low_sky, colors.zenith, 0.8F);
  const float luminance = luminanceOf(mean);
  colors.ambient_sky = lerp(mean, Vec3{1, 1, 1} * luminance, 0.5F);
  const Vec3 light = colors.sun_color * std::max(0.0F, sun_height) + colors.ambient_sky;
  colors.ground = Vec3{0.15F, 0.16F, 0.15F} * light;
  colors.ambient_ground = colors.ground * 0.4F;
  return colors;
}

SkySettings publishedSky() {
  SkySettings settings;
  settings.disc = kPublishedDisc;
  return settings;
}

KeyLight keyLight(const SkySettings& sky) {
  const float dip = degreesOf(horizonDip(sky.viewer_height)), elevation = degreesOf(sky.to_sun.y) + dip;
  if (elevation >= kFullLight) return {sky.to_sun, sky.colors.sun_color};
  const Vec3 moon = sky.moon ? moonLight(*sky.moon, degreesOf(sky.moon->direction.y) + dip) : Vec3{};
  const float moon_tone = toneOf(luminanceOf(moon));
  constexpr float kNaturalTone = 0.22F, kBrightTone = 0.45F, kEarliest = -2;
  const float change = lerp(kLastLight, kEarliest, saturate((moon_tone - kNaturalTone) / (kBrightTone - kNaturalTone)));
  if (elevation > change || !sky.moon) {
    const float tone = toneOf(1) * std::max(0.0F, (elevation - change) / (kFullLight - change));
    return {towardsLight(sky.to_sun, elevation, dip), dimmedTo(tone, sky.colors.sun_color)};
  }
  const float risen = std::min(1.0F, (change - elevation) / (kLastLight - kMoonLight));
  return {sky.moon->direction, dimmedTo(moon_tone * risen, moon)};
}

SkyColors lightColors(const SkySettings& sky) {
  SkyColors colors = sky.colors;
  const Vec3 key = keyLight(sky).color, least = colors.ambient_ground;
  colors.sun_color = {std::max(key.x, least.x), std::max(key.y, least.y), std::max(key.z, least.z)};
  return colors;
}

float horizonLine(float view_y, float exponent, float viewer_height) {
  return std::pow(saturate(1 - std::abs(view_y + horizonDip(viewer_height))), exponent);
}

Vec3 skyColor(Vec3 view, const SkySettings& settings) {
  const SkyColors& colors = settings.colors;

  // The gradient is above the horizon. Below it, the ground fades into the haze towards the horizon.
  const float height = view.y + horizonDip(settings.viewer_height);
  const float line = horizonLine(view.y, settings.horizon_exponent, settings.viewer_height);
  const Vec3 line_color = lerp(colors.horizon, settings.horizon_color.value_or(colors.horizon), settings.horizon_strength);
  if (height < 0) {
    const Vec3 level = atHorizon(view, settings);
    return lerp(colors.ground, line_color + sunGlow(level, settings) + moonGlow(level, settings.moon), line);
  }
  const float blue = std::sqrt(std::min(1.0F, height));
  const Vec3 gradient = lerp(colors.low_sky, colors.zenith, blue);
  Vec3 color = lerp(gradient, line_color, line);

  // Sun, moon, stars and aurora add to the gradient and set behind the horizon.
  color += sunGlow(view, settings);
  if (settings.sun_disc == DiscKind::kSimple) color += colors.sun_color * (4 * discMask(view, settings.to_sun, settings.disc));
  if (settings.stars) color += starLight(view, settings.to_sun.y, *settings.stars) * (1 - moonCover(view, settings.moon));
  if (settings.moon) color += moonColor(view, *settings.moon);
  if (settings.aurora) color += auroraLight(view, settings.to_sun.y, *settings.aurora);
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

// --- Keys ---

const Keys<SkyColors>& colorKeys() {
  using S = SkyColors;
  constexpr const char* kWhy = "the page has a table of the colours by the sun's height";
  static const Keys<S> keys{
      {"zenith", &S::zenith, 0, kBright, "sky above", KeyUse::kShader, kWhy},
      {"low_sky", &S::low_sky, 0, kBright, "sky just above that line; unset: a horizon that is set", KeyUse::kShader, kWhy},
      {"horizon", &S::horizon, 0, kBright, "line at the horizon, and fog", KeyUse::kShader, kWhy},
      {"ground", &S::ground, 0, kBright, "haze below the horizon", KeyUse::kShader, kWhy},
      {"sun", &S::sun_color, 0, kBright, "light of the sun", KeyUse::kShader, kWhy},
      {"ambient_sky", &S::ambient_sky, 0, kBright, "ambient light from above", KeyUse::kShader, kWhy},
      {"ambient_ground", &S::ambient_ground, 0, kBright, "ambient light from below", KeyUse::kShader, kWhy},
  };
  return keys;
}

const Keys<DiscSettings>& sunDiscKeys() {
  using S = DiscSettings;
  static const Keys<S> keys{
      {"disc_exponent", &S::exponent, 1, 1e9, "a of the simple disc, (l·v)^a · b"},
      {"disc_gain", &S::gain, 0, 1e30, "b of the simple disc; its radius is √(2·ln(b)/a)"},
  };
  return keys;
}

const Keys<SkySettings>& skyKeys() {
  using S = SkySettings;
  static const Keys<S> keys{
      {"glow", &S::glow, 0, kBright, "strength of the wide glow around the simple disc"},
      {"horizon_exponent", &S::horizon_exponent, 1, 1000, "e of the line at the horizon, (1 − |v.y|)^e: how thin it is"},
      {"horizon_color", &S::horizon_color, 0, kBright, "colour of the line; unset: that of the horizon"},
      {"horizon_strength", &S::horizon_strength, 0, 1, "how much the line has of horizon_color"},
      {"viewer_height", &S::viewer_height, 0, 1e3,
       "height of the viewer in radii of the planet: the horizon sinks by arccos(1/(1 + height))"},
  };
  return keys;
}

}  // namespace cloudbake
