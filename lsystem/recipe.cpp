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

namespace {

constexpr size_t kMaxBytes = 2U << 20U;

void checkSize(const std::string& text, const std::string& name) {
  if (text.size() > kMaxBytes) throw InputError(name, "the file is larger than 2 MiB, the limit of a recipe");
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

void readPremise(TomlReader& table, const std::vector<std::string>& file_lines, SourceLine& target) {
  const toml::node* node = table.find("premise");
  if (!node) return;
  const auto lines = node->is_string() ? linesOf(file_lines, *node) : std::vector<SourceLine>{};
  if (lines.size() != 1) table.refuse("premise", *node, "one line of text in single quotes: 'FFFA'");
  target = lines[0];
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

void readContextIgnore(TomlReader& table, std::string& target) {
  const toml::node* node = table.find("context_ignore");
  if (!node) return;
  if (!node->is_string()) table.refuse("context_ignore", *node, "a text in single quotes");
  target = *node->value<std::string>();
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

void readVector(TomlReader& table, const char* key, Double3& target) {
  if (const auto v = table.numbers(key, 3, "three numbers: [x, y, z]")) target = {(*v)[0], (*v)[1], (*v)[2]};
}

void readDomain(TomlReader& table, std::optional<Double3>& target) {
  if (table.isNone("domain")) return target.reset();
  constexpr const char* kWanted = "three lengths, [width, height, depth], where 0 means that the length follows from the others";
  const auto v = table.numbers("domain", 3, kWanted);
  if (!v) return;
  target = Double3{(*v)[0], (*v)[1], (*v)[2]};
  if (!(target->x >= 0 && target->y >= 0 && target->z >= 0 && target->x + target->y + target->z > 0))
    table.refuse("domain", *table.find("domain"), kWanted);
}

// Reads a value that may be missing by `read(value)`.
template <class Value, class Read>
void readIfThere(TomlReader& table, const char* key, std::optional<Value>& target, const Read& read) {
  if (!table.find(key)) return;
  Value value{};
  read(value);
  target = value;
}

void readTurtle(TomlReader& table, TurtleSettings& t) {
  constexpr double kAny = INFINITY;
  for (const auto& [key, target] : {std::pair<const char*, double*>{"step", &t.step},
                                    {"step_scale", &t.step_scale},
                                    {"angle", &t.angle},
                                    {"angle_scale", &t.angle_scale},
                                    {"thickness_scale", &t.thickness_scale},
                                    {"gravity", &t.gravity},
                                    {"uv_increment", &t.uv_increment},
                                    {"vertical_increment", &t.vertical_increment}})
    table.read(key, -kAny, kAny, *target);
  table.readPositive("thickness", t.thickness);
  table.read("random_scale", 0, 1, t.random_scale);
  table.read("segments", 1, 10000, t.segments);
  for (const auto& [key, target] : {std::pair<const char*, bool*>{"random_scale_all", &t.random_scale_all},
                                    {"continuous_length", &t.continuous_length},
                                    {"continuous_angles", &t.continuous_angles},
                                    {"continuous_width", &t.continuous_width},
                                    {"pitch_up", &t.pitch_up}})
    table.read(key, *target);
  readVector(table, "start_position", t.start_position);
  readVector(table, "start_rotation", t.start_rotation);
}

void readSpheres(TomlReader& table, SphereSettings& s) {
  table.read("emit", {{"points", Emit::kPoints}, {"leaves", Emit::kLeaves}, {"both", Emit::kBoth}}, s.emit);
  readIfThere(table, "size", s.size, [&](double& size) { table.readPositive("size", size); });
  table.readPositive("leaf_size", s.leaf_size);
  table.read("width_power", -INFINITY, INFINITY, s.width_power);
  table.read("generation_power", -INFINITY, INFINITY, s.generation_power);
  table.readPositive("radius_min", s.radius_min);
  table.readPositive("radius_max", s.radius_max);
  table.read("top_falloff", 0, 1, s.top_falloff);
  table.read("jitter", 0, INFINITY, s.jitter);
  table.readOrNone("base", s.base);
  table.read("squash", 0, 1, s.squash);
  table.readOrNone("ceiling", s.ceiling);
  table.readOrNone("flat", s.flat);
  if (table.isNone("count"))
    s.count.reset();
  else
    readIfThere(table, "count", s.count, [&](uint64_t& count) { table.read("count", 1, 100'000'000, count); });
  readDomain(table, s.domain);
  readIfThere(table, "connect", s.connect, [&](bool& connect) { table.read("connect", connect); });
}

void readTop(TomlReader& table, const std::vector<std::string>& file_lines, CloudRecipe& recipe) {
  readPremise(table, file_lines, recipe.grammar.premise);
  readRules(table, file_lines, recipe.grammar.rules);
  readContextIgnore(table, recipe.grammar.context_ignore);
  table.read("generations", 0, INFINITY, recipe.derive.generations);
  table.read("seed", 0, INT64_MAX, recipe.derive.seed);
  table.read("context_includes_siblings", recipe.derive.context_includes_siblings);
  readInnerShape(table, recipe.derive.inner_shape);
}

void readLimits(TomlReader& table, CloudRecipe& recipe) {
  table.read("max_modules", 1, 200'000'000, recipe.derive.max_modules);
  table.read("max_passes", 0, 1'000'000, recipe.derive.max_passes);
  readIfThere(table, "max_steps", recipe.derive.max_steps, [&](uint64_t& steps) { table.read("max_steps", 1, 1'000'000'000'000, steps); });
  table.read("max_depth", 0, 1'000'000, recipe.turtle.max_depth);
  table.read("max_points", 1, 100'000'000, recipe.turtle.max_points);
  table.read("max_spheres", 1, 100'000'000, recipe.spheres.max_spheres);
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

void setRecipeKey(CloudRecipe& recipe, const std::string& key, const std::string& value) {
  if (key == "variable") return declareVariables(recipe, value);
  const bool is_text = key == "premise" || key == "context_ignore";
  toml::table one;
  if (is_text)
    one.insert(key, value);
  else
    one.insert(key, std::move(*nodeOf(value)));
  TomlReader table(&one, "", "");
  readTop(table, {}, recipe);
  readTurtle(table, recipe.turtle);
  readSpheres(table, recipe.spheres);
  readLimits(table, recipe);
  table.finish();
}

CloudRecipe parseRecipe(const std::string& text, const std::string& name) {
  checkSize(text, name);
  const toml::table document = parseTomlTable(text, name);
  TomlReader table(&document, "", name);
  CloudRecipe recipe;
  recipe.grammar.file = name;
  readTop(table, splitLines(text), recipe);
  readFreeTable(table, "variables", [&](const toml::key& key, const toml::node& value) {
    const auto number = value.is_number() ? value.value<double>() : std::nullopt;
    if (!number || !std::isfinite(*number)) table.refuse("a variable", value, "a number");
    recipe.grammar.variables.emplace_back(std::string(key.str()), *number);
  });
  TomlReader turtle = table.table("turtle"), spheres = table.table("spheres"), limits = table.table("limits");
  readTurtle(turtle, recipe.turtle);
  readSpheres(spheres, recipe.spheres);
  readLimits(limits, recipe);
  readFreeTable(table, "bake", [&](const toml::key& key, const toml::node& value) {
    recipe.bake_options.push_back({std::string(key.str()), optionText(value, name), int(key.source().begin.line)});
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
