// The pictures of `preview`: an asset or a scene, still or in motion, as PNG.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "io/report/report.h"
#include "pipeline/options.h"
#include "pipeline/picture/scene_picture.h"
#include "pipeline/stopwatch.h"

namespace cloudbake {

struct NamedFile {
  std::filesystem::path file;
  std::string bytes;
};

/// The pictures that were drawn.
struct Pictures {
  std::string png;                ///< the picture, or the animation
  std::vector<NamedFile> beside;  ///< files of --channels, --steps and --frames
  StageSeconds renderers;         ///< seconds per renderer, for the picture or for all frames
  Film film;                      ///< of an animation
};

/// Grows or reads a cloud and bakes it as `grow` and `bake` do, with these options. Throws as they do.
BakedMesh bakedMesh(const SourceSettings& from, std::span<const Given> given, BakeReport& report);

/// Reads the asset, or the scene with its clouds. The options `given` override the view of the scene.
Scenery readScenery(const Settings& settings, std::span<const Given> given, BakeReport& report);

/// Like readScenery for what `view --watch` shows, settings.source: an asset that is baked already is read; a sculpt, a volume or a recipe
/// is baked in memory, with the options of the bake among `given`. Throws UsageError if there are such options for an asset.
Scenery bakeScenery(const Settings& settings, std::span<const Given> given, BakeReport& report);

/// Draws what the view of the scenery asks for. Throws UsageError if it asks for channels or steps but the scene has no mesh clouds, and
/// IoError if the encoder of animations is missing.
Pictures drawPictures(const Scenery& scenery, BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
