// The pictures of `preview`: an asset or a scene, still or in motion, as PNG.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "io/report/report.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/options.h"
#include "pipeline/picture/scene_picture.h"

namespace cloudbake {

/// Receives pictures as they are drawn, so that no more than a few are in memory.
struct PictureSink {
  std::function<void(std::string_view bytes)> picture;                                      ///< more of the picture, or of the animation
  std::function<void(const std::filesystem::path& file, std::string_view bytes)> beside{};  ///< a file of --channels, --steps or --frames
};

/// The result of drawing.
struct Pictures {
  StageSeconds renderers;  ///< seconds per renderer, for the picture or for all frames
  Film film;               ///< of an animation
};

/// Grows or reads a cloud and bakes it as `grow` and `bake` do, with these options. Throws as they do.
BakedMesh bakedMesh(const SourceSettings& from, std::span<const Given> given, BakeReport& report);

/// By what Scenery::meshes has the mesh of a cloud.
std::string keyOf(const SceneCloud& cloud);
/// The bytes of the asset of a cloud of a scene: of its file, or as it is grown for the scene. Throws as reading and growing do.
std::string assetOf(const SceneCloud& cloud, uint64_t memory_limit, Warnings& warnings);

/// Reads the asset, or the scene with its clouds. The options `given` override the view of the scene.
Scenery readScenery(const Settings& settings, std::span<const Given> given, BakeReport& report);

/// Like readScenery for what `view --watch` shows, settings.source: an asset that is baked already is read; a sculpt, a volume or a recipe
/// is baked in memory, with the options of the bake among `given`. Throws UsageError if there are such options for an asset.
Scenery bakeScenery(const Settings& settings, std::span<const Given> given, BakeReport& report);

/// The still picture of the scenery's view, ready for 8 bits. Adds the seconds of each renderer to `seconds`.
Image stillPicture(const Scenery& scenery, StageSeconds& seconds);

/// Draws the pictures that the view of the scenery asks for. Throws UsageError, before the sink gets anything, if that is channels or steps
/// of a scene without mesh clouds.
Pictures drawPictures(const Scenery& scenery, const PictureSink& sink, BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
