// Where the picture of a cloud's shadow lies in the world. shaders/engines/cast_shadow.glsl is the same in GLSL.
#pragma once

#include <span>

#include "core/types.h"
#include "core/vec3.h"

namespace cloudbake {

/// The picture is seen from the sun, in parallel projection: its columns run along `right` and its rows along `up`. World units.
struct ShadowFrame {
  Vec3 origin;                                        ///< the centre of the picture, in the middle of the cloud
  Vec3 right{1, 0, 0}, up{0, 1, 0}, to_sun{0, 0, 1};  ///< unit vectors at right angles: right × up = to_sun
  float width = 1, height = 1;
  float top = 0, bottom = 0;  ///< where the cloud ends towards the sun and away from it: lengths from `origin` along `to_sun`
};

/// The frame that encloses these points, seen from the sun. `up` is as far upwards as it can be; of a sun at the zenith, `right` is +X.
ShadowFrame shadowFrame(std::span<const Vec3> points, Vec3 to_sun);

/// Where a place of the world is in the picture, 0 … 1 from the lower left.
Vec2 shadowPlace(Vec3 place, const ShadowFrame& frame);

/// How much of the shadow counts at a place: 0 at the top of the cloud and above it, 1 at its bottom and below.
float shadowDepth(Vec3 place, const ShadowFrame& frame);

/// The share of the sun's light that comes to a place. `transmittance` is what the picture has at `at`; outside of it the share is 1.
float shadowFactor(float transmittance, Vec2 at, float strength);

}  // namespace cloudbake
