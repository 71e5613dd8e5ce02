// Scenes in TOML (docs/previewer.md): clouds in their places, camera, sun, sky, fog and the image chain. `preview --scene` draws one; a
// bake for a scene needs its camera and its sun alone.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"
#include "core/warnings.h"
#include "pipeline/scene_needs.h"
#include "preview/backdrop/marched_clouds.h"
#include "preview/backdrop/slab_clouds.h"
#include "preview/backdrop/terrain.h"
#include "preview/camera.h"
#include "preview/grade.h"
#include "preview/mesh_clouds/lit_mesh.h"
#include "preview/mesh_clouds/mesh_clouds.h"

namespace cloudbake {

class TomlReader;  // core/text/toml.h

/// A baked asset, or a cloud that is grown and baked for the scene.
struct SceneCloud {
  std::filesystem::path file;  ///< found from the scene's folder; empty where `preset` says what to grow
  std::string preset;          ///< a preset's name, or a recipe as the scene names it from its folder
  uint64_t seed = 1;
  size_t vertices = 10000;
  bool fit = true;  ///< a fitted lobe
  Affine to_world;
};

/// Where a camera stands, where it does not frame the clouds by angles.
struct CameraPlace {
  Vec3 look_from, look_at;
};

/// Where the sun goes; a picture has it in the middle.
struct SunRange {
  float azimuth_low = 105, azimuth_high = 105, elevation_low = 30, elevation_high = 30;  ///< degrees
  bool has_azimuth = false, has_elevation = false;                                       ///< the file gives them
};

/// What is done to a picture once it is drawn, in this order.
struct GradeSettings {
  bool sqrt_gamma = false;  ///< the square root in place of the filmic curve
  bool motion_blur = false;
  std::optional<VignetteSettings> vignette;
  std::optional<ContrastSettings> contrast;
};

/// What a scene file says beside the view.
struct SceneFile {
  std::vector<SceneCloud> clouds;
  PictureSettings view;  ///< angles, size, exposure, time: as the file gives them, under what the command line gave
  std::optional<CameraPlace> camera;
  std::optional<double> camera_distance;  ///< of a camera that is placed by angles; unset: it frames the clouds
  bool camera_path = false;               ///< the camera is on the terrain's path, at the view's time
  LightSettings light;                    ///< for the view's sun, with the colours that the file sets
  PostSettings post;
  std::optional<TerrainSettings> terrain;
  bool terrain_sky = false;  ///< the terrain's own sky behind all
  std::vector<SlabSettings> slabs;
  std::vector<DistanceCloudSettings> distance_clouds;
  std::vector<DensityCloudSettings> density_clouds;
  FogSettings fog;  ///< over distances; with a density it is in place of the chain's
  GradeSettings grade;
  bool compares_techniques = false;  ///< a sheet of the clouds alone, in place of all together
};

/// Reads a scene for a picture. `over` puts what the command line gave over the view that the file gives. Throws InputError with file, line
/// and column.
SceneFile readSceneFile(const std::filesystem::path& file, const std::string& text,
                        const std::function<PictureSettings(const PictureSettings&)>& over);

/// Reads what a bake needs of a scene: [camera], [picture], [sun]; its clouds are not opened. The keys of earlier versions
/// (camera_distance, field_of_view, image_height, sun_elevation, sun_azimuth at the top) are read too and counted as kOldKey. Throws
/// IoError, InputError with file, line and column.
SceneNeeds readSceneNeeds(const std::filesystem::path& file, Warnings& warnings);
/// The same of a reader at the table that stands for the file.
SceneNeeds readSceneNeeds(TomlReader& table, const std::filesystem::path& folder, Warnings& warnings);

/// Scale, then rotation about X, then Y, then Z in degrees, then the way to `position`.
Affine placement(Vec3 position, Vec3 rotation_degrees, Vec3 scale);

}  // namespace cloudbake
