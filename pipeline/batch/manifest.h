// The manifest of a batch: a TOML file that says what is to be made.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/warnings.h"
#include "pipeline/scene_needs.h"

namespace cloudbake {

/// A key as the command line would carry it, and where it stands (from 1; 0: not in a file).
struct ManifestValue {
  std::string key, value;
  int line = 0, column = 0;
};

/// One [[cloud]]: a preset or a file to grow, or sculpts; with several seeds or several sculpts it stands for as many assets.
struct ManifestCloud {
  SourceKind kind = SourceKind::kPreset;
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
  std::optional<SceneNeeds> scene;
  std::vector<ManifestCloud> clouds;
};

/// Reads a manifest:
///   name = '{stem}.glb'         top level, optional
///   [defaults] OPTION = VALUE   with _ for -
///   [scene]                     the tables of a scene file (pipeline/picture/scene_file.h): [scene.camera], [scene.picture], [scene.sun]
///   [[cloud]]                   preset = 'NAME' | recipe = 'FILE' | rules = 'FILE' | from_spheres = 'FILE' | sculpt = 'GLOB' or [GLOB, …];
///                               seeds = [1, 2, …] or 'LOW-HIGH', name = 'TEMPLATE', OPTION = VALUE
/// Names of options are not checked here. Counted: kOldKey. Throws IoError; InputError with file, line and column for a syntax error, an
/// unknown table or key of the top level, a wrong type, a cloud without or with two sources, no cloud at all.
Manifest readManifest(const std::filesystem::path& file, Warnings& warnings);
/// The same from text; `file` names it.
Manifest parseManifest(const std::string& text, const std::filesystem::path& file, Warnings& warnings);

}  // namespace cloudbake
