#include "pipeline/kit/scene_constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/text/numbers.h"
#include "pipeline/scene/scene_keys.h"
#include "preview/mesh_clouds/paint.h"
#include "preview/mesh_clouds/post.h"

namespace cloudbake {

namespace {

using Constants = std::map<std::string, std::string>;

SceneFile sceneOf(const std::string& text) {
  return readSceneFile("scene", text + "[[cloud]]\nfile = 'cloud.glb'\n", [](const PictureSettings& view) { return view; });
}

std::string realText(std::string_view number) {
  return std::string(number) + (number.find_first_of(".e") == std::string_view::npos ? ".0" : "");
}

// A vector, and its numbers.
void add(Constants& constants, const std::string& name, const std::vector<std::string>& numbers) {
  constants[fmt::format("@{}@", name)] = fmt::format("{}", fmt::join(numbers, ", "));
  for (size_t i = 0; i < numbers.size() && numbers.size() > 1; ++i) constants[fmt::format("@{}_{}@", name, "xyz"[i])] = numbers[i];
}

void add(Constants& constants, const DescribedKey& key) {
  std::string name = key.table + "_" + key.name;
  std::ranges::replace_if(
      name, [](char c) { return c == '.' || c == ' '; }, '_');
  if (key.is_whole) return add(constants, name, {key.value});
  if (key.value == "unset") return add(constants, name, {"0.0"});
  constexpr std::string_view kAround = "[], ";
  std::vector<std::string> numbers;
  for (size_t at = key.value.find_first_not_of(kAround); at != key.value.npos;) {
    const size_t end = std::min(key.value.find_first_of(kAround, at), key.value.size());
    numbers.push_back(realText(std::string_view(key.value).substr(at, end - at)));
    at = key.value.find_first_not_of(kAround, end);
  }
  add(constants, name, numbers);
}

std::string realText(float number) { return realText(shortestText(number)); }

}  // namespace

SceneFile defaultScene() { return sceneOf(""); }

Constants sceneConstants(const SceneFile& scene) {
  Constants constants;
  for (const SceneFile& one : {sceneOf("[chain]\nas_published = true\n"), defaultScene(), scene})
    for (const DescribedKey& key : describeKeys(one)) add(constants, key);
  constants["@chain_as_published@"] = scene.post.published ? "true" : "false";
  const Vec3 to_sun = scene.light.sky.to_sun;
  add(constants, "sun_direction", {realText(to_sun.x), realText(to_sun.y), realText(to_sun.z)});
  constants["@far_sizes@"] = realText(kFarSides);
  constants["@swirl_octaves@"] = std::to_string(kSwirlNoise.octaves);
  constants["@swirl_gain@"] = realText(kSwirlNoise.gain);
  constants["@swirl_cells@"] = std::to_string(kSwirlNoise.period);
  constants["@swirl_slope@"] = realText(kTypicalSlope);
  constants["@erosion_octaves@"] = std::to_string(kErosionNoise.octaves);
  constants["@erosion_gain@"] = realText(kErosionNoise.gain);
  add(constants, "erosion_fading", {realText(kFadingFrom), realText(kFadingTo)});
  return constants;
}

}  // namespace cloudbake
