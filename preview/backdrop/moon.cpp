// "Procedural Stylized Sky 1" (tajourney): the moon's picture is read at
//   X = up, Y = direction × up, u = X̂·v, v = Ŷ·v, scaled so that the disc fills [0, 1]; times the simple disc.
// The picture is our own, of plains and craters, unless one is given.
#include "preview/backdrop/moon.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/random.h"
#include "core/types.h"
#include "preview/backdrop/noise.h"
#include "preview/shading_math.h"

namespace cloudbake {

namespace {

// Sine of the angle at which a disc's mask is 1/2: cos^a · b = 1/2.
float sineOfDiscRadius(const DiscSettings& disc) {
  const float cosine = std::min(1.0F, std::pow(0.5F / disc.gain, 1 / disc.exponent));
  return std::sqrt(std::max(1e-12F, 1 - cosine * cosine));
}

// The brightness of the ground in full light: dark plains where a noise is high, with craters over them.
float moonAlbedo(Vec3 place) {
  static const std::array<MoonCrater, kMoonCraters> kCraters = moonCraters();
  const float plains = fbmValue3(place * 1.7F + Vec3{5, 2, 9}, {.octaves = 5}).value;
  float albedo = lerp(0.95F, 0.45F, smoothStep(0.46F, 0.58F, plains));
  albedo *= 0.9F + 0.2F * fbmValue3(place * 9, {.octaves = 3, .seed = 1}).value;
  for (const MoonCrater& crater : kCraters) {
    const float distance = length(place - crater.center) / crater.radius;
    if (distance > 1.4F) continue;
    const float wall = smoothStep(0.7F, 0.95F, distance) * smoothStep(1.4F, 1, distance);
    const float bowl = smoothStep(0.9F, 0.6F, distance);
    albedo += 0.22F * wall - 0.12F * bowl;
  }
  return saturate(albedo);
}

// The share of the sun's light at a point of the disc. The moon's dust reflects light back to where it came from, so that the moon is
// evenly bright up to the terminator.
float litShare(Vec3 place, float phase_degrees) {
  const float phase = phase_degrees * float(kPi / 180);
  return smoothStep(-0.02F, 0.18F, dot(place, {0, std::sin(phase), std::cos(phase)}));
}

// The light of a moon in this phase, in shares of that of a full one.
float fullShare(float phase_degrees) { return 0.5F + 0.5F * std::cos(phase_degrees * float(kPi / 180)); }

// The point of a ball that is visible at a point of the picture.
Vec3 placeOnBall(Vec2 uv) {
  float x = 2 * uv.x - 1, y = 2 * uv.y - 1;
  const float square = x * x + y * y;
  if (square > 1) x /= std::sqrt(square), y /= std::sqrt(square);
  return {x, y, std::sqrt(std::max(0.0F, 1 - square))};
}

// The picture's colour at (u, v): u counts up, v to the right of a viewer who sees `up` at the top.
Vec3 colorAt(const Image& picture, Vec2 uv) {
  const float x = std::clamp(uv.y * float(picture.width) - 0.5F, 0.0F, float(picture.width - 1));
  const float y = std::clamp((1 - uv.x) * float(picture.height) - 0.5F, 0.0F, float(picture.height - 1));
  const int x0 = int(x), y0 = int(y), x1 = std::min(x0 + 1, picture.width - 1), y1 = std::min(y0 + 1, picture.height - 1);
  const float part = x - float(x0);
  return lerp(lerp(picture.at(x0, y0), picture.at(x1, y0), part), lerp(picture.at(x0, y1), picture.at(x1, y1), part), y - float(y0));
}

}  // namespace

// Craters anywhere on the visible half, more small ones than large ones.
std::array<MoonCrater, kMoonCraters> moonCraters() {
  std::array<MoonCrater, kMoonCraters> craters;
  for (size_t i = 0; i < craters.size(); ++i) {
    const auto draw = [i](uint32_t what) { return uniformFloat(hashDraw(mix64(kGolden64), uint32_t(i), what)); };
    const float z = 0.15F + 0.85F * draw(0), across = std::sqrt(1 - z * z), angle = float(2 * kPi) * draw(1), size = draw(2);
    craters[i] = {{across * std::cos(angle), across * std::sin(angle), z}, 0.03F + 0.16F * size * size * size};
  }
  return craters;
}

std::optional<Vec2> moonUv(Vec3 view, const MoonSettings& settings) {
  const Vec3 direction = settings.direction;
  if (dot(view, direction) <= 0) return std::nullopt;
  const Vec3 y = normalized(cross(direction, settings.up)).value_or(frameAround(direction).tangent), x = cross(y, direction);
  const float scale = 0.5F / sineOfDiscRadius(settings.disc);
  return Vec2{dot(x, view) * scale + 0.5F, dot(y, view) * scale + 0.5F};
}

float moonBrightness(Vec2 uv, float phase_degrees) {
  const Vec3 place = placeOnBall(uv);
  const float lit = litShare(place, phase_degrees);
  return lit > 0 ? lit * moonAlbedo(place) : 0;
}

Vec3 moonColor(Vec3 view, const MoonSettings& settings) {
  if (settings.disc_kind == DiscKind::kSmooth)
    return smoothDiscColor(view, settings.direction, settings.color, settings.smooth_disc) * fullShare(settings.phase_degrees);
  const float mask = discMask(view, settings.direction, settings.disc);
  if (!(mask > 1e-4F)) return {};
  const Vec2 uv = *moonUv(view, settings);
  if (!settings.picture) return settings.color * (mask * moonBrightness(uv, settings.phase_degrees));
  return settings.color * colorAt(*settings.picture, uv) * (mask * litShare(placeOnBall(uv), settings.phase_degrees));
}

// By the square, because a screen shows the root of a light evenly.
Vec3 moonLight(const MoonSettings& settings, float elevation_degrees) {
  constexpr float kFull = 10;
  const float risen = saturate(elevation_degrees / kFull);
  return settings.light * (fullShare(settings.phase_degrees) * risen * risen);
}

// --- Keys ---

const Keys<MoonSettings>& moonKeys() {
  using S = MoonSettings;
  static const Keys<S> keys{
      {"phase", &S::phase_degrees, -180, 180, "degrees: 0 is full, ±180 new; a positive moon grows"},
      {"color", &S::color, 0, kBright, "colour of the brightest ground of a full moon"},
      {"light", &S::light, 0, kBright, "light of a full moon on clouds and ground at night", KeyUse::kScript, nullptr, true},
      {"direction", &S::direction, -1, 1, "towards the moon", KeyUse::kComputed},
      {"up", &S::up, -1, 1, "the top of its picture", KeyUse::kComputed},
  };
  return keys;
}

const Keys<DiscSettings>& moonDiscKeys() {
  using S = DiscSettings;
  static const Keys<S> keys{
      {"disc_exponent", &S::exponent, 1, 1e9, "a of the moon's disc, (m·v)^a · b"},
      {"disc_gain", &S::gain, 0.51, 1e30, "b of the moon's disc"},
  };
  return keys;
}

}  // namespace cloudbake
