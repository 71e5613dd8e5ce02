// The keys that a scene file may have, with their values, and the reference of all of them.
#pragma once

#include <string>
#include <vector>

#include "core/keys.h"
#include "pipeline/picture/scene_file.h"

namespace cloudbake {

/// A key with the value that a scene has, as it would stand in the file.
struct DescribedKey {
  std::string table;  ///< such as "terrain.ground", "marched by density"
  std::string name, value;
  double low, high;  ///< of each number
  std::string help;
  KeyUse use;
};

/// All keys of the tables that a scene has; of several slabs, and of several marched clouds of a kind, those of the first one.
std::vector<DescribedKey> describeKeys(const SceneFile& scene);

/// docs/scene_reference.md: by table, each key with its default, its value with as_published = true, its range and its help. A key that
/// only the published or only the painted chain has "–" for the other value.
std::string sceneReference();

}  // namespace cloudbake
