// The scene file of a plan: that of the scene, with other files for its clouds.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "pipeline/scene/scene_file.h"

namespace cloudbake {

/// What a cloud of the scene is replaced by.
struct PlannedCloud {
  std::string file;  ///< relative to the planned scene
  bool levels = false;
};

/// What follows from the sizes of the clouds' meshes, as it is with the full ones, whose boxes differ a little from those of levels.
struct PlannedSizes {
  std::optional<CameraPlace> camera;  ///< unset: the scene places it
  double far_distance = 0;            ///< of the chain, world units
  double detail_factor = 1;           ///< of its detail_size
};

/// The text of the planned scene, in `folder`. `clouds`: by what keyOf (pipeline/picture/picture.h) says of the scene's clouds; others stay
/// as they are. Paths of other files are given relative to the folder. `text` is that of the scene `file`.
std::string plannedScene(const std::filesystem::path& file, const std::string& text, const std::filesystem::path& folder,
                         const std::map<std::string, PlannedCloud>& clouds, const PlannedSizes& sizes);

}  // namespace cloudbake
