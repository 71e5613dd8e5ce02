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

/// What was drawn.
struct Pictures {
  std::string png;                ///< the picture, or the animation
  std::vector<NamedFile> beside;  ///< of --channels, --steps and --frames
  StageSeconds renderers;         ///< seconds per renderer, of a picture or of all frames
};

/// Reads the asset, or the scene with its clouds, under the view that `given` puts over the scene's.
Scenery readScenery(const Settings& settings, std::span<const Given> given, BakeReport& report);

/// Draws it as its view asks. Throws UsageError where channels are asked of a scene without mesh clouds, IoError where an animation lacks
/// its encoder.
Pictures drawPictures(const Scenery& scenery, BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
