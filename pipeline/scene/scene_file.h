// Scenes in TOML (docs/previewer.md): placed clouds, camera, sun, sky, fog and the image chain. `preview --scene` draws a scene; a bake for
// a scene only needs its camera, picture size and sun.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/harmonic_lattice.h"
#include "core/types.h"
#include "pipeline/options/scene_needs.h"
#include "pipeline/scene/day.h"
#include "preview/backdrop/dust.h"
#include "preview/backdrop/marched_clouds.h"
#include "preview/backdrop/sky_strip.h"
#include "preview/backdrop/slab_clouds.h"
#include "preview/backdrop/terrain.h"
#include "preview/camera.h"
#include "preview/grade.h"
#include "preview/lamp.h"
#include "preview/mesh_clouds/lit_mesh.h"
#include "preview/mesh_clouds/mesh_clouds.h"
#include "preview/mesh_clouds/scatter.h"

namespace cloudbake {

class TomlReader;  // core/text/toml.h

/// A baked asset, or a cloud that is grown and baked for the scene.
struct SceneCloud {
  std::filesystem::path file;  ///< resolved against the scene's folder; empty if `preset` is given
  std::string preset;          ///< a preset's name, or a recipe file, resolved against the scene's folder
  uint64_t seed = 1;
  uint64_t vertices = 10000;
  bool fit = true;      ///< fitted lobes, else mean ones
  bool levels = false;  ///< levels of detail, which are beside `file`, are drawn where the cloud is small in the picture
  Affine to_world;
};
/// Those of its keys in a scene file that belong to a preset.
const Keys<SceneCloud>& growthKeys();

/// A field of clouds: copies of a few clouds, scattered.
struct SceneField {
  std::vector<SceneCloud> clouds;  ///< that are copied; their to_world turns and scales them first, and moves nothing
  std::vector<double> weights;     ///< one of each of them, > 0
  ScatterSettings scatter;
};

/// The place of a camera that does not frame the clouds by angles.
struct CameraPlace {
  Vec3 look_from, look_at;
};

/// The range of the sun; a picture has it in the middle.
struct SunRange {
  float azimuth_low = 105, azimuth_high = 105, elevation_low = 30, elevation_high = 30;  ///< degrees
  bool has_azimuth = false, has_elevation = false;                                       ///< whether the file gives them
};

/// Dust that a lattice of harmonics lights.
struct SceneDust {
  std::filesystem::path file;  ///< of the lattice, resolved against the scene's folder; it is not read with the scene
  std::shared_ptr<const HarmonicLattice> lattice;
  Affine to_world;
  DustSettings settings;
};

/// The steps that are applied to a drawn picture, in this order.
struct GradeSettings {
  bool sqrt_gamma = false;  ///< use the square root instead of the filmic curve
  std::optional<MotionBlurSettings> motion_blur;
  std::optional<VignetteSettings> vignette;
  std::optional<ContrastSettings> contrast;
};

/// The contents of a scene file.
struct SceneFile {
  std::vector<SceneCloud> clouds;
  std::vector<SceneField> fields;
  PictureSettings view;  ///< angles, size, exposure and time from the file, overridden by the command line
  std::optional<CameraPlace> camera;
  std::optional<double> camera_distance;  ///< of a camera placed by angles; unset: it frames the clouds
  bool camera_path = false;               ///< the camera is on the terrain's path, at the view's time
  float camera_roll_degrees = 0;          ///< of a camera that is not on a path
  std::optional<Day> day;                 ///< of scenes in which an hour places sun, moon and stars
  std::filesystem::path moon_picture;     ///< resolved against the scene's folder; it is not read with the scene
  SkyStrip sky_strip;                     ///< of a sky whose ramp is a picture
  std::vector<LampSettings> lamps;
  std::vector<LightningSettings> lightning;
  ShadowSettings shadows;
  LightSettings light;   ///< for the view's sun, with the colours that the file sets, and the lamps that shine at its time
  VolumeChoices volume;  ///< of the lobes that are baked for the scene
  PostSettings post;
  std::optional<TerrainSettings> terrain;
  bool terrain_sky = false;  ///< the background is the terrain's own sky
  std::vector<SlabSettings> slabs;
  std::vector<DistanceCloudSettings> distance_clouds;
  std::vector<DensityCloudSettings> density_clouds;
  std::vector<SceneDust> dust;
  FogSettings fog;  ///< fog over distance; with a density it replaces the chain's fog
  GradeSettings grade;
  bool compares_techniques = false;  ///< draw a sheet with each kind of cloud on its own instead of one picture
};
/// Whether the scene has mesh clouds.
inline bool hasMeshClouds(const SceneFile& scene) { return !scene.clouds.empty() || !scene.fields.empty(); }
/// The keys of [camera] that the command line does not have.
const Keys<SceneFile>& cameraKeys();
/// The keys of [picture], [camera], [sun] and [volume].
const Keys<PictureSettings>& pictureKeys();
const Keys<PictureSettings>& viewKeys();
const Keys<Day>& dayKeys();
const Keys<VolumeChoices>& volumeKeys();
const Keys<OctaveSettings>& octaveKeys();

/// Reads a scene for a picture. `over` applies the options of the command line to the view of the file, or what a moment of a motion
/// changes: all that follows from time and sun is read for these. Of the files that it names only the picture of the sky's ramp is
/// read. Throws InputError with file, line and column.
SceneFile readSceneFile(const std::filesystem::path& file, const std::string& text,
                        const std::function<PictureSettings(const PictureSettings&)>& over);

/// Reads the parts of a scene that a bake needs: [camera], [picture], [sun] and [volume]. Its clouds are not opened. Throws IoError, and
/// InputError with file, line and column.
SceneNeeds readSceneNeeds(const std::filesystem::path& file, const FileReader& read_file = readFileBytes);
/// The same from a table that holds the scene.
SceneNeeds readSceneNeeds(TomlReader& table, const std::filesystem::path& folder);

/// Scale, then rotation about X, then Y, then Z in degrees, then translation to `position`.
Affine placement(Vec3 position, Vec3 rotation_degrees, Vec3 scale);

}  // namespace cloudbake
