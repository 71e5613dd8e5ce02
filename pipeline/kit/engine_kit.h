// The engine kit: shaders and scripts for an engine, made of the one GLSL of shaders/functions/ (or its HLSL) and the constants of an
// asset and of a scene.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"
#include "pipeline/kit/scene_constants.h"

namespace cloudbake {

/// The engines that the kit has files for, sorted: "blender", "glsl", "godot3" …
std::vector<std::string> engineNames();

/// What people call an engine: "Godot 3"; "three.js, Babylon.js" for files that serve both. `engine` is one of engineNames().
std::string engineTitle(std::string_view engine);

/// Whether the files of an engine play sequences (io/gltf/sequence), as its engine.json says.
bool playsSequences(std::string_view engine);

/// A file of the kit as it is written.
struct EngineFile {
  std::string name;  ///< relative to the folder that is written to
  std::string text;
};

/// k, b and σ of a cloud whose longest side is 1, baked with the defaults: what the kit has without an asset.
AssetInfo defaultAssetInfo();

/// The files of an engine, without its engine.json. A line that includes a shared file (`#include "lobe.glsl"`) becomes that file's text, a
/// line `#structure NAME FILE…` the structure of HLSL that hlslStructure makes of files of GLSL, and
/// @exponent@, @bias@, @extinction@, @first_set@, @second_set@ and @version@ become those of `info`, and the marks of sceneConstants those
/// of `scene`. Throws UsageError for an unknown engine.
std::vector<EngineFile> engineFiles(std::string_view engine, const AssetInfo& info, const SceneFile& scene = defaultScene());

}  // namespace cloudbake
