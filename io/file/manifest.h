// TOML files that say what is to be made: the manifest of a batch, and the scene that a cloud is made for.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// The part of a scene that decides what a cloud must show.
struct SceneView {
  double camera_distance = 0;        ///< world units, from the camera to the cloud
  double field_of_view_degrees = 0;  ///< vertical
  int image_height = 0;              ///< pixels
  std::optional<SunArc> sun_arc;
  double pixel() const;  ///< size of a pixel at the cloud, world units
};

/// Reads the keys camera_distance, field_of_view, image_height, sun_elevation = [low, high], sun_azimuth = [low, high]. Throws InputError
/// with the place, for an unknown key too.
SceneView readSceneView(const std::filesystem::path& file);

/// A key as the command line would carry it, and where it stands (from 1; 0: not in a file).
struct ManifestValue {
  std::string key, value;
  int line = 0, column = 0;
};

/// What a [[cloud]] is made from.
enum class CloudSourceKind { kPreset, kRecipe, kRules, kSpheres, kSculpt };

/// One [[cloud]]: a preset or a file to grow, or sculpts; with several seeds or several sculpts it stands for as many assets.
struct ManifestCloud {
  CloudSourceKind kind = CloudSourceKind::kPreset;
  std::vector<ManifestValue> sources;  ///< the preset or the file; of sculpts paths and globs, as written
  std::vector<uint64_t> seeds;         ///< of a grown cloud; empty: the recipe's own
  std::optional<ManifestValue> name;   ///< template of the outputs' names, over the manifest's
  std::vector<ManifestValue> options;  ///< any option of `grow` and `bake`, in the order of the file
  int line = 0, column = 0;
};

struct Manifest {
  std::filesystem::path file;
  std::optional<ManifestValue> name;    ///< template of the outputs' names
  std::vector<ManifestValue> defaults;  ///< options for all clouds that they suit
  std::optional<SceneView> scene;
  std::vector<ManifestCloud> clouds;
};

/// Reads a manifest:
///   name = '{stem}.glb'         top level, optional
///   [defaults] OPTION = VALUE   with _ for -
///   [scene]                     as readSceneView
///   [[cloud]]                   preset = 'NAME' | recipe = 'FILE' | rules = 'FILE' | from_spheres = 'FILE' | sculpt = 'GLOB' or [GLOB, …];
///                               seeds = [1, 2, …] or 'LOW-HIGH', name = 'TEMPLATE', OPTION = VALUE
/// Names of options are not checked here. Throws IoError; InputError with file, line and column for a syntax error, an unknown table or key
/// of the top level, a wrong type, a cloud without or with two sources, no cloud at all.
Manifest readManifest(const std::filesystem::path& file);
/// The same from text; `file` names it.
Manifest parseManifest(const std::string& text, const std::filesystem::path& file);

}  // namespace cloudbake
