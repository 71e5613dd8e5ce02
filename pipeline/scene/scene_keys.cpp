#include "pipeline/scene/scene_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "core/text/markup.h"
#include "core/text/numbers.h"
#include "core/text/toml.h"

namespace cloudbake {

namespace {

std::string tomlText(float value) { return shortestText(value); }
std::string tomlText(double value) { return shortestText(value); }
std::string tomlText(int value) { return std::to_string(value); }
std::string tomlText(uint32_t value) { return std::to_string(value); }
std::string tomlText(uint64_t value) { return std::to_string(value); }
std::string tomlText(bool value) { return value ? "true" : "false"; }
std::string tomlText(Vec2 v) { return "[" + tomlText(v.x) + ", " + tomlText(v.y) + "]"; }
std::string tomlText(Vec3 v) { return "[" + tomlText(v.x) + ", " + tomlText(v.y) + ", " + tomlText(v.z) + "]"; }
template <typename Value>
std::string tomlText(const std::optional<Value>& value) {
  return value ? tomlText(*value) : "unset";
}

// Calls visit(table, keys, settings) for every table of keys.
template <typename Visit>
void visitKeys(const SceneFile& scene, const Visit& visit) {
  const SkySettings& sky = scene.light.sky;
  visit("picture", pictureKeys(), scene.view);
  visit("camera", viewKeys(), scene.view);
  visit("camera", cameraKeys(), scene);
  if (scene.day) visit("sun", dayKeys(), *scene.day);
  visit("sky", sunDiscKeys(), sky.disc);
  visit("sky", smoothDiscKeys(), sky.smooth_disc);
  visit("sky", skyKeys(), sky);
  visit("sky", skyStripKeys(), scene.sky_strip);
  visit("sky.colors", colorKeys(), sky.colors);
  if (sky.moon) visit("sky.moon", moonKeys(), *sky.moon);
  if (sky.moon) visit("sky.moon", moonDiscKeys(), sky.moon->disc);
  if (sky.moon) visit("sky.moon", smoothDiscKeys(), sky.moon->smooth_disc);
  if (sky.stars) visit("sky.stars", starKeys(), *sky.stars);
  if (sky.aurora) visit("sky.aurora", auroraKeys(), *sky.aurora);
  const PostSettings& post = scene.post;
  visit("light", lightKeys(), scene.light);
  visit("light", shadowKeys(), scene.shadows);
  visit("light", phaseKeys(), post.composite.phase);
  if (!scene.lamps.empty()) visit("lamp", lampKeys(), scene.lamps.front());
  if (!scene.lightning.empty()) visit("lightning", lightningKeys(), scene.lightning.front());
  visit("fog", chainFogKeys(), post.composite);
  visit("fog", fogKeys(), scene.fog);
  visit("fog", scatterKeys(), post.composite.scatter);
  visit("chain", depthKeys(), post);
  visit("chain", distortKeys(), post.distort);
  if (post.published) {
    visit("chain", publishedKeys(), *post.published);
    visit("chain", channelKeys(), post.published->channels);
    visit("chain", blurKeys(), post.published->blur);
    visit("chain", depthBlurKeys(), post.published->depth_blur);
  } else {
    visit("chain", paintedKeys(), post.painted);
    visit("chain", softenKeys(), post.painted.soften);
    visit("chain", erodeKeys(), post.painted.erode);
  }
  if (!scene.clouds.empty() && !scene.clouds.front().preset.empty()) visit("cloud", growthKeys(), scene.clouds.front());
  if (!scene.fields.empty()) visit("cloud.scatter", fieldKeys(), scene.fields.front().scatter);
  if (!scene.slabs.empty()) visit("slab", slabKeys(), scene.slabs.front());
  if (!scene.slabs.empty()) visit("slab", slabToneKeys(), scene.slabs.front().tones);
  if (!scene.distance_clouds.empty()) visit("marched by distance", distanceCloudKeys(), scene.distance_clouds.front());
  if (!scene.density_clouds.empty()) visit("marched by density", densityCloudKeys(), scene.density_clouds.front());
  if (!scene.dust.empty()) visit("dust", dustKeys(), scene.dust.front().settings);
  if (scene.terrain) visitTerrainKeys(*scene.terrain, visit);
  const GradeSettings& grade = scene.grade;
  if (grade.motion_blur) visit("grade", motionBlurKeys(), *grade.motion_blur);
  if (grade.vignette) visit("grade", vignetteKeys(), *grade.vignette);
  if (grade.contrast) visit("grade", contrastKeys(), *grade.contrast);
  visit("volume", volumeKeys(), scene.volume);
  if (scene.volume.octaves) visit("volume", octaveKeys(), *scene.volume.octaves);
}

constexpr const char *kSwitch = "true, false", *kPlace = "[x, y, z]", *kAngle = "degrees",
                     *kOneChoice = "the page is written for one choice", *kDefaults = "it sets defaults when the file is read",
                     *kInMesh = "the page has the clouds where they are", *kInField = "the page has the field as the file scatters it",
                     *kDustPlace = "the page has the dust where it is", *kCameraByHand = "the camera moves by hand";

constexpr SpecialKey kSpecialKeys[]{
    {"picture", "layout", "\"whole\"", "whole, techniques", "techniques: each cloud of the scene in a tile of its own", kOneChoice},
    {"camera", "path", "\"none\"", "none, terrain", "terrain: the camera flies along [terrain.path]", kOneChoice},
    {"camera", "position", "unset", kPlace, "where the camera is; with target, in place of azimuth, elevation and distance", kCameraByHand},
    {"camera", "target", "unset", kPlace, "the point that the camera looks at", kCameraByHand},
    {"sun", "azimuth", "of the look", "degrees, or [low, high]", "direction to the sun; 0 is +Z, 90 is +X; a picture has the middle"},
    {"sun", "elevation", "of the look", "degrees, or [low, high]", "height of the sun above the horizon; a picture has the middle"},
    {"sky", "as_published", "false", kSwitch, "the larger disc of the source", kDefaults},
    {"sky", "disc", "\"simple\"", "simple, smooth, none", "disc of the sun", kOneChoice},
    {"sky", "ramp", "unset", "a file", "picture of the colours by the sun's height, PNG, in place of [[sky.hours]]",
     "the page has a table of the colours by the sun's height"},
    {"sky.hours", "elevation", "required", kAngle, "height of the sun of the colours that follow, which have the keys of [sky.colors]",
     "the page has a table of the colours by the sun's height"},
    {"sky.moon", "disc", "\"simple\"", "simple, smooth", "smooth: a plateau that falls off over the sky, in place of the moon's ground",
     kOneChoice},
    {"sky.moon", "picture", "unset", "a file", "picture of a full moon, in place of drawn ground", "the page has the picture of the file"},
    {"sky.moon", "up", "of the hour, or [0, 1, 0]", kPlace,
     "top of the moon's ground or picture; a moon that grows is lit on the right of it", "without the key it follows the sun"},
    {"sky.moon", "azimuth", "180", kAngle, "direction to the moon, like that to the sun; with [sun] hour: on the sun's circle", kOneChoice},
    {"sky.moon", "elevation", "45", kAngle, "height of the moon above the horizon; with [sun] hour: on the sun's circle", kOneChoice},
    {"sky.stars", "pole", "of the hour, or [0, 0.707, -0.707]", kPlace, "direction of the axis about which the stars turn",
     "without the key it is that of the sun's circle"},
    {"light", "cloud_shade", "\"each\"", "each, grid, none",
     "how mesh clouds shade each other; each: by a shadow of each; grid: by one grid of the whole sky, for many clouds", kOneChoice},
    {"chain", "as_published", "false", kSwitch, "the chain of the source; light, sun and camera are those of the plain look", kDefaults},
    {"chain", "mean", "\"covered\"", "covered, all", "pixels that count in means, with as_published", kOneChoice},
    {"cloud", "file", "unset", "a file", "baked cloud, .glb; a cloud has a file or a preset", kInMesh},
    {"cloud", "preset", "unset", "a preset or a file", "the cloud is grown for the scene, from a preset or a recipe", kInMesh},
    {"cloud", "files", "unset", "a list of files", "several clouds of a field, in place of a file", kInField},
    {"cloud", "presets", "unset", "a list of presets or files", "several clouds of a field, in place of a preset", kInField},
    {"cloud", "weights", "unset", "numbers", "how often the clouds of a field occur, for each one; unset: all alike", kInField},
    {"cloud", "levels", "false", kSwitch, "draw levels of detail, which are beside the file, where the cloud is small",
     "the page has the levels or not"},
    {"cloud", "lobe", "\"fit\"", "fit, mean", "lobes of a grown cloud", kInMesh},
    {"cloud", "position", "[0, 0, 0]", kPlace, "world units", kInMesh},
    {"cloud", "rotation", "[0, 0, 0]", kPlace, "degrees about x, then y, then z", kInMesh},
    {"cloud", "scale", "1", "a number or [x, y, z]", "a negative one mirrors", kInMesh},
    {"cloud.scatter", "low", "required", kPlace, "the box in which clouds are scattered and wrap around: its lowest corner, world units",
     kInField},
    {"cloud.scatter", "high", "required", kPlace, "its highest corner", kInField},
    {"slab", "as_published", "false", kSwitch, "the constants of the source", kDefaults},
    {"marched by distance", "field", "\"distance\"", "distance, density", "kind of the noise", kOneChoice},
    {"marched by distance", "as_published", "false", kSwitch, "the constants of the source", kDefaults},
    {"marched by density", "field", "\"distance\"", "distance, density", "kind of the noise", kOneChoice},
    {"marched by density", "as_published", "false", kSwitch, "the constants of the source", kDefaults},
    {"dust", "lattice", "required", "a file", "light in and around the cloud, .json of `bake --basis sh3 --lattice`", kDustPlace},
    {"dust", "position", "[0, 0, 0]", kPlace, "world units", kDustPlace},
    {"dust", "rotation", "[0, 0, 0]", kPlace, "degrees about x, then y, then z", kDustPlace},
    {"dust", "scale", "1", "a number or [x, y, z]", "a negative one mirrors", kDustPlace},
    {"terrain", "as_published", "false", kSwitch, "own_sky, and at every hour the light of the source", kDefaults},
    {"terrain", "own_sky", "false", kSwitch, "draws the source's sky, and its fog", kOneChoice},
    {"terrain.ground", "snow_side", "away from the sun", kAngle, "slopes that face away from this azimuth have less snow",
     "without the key it follows the sun"},
    {"grade", "gamma", "\"film\"", "film, sqrt", "sqrt: the square root in place of the filmic curve", kOneChoice},
    {"grade", "motion_blur", "false", kSwitch, "blur by the motion of the camera", kOneChoice},
};

// A scene with everything.
SceneFile wholeScene(bool as_published) {
  const std::string published = as_published ? "as_published = true\n" : "";
  const std::string text =
      "[sun]\nhour = 12\n[sky]\n" + published + "[sky.moon]\n[sky.stars]\n[sky.aurora]\n[chain]\n" + published +
      "[[cloud]]\npreset = 'hero'\n[[cloud]]\npreset = 'hero'\n[cloud.scatter]\nlow = [0, 0, 0]\nhigh = [1, 1, 1]\n[[slab]]\n" + published +
      "[[marched]]\n" + published + "[[marched]]\nfield = 'density'\n" + published + "[terrain]\n" + published +
      "[[dust]]\nlattice = 'cloud.json'\n[camera]\npath = 'terrain'\n[grade]\nmotion_blur = true\nvignette = 0.5\ncontrast = 0.4\n"
      "[volume]\noctaves = 0\n[[lamp]]\n[[lightning]]\n";
  return readSceneFile("scene", text, [](const PictureSettings& view) { return view; });
}

// A table of a scene file.
struct Table {
  const char *name, *title;
  const char* source = nullptr;  // what its methods are after
};

constexpr Table kTables[]{
    {"picture", "[picture]"},
    {"camera", "[camera]"},
    {"sun", "[sun]"},
    {"sky", "[sky]", "\"Procedural Stylized Sky 1\" (discs) and unity-stylized-sky (the line at the horizon)"},
    {"sky.colors", "[sky.colors]"},
    {"sky.hours", "[[sky.hours]]"},
    {"sky.moon", "[sky.moon]"},
    {"sky.stars", "[sky.stars]"},
    {"sky.aurora", "[sky.aurora]"},
    {"light", "[light]", "maajor/Mesh-Cloud-Rendering (half-Lambert)"},
    {"lamp", "[[lamp]]", "glTF's extension KHR_lights_punctual (falloff and angles)"},
    {"lightning", "[[lightning]]", "counts of real flashes (`preview/lamp.cpp`)"},
    {"fog", "[fog]"},
    {"chain", "[chain]", "\"Volumetric Clouds and Mega-Particles\""},
    {"cloud", "[[cloud]]"},
    {"cloud.scatter", "[cloud.scatter]", "maajor/Mesh-Cloud-Rendering"},
    {"slab", "[[slab]]", "\"Stylized cartoon volumetric clouds\""},
    {"marched by distance", "[[marched]] field = \"distance\"", "\"Cloud Ten\""},
    {"marched by density", "[[marched]] field = \"density\"", "\"Clouds\""},
    {"dust", "[[dust]]"},
    {"terrain", "[terrain]", "\"Elevated\""},
    {"terrain.shape", "[terrain.shape]"},
    {"terrain.fbm", "[terrain.fbm]"},
    {"terrain.march", "[terrain.march]"},
    {"terrain.shadow", "[terrain.shadow]"},
    {"terrain.ground", "[terrain.ground]"},
    {"terrain.light", "[terrain.light]"},
    {"terrain.sky", "[terrain.sky]"},
    {"terrain.fog", "[terrain.fog]"},
    {"terrain.path", "[terrain.path]"},
    {"grade", "[grade]", "the image pass of \"Elevated\""},
    {"volume", "[volume]"},
};

constexpr const char* kIntroduction = R"(# Keys of a scene file

These are all keys of a scene file ([previewer.md](previewer.md#scenes)). `published` is the value under
`as_published = true` of the table, where it differs; "–" marks a key that only the other chain has. Colours are linear.
Defaults of colours are those under the default sun; they follow its height. In the formulas v is the view, l the
direction to the light, n the normal, p a place, ss a smooth step, and numbers are constants of the source. The last
column also says why the page of `view` has no control for a key.

`cloudbake print-docs scene-keys` writes this page from the tables of keys in the code.
)";

std::string row(const std::string& name, const std::string& value, const std::string& published, const std::string& range,
                const std::string& help, const std::string& without_control) {
  const std::string why = without_control.empty() ? "" : " (no control: " + without_control + ")";
  return fmt::format("| `{}` | {} | {} | {} | {}{} |\n", name, value, published, range, filledTemplate(help, {{"|", "\\|"}}), why);
}

std::string row(const DescribedKey& key, const std::string& value, const std::string& published) {
  const bool is_switch = key.value == "true" || key.value == "false";
  const std::string range = is_switch ? "" : shortestText(key.low) + " … " + shortestText(key.high);
  return row(key.name, value, published, range, key.help, key.without_control);
}

}  // namespace

std::vector<DescribedKey> describeKeys(const SceneFile& scene) {
  std::vector<DescribedKey> all;
  visitKeys(scene, [&](const char* table, const auto& keys, const auto& settings) {
    visitValues(keys, settings, [&](const auto& key, const auto& value) {
      if (key.use == KeyUse::kComputed) return;
      constexpr bool kIsWhole = std::is_integral_v<std::remove_cvref_t<decltype(value)>>;
      all.push_back(
          {table, key.name, tomlText(value), kIsWhole, key.low, key.high, key.help, key.without_control ? key.without_control : ""});
    });
  });
  return all;
}

std::span<const SpecialKey> specialKeys() { return kSpecialKeys; }

std::string sceneReference() {
  const std::vector<DescribedKey> keys = describeKeys(wholeScene(false)), published = describeKeys(wholeScene(true));
  const auto namesake = [](const std::vector<DescribedKey>& all, const DescribedKey& key) {
    return std::find_if(all.begin(), all.end(), [&](const DescribedKey& one) { return one.table == key.table && one.name == key.name; });
  };
  std::string text = kIntroduction;
  for (const Table& table : kTables) {
    text += fmt::format("\n## `{}`\n\n", table.title);
    if (table.source) text += fmt::format("After {}.\n\n", table.source);
    text += "| key | default | published | range | what it is |\n| --- | --- | --- | --- | --- |\n";
    for (const SpecialKey& key : kSpecialKeys)
      if (table.name == std::string_view(key.table))
        text += row(key.name, key.fallback, "", key.values, key.help, key.without_control ? key.without_control : "");
    for (const DescribedKey& key : keys) {
      if (key.table != table.name) continue;
      const auto other = namesake(published, key);
      text += row(key, key.value, other == published.end() ? "–" : other->value == key.value ? "" : other->value);
    }
    for (const DescribedKey& key : published)
      if (key.table == table.name && namesake(keys, key) == keys.end()) text += row(key, "–", key.value);
  }
  return text;
}

}  // namespace cloudbake
