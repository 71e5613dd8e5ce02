// Scenes for `preview --scene`: clouds in their places, camera, sun, sky, fog and the image chain, in TOML (docs/previewer.md).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/options.h"
#include "core/types.h"
#include "preview/camera.h"
#include "preview/lit_mesh.h"
#include "preview/mesh_clouds.h"

namespace cloudbake {

struct SceneCloud {
  std::filesystem::path file;  ///< as the scene names it, from the scene's folder
  Affine to_world;
};

/// Where a camera stands, where it does not frame the clouds by angles.
struct CameraPlace {
  Vec3 look_from, look_at;
};

/// What a scene file says beside the view.
struct SceneFile {
  std::vector<SceneCloud> clouds;
  std::optional<CameraPlace> camera;
  LightSettings light;  ///< for the view's sun, with the colours that the file sets
  PostSettings post;
};

/// Reads a scene. What the command line can say too (angles, size, exposure, time) goes into `settings.view` before the command line is
/// applied over it. Throws InputError with file, line and column.
SceneFile readSceneFile(const std::filesystem::path& file, const std::string& text, Settings& settings,
                        const std::function<void(Settings&)>& apply_command_line);

/// Scale, then rotation about X, then Y, then Z in degrees, then the way to `position`.
Affine placement(Vec3 position, Vec3 rotation_degrees, Vec3 scale);

}  // namespace cloudbake
