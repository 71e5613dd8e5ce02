// The layers of a scene beside its mesh clouds, as the page of `view` needs them: settings and limits of their keys as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "core/keys.h"
#include "io/gltf/asset_info.h"
#include "pipeline/picture/scene_picture.h"
#include "pipeline/scene/scene_keys.h"

namespace cloudbake {

/// A vector as three numbers.
Json jsonOf(Vec3 v);

/// The linear part of a map, by columns; and the same, then the offset.
Json linearJson(const Affine& map);
Json affineJson(const Affine& map);

/// The smallest and the largest value of a key, its step, 0 unless it is a whole number, and its help.
template <typename Settings>
Json limitsOf(const Key<Settings>& key) {
  const bool is_whole = std::holds_alternative<int Settings::*>(key.field) || std::holds_alternative<uint32_t Settings::*>(key.field);
  return {key.low, key.high, int(is_whole), key.help};
}

/// Whether the page draws the scene as layers that are composed by distance. Otherwise mesh clouds are drawn straight over their sky.
bool isLayered(const SceneFile& scene);

/// The settings of all layers, named like the keys of a scene file: `terrain` with a table for each of its parts, arrays of `slabs`,
/// `distance` and `density` clouds and `dust`, `sky` with its `moon`, `stars`, `aurora` and `smooth_disc`, `grade`. `limits` has those of
/// every key, by table; `by_sun` what the sun's height changes, as rows of numbers at `heights`, at which the scene is as in `under`; both
/// are left out if `under` is empty.
Json layersJson(const Scenery& scenery, std::span<const float> heights, std::span<const SceneFile> under);

/// The scene's file, which the scenery must have, under a sun at these angles, at the view's time.
SceneFile sceneUnder(const Scenery& scenery, float azimuth_degrees, float elevation_degrees);

}  // namespace cloudbake
