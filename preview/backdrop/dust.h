// Thin dust in and around a cloud, marched along the view and lit through the cloud.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/affine.h"
#include "core/keys.h"
#include "preview/backdrop/sky.h"
#include "preview/camera.h"
#include "preview/layer.h"

namespace cloudbake {

struct DustSettings {
  float reach = 1.5F;       ///< how far the dust extends, in half sides of the box, > 0
  float thickness = 0.12F;  ///< optical depth of the box's longest side where the dust is full, ≥ 0
  float fade_start = 0.4F;  ///< share of the reach from which it thins out, 0 … < 1
  Vec3 color{1, 1, 1};      ///< albedo, linear
  float asymmetry = 0.5F;   ///< g of Henyey and Greenstein, −1 < g < 1
  float ambient = 1;        ///< factor of the sky's light, ≥ 0
  int samples = 64;         ///< along a ray through the dust, ≥ 1
  float dither = 1;         ///< of a step by which the first sample is moved at random, 0 … 1
  uint32_t seed = 0;
  int samples_per_side = 1;  ///< n·n samples per pixel, ≥ 1
};
/// Its keys in a scene file.
const Keys<DustSettings>& dustKeys();

/// How much light comes from a unit direction of the world to a point of the world, 0 … 1.
using LightAt = std::function<float(Vec3 point, Vec3 to_light)>;

/// The dust about a box that `to_world` places: an ellipsoid of its proportions. It is lit by the sky's key light and from above, each as
/// much as `light` lets through. Cut as renderDistanceClouds cuts. Throws std::invalid_argument if a setting is out of its range.
std::vector<Layer> renderDust(const Camera& camera, const SkySettings& sky, const Box& box, const Affine& to_world,
                              const DustSettings& settings, const LightAt& light, std::span<const Layer> surfaces = {});

}  // namespace cloudbake
