// Lamps: point lights and spotlights that light mesh clouds beside sun and sky. shaders/functions/lamp.glsl is the same in GLSL.
//
// The falloff with distance and angle is that of glTF's extension KHR_lights_punctual: the inverse square, windowed to 0 at the range by
// 1 − (r/range)⁴, and for spotlights the square of a ramp between the cosines of the outer and the inner angle. Nearer than the radius
// of the source a lamp gets no brighter. What comes through the cloud is exp(−σ min(s(l), r)): no more of the cloud counts than lies
// before the lamp.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/keys.h"
#include "core/lobe_lighting.h"
#include "core/types.h"
#include "core/vec3.h"
#include "preview/shading_math.h"

namespace cloudbake {

/// Colours are linear, lengths are world units.
struct Lamp {
  Vec3 place;
  Vec3 color;           ///< at distance 1, times its strength
  float range = 0;      ///< no light beyond it; 0: without end
  float radius = 0;     ///< of the source
  Vec3 axis{0, -1, 0};  ///< of a spotlight: the unit vector in which it shines
  Vec2 cone{-1, -1};    ///< cosines of its inner and outer angle; (−1, −1) or less: a point light
};

inline float lampFalloff(float away, float range, float radius) {
  const float nearest = std::max({away, radius, 1e-6F});
  const float share = range > 0 ? away / range : 0, squared = share * share;
  return std::max(1 - squared * squared, 0.0F) / (nearest * nearest);
}

/// `to_lamp` is the unit vector from the lit place to the lamp.
inline float lampCone(Vec3 to_lamp, Vec3 axis, Vec2 cone) {
  if (!(cone.y > -1)) return 1;
  const float share = saturate((-dot(to_lamp, axis) - cone.y) / std::max(cone.x - cone.y, 0.001F));
  return share * share;
}

/// The light of a lamp that a vertex of a cloud shows. Lobe, place, normal and shape are in the world; σ is per world unit.
inline Vec3 lampLight(const Lamp& lamp, const Lobe& lobe, Vec3 place, Vec3 normal, float half_lambert, LobeShape shape, float extinction) {
  const Vec3 way = lamp.place - place;
  const float away = length(way);
  const Vec3 to_lamp = away > 0 ? way / away : normal;
  const float light = lampFalloff(away, lamp.range, lamp.radius) * lampCone(to_lamp, lamp.axis, lamp.cone);
  return lamp.color * (light * surfaceFactor(normal, to_lamp, half_lambert) * lampTransmittance(lobe, to_lamp, away, shape, extinction));
}

/// So many lamps and lightnings a scene may have.
inline constexpr size_t kMostLamps = 16;

/// A lamp of a scene.
struct LampSettings {
  Vec3 place, color{1, 1, 1};
  float strength = 1, range = 0, radius = 0.1F;
  std::optional<Vec3> look_at;                   ///< makes it a spotlight
  float inner_degrees = 15, outer_degrees = 30;  ///< from its axis, inner < outer
};
/// Its keys in a scene file.
const Keys<LampSettings>& lampKeys();

/// Flashes of lightning, which light clouds from inside. Everything follows from the seed and the time.
struct LightningSettings {
  Vec3 place, spread, color{0.8F, 0.87F, 1};
  float strength = 1, range = 0, radius = 0.1F;
  float every_seconds = 6;  ///< each stretch of this length has one flash
  std::optional<float> at;  ///< seconds: one flash, and no others
  int most_strokes = 8;
  float decay_seconds = 0.05F;
  uint32_t seed = 0;
};
/// Its keys in a scene file.
const Keys<LightningSettings>& lightningKeys();

/// Flashes that are different; then the first comes again.
inline constexpr int kFlashes = 16;
/// Less than this share of a first stroke counts as dark.
inline constexpr float kDarkFlash = 1e-3F;

/// A flash: its place, and the return strokes with their starts, in seconds since the stretch of the flash began, and their strengths.
struct Flash {
  Vec3 place;
  std::vector<Vec2> strokes;
};
/// kFlashes flashes, or the one of `at`, whose seconds are those of the scene.
std::vector<Flash> flashesOf(const LightningSettings& settings);
/// The light of a flash at these seconds, relative to that of its first stroke.
float flashBrightness(const Flash& flash, float seconds, float decay_seconds);

Lamp lampOf(const LampSettings& settings);
/// The lamps and flashes that shine at a time of the scene.
std::vector<Lamp> lampsAt(std::span<const LampSettings> lamps, std::span<const LightningSettings> lightning, double seconds);

}  // namespace cloudbake
