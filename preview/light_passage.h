// How much of a light comes to places past the things in between.
#pragma once

#include <functional>
#include <span>

#include "core/vec3.h"

namespace cloudbake {

/// Multiplies each share by the light that a thing lets through to a point of the world from the direction of the light, 0 … 1. As many
/// shares as points.
using LightPassage = std::function<void(std::span<const Vec3> points, std::span<float> shares)>;

/// How clouds that are marched are shadowed where their samples are. Their colours do not tell the part of the light from that of the sky:
/// where no light comes, `sky_share` of the colour is left.
struct MarchedShadow {
  LightPassage passage;  ///< empty: no shadow
  Vec3 sky_share{1, 1, 1};

  /// The factor of the colour at a point of the world.
  Vec3 factorAt(Vec3 point) const {
    if (!passage) return {1, 1, 1};
    float share = 1;
    passage({&point, 1}, {&share, 1});
    return factor(share);
  }
  /// The same for a share of the light that is known.
  Vec3 factor(float share) const { return sky_share + (Vec3{1, 1, 1} - sky_share) * share; }
};

}  // namespace cloudbake
