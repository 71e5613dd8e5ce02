#include "pipeline/picture/scene_keys.h"

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
std::string tomlText(bool value) { return value ? "true" : "false"; }
std::string tomlText(Vec2 v) { return "[" + tomlText(v.x) + ", " + tomlText(v.y) + "]"; }
std::string tomlText(Vec3 v) { return "[" + tomlText(v.x) + ", " + tomlText(v.y) + ", " + tomlText(v.z) + "]"; }

// Calls visit(table, keys, settings) for every table of keys.
template <typename Visit>
void visitKeys(const SceneFile& scene, const Visit& visit) {
  const SkySettings& sky = scene.light.sky;
  visit("sky", sunDiscKeys(), sky.disc);
  visit("sky", smoothDiscKeys(), sky.smooth_disc);
  visit("sky", skyKeys(), sky);
  if (sky.moon) visit("sky.moon", moonKeys(), *sky.moon);
  if (sky.moon) visit("sky.moon", moonDiscKeys(), sky.moon->disc);
  if (sky.stars) visit("sky.stars", starKeys(), *sky.stars);
  const PostSettings& post = scene.post;
  visit("light", lightKeys(), scene.light);
  visit("light", shadowKeys(), scene.shadows);
  visit("light", phaseKeys(), post.composite.phase);
  visit("fog", chainFogKeys(), post.composite);
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
}

// A scene with everything.
SceneFile wholeScene(bool as_published) {
  const std::string published = as_published ? "as_published = true\n" : "";
  const std::string text =
      "[sky]\n" + published + "[sky.moon]\n[sky.stars]\n[chain]\n" + published + "[[slab]]\n" + published + "[[marched]]\n" + published +
      "[[marched]]\nfield = 'density'\n" + published + "[terrain]\n" + published +
      "[[dust]]\nlattice = 'cloud.json'\n[camera]\npath = 'terrain'\n[grade]\nmotion_blur = true\nvignette = 0.5\ncontrast = 0.4\n";
  return readSceneFile("scene", text, [](const PictureSettings& view) { return view; });
}

// The table as a scene file has it.
std::string titleOf(const std::string& table) {
  if (table == "slab" || table == "dust") return "[[" + table + "]]";
  if (table == "marched by distance") return "[[marched]] field = \"distance\"";
  if (table == "marched by density") return "[[marched]] field = \"density\"";
  return "[" + table + "]";
}

// What the methods of a table are after.
constexpr std::pair<std::string_view, std::string_view> kSources[]{
    {"sky", "\"Procedural Stylized Sky 1\" (discs) and unity-stylized-sky (the line at the horizon)"},
    {"light", "maajor/Mesh-Cloud-Rendering (half-Lambert)"},
    {"chain", "\"Volumetric Clouds and Mega-Particles\""},
    {"slab", "\"Stylized cartoon volumetric clouds\""},
    {"marched by distance", "\"Cloud Ten\""},
    {"marched by density", "\"Clouds\""},
    {"terrain", "\"Elevated\""},
    {"grade", "the image pass of \"Elevated\""},
};

constexpr const char* kReferenceIntroduction = R"(# Keys of a scene file

Each of these keys sets one number, switch or colour of a scene file ([previewer.md](previewer.md#scenes)). `published`
is the value under `as_published = true` of the table, where it differs; "–" marks a key that only the other chain has.
Colours are linear, and "unset: of the hour" means that the default follows the sun's height. In the formulas v is the
view, l the direction to the light, n the normal, p a place, ss a smooth step, and numbers are constants of the source.

`cloudbake print-docs scene-keys` writes this page from the tables of keys in `preview/`.
)";

std::string referenceRow(const DescribedKey& key, const std::string& value, const std::string& published) {
  const bool is_switch = key.value == "true" || key.value == "false";
  const std::string range = is_switch ? "" : shortestText(key.low) + " … " + shortestText(key.high);
  const std::string where = key.use == KeyUse::kNotInPage ? " (not in the page of `view`)" : "";
  const std::string help = filledTemplate(key.help, {{"|", "\\|"}}) + where;
  return fmt::format("| `{}` | {} | {} | {} | {} |\n", key.name, value, published, range, help);
}

}  // namespace

std::vector<DescribedKey> describeKeys(const SceneFile& scene) {
  std::vector<DescribedKey> all;
  visitKeys(scene, [&](const char* table, const auto& keys, const auto& settings) {
    visitValues(keys, settings, [&](const auto& key, const auto& value) {
      if (key.use == KeyUse::kComputed) return;
      all.push_back({table, key.name, tomlText(value), key.low, key.high, key.help, key.use});
    });
  });
  return all;
}

std::string sceneReference() {
  const std::vector<DescribedKey> keys = describeKeys(wholeScene(false)), published = describeKeys(wholeScene(true));
  const auto namesake = [](const std::vector<DescribedKey>& all, const DescribedKey& key) {
    return std::find_if(all.begin(), all.end(), [&](const DescribedKey& one) { return one.table == key.table && one.name == key.name; });
  };
  std::string text = kReferenceIntroduction;
  for (auto key = keys.begin(); key != keys.end();) {
    const std::string table = key->table;
    text += "\n## `" + titleOf(table) + "`\n\n";
    for (const auto& [of, source] : kSources)
      if (of == table) text += fmt::format("After {}.\n\n", source);
    text += "| key | default | published | range | what it is |\n| --- | --- | --- | --- | --- |\n";
    for (; key != keys.end() && key->table == table; ++key) {
      const auto other = namesake(published, *key);
      text += referenceRow(*key, key->value, other == published.end() ? "–" : other->value == key->value ? "" : other->value);
    }
    for (const DescribedKey& other : published)
      if (other.table == table && namesake(keys, other) == keys.end()) text += referenceRow(other, "–", other.value);
  }
  return text;
}

}  // namespace cloudbake
