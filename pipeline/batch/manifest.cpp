// Keys are read in the order of the file, so that the first fault is reported.
#include "pipeline/batch/manifest.h"

#include <algorithm>
#include <charconv>
#include <limits>

#include "core/error.h"
#include "core/text/numbers.h"
#include "core/text/scan.h"
#include "core/text/toml.h"
#include "io/file/write_file.h"
#include "pipeline/scene/scene_file.h"

namespace cloudbake {

namespace {

constexpr size_t kMaxSeeds = 1'000'000;

ManifestValue valueAt(const toml::key& key, const toml::node& node, std::string value) {
  const auto place = node.source().begin;
  return {std::string(key.str()), std::move(value), int(place.line), int(place.column)};
}

ManifestValue textAt(const toml::key& key, const toml::node& node, const std::string& file) {
  const auto text = node.value<std::string>();
  if (!node.is_string() || text->empty())
    refuseToml(file, node.source(), "'" + std::string(key.str()) + "' must be a non-empty string in quotes");
  return valueAt(key, node, *text);
}

// One string, or a list of strings.
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

// [1, 2, 5], or 'LOW-HIGH' including both ends.
std::vector<uint64_t> seedsAt(const toml::node& node, const std::string& file) {
  const auto refuse = [&](const toml::node& at, const std::string& what) {
    refuseToml(file, at.source(), "'seeds' " + what + ": give a list of whole numbers, [1, 2, 3], or a range in quotes, '1-40'");
  };
  std::vector<uint64_t> seeds;
  if (const toml::array* list = node.as_array()) {
    for (const toml::node& element : *list) {
      const auto seed = element.is_integer() ? element.value<int64_t>() : std::nullopt;
      if (!seed || *seed < 0) refuse(element, "has a value that is no whole number from 0 on");
      seeds.push_back(uint64_t(*seed));
    }
    if (seeds.empty()) refuse(node, "is an empty list");
    return seeds;
  }
  if (!node.is_string()) refuse(node, "is neither a list nor a text");
  const std::string text = *node.value<std::string>();
  const size_t dash = text.find('-');
  const auto low = seedOf(std::string_view(text).substr(0, dash));
  const auto high = dash == std::string::npos ? std::nullopt : seedOf(std::string_view(text).substr(dash + 1));
  if (!low || !high || *low > *high) refuse(node, "is " + quotedWord(text) + ", which is no range");
  if (*high - *low >= kMaxSeeds) refuse(node, "is " + quotedWord(text) + ", more than " + std::to_string(kMaxSeeds) + " seeds");
  for (uint64_t seed = *low; seeds.size() <= *high - *low; ++seed) seeds.push_back(seed);
  return seeds;
}

std::optional<SourceKind> sourceKind(std::string_view key) {
  if (key == "preset") return SourceKind::kPreset;
  if (key == "recipe") return SourceKind::kRecipe;
  if (key == "rules") return SourceKind::kRules;
  if (key == "from_spheres") return SourceKind::kSpheres;
  if (key == "sculpt") return SourceKind::kSculpt;
  return std::nullopt;
}

ManifestCloud readCloud(const toml::table& table, const std::string& file) {
  constexpr const char* kSources = "preset, recipe, rules, from_spheres, sculpt or sequence";
  ManifestCloud cloud;
  cloud.line = int(table.source().begin.line);
  cloud.column = int(table.source().begin.column);
  for (const auto& [key, node] : inOrder(table)) {
    const bool is_sequence = key->str() == "sequence";
    if (const auto kind = sourceKind(key->str()); kind || is_sequence) {
      if (!cloud.sources.empty()) refuseToml(file, key->source(), std::string("a cloud has only one source: give one of ") + kSources);
      cloud.kind = kind.value_or(SourceKind::kSculpt);
      cloud.is_sequence = is_sequence;
      cloud.sources = kind == SourceKind::kSculpt ? textsAt(*key, *node, file) : std::vector{textAt(*key, *node, file)};
    } else if (key->str() == "seeds") {
      cloud.seeds = seedsAt(*node, file);
    } else if (key->str() == "name") {
      cloud.name = textAt(*key, *node, file);
    } else {
      cloud.options.push_back(valueAt(*key, *node, optionText(*node, file)));
    }
  }
  if (cloud.sources.empty()) refuseToml(file, table.source(), std::string("this cloud has no source: add ") + kSources);
  if (const toml::node* seeds = table.get("seeds")) {
    if (!cloud.is_sequence && (cloud.kind == SourceKind::kSculpt || cloud.kind == SourceKind::kSpheres))
      refuseToml(file, seeds->source(), "'seeds' are for clouds that grow from rules: remove it, or set seed");
    if (table.contains("seed")) refuseToml(file, table.get("seed")->source(), "'seed' and 'seeds' are both given: give one of the two");
  }
  return cloud;
}

SceneNeeds sceneOf(const toml::table& table, const std::filesystem::path& file) {
  TomlReader reader(&table, "[scene]", file.string());
  return readSceneNeeds(reader, file.parent_path());
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
      manifest.scene = sceneOf(asTable(*node, word, name), file);
    else if (word == "cloud")
      manifest.clouds = readClouds(*node, name);
    else if (word == "defaults")
      for (const auto& [option, value] : inOrder(asTable(*node, word, name)))
        manifest.defaults.push_back(valueAt(*option, *value, optionText(*value, name)));
    else
      refuseToml(name, key->source(), "unknown key '" + word + "' in a manifest: the keys are name, [defaults], [scene] and [[cloud]]");
  }
  if (manifest.clouds.empty())
    throw InputError(name, "no cloud in this manifest: add a [[cloud]] with preset = 'humilis' or sculpt = '*.obj'");
  return manifest;
}

}  // namespace cloudbake
