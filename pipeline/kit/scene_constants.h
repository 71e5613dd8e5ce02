// The constants of a scene file for the engine kit: every number and switch of its tables, by a mark such as @chain_near_width@.
#pragma once

#include <map>
#include <string>

#include "pipeline/scene/scene_file.h"

namespace cloudbake {

/// Texts by mark. The mark of a key is its table and its name: `[sky.colors] sun` is @sky_colors_sun@. A vector is "1.0, 0.0, 0.5", and
/// each of its numbers has a mark of its own (@sky_colors_sun_x@). Real numbers have a point or an exponent, as shading languages need; a
/// number that is not set is 0.0. Keys that `scene` has not, as those of the other chain, have the values of a scene without them. Besides:
/// @sun_direction@, and the constants of the chain that no key sets, such as @swirl_octaves@.
std::map<std::string, std::string> sceneConstants(const SceneFile& scene);

/// What the kit has without a scene: the previewer's defaults.
SceneFile defaultScene();

}  // namespace cloudbake
