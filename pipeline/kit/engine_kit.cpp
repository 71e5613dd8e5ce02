#include "pipeline/kit/engine_kit.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "core/error.h"
#include "core/text/json.h"
#include "core/text/maker.h"
#include "core/text/markup.h"
#include "core/text/numbers.h"
#include "pipeline/kit/gdshader.h"
#include "pipeline/kit/hlsl.h"
#include "pipeline/kit/kit_files.h"
#include "shaders/shader_files.h"

namespace cloudbake {

namespace {

// Describes the engine for readers and tests (scripts/engine_tables), and is no file of the kit.
constexpr std::string_view kDescription = "engine.json";

// The engine of a file; empty for one that lies beside the folders of the engines, because several of them include it.
std::string_view engineOf(const KitFile& file) {
  const std::string_view name = file.name;
  const size_t slash = name.find('/');
  return slash == std::string_view::npos ? "" : name.substr(0, slash);
}

// The name of a file in the folder of its engine.
std::string nameIn(const KitFile& file) { return std::string(file.name).substr(engineOf(file).size() + 1); }

// The rows of an engine's description; none of an unknown engine.
Json descriptionOf(std::string_view engine) {
  for (const KitFile& file : kitFiles())
    if (engineOf(file) == engine && nameIn(file) == kDescription) return parseJson(file.text).value();
  return Json::array();
}

// A number that every shading language reads as a float.
std::string floatText(const char* name, float value) {
  if (!std::isfinite(value))
    throw InputError("", fmt::format("the {} of the asset is {}, which no shader can have; bake it again", name, value));
  std::string text = shortestText(value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

// The text of a file that templates may include; empty if there is none. A file of GLSL is also one of HLSL.
std::string sharedText(std::string_view name) {
  for (const KitFile& file : kitFiles())
    if (engineOf(file).empty() && name == file.name) return file.text;
  for (const ShaderFile& file : shaderFiles()) {
    if (name == std::string(file.name) + ".glsl") return file.text;
    if (name == std::string(file.name) + ".hlsl") return hlslOf(file.text);
  }
  return {};
}

// The name in a line `#include "NAME"`, else nothing.
std::string_view includedBy(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  constexpr std::string_view kBefore = "#include \"";
  if (!line.starts_with(kBefore) || !line.ends_with('"')) return {};
  return line.substr(kBefore.size(), line.size() - kBefore.size() - 1);
}

// What a line `#structure NAME FILE…` becomes: those files of GLSL as a structure of HLSL. Empty of another line.
std::string structureOf(std::string_view line) {
  constexpr std::string_view kBefore = "#structure ";
  if (!line.starts_with(kBefore)) return {};
  std::istringstream words{std::string(line.substr(kBefore.size()))};
  std::string name, glsl;
  words >> name;
  for (std::string file; words >> file;) glsl += sharedText(file + ".glsl");
  return hlslStructure(name, sharedText("glsl.hlsl"), glsl);
}

std::string withIncludes(std::string_view text) {
  std::string out;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    std::string_view line = text.substr(begin, end - begin);
    const std::string_view words = line.substr(0, line.find('\n'));
    const std::string included = sharedText(includedBy(words)), structure = structureOf(words);
    out += !structure.empty() ? structure : included.empty() ? std::string(line) : withIncludes(included);
    begin = end;
  }
  return out;
}

// What the marks of templates become. A scene may have an extinction of its own.
std::map<std::string, std::string> constantsOf(const AssetInfo& info, const SceneFile& scene) {
  std::map<std::string, std::string> constants = sceneConstants(scene);
  constants["@exponent@"] = floatText("exponent", info.shape.exponent);
  constants["@bias@"] = floatText("bias", info.shape.bias);
  constants["@extinction@"] = floatText("extinction", scene.light.extinction.value_or(info.extinction));
  constants["@density_max@"] = floatText("density_max", info.density_max);
  constants["@first_set@"] = std::to_string(info.first_uv_set);
  constants["@second_set@"] = std::to_string(info.first_uv_set + 1);
  constants["@version@"] = CLOUDBAKE_VERSION;
  return constants;
}

// Shaders of Godot are templates of GLSL.
std::string inOwnLanguage(std::string_view name, std::string text) {
  return name.starts_with("godot") && name.ends_with("shader") ? gdshaderOf(text) : std::move(text);
}

// Ends a file with a comment that says who made it, unless it says so already.
std::string withMaker(const std::string& name, std::string text) {
  if (namesMaker(text)) return text;
  const std::string ending = std::filesystem::path(name).extension().string();
  const bool is_page = ending == ".md";
  const char* const comment = is_page                                   ? "<!-- "
                              : ending == ".gd" || ending == ".py"      ? "# "
                              : ending == ".tscn" || ending == ".godot" ? "; "
                                                                        : "// ";
  return text + comment + "Made by " + std::string(kMaker) + (is_page ? " -->\n" : ".\n");
}

}  // namespace

std::vector<std::string> engineNames() {
  std::vector<std::string> names;
  for (const KitFile& file : kitFiles())
    if (const auto engine = engineOf(file); !engine.empty() && (names.empty() || names.back() != engine)) names.emplace_back(engine);
  return names;
}

std::string engineTitle(std::string_view engine) {
  std::vector<std::string> titles;
  for (const Json& row : descriptionOf(engine)) titles.push_back(row.at("title"));
  return fmt::format("{}", fmt::join(titles, ", "));
}

bool playsSequences(std::string_view engine) {
  const Json rows = descriptionOf(engine);
  return std::ranges::any_of(rows, [](const Json& row) { return row.value("sequences", false); });
}

AssetInfo defaultAssetInfo() {
  AssetInfo info;
  info.shape = {3, -0.003F};
  info.extinction = 7;
  return info;
}

std::vector<EngineFile> engineFiles(std::string_view engine, const AssetInfo& info, const SceneFile& scene) {
  const std::map<std::string, std::string> constants = constantsOf(info, scene);
  const std::vector<std::pair<std::string_view, std::string>> marks(constants.begin(), constants.end());
  std::vector<EngineFile> files;
  for (const KitFile& file : kitFiles())
    if (!engine.empty() && engineOf(file) == engine && nameIn(file) != kDescription)
      files.push_back({nameIn(file), withMaker(file.name, inOwnLanguage(file.name, filledTemplate(withIncludes(file.text), marks)))});
  if (files.empty()) throw UsageError(fmt::format("no engine '{}': the engines are {}", engine, fmt::join(engineNames(), ", ")));
  return files;
}

}  // namespace cloudbake
