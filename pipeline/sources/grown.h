// Clouds that grow: from a preset, a recipe, a list of rules or a file of spheres to a scene.
#pragma once

#include <functional>
#include <string>

#include "pipeline/fields.h"
#include "pipeline/options.h"
#include "pipeline/asset.h"

namespace cloudbake {

/// Whether the settings name something to grow: --rules, --from-spheres, a preset, a .toml.
bool isGrown(const Settings& settings);
/// Names of the built-in presets, joined by commas.
std::string presetNames();

/// Grows the spheres, and but for --dry-run their level set and surface. `settings` takes what the recipe's [bake] table says, under what
/// the command line set (`apply_command_line` runs after it). With --explain, `report.growth` says how.
Scene growScene(Settings& settings, const std::function<void(Settings&)>& apply_command_line, BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
