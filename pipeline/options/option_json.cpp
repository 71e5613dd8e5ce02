// Source: JSON Schema, draft 2020-12 (json-schema.org/draft/2020-12).
#include "pipeline/options/option_json.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "lsystem/recipe.h"
#include "pipeline/options/presets.h"

namespace cloudbake {

namespace {

constexpr const char* kKinds[] = {"text", "flag", "choice", "whole", "number"};
constexpr std::string_view kMore = ",…";

std::string underscored(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

Json wordsOf(const ValueForm& form) {
  Json words = Json::array();
  for (const ValueForm::Word& word : form.words)
    if (word.text) words.push_back(word.text);
  return words;
}

// The words of a choice, and without quotes those that are numbers.
Json choicesOf(const ValueForm& form) {
  Json choices = wordsOf(form);
  for (const Json& word : wordsOf(form))
    if (Json number = Json::parse(word.get<std::string>(), nullptr, false); number.is_number()) choices.push_back(std::move(number));
  return choices;
}

bool takesPercent(const ValueForm& form) { return form.high_percent > 0; }
// Whether the words are parts of the shape, and no values themselves.
bool hasWordsInShape(const ValueForm& form) { return form.shape[0] == 'W'; }

// A limit that is no whole number in int64_t stays as it is.
Json limitJson(const ValueForm& form, double at) {
  return form.kind == ValueForm::kWhole && std::fabs(at) < 0x1p63 ? Json(int64_t(at)) : Json(at);
}

// --- Schemas ---

// A regular expression for what the shape stands for.
std::string patternOf(const ValueForm& form, std::string_view shape) {
  if (shape.ends_with(kMore)) {
    const std::string one = patternOf(form, shape.substr(0, shape.size() - kMore.size()));
    return one + "(," + one + ")*";
  }
  std::string words;
  for (const ValueForm::Word& word : form.words)
    if (word.text) words += (words.empty() ? "" : "|") + std::string(word.text);
  std::string pattern;
  bool is_second = false;  // of LOW:HIGH, which may be one number
  for (const char c : shape) {
    if (c == 'X') pattern += std::string("-?[0-9.]+(e[+-]?[0-9]+)?") + (takesPercent(form) ? "%?" : "");
    if (c == 'N') pattern += "[0-9]+";
    if (c == 'W') pattern += words.empty() ? "\\w+" : "(" + words + ")";
    if (is_second) pattern += ")?";
    is_second = c == ':';
    if (is_second) pattern += "(";
    if (std::string_view("XNW").find(c) == std::string_view::npos) pattern += c;
  }
  return pattern;
}

Json textLike(const std::string& pattern) { return {{"type", "string"}, {"pattern", "^" + pattern + "$"}}; }

Json numberSchema(const ValueForm& form) {
  Json number{{"type", form.kind == ValueForm::kWhole ? "integer" : "number"}};
  if (form.low == kAboveZero)
    number["exclusiveMinimum"] = 0;
  else if (std::isfinite(form.low))
    number["minimum"] = limitJson(form, form.low);
  if (std::isfinite(form.high)) number["maximum"] = limitJson(form, form.high);
  return number;
}

// The values that a file may give. A key of a recipe itself that has several numbers is a list of as many. An option may be in quotes, as
// on the command line, or a list of words or of three numbers.
Json valueSchema(const ValueForm& form, bool is_option) {
  Json all = Json::array();
  switch (form.kind) {
    case ValueForm::kFlag: return {{"type", "boolean"}};
    case ValueForm::kChoice: return {{"enum", choicesOf(form)}};
    case ValueForm::kText:
      if (!*form.shape) return {{"type", "string"}};
      break;
    default:
      all.push_back(numberSchema(form));
      if (is_option) all.push_back(textLike(patternOf(form, form.kind == ValueForm::kWhole ? "N" : "X")));
  }
  if (form.words[0].text && !hasWordsInShape(form)) all.push_back({{"enum", wordsOf(form)}});
  if (const std::string_view shape = form.shape; !shape.empty() && is_option) {
    all.push_back(textLike(patternOf(form, shape)));
    if (hasWordsInShape(form)) {
      const Json item = textLike(patternOf(form, shape.substr(0, shape.size() - kMore.size())));
      all.push_back({{"type", "array"}, {"items", item}, {"minItems", 1}});
    }
  }
  if (const std::string_view shape = form.shape; shape == "X,X,X" || (!shape.empty() && !is_option)) {
    const auto count = std::count(shape.begin(), shape.end(), 'X');
    all.push_back({{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", count}, {"maxItems", count}});
  }
  return all.size() == 1 ? all[0] : Json{{"anyOf", all}};
}

Json described(Json schema, const std::string& text) {
  schema["description"] = text;
  return schema;
}

Json optionSchema(const Option& option) {
  const std::string fallback = defaultOf(option);
  return described(valueSchema(option.value.form, true), option.help + (fallback.empty() ? "" : " [" + fallback + "]"));
}

Json tableOf(Json properties) { return {{"type", "object"}, {"properties", std::move(properties)}, {"additionalProperties", false}}; }

Json fileSchema(const char* name, const Json& table) {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"$id", name}, {"title", name}};
  schema.update(table);
  return schema;
}

const Json kText{{"type", "string"}, {"minLength", 1}};

}  // namespace

Json optionJson(const Option& option, Command command) {
  const ValueForm& form = option.value.form;
  Json json{{"name", option.name},
            {"label", option.label},
            {"unit", option.unit},
            {"fallback", defaultOf(option)},
            {"help", option.help},
            {"group", groupOf(option, command)},
            {"common", (option.common & command) != 0},
            {"choices", optionChoices(option)},
            {"kind", kKinds[form.kind]}};
  if (std::isfinite(form.low)) json["low"] = limitJson(form, form.low);
  if (std::isfinite(form.high)) json["high"] = limitJson(form, form.high);
  json["words"] = wordsOf(form);
  json["percent"] = takesPercent(form);
  json["shape"] = form.shape;
  return json;
}

Json blenderOptions() {
  Json panel = Json::array(), refused = {"output", "quiet", "help", "help_all"};
  for (const Option& option : optionTable()) {
    if (!(option.commands & kBake)) continue;
    if (option.bits & kNotInBlender) refused.push_back(underscored(option.name));
    if (!(option.bits & kInBlendersPanel)) continue;
    Json row = optionJson(option, kBake);
    for (const char* key : {"label", "unit", "group", "common", "choices", "percent"}) row.erase(key);
    row["name"] = underscored(option.name);
    panel.push_back(row);
  }
  return {{"panel", panel}, {"refused", refused}};
}

Json manifestSchema() {
  Json options = Json::object();
  for (const Option& option : optionTable())
    if (findAssetOption(option.name) == &option) options[underscored(option.name)] = optionSchema(option);

  Json cloud = options;
  for (const Option& option : optionTable())
    if (isOfSequence(option)) cloud[underscored(option.name)] = optionSchema(option);
  Json names = Json::array();
  for (const Preset& preset : presets()) names.push_back(preset.name);
  Json sources = Json::array();
  const auto addSource = [&](const char* key, Json schema, const char* text) {
    cloud[key] = described(std::move(schema), text);
    sources.push_back({{"required", {key}}});
  };
  addSource("preset", {{"enum", names}}, "preset to grow");
  addSource("recipe", kText, "recipe (.toml) to grow");
  addSource("rules", kText, "plain list of rules to grow");
  addSource("from_spheres", kText, "points and radii, .ply or .csv");
  addSource("sequence", kText, "a cloud that changes: frames by a pattern, a folder, a preset or a recipe");
  addSource("sculpt", {{"anyOf", {kText, {{"type", "array"}, {"items", kText}, {"minItems", 1}}}}},
            "sculpt or volume: a path, a glob, or a list of them");
  cloud["seeds"] = described(
      {{"anyOf", {{{"type", "array"}, {"items", {{"type", "integer"}, {"minimum", 0}}}, {"minItems", 1}}, textLike("[0-9]+(-[0-9]+)?")}}},
      "a cloud for each: [1, 2, 5] or '1-40'");
  const Json name = described(kText, "names of the outputs; words: {stem}, {ext}, {folder}, {seed}");
  cloud["name"] = name;
  Json one_cloud = tableOf(cloud);
  one_cloud["oneOf"] = sources;

  Json manifest = tableOf({{"name", name},
                           {"defaults", described(tableOf(options), "options for every cloud that they apply to")},
                           {"scene", {{"type", "object"}, {"description", "scene that the clouds are made for"}}},
                           {"cloud", {{"type", "array"}, {"items", one_cloud}, {"minItems", 1}}}});
  manifest["required"] = {"cloud"};
  return fileSchema("cloudbake-manifest", manifest);
}

Json recipeSchema() {
  std::map<std::string_view, Json> tables;
  for (const RecipeKey& key : recipeKeys()) tables[key.table][key.name] = described(valueSchema(key.form, false), key.help);
  Json top = tables[""];
  const Json number{{"type", "number"}};
  top["rules"] = described({{"anyOf", {{{"type", "string"}}, {{"type", "array"}, {"items", {{"type", "string"}}}}}}},
                           "rules, one a line or one a text");
  top["inner_shape"] = described({{"type", "array"}, {"items", {{"type", "array"}, {"items", number}, {"minItems", 4}, {"maxItems", 4}}}},
                                 "spheres, [x, y, z, radius] each");
  top["variables"] = {{"type", "object"}, {"additionalProperties", number}, {"description", "variables of the expressions"}};
  for (const auto& [name, keys] : tables)
    if (!name.empty()) top[std::string(name)] = tableOf(keys);
  Json bake = Json::object(), sequence = Json::object();
  for (const Option& option : optionTable()) {
    if (option.bits & kInRecipe) bake[underscored(option.name)] = optionSchema(option);
    if (isOfSequence(option)) sequence[underscored(option.name)] = optionSchema(option);
  }
  top["bake"] = described(tableOf(bake), "options of `cloudbake grow`");
  top["sequence"] = described(tableOf(sequence), "options of `cloudbake sequence`");
  Json recipe = tableOf(top);
  recipe["required"] = {"premise"};
  return fileSchema("cloudbake-recipe", recipe);
}

}  // namespace cloudbake
