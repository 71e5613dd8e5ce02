// Clouds that are grown from a preset, a recipe, a list of rules or a file of spheres.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/report/report.h"
#include "lsystem/recipe.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/options.h"
#include "pipeline/options/scene_needs.h"

namespace cloudbake {

/// The source of a grown cloud: rules with their settings, or the spheres themselves.
struct GrownSource {
  std::optional<CloudRecipe> recipe;
  std::vector<Sphere> spheres;
  std::string file;                ///< for messages: a path, or "preset humilis"
  std::string name;                ///< of the cloud's only part
  std::string bytes;               ///< the input as it was read
  std::vector<Given> given;        ///< the seed and the [bake] table of a recipe
  std::vector<Given> of_sequence;  ///< its [sequence] table: options that only `sequence` has
};

/// Reads the source; isGrown(source.kind) must hold. Throws IoError, and InputError for an unknown preset, a damaged file or an unknown key
/// in [bake] or [sequence].
GrownSource readGrownSource(const SourceSettings& source);

/// Grows the spheres and, unless settings.source.spheres_only is set, their level set and surface. If the settings have no vertex budget,
/// `scene` gives one. With --explain, `report.growth` says how the cloud grew.
Cloud growCloud(GrownSource source, const Settings& settings, const std::optional<SceneNeeds>& scene, BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
