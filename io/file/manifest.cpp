// Keys are walked in the order of the file, so that the first fault is told.
#include "io/file/manifest.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>

#include "core/error.h"
#include "core/text/numbers.h"
#include "core/vec3.h"
#include "core/text/toml.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

constexpr size_t kMaxSeeds = 1'000'000;

// --- Scenes ---

double positiveNumber(const toml::table& table, const char* key, double high, const std::string& file) {
  const toml::node* node = table.get(key);
  if (!node)
    refuseToml(file, table.source(),
               std::string("'") + key + "' is missing: a scene needs camera_distance, field_of_view and image_height");
  const auto value = node->value<double>();
  if (!value || !(*value > 0) || !(*value <= high))
    refuseToml(file, node->source(), std::string("'") + key + "' is out of range: give a number above 0, at most " + shortestText(high));
  return *value;
}

std::pair<float, float> angleRange(const toml::table& table, const char* key, std::pair<float, float> fallback, const std::string& file) {
  const toml::node* node = table.get(key);
  if (!node) return fallback;
  const toml::array* pair = node->as_array();
  const auto low = pair && pair->size() == 2 ? (*pair)[0].value<double>() : std::nullopt,
             high = low ? (*pair)[1].value<double>() : std::nullopt;
  if (!high || !(*low <= *high) || !(std::fabs(*low) <= 3600) || !(std::fabs(*high) <= 3600))
    refuseToml(file, node->source(), std::string("'") + key + "' is no range: give two angles in degrees, [low, high]");
  return {float(*low), float(*high)};
}

SceneView sceneView(const toml::table& table, const std::string& file) {
  const std::set<std::string_view> known{"camera_distance", "field_of_view", "image_height", "sun_elevation", "sun_azimuth"};
  for (const auto& [key, node] : inOrder(table))
    if (!known.contains(key->str())) refuseToml(file, key->source(), "unknown key '" + std::string(key->str()) + "' in a scene: remove it");
  SceneView view;
  view.camera_distance = positiveNumber(table, "camera_distance", 1e30, file);
  view.field_of_view_degrees = positiveNumber(table, "field_of_view", 179, file);
  view.image_height = std::max(1, int(positiveNumber(table, "image_height", 65536, file)));
  if (table.contains("sun_elevation") || table.contains("sun_azimuth")) {
    const auto elevation = angleRange(table, "sun_elevation", {0, 90}, file), azimuth = angleRange(table, "sun_azimuth", {0, 360}, file);
    view.sun_arc = SunArc{elevation.first, elevation.second, azimuth.first, azimuth.second};
  }
  return view;
}

// --- Manifests ---

// A list of numbers is joined by commas, as the command line has it.
std::string optionValue(const toml::node& node, const std::string& file) {
  if (node.is_string()) return *node.value<std::string>();
  if (node.is_boolean()) return *node.value<bool>() ? "true" : "false";
  if (node.is_integer()) return std::to_string(*node.value<int64_t>());
  if (node.is_floating_point() && std::isfinite(*node.value<double>())) return shortestText(*node.value<double>());
  if (const toml::array* list = node.as_array(); list && !list->empty()) {
    std::string joined;
    for (const toml::node& element : *list) {
      if (element.is_array()) break;
      joined += (joined.empty() ? "" : ",") + optionValue(element, file);
      if (&element == &list->back()) return joined;
    }
  }
  refuseToml(file, node.source(), "no option takes this: give a text, a finite number, true or false, or a list of them");
}

ManifestValue valueAt(const toml::key& key, const toml::node& node, std::string value) {
  const auto place = node.source().begin;
  return {std::string(key.str()), std::move(value), int(place.line), int(place.column)};
}

ManifestValue textAt(const toml::key& key, const toml::node& node, const std::string& file) {
  const auto text = node.value<std::string>();
  if (!node.is_string() || text->empty()) refuseToml(file, node.source(), "'" + std::string(key.str()) + "' is no text: put it in quotes");
  return valueAt(key, node, *text);
}

// One text, or a list of them.
std::vector<ManifestValue> textsAt(const toml::key& key, const toml::node& node, const std::string& file) {
  std::vector<ManifestValue> texts;
  const toml::array* list = node.as_array();
  if (!list) return {textAt(key, node, file)};
  for (const toml::node& element : *list) texts.push_back(textAt(key, element, file));
  if (texts.empty()) refuseToml(file, node.source(), "'" + std::string(key.str()) + "' is an empty list: name a file or a glob");
  return texts;
}

std::optional<uint64_t> seedOf(std::string_view text) {
  uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  return error == std::errc() && end == text.data() + text.size() && !text.empty() ? std::optional(seed) : std::nullopt;
}

// [1, 2, 5], or 'LOW-HIGH' with both ends.
std::vector<uint64_t> seedsAt(const toml::node& node, const std::string& file) {
  std::vector<uint64_t> seeds;
  if (const toml::array* list = node.as_array()) {
    for (const toml::node& element : *list)
      if (const auto seed = element.is_integer() ? element.value<int64_t>() : std::nullopt; seed && *seed >= 0)
        seeds.push_back(uint64_t(*seed));
    if (!seeds.empty() && seeds.size() == list->size()) return seeds;
  } else if (node.is_string()) {
    const std::string text = *node.value<std::string>();
    const size_t dash = text.find('-');
    const auto low = seedOf(std::string_view(text).substr(0, dash));
    const auto high = dash == std::string::npos ? std::nullopt : seedOf(std::string_view(text).substr(dash + 1));
    if (low && high && *low <= *high && *high - *low < kMaxSeeds) {
      for (uint64_t seed = *low; seeds.size() <= *high - *low; ++seed) seeds.push_back(seed);
      return seeds;
    }
  }
  refuseToml(file, node.source(), "'seeds' are no seeds: give a list of whole numbers, [1, 2, 3], or a range in quotes, '1-40'");
}

std::optional<CloudSourceKind> sourceKind(std::string_view key) {
  if (key == "preset") return CloudSourceKind::kPreset;
  if (key == "recipe") return CloudSourceKind::kRecipe;
  if (key == "rules") return CloudSourceKind::kRules;
  if (key == "from_spheres") return CloudSourceKind::kSpheres;
  if (key == "sculpt") return CloudSourceKind::kSculpt;
  return std::nullopt;
}

ManifestCloud readCloud(const toml::table& table, const std::string& file) {
  constexpr const char* kSources = "preset, recipe, rules, from_spheres or sculpt";
  ManifestCloud cloud;
  cloud.line = int(table.source().begin.line);
  cloud.column = int(table.source().begin.column);
  for (const auto& [key, node] : inOrder(table)) {
    if (const auto kind = sourceKind(key->str())) {
      if (!cloud.sources.empty()) refuseToml(file, key->source(), std::string("a cloud has one source: give one of ") + kSources);
      cloud.kind = *kind;
      cloud.sources = *kind == CloudSourceKind::kSculpt ? textsAt(*key, *node, file) : std::vector{textAt(*key, *node, file)};
    } else if (key->str() == "seeds") {
      cloud.seeds = seedsAt(*node, file);
    } else if (key->str() == "name") {
      cloud.name = textAt(*key, *node, file);
    } else {
      cloud.options.push_back(valueAt(*key, *node, optionValue(*node, file)));
    }
  }
  if (cloud.sources.empty()) refuseToml(file, table.source(), std::string("a cloud without a source: add ") + kSources);
  if (const toml::node* seeds = table.get("seeds")) {
    if (cloud.kind == CloudSourceKind::kSculpt || cloud.kind == CloudSourceKind::kSpheres)
      refuseToml(file, seeds->source(), "'seeds' are for clouds that grow from rules: remove it, or set seed");
    if (table.contains("seed")) refuseToml(file, table.get("seed")->source(), "'seed' and 'seeds' both stand here: give one of the two");
  }
  return cloud;
}

template <class Node>
const auto& asTable(const Node& node, const std::string& key, const std::string& file) {
  if (!node.is_table()) refuseToml(file, node.source(), "'" + key + "' must be a table: [" + key + "]");
  return *node.as_table();
}

std::vector<ManifestCloud> readClouds(const toml::node& node, const std::string& file) {
  const toml::array* list = node.as_array();
  if (!list || !list->is_homogeneous(toml::node_type::table))
    refuseToml(file, node.source(), "'cloud' must be a list of tables: [[cloud]]");
  std::vector<ManifestCloud> clouds;
  for (const toml::node& element : *list) clouds.push_back(readCloud(*element.as_table(), file));
  return clouds;
}

}  // namespace

double SceneView::pixel() const { return 2 * camera_distance * std::tan(field_of_view_degrees * kPi / 360) / image_height; }

SceneView readSceneView(const std::filesystem::path& file) {
  return sceneView(parseTomlTable(readFileBytes(file), file.string()), file.string());
}

Manifest readManifest(const std::filesystem::path& file) { return parseManifest(readFileBytes(file), file); }

Manifest parseManifest(const std::string& text, const std::filesystem::path& file) {
  const std::string name = file.string();
  const toml::table table = parseTomlTable(text, name);
  Manifest manifest;
  manifest.file = file;
  for (const auto& [key, node] : inOrder(table)) {
    const std::string word(key->str());
    if (word == "name")
      manifest.name = textAt(*key, *node, name);
    else if (word == "scene")
      manifest.scene = sceneView(asTable(*node, word, name), name);
    else if (word == "cloud")
      manifest.clouds = readClouds(*node, name);
    else if (word == "defaults")
      for (const auto& [option, value] : inOrder(asTable(*node, word, name)))
        manifest.defaults.push_back(valueAt(*option, *value, optionValue(*value, name)));
    else
      refuseToml(name, key->source(), "unknown key '" + word + "' in a manifest: there are name, [defaults], [scene] and [[cloud]]");
  }
  if (manifest.clouds.empty())
    throw InputError(name, "no cloud in this manifest: add a [[cloud]] with preset = 'humilis' or sculpt = '*.obj'");
  return manifest;
}

}  // namespace cloudbake
