// A moon with a picture of its own on a disc, and the light that it sends to clouds at night.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "core/image.h"
#include "core/keys.h"
#include "preview/backdrop/disc.h"

namespace cloudbake {

struct MoonSettings {
  Vec3 direction{0, 0.70710678F, -0.70710678F};     ///< unit, towards the moon
  Vec3 up{0, 1, 0};                                 ///< top of its picture, made perpendicular to the direction; not parallel to it
  DiscKind disc_kind = DiscKind::kSimple;           ///< kSmooth: neither ground nor picture; its light falls with the phase
  DiscSettings disc{13000, 1e8F};                   ///< of kSimple: radius 3 degrees; the rim is sharper than the sun's. gain > 1/2
  SmoothDiscSettings smooth_disc{0.05F, 2, 0.02F};  ///< of kSmooth
  Vec3 color{0.9F, 0.93F, 1};                       ///< of a full moon's brightest ground, linear
  float phase_degrees = 0;               ///< 0 = full, 90 = half, 180 = new; where it is positive, v of its picture has the lit side
  Vec3 light{0.030F, 0.042F, 0.075F};    ///< of a full moon on clouds and ground at night, linear
  std::shared_ptr<const Image> picture;  ///< linear, its top along `up`; unset: plains and craters
};
/// Its keys in a scene file.
const Keys<MoonSettings>& moonKeys();
const Keys<DiscSettings>& moonDiscKeys();

/// Where a view meets the moon's picture: u along its up, v along direction × up, the disc's rim (mask 1/2) on the circle of radius
/// 1/2 around (1/2, 1/2). Not clamped. None for the half of all views that faces away, where the formula repeats.
std::optional<Vec2> moonUv(Vec3 view, const MoonSettings& settings);

/// A crater on the near half of the moon: bowl and bright wall.
struct MoonCrater {
  Vec3 center;  ///< unit: along up, along direction × up, towards the viewer
  float radius = 0;
};
inline constexpr size_t kMoonCraters = 24;
std::array<MoonCrater, kMoonCraters> moonCraters();

/// How bright the moon's ground is at a point of its picture, 0 … 1: plains, craters and the shadow of the phase. Beyond the circle of
/// radius 1/2 the rim continues.
float moonBrightness(Vec2 uv, float phase_degrees);

/// The colour of the moon along a unit vector, with its mask: 0 outside its disc, unless that is smooth.
Vec3 moonColor(Vec3 view, const MoonSettings& settings);

/// The light of the moon at its phase and its elevation above the horizon, degrees, linear: full from 10 degrees on, 0 once it has set.
Vec3 moonLight(const MoonSettings& settings, float elevation_degrees);

}  // namespace cloudbake
