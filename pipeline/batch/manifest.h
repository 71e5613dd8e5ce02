// The manifest of a batch: a TOML file that lists what to make.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/options/scene_needs.h"

namespace cloudbake {

/// A key and its value as on the command line, and their place in the file (from 1; 0: not in a file).
struct ManifestValue {
  std::string key, value;
  int line = 0, column = 0;
};

/// One [[cloud]]: a preset or a file to grow, or sculpts. With several seeds or sculpts it makes one asset for each.
struct ManifestCloud {
  SourceKind kind = SourceKind::kPreset;  ///< of a sequence, whatever it names
  bool is_sequence = false;
  std::vector<ManifestValue> sources;  ///< the preset or the file, or paths and globs of sculpts, as written
  std::vector<uint64_t> seeds;         ///< of a grown cloud; empty: the recipe's own
  std::optional<ManifestValue> name;   ///< template for the names of the outputs; overrides the manifest's
  std::vector<ManifestValue> options;  ///< any option of `grow` and `bake`, in the order of the file
  int line = 0, column = 0;
};

struct Manifest {
  std::filesystem::path file;
  std::optional<ManifestValue> name;    ///< template for the names of the outputs
  std::vector<ManifestValue> defaults;  ///< options for all clouds that they apply to
  std::optional<SceneNeeds> scene;
  std::vector<ManifestCloud> clouds;
};

/// Reads a manifest:
///   name = '{stem}.glb'         top level, optional
///   [defaults] OPTION = VALUE   with _ for -
///   [scene]                     the tables of a scene file (pipeline/scene/scene_file.h): [scene.camera], [scene.picture], [scene.sun]
///   [[cloud]]                   preset = 'NAME' | recipe = 'FILE' | rules = 'FILE' | from_spheres = 'FILE' | sculpt = 'GLOB' or [GLOB, …]
///                               | sequence = 'FRAMES', as of `cloudbake sequence`;
///                               seeds = [1, 2, …] or 'LOW-HIGH', name = 'TEMPLATE', OPTION = VALUE
/// Names of options are not checked here. Throws IoError, and InputError with file, line and column for a syntax error, an
/// unknown table or key at the top level, a wrong type, a cloud with no source or with two, or no cloud at all.
Manifest readManifest(const std::filesystem::path& file);
/// The same from text; `file` names it.
Manifest parseManifest(const std::string& text, const std::filesystem::path& file);

}  // namespace cloudbake
