// Lamps: point lights and spotlights that light mesh clouds beside sun and sky. shaders/functions/lamp.glsl is the same in GLSL.
//
// The falloff with distance and angle is that of glTF's extension KHR_lights_punctual: the inverse square, windowed to 0 at the range by
// 1 − (r/range)⁴, and for spotlights the square of a ramp between the cosines of the outer and the inner angle. Nearer than the radius
// of the source a lamp gets no brighter. What comes through the cloud is exp(−σ min(s(l), r)): no more of the cloud counts than lies
// before the lamp.
#pragma once

#include <algorithm>
#include <cmath>

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

}  // namespace cloudbake
