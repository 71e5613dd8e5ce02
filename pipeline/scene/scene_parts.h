// Parts of reading a scene file (pipeline/scene/scene_file.h). All throw InputError with file, line and column.
#pragma once

#include <filesystem>

#include "pipeline/scene/scene_file.h"

namespace cloudbake {

class TomlReader;  // core/text/toml.h

/// [sky]: scene.light.sky for the sun and the day of the scene, and the file of the moon's picture. The rest of scene.light stays.
void readSky(TomlReader table, const std::filesystem::path& folder, SceneFile& scene);

/// [terrain], [[slab]] and [[marched]], for the time, the light and the sky of the scene.
void readLayers(TomlReader& table, SceneFile& scene);

}  // namespace cloudbake
