// Parts of reading a scene file (pipeline/scene/scene_file.h). All throw InputError with file, line and column.
#pragma once

#include <filesystem>

#include "io/file/write_file.h"
#include "pipeline/scene/scene_file.h"

namespace cloudbake {

class TomlReader;  // core/text/toml.h

/// [sky]: scene.light.sky for the sun and the day of the scene, and the file of the moon's picture. The rest of scene.light stays. The
/// picture of a ramp is read if there is a reader; without one the scene has the default ramp.
void readSky(TomlReader table, const std::filesystem::path& folder, const FileReader* read_file, SceneFile& scene);

/// [terrain], [[slab]] and [[marched]], for the time, the light and the sky of the scene.
void readLayers(TomlReader& table, SceneFile& scene);

}  // namespace cloudbake
