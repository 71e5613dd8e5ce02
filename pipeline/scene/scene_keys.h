// The keys that a scene file may have, with their values, and the reference of all of them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/keys.h"
#include "pipeline/scene/scene_file.h"

namespace cloudbake {

/// A key with the value that a scene has, as it would stand in the file.
struct DescribedKey {
  std::string table;  ///< such as "terrain.ground", "marched by density"
  std::string name, value;
  bool is_whole;     ///< a whole number or a switch, not a real number
  double low, high;  ///< of each number
  std::string help;
  std::string without_control;  ///< why the page of `view` has no control for it; empty: it has one
};

/// All keys of structs, of the tables that a scene has; of several clouds of a kind, those of the first one.
std::vector<DescribedKey> describeKeys(const SceneFile& scene);

/// A key that is no field of a struct: a word, a file, a place, or a choice of defaults.
struct SpecialKey {
  const char *table, *name;
  const char* fallback;  ///< the value without the key
  const char* values;    ///< those that it takes
  const char* help;
  const char* without_control = nullptr;
};

/// All keys that describeKeys does not have.
std::span<const SpecialKey> specialKeys();

/// docs/scene_reference.md: by table, each key with its default, its value with as_published = true, its range and its help. A key that
/// only the published or only the painted chain has "–" for the other value.
std::string sceneReference();

}  // namespace cloudbake
