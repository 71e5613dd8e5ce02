// A rule keeps the line and column of its first character, so that errors inside it point into the file. If the escapes of a "basic" string
// make the column uncertain, it is left out.
#include "lsystem/recipe.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/text/scan.h"
#include "core/text/toml.h"

namespace cloudbake {

/// A table, the lines of its file for the places of texts, and what is read from it.
struct RecipeReading {
  TomlReader& table;
  const std::vector<std::string>& file_lines;
  CloudRecipe& recipe;
};

namespace {

constexpr size_t kMaxBytes = 2U << 20U;

void checkSize(const std::string& text, const std::string& name) {
  if (text.size() > kMaxBytes) throw InputError(name, "the file is larger than 2 MiB: this is not a recipe");
}

std::vector<std::string> splitLines(const std::string& text) {
  std::vector<std::string> lines;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    if (!lines.back().empty() && lines.back().back() == '\r') lines.back().pop_back();
    begin = end + 1;
  }
  return lines;
}

// --- Texts with their place in the file ---

// The lines of a string value, each with its place in the file. `file_lines` are the lines of that file.
std::vector<SourceLine> linesOf(const std::vector<std::string>& file_lines, const toml::node& node) {
  const auto begin = node.source().begin, end = node.source().end;
  std::vector<SourceLine> result;
  for (std::string& text : splitLines(*node.value<std::string>())) result.push_back({std::move(text), int(begin.line), 0});

  // Escapes shift characters: then only the line of the string is certain.
  const auto raw_line = [&](size_t line) {
    return line >= 1 && line <= file_lines.size() ? std::string_view(file_lines[line - 1]) : std::string_view();
  };
  const size_t skipped = std::min<size_t>(begin.column - 1, raw_line(begin.line).size());
  const std::string_view opening = raw_line(begin.line).substr(skipped);
  if (!opening.starts_with('\''))
    for (size_t line = begin.line; line <= end.line; ++line) {
      std::string_view piece = raw_line(line);
      if (line == end.line) piece = piece.substr(0, end.column);
      if (line == begin.line) piece.remove_prefix(std::min(skipped, piece.size()));
      if (piece.find('\\') != std::string_view::npos) return result;
    }

  const bool is_long = opening.starts_with("'''") || opening.starts_with("\"\"\"");
  const bool starts_below = is_long && opening.size() == 3;
  for (size_t k = 0; k < result.size(); ++k) {
    result[k].line = int(begin.line + k + (starts_below ? 1 : 0));
    result[k].column = k == 0 && !starts_below ? int(begin.column) + (is_long ? 3 : 1) : 1;
  }
  return result;
}

void readPremise(const RecipeKey& key, RecipeReading& reading) {
  const toml::node* node = reading.table.find(key.name);
  if (!node) return;
  const auto lines = node->is_string() ? linesOf(reading.file_lines, *node) : std::vector<SourceLine>{};
  if (lines.size() != 1) reading.table.refuse(key.name, *node, "one line of text in single quotes: 'FFFA'");
  reading.recipe.grammar.premise = lines[0];
}

void readRules(TomlReader& table, const std::vector<std::string>& file_lines, std::vector<SourceLine>& target) {
  const toml::node* node = table.find("rules");
  if (!node) return;
  const auto add = [&](const toml::node& text) {
    if (!text.is_string()) table.refuse("rules", text, "texts in single quotes: ['A=FA', …] or '''…''' with one rule per line");
    for (SourceLine& line : linesOf(file_lines, text)) target.push_back(std::move(line));
  };
  if (const toml::array* array = node->as_array())
    std::for_each(array->begin(), array->end(), add);
  else
    add(*node);
}

void readContextIgnore(const RecipeKey& key, RecipeReading& reading) {
  const toml::node* node = reading.table.find(key.name);
  if (!node) return;
  if (!node->is_string()) reading.table.refuse(key.name, *node, "a text in single quotes");
  reading.recipe.grammar.context_ignore = *node->value<std::string>();
}

// --- Tables ---

void readInnerShape(TomlReader& table, std::vector<Sphere>& target) {
  const toml::node* node = table.find("inner_shape");
  if (!node) return;
  const auto refuse = [&](const toml::node& place) {
    table.refuse("inner_shape", place, "a list of spheres: [[x, y, z, radius], …], radius above 0");
  };
  if (!node->is_array()) refuse(*node);
  for (const toml::node& element : *node->as_array()) {
    const auto v = finiteNumbers(element, 4, refuse);
    const Sphere sphere{{float(v[0]), float(v[1]), float(v[2])}, float(v[3])};
    if (!isFinite(sphere.center) || !(sphere.radius > 0) || !std::isfinite(sphere.radius)) refuse(element);
    target.push_back(sphere);
  }
}

void readDomain(const RecipeKey& key, RecipeReading& reading) {
  std::optional<Double3>& target = reading.recipe.spheres.domain;
  if (reading.table.isNone(key.name)) return target.reset();
  constexpr const char* kWanted = "three lengths, [width, height, depth], where 0 means that the length follows from the others";
  const auto v = reading.table.numbers(key.name, 3, kWanted);
  if (!v) return;
  target = Double3{(*v)[0], (*v)[1], (*v)[2]};
  if (!(target->x >= 0 && target->y >= 0 && target->z >= 0 && target->x + target->y + target->z > 0))
    reading.table.refuse(key.name, *reading.table.find(key.name), kWanted);
}

// --- Keys of one value ---

// Reads a key that is there.
void readValue(const RecipeKey& key, TomlReader& table, double& value) {
  if (key.form.low == kAboveZero)
    table.readPositive(key.name, value);
  else
    table.read(key.name, key.form.low, key.form.high, value);
}
void readValue(const RecipeKey& key, TomlReader& table, bool& value) { table.read(key.name, value); }
void readValue(const RecipeKey& key, TomlReader& table, Double3& value) {
  if (const auto v = table.numbers(key.name, 3, "three numbers: [x, y, z]")) value = {(*v)[0], (*v)[1], (*v)[2]};
}
void readValue(const RecipeKey& key, TomlReader& table, Emit& value) {
  const toml::node* node = table.find(key.name);
  const ValueForm::Word* word = findWord(key.form, node->value_or(std::string_view()));
  if (!word) table.refuse(key.name, *node, "one of " + wordList(key.form));
  value = Emit(word->value);
}
template <std::integral Integer>
void readValue(const RecipeKey& key, TomlReader& table, Integer& value) {
  table.read(key.name, limitAs<int64_t>(key.form.low), limitAs<int64_t>(key.form.high), value);
}

// Sets the field that the members lead to. The word none unsets a field that may be unset.
template <auto... Members>
void readField(const RecipeKey& key, RecipeReading& reading) {
  auto& field = fieldOf<Members...>(reading.recipe);
  using Field = std::remove_reference_t<decltype(field)>;
  if (!reading.table.find(key.name)) return;
  WithoutOptional<Field> value{};
  if constexpr (!std::is_same_v<Field, WithoutOptional<Field>>) {
    const toml::node& node = *reading.table.find(key.name);
    if (findWord(key.form, "none") && reading.table.isNone(key.name)) return field.reset();
    if (findWord(key.form, "none") && !node.is_number()) reading.table.refuse(key.name, node, "a number, or 'none'");
  }
  readValue(key, reading.table, value);
  field = value;
}

using R = CloudRecipe;
constexpr auto kTurtle = &R::turtle;
constexpr auto kSpheres = &R::spheres;
constexpr auto kDerive = &R::derive;
using T = TurtleSettings;
using S = SphereSettings;
using D = DeriveSettings;

constexpr ValueForm kFlag{.kind = ValueForm::kFlag}, kNumber{.kind = ValueForm::kNumber};
constexpr ValueForm textLike(const char* examples) { return {.examples = examples}; }
constexpr ValueForm threeLike(const char* examples) { return {.shape = "X,X,X", .examples = examples}; }
constexpr ValueForm numberFrom(double low, double high = INFINITY) { return {.kind = ValueForm::kNumber, .low = low, .high = high}; }
constexpr ValueForm wholeFrom(double low, double high) { return {.kind = ValueForm::kWhole, .low = low, .high = high}; }
constexpr ValueForm orNone(ValueForm form) {
  form.words = {{{"none"}}};
  return form;
}
constexpr ValueForm kPositive = numberFrom(kAboveZero), kNumberOrNone = orNone(kNumber);
constexpr ValueForm kEmit{.kind = ValueForm::kChoice,
                          .words = {{{"points", int(Emit::kPoints)}, {"leaves", int(Emit::kLeaves)}, {"both", int(Emit::kBoth)}}}};
constexpr ValueForm kDomain{.words = {{{"none"}}}, .shape = "XxXxX", .examples = "4x2x4 none"};

const RecipeKey kKeys[] = {
    {"", "premise", readPremise, textLike("F FF"), "TEXT", "symbols that the rules start from"},
    {"", "generations", readField<kDerive, &D::generations>, numberFrom(0), "G",
     "passes of the rules; a fraction grows the last pass in part", true},
    {"", "seed", readField<kDerive, &D::seed>, wholeFrom(0, double(INT64_MAX)), "", "random seed of the shape"},
    {"", "context_ignore", readContextIgnore, textLike("+- F"), "SYMBOLS", "symbols that are skipped when contexts are matched"},
    {"", "context_includes_siblings", readField<kDerive, &D::context_includes_siblings>, kFlag, "BOOL",
     "contexts include sibling branches"},
    {"limits", "max_modules", readField<kDerive, &D::max_modules>, wholeFrom(1, 200'000'000), "N", "limit of the number of symbols"},
    {"limits", "max_passes", readField<kDerive, &D::max_passes>, wholeFrom(0, 1'000'000), "N", "limit of the generations"},
    {"limits", "max_steps", readField<kDerive, &D::max_steps>, wholeFrom(1, 1'000'000'000'000), "N",
     "limit of the work of all generations"},
    {"limits", "max_depth", readField<kTurtle, &T::max_depth>, wholeFrom(0, 1'000'000), "N", "limit of open brackets"},
    {"limits", "max_points", readField<kTurtle, &T::max_points>, wholeFrom(1, 100'000'000), "N", "limit of the turtle's points"},
    {"limits", "max_spheres", readField<kSpheres, &S::max_spheres>, wholeFrom(1, 100'000'000), "N", "limit of the spheres"},
    {"turtle", "step", readField<kTurtle, &T::step>, kNumber, "D", "length of an F, world units"},
    {"turtle", "step_scale", readField<kTurtle, &T::step_scale>, kNumber, "X", "factor of \" on the step"},
    {"turtle", "angle", readField<kTurtle, &T::angle>, kNumber, "DEG", "angle of a turn"},
    {"turtle", "angle_scale", readField<kTurtle, &T::angle_scale>, kNumber, "X", "factor of ; on the angle"},
    {"turtle", "thickness", readField<kTurtle, &T::thickness>, kPositive, "W", "width at the start, world units"},
    {"turtle", "thickness_scale", readField<kTurtle, &T::thickness_scale>, kNumber, "X", "factor of ! on the width"},
    {"turtle", "gravity", readField<kTurtle, &T::gravity>, kNumber, "DEG", "how far T bends a horizontal heading"},
    {"turtle", "random_scale", readField<kTurtle, &T::random_scale>, numberFrom(0, 1), "X",
     "random variation of lengths, as a fraction, 0 to 1"},
    {"turtle", "random_scale_all", readField<kTurtle, &T::random_scale_all>, kFlag, "BOOL", "also vary angles and widths"},
    {"turtle", "segments", readField<kTurtle, &T::segments>, wholeFrom(1, 10000), "N", "points per F"},
    {"turtle", "continuous_length", readField<kTurtle, &T::continuous_length>, kFlag, "BOOL",
     "lengths of the newest symbols grow with the fraction of the generation"},
    {"turtle", "continuous_angles", readField<kTurtle, &T::continuous_angles>, kFlag, "BOOL", "the same for their angles"},
    {"turtle", "continuous_width", readField<kTurtle, &T::continuous_width>, kFlag, "BOOL", "the same for their widths and radii"},
    {"turtle", "pitch_up", readField<kTurtle, &T::pitch_up>, kFlag, "BOOL", "& pitches up and ^ down"},
    {"turtle", "uv_increment", readField<kTurtle, &T::uv_increment>, kNumber, "X", "step of ' and #"},
    {"turtle", "vertical_increment", readField<kTurtle, &T::vertical_increment>, kNumber, "X",
     "growth per segment of the attribute lage, as in Houdini"},
    {"turtle", "start_position", readField<kTurtle, &T::start_position>, threeLike("1,2,3 3,2,1"), "X,Y,Z",
     "where the turtle starts, world units"},
    {"turtle", "start_rotation", readField<kTurtle, &T::start_rotation>, threeLike("10,20,30 30,20,10"), "X,Y,Z",
     "degrees about X, then Y, then Z"},
    {"spheres", "emit", readField<kSpheres, &S::emit>, kEmit, "WHAT", "what becomes a sphere: points, leaves, both"},
    {"spheres", "size", readField<kSpheres, &S::size>, kPositive, "R", "radius of a sphere at the starting width, world units"},
    {"spheres", "leaf_size", readField<kSpheres, &S::leaf_size>, kPositive, "R", "radius of a leaf of scale 1, world units"},
    {"spheres", "width_power", readField<kSpheres, &S::width_power>, kNumber, "X", "radius x (width / thickness)^X"},
    {"spheres", "generation_power", readField<kSpheres, &S::generation_power>, kNumber, "X", "radius x (2 / (generation + 2))^X"},
    {"spheres", "radius_min", readField<kSpheres, &S::radius_min>, kPositive, "X", "lower end of the random factor on each radius"},
    {"spheres", "radius_max", readField<kSpheres, &S::radius_max>, kPositive, "X", "upper end of the random factor on each radius"},
    {"spheres", "top_falloff", readField<kSpheres, &S::top_falloff>, numberFrom(0, 1), "X",
     "how much smaller spheres get towards the top, 0 to 1"},
    {"spheres", "jitter", readField<kSpheres, &S::jitter>, numberFrom(0), "X",
     "centres are moved at random by up to X radii along each axis"},
    {"spheres", "base", readField<kSpheres, &S::base>, kNumberOrNone, "Y", "height of the condensation level, world units, or none"},
    {"spheres", "squash", readField<kSpheres, &S::squash>, numberFrom(0, 1), "X", "factor on the depth below the base, 0 to 1"},
    {"spheres", "ceiling", readField<kSpheres, &S::ceiling>, kNumberOrNone, "Y",
     "height above which heights are scaled by 0.3, world units, or none"},
    {"spheres", "flat", readField<kSpheres, &S::flat>, kNumberOrNone, "X", "centres stay at least X radii above the base, or none"},
    {"spheres", "count", readField<kSpheres, &S::count>, orNone(wholeFrom(1, 100'000'000)), "N",
     "keep only the N largest spheres, or none"},
    {"spheres", "domain", readDomain, kDomain, "WxHxD", "box that the cloud fills, world units; a side of 0 follows the others; or none"},
    {"spheres", "connect", readField<kSpheres, &S::connect>, kFlag, "BOOL", "join separate parts by moving them together"},
};

// Reads the keys of a table: the top level's if the name is empty.
void readKeys(std::string_view name, RecipeReading reading) {
  for (const RecipeKey& key : kKeys)
    if (name == key.table) key.read(key, reading);
}

// Reads a table whose keys are arbitrary. Calls take(name, value) in the order of the file.
template <class Take>
void readFreeTable(TomlReader& table, const char* key, const Take& take) {
  const toml::node* node = table.find(key);
  if (!node) return;
  if (!node->is_table()) table.refuse(key, *node, "a table: [" + std::string(key) + "]");
  for (const auto& [name, value] : inOrder(*node->as_table())) take(*name, *value);
}

// --- Values of a command line ---

// The TOML value for a text without quotes.
std::unique_ptr<toml::node> nodeOf(const std::string& text) {
  if (text == "true" || text == "false") return std::make_unique<toml::value<bool>>(text == "true");
  if (const auto integer = parseInteger(text)) return std::make_unique<toml::value<int64_t>>(*integer);
  if (const auto number = parseNumber(text)) return std::make_unique<toml::value<double>>(*number);
  auto list = std::make_unique<toml::array>();
  for (size_t begin = 0; begin <= text.size();) {
    const size_t stop = std::min(text.find_first_of(",x", begin), text.size());
    const auto number = parseNumber(std::string_view(text).substr(begin, stop - begin));
    if (!number) return std::make_unique<toml::value<std::string>>(text);
    list->push_back(*number);
    begin = stop + 1;
  }
  return list;
}

// NAME=NUMBER, or several joined by commas.
void declareVariables(CloudRecipe& recipe, const std::string& value) {
  for (size_t begin = 0; begin <= value.size();) {
    const size_t end = std::min(value.find(',', begin), value.size());
    const std::string one = value.substr(begin, end - begin);
    const size_t at = one.find('=');
    const auto number = at == std::string::npos ? std::nullopt : parseNumber(std::string_view(one).substr(at + 1));
    if (!number || !std::isfinite(*number) || at == 0)
      throw InputError("", quotedWord(one) + ": write a variable as NAME=NUMBER, with a finite number");
    recipe.grammar.variables.emplace_back(one.substr(0, at), *number);
    begin = end + 1;
  }
}

}  // namespace

std::span<const RecipeKey> recipeKeys() { return kKeys; }

void setRecipeKey(CloudRecipe& recipe, const std::string& key, const std::string& value) {
  if (key == "variable") return declareVariables(recipe, value);
  const bool is_text = key == "premise" || key == "context_ignore";
  toml::table one;
  if (is_text)
    one.insert(key, value);
  else
    one.insert(key, std::move(*nodeOf(value)));
  TomlReader table(&one, "", "");
  for (const char* name : {"", "turtle", "spheres", "limits"}) readKeys(name, {table, {}, recipe});
  table.finish();
}

CloudRecipe parseRecipe(const std::string& text, const std::string& name) {
  checkSize(text, name);
  const toml::table document = parseTomlTable(text, name);
  TomlReader table(&document, "", name);
  CloudRecipe recipe;
  recipe.grammar.file = name;
  const std::vector<std::string> lines = splitLines(text);
  readKeys("", {table, lines, recipe});
  readRules(table, lines, recipe.grammar.rules);
  readInnerShape(table, recipe.derive.inner_shape);
  readFreeTable(table, "variables", [&](const toml::key& key, const toml::node& value) {
    const auto number = value.is_number() ? value.value<double>() : std::nullopt;
    if (!number || !std::isfinite(*number)) table.refuse("a variable", value, "a number");
    recipe.grammar.variables.emplace_back(std::string(key.str()), *number);
  });
  TomlReader turtle = table.table("turtle"), spheres = table.table("spheres"), limits = table.table("limits");
  readKeys("turtle", {turtle, lines, recipe});
  readKeys("spheres", {spheres, lines, recipe});
  readKeys("limits", {limits, lines, recipe});
  readFreeTable(table, "bake", [&](const toml::key& key, const toml::node& value) {
    recipe.bake_options.push_back({std::string(key.str()), optionText(value, name), int(key.source().begin.line)});
  });
  readFreeTable(table, "sequence", [&](const toml::key& key, const toml::node& value) {
    recipe.sequence_options.push_back({std::string(key.str()), optionText(value, name), int(key.source().begin.line)});
  });
  for (const TomlReader* each : {&table, &turtle, &spheres, &limits}) each->finish();
  if (recipe.grammar.premise.text.empty()) throw InputError(name, "no premise: add a line such as premise = 'FFFA'");
  return recipe;
}

CloudRecipe parseRules(const std::string& text, const std::string& name) {
  checkSize(text, name);
  CloudRecipe recipe;
  recipe.grammar.file = name;
  const std::vector<std::string> lines = splitLines(text);
  bool has_ignore = false;
  for (size_t k = 0; k < lines.size(); ++k) {
    const std::string& line = lines[k];
    const size_t first = std::min(line.find_first_not_of(" \t"), line.size());
    const auto header = [&](std::string_view label, bool repeated) {
      if (!std::string_view(line).substr(first).starts_with(label)) return false;
      if (repeated)
        throw InputError(recipe.grammar.file, int(k) + 1, int(first) + 1, "\"" + std::string(label) + "\" appears twice: keep one");
      return true;
    };
    if (header("premise:", recipe.grammar.premise.line > 0)) {
      const size_t begin = first + std::strlen("premise:");
      recipe.grammar.premise = {line.substr(begin), int(k) + 1, int(begin) + 1};
    } else if (header("context_ignore:", has_ignore)) {
      recipe.grammar.context_ignore = line.substr(first + std::strlen("context_ignore:"));
      has_ignore = true;
    } else {
      recipe.grammar.rules.push_back({line, int(k) + 1, 1});
    }
  }
  return recipe;
}

std::vector<Sphere> growSpheres(const CloudRecipe& recipe, uint64_t seed, Warnings& warnings, GrowthSummary* summary) {
  DeriveSettings derivation = recipe.derive;
  derivation.seed = seed;
  if (recipe.grammar.premise.text.empty())
    throw InputError(recipe.grammar.file, "no premise: add a line such as premise: FFFA, or give --premise FFFA");
  const Grammar grammar = parseGrammar(recipe.grammar, warnings);
  const ModuleString string = derive(grammar, derivation, recipe.turtle, warnings, summary == nullptr ? nullptr : &summary->generations);
  if (summary != nullptr) summary->expansion = printModules(string, true, 4000);
  std::vector<Sphere> spheres = spheresFromPath(runTurtle(string, recipe.turtle, warnings), recipe.spheres, warnings, summary);
  if (summary != nullptr)
    for (const Sphere& sphere : spheres) summary->radii.push_back(sphere.radius);
  return spheres;
}

}  // namespace cloudbake
