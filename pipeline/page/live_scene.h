// A scene of mesh clouds as the page of `view` needs it: settings, constants, vertices and triangles as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "io/gltf/asset_info.h"
#include "pipeline/picture/scene_picture.h"

namespace cloudbake {

/// A scene and the looks in which it is drawn, by name: an asset has "painted", "published" and "plain", a scene file its own. The page
/// begins with the look of `scenery.scene`. `name` is what the page calls it.
struct LiveScene {
  Json scene, looks;
};

/// Throws UsageError if the scene has what the page cannot show.
LiveScene liveScene(const Scenery& scenery, const std::string& name);

}  // namespace cloudbake
