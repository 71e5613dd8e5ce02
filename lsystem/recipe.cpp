// One table of keys per TOML table: name, kind, range, destination. A rule keeps the line and column of its first character, so
// that errors inside it point into the file; where escapes of a "basic" string blur that, the column is left out.
#include "lsystem/recipe.h"

#include <toml++/toml.h>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>

#include "core/text/check_toml.h"
#include "core/error.h"
#include "core/text/numbers.h"

namespace cloudbake {

namespace {

constexpr size_t kMaxFileBytes = 2U << 20U;

std::string readText(const Path& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw IoError(file.string(), std::string("cannot open: ") + std::strerror(errno) + ", check the path");
  std::string text, block(1U << 16U, '\0');
  while (text.size() <= kMaxFileBytes && stream) {
    stream.read(block.data(), std::streamsize(block.size()));
    text.append(block, 0, size_t(stream.gcount()));
  }
  if (stream.bad()) throw IoError(file.string(), std::string("cannot read: ") + std::strerror(errno) + ", check the path");
  if (text.size() > kMaxFileBytes) throw InputError(file.string(), "more than 2 MiB: this is no recipe");
  return text;
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

// --- Keys ---

struct Document {
  std::string file;
  std::vector<std::string> lines;
};

[[noreturn]] void failNode(const Document& document, const toml::node& node, const std::string& message) {
  const auto place = node.source().begin;
  throw InputError(document.file, int(place.line), int(place.column), message);
}

struct Key {
  std::string name;
  std::function<void(const toml::node&)> read;
};

std::string rangeText(double low, double high) {
  if (std::isinf(low) && std::isinf(high)) return "";
  if (std::isinf(high)) return " of " + shortestText(low) + " or more";
  return " from " + shortestText(low) + " to " + shortestText(high);
}

Key numberKey(const Document& document, const char* name, double& target, double low = -INFINITY, double high = INFINITY) {
  return {name, [&document, name, &target, low, high](const toml::node& node) {
            const auto value = node.is_number() ? node.value<double>() : std::nullopt;
            if (!value || !std::isfinite(*value) || *value < low || *value > high)
              failNode(document, node, std::string(name) + " must be a number" + rangeText(low, high));
            target = *value;
          }};
}

// A positive number; zero is refused.
Key positiveKey(const Document& document, const char* name, double& target) {
  return {name, [&document, name, &target](const toml::node& node) {
            const auto value = node.is_number() ? node.value<double>() : std::nullopt;
            if (!value || !std::isfinite(*value) || !(*value > 0))
              failNode(document, node, std::string(name) + " must be a number above 0");
            target = *value;
          }};
}

Key optionalKey(const Document& document, const char* name, std::optional<double>& target) {
  return {name, [&document, name, &target](const toml::node& node) {
            if (node.is_string() && *node.value<std::string>() == "none") return target.reset();
            const auto value = node.is_number() ? node.value<double>() : std::nullopt;
            if (!value || !std::isfinite(*value))
              failNode(document, node, std::string(name) + " must be a number; leave the key out for none");
            target = *value;
          }};
}

template <class Integer>
Key integerKey(const Document& document, const char* name, Integer& target, int64_t low, int64_t high) {
  return {name, [&document, name, &target, low, high](const toml::node& node) {
            const auto value = node.is_integer() ? node.value<int64_t>() : std::nullopt;
            if (!value || *value < low || *value > high)
              failNode(document, node,
                       std::string(name) + " must be a whole number from " + std::to_string(low) + " to " + std::to_string(high));
            target = Integer(*value);
          }};
}

Key switchKey(const Document& document, const char* name, bool& target) {
  return {name, [&document, name, &target](const toml::node& node) {
            if (!node.is_boolean()) failNode(document, node, std::string(name) + " must be true or false");
            target = *node.value<bool>();
          }};
}

// The key of a value that may be missing: `plain(value)` is the key of one that is there; `clears`: "none" takes it away.
template <class Value, class Plain>
Key missableKey(std::optional<Value>& target, bool clears, Plain plain) {
  Value unread{};
  return {plain(unread).name, [&target, clears, plain](const toml::node& node) {
            if (clears && node.is_string() && *node.value<std::string>() == "none") return target.reset();
            Value value{};
            plain(value).read(node);
            target = value;
          }};
}

// `count` finite numbers in brackets.
std::vector<double> readNumbers(const Document& document, const toml::node& node, const std::string& what, size_t count) {
  std::vector<double> numbers;
  if (const toml::array* array = node.as_array())
    for (const toml::node& element : *array) {
      const auto value = element.is_number() ? element.value<double>() : std::nullopt;
      if (value && std::isfinite(*value)) numbers.push_back(*value);
    }
  if (numbers.size() != count || node.as_array()->size() != count) failNode(document, node, what);
  return numbers;
}

Key vectorKey(const Document& document, const char* name, Double3& target) {
  return {name, [&document, name, &target](const toml::node& node) {
            const auto v = readNumbers(document, node, std::string(name) + " must be three numbers: [x, y, z]", 3);
            target = {v[0], v[1], v[2]};
          }};
}

Key domainKey(const Document& document, Double3& target) {
  return {"domain", [&document, &target](const toml::node& node) {
            const char* what = "domain must be three lengths, [width, height, depth], 0 for one that follows the others";
            const auto v = readNumbers(document, node, what, 3);
            if (!(v[0] >= 0 && v[1] >= 0 && v[2] >= 0 && v[0] + v[1] + v[2] > 0)) failNode(document, node, what);
            target = {v[0], v[1], v[2]};
          }};
}

Key shapeKey(const Document& document, std::vector<Sphere>& target) {
  return {"inner_shape", [&document, &target](const toml::node& node) {
            const std::string what = "inner_shape must be a list of spheres: [[x, y, z, radius], …], radius above 0";
            if (!node.is_array()) failNode(document, node, what);
            for (const toml::node& element : *node.as_array()) {
              const auto v = readNumbers(document, element, what, 4);
              const Sphere sphere{{float(v[0]), float(v[1]), float(v[2])}, float(v[3])};
              if (!isFinite(sphere.center) || !(sphere.radius > 0) || !std::isfinite(sphere.radius)) failNode(document, element, what);
              target.push_back(sphere);
            }
          }};
}

Key emitKey(const Document& document, Emit& target) {
  return {"emit", [&document, &target](const toml::node& node) {
            const std::string value = node.value<std::string>().value_or("");
            if (value == "points")
              target = Emit::kPoints;
            else if (value == "leaves")
              target = Emit::kLeaves;
            else if (value == "both")
              target = Emit::kBoth;
            else
              failNode(document, node, "emit must be \"points\", \"leaves\" or \"both\"");
          }};
}

// --- Texts that keep their place ---

// The lines of a string value, each with its place in the file.
std::vector<SourceLine> linesOf(const Document& document, const toml::node& node) {
  const auto begin = node.source().begin, end = node.source().end;
  std::vector<SourceLine> result;
  for (std::string& text : splitLines(*node.value<std::string>())) result.push_back({std::move(text), int(begin.line), 0});

  // Escapes move characters: the place of the string is all that is sure.
  const auto raw_line = [&](size_t line) {
    return line >= 1 && line <= document.lines.size() ? std::string_view(document.lines[line - 1]) : std::string_view();
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

Key premiseKeyOf(const Document& document, SourceLine& target) {
  return {"premise", [&document, &target](const toml::node& node) {
            const auto lines = node.is_string() ? linesOf(document, node) : std::vector<SourceLine>{};
            if (lines.size() != 1) failNode(document, node, "premise must be one line of text in single quotes: 'FFFA'");
            target = lines[0];
          }};
}

Key rulesKey(const Document& document, std::vector<SourceLine>& target) {
  return {"rules", [&document, &target](const toml::node& node) {
            const auto add = [&](const toml::node& text) {
              if (!text.is_string())
                failNode(document, text, "rules must be texts in single quotes: ['A=FA', …] or '''…''' with one rule per line");
              for (SourceLine& line : linesOf(document, text)) target.push_back(std::move(line));
            };
            if (const toml::array* array = node.as_array())
              std::for_each(array->begin(), array->end(), add);
            else
              add(node);
          }};
}

Key textKey(const Document& document, const char* name, std::string& target) {
  return {name, [&document, name, &target](const toml::node& node) {
            if (!node.is_string()) failNode(document, node, std::string(name) + " must be a text in single quotes");
            target = *node.value<std::string>();
          }};
}

// --- Tables ---

void readTable(const Document& document, const toml::table& table, const std::string& where, const std::vector<Key>& keys) {
  for (const auto& [name, node] : table) {
    const auto key = std::find_if(keys.begin(), keys.end(), [&, wanted = name.str()](const Key& k) { return k.name == wanted; });
    if (key != keys.end()) {
      key->read(node);
      continue;
    }
    std::vector<std::string> known;
    for (const Key& k : keys) known.push_back(k.name);
    const std::string nearest = nearestName(name.str(), known);
    const auto place = name.source().begin;
    throw InputError(document.file, int(place.line), int(place.column),
                     "unknown key \"" + std::string(name.str()) + "\"" + where + (nearest.empty() ? ": remove it" : nearest));
  }
}

Key tableKey(const Document& document, const char* name, std::vector<Key> keys) {
  return {name, [&document, name, keys = std::move(keys)](const toml::node& node) {
            if (!node.is_table()) failNode(document, node, std::string(name) + " must be a table: [" + name + "]");
            readTable(document, *node.as_table(), std::string(" in [") + name + "]", keys);
          }};
}

Key variablesKey(const Document& document, std::vector<std::pair<std::string, double>>& target) {
  return {"variables", [&document, &target](const toml::node& node) {
            if (!node.is_table()) failNode(document, node, "variables must be a table: [variables]");
            for (const auto& [name, value] : *node.as_table()) {
              double number = 0;
              numberKey(document, "a variable", number).read(value);
              target.emplace_back(std::string(name.str()), number);
            }
          }};
}

// The value as the command line would carry it.
std::string optionValue(const Document& document, const toml::node& node) {
  if (node.is_string()) return *node.value<std::string>();
  if (node.is_boolean()) return *node.value<bool>() ? "true" : "false";
  if (node.is_integer()) return std::to_string(*node.value<int64_t>());
  if (node.is_floating_point() && std::isfinite(*node.value<double>())) return shortestText(*node.value<double>());
  failNode(document, node, "an option in [bake] must be a text, a finite number, true or false");
}

Key bakeKey(const Document& document, std::vector<RecipeOption>& target) {
  return {"bake", [&document, &target](const toml::node& node) {
            if (!node.is_table()) failNode(document, node, "bake must be a table: [bake]");
            for (const auto& [name, value] : *node.as_table())
              target.push_back({std::string(name.str()), optionValue(document, value), int(name.source().begin.line)});
            std::stable_sort(target.begin(), target.end(), [](const RecipeOption& a, const RecipeOption& b) { return a.line < b.line; });
          }};
}

std::vector<Key> turtleKeys(const Document& d, TurtleSettings& t) {
  return {numberKey(d, "step", t.step),
          numberKey(d, "step_scale", t.step_scale),
          numberKey(d, "angle", t.angle),
          numberKey(d, "angle_scale", t.angle_scale),
          positiveKey(d, "thickness", t.thickness),
          numberKey(d, "thickness_scale", t.thickness_scale),
          numberKey(d, "gravity", t.gravity),
          numberKey(d, "uv_increment", t.uv_increment),
          numberKey(d, "vertical_increment", t.vertical_increment),
          numberKey(d, "random_scale", t.random_scale, 0, 1),
          switchKey(d, "random_scale_all", t.random_scale_all),
          integerKey(d, "segments", t.segments, 1, 10000),
          switchKey(d, "continuous_length", t.continuous_length),
          switchKey(d, "continuous_angles", t.continuous_angles),
          switchKey(d, "continuous_width", t.continuous_width),
          switchKey(d, "pitch_up", t.pitch_up),
          vectorKey(d, "start_position", t.start_position),
          vectorKey(d, "start_rotation", t.start_rotation)};
}

std::vector<Key> sphereKeys(const Document& d, SphereSettings& s) {
  return {emitKey(d, s.emit),
          missableKey(s.size, false, [&d](double& size) { return positiveKey(d, "size", size); }),
          positiveKey(d, "leaf_size", s.leaf_size),
          numberKey(d, "width_power", s.width_power),
          numberKey(d, "generation_power", s.generation_power),
          positiveKey(d, "radius_min", s.radius_min),
          positiveKey(d, "radius_max", s.radius_max),
          numberKey(d, "top_falloff", s.top_falloff, 0, 1),
          numberKey(d, "jitter", s.jitter, 0),
          optionalKey(d, "base", s.base),
          numberKey(d, "squash", s.squash, 0, 1),
          optionalKey(d, "ceiling", s.ceiling),
          optionalKey(d, "flat", s.flat),
          missableKey(s.count, true, [&d](uint64_t& count) { return integerKey(d, "count", count, 1, 100'000'000); }),
          missableKey(s.domain, true, [&d](Double3& domain) { return domainKey(d, domain); }),
          missableKey(s.connect, false, [&d](bool& connect) { return switchKey(d, "connect", connect); })};
}

std::vector<Key> topKeys(const Document& d, CloudRecipe& recipe) {
  return {premiseKeyOf(d, recipe.grammar.premise),
          rulesKey(d, recipe.grammar.rules),
          textKey(d, "context_ignore", recipe.grammar.context_ignore),
          numberKey(d, "generations", recipe.derive.generations, 0),
          integerKey(d, "seed", recipe.derive.seed, 0, INT64_MAX),
          switchKey(d, "context_includes_siblings", recipe.derive.context_includes_siblings),
          shapeKey(d, recipe.derive.inner_shape)};
}

std::vector<Key> limitKeys(const Document& d, CloudRecipe& recipe) {
  return {integerKey(d, "max_modules", recipe.derive.max_modules, 1, 200'000'000),
          integerKey(d, "max_passes", recipe.derive.max_passes, 0, 1'000'000),
          missableKey(recipe.derive.max_steps, false,
                      [&d](uint64_t& steps) { return integerKey(d, "max_steps", steps, 1, 1'000'000'000'000); }),
          integerKey(d, "max_depth", recipe.turtle.max_depth, 0, 1'000'000),
          integerKey(d, "max_points", recipe.turtle.max_points, 1, 100'000'000),
          integerKey(d, "max_spheres", recipe.spheres.max_spheres, 1, 100'000'000)};
}

// --- Values of a command line ---

std::optional<double> parsedNumber(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && !text.empty() ? std::optional(value) : std::nullopt;
}

// What TOML would hold in place of a bare text.
std::unique_ptr<toml::node> nodeOf(const std::string& text) {
  if (text == "true" || text == "false") return std::make_unique<toml::value<bool>>(text == "true");
  int64_t integer = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), integer);
  if (error == std::errc() && end == text.data() + text.size()) return std::make_unique<toml::value<int64_t>>(integer);
  if (const auto number = parsedNumber(text)) return std::make_unique<toml::value<double>>(*number);
  auto list = std::make_unique<toml::array>();
  for (size_t begin = 0; begin <= text.size();) {
    const size_t stop = std::min(text.find_first_of(",x", begin), text.size());
    const auto number = parsedNumber(std::string_view(text).substr(begin, stop - begin));
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
    const auto number = at == std::string::npos ? std::nullopt : parsedNumber(std::string_view(one).substr(at + 1));
    if (!number || !std::isfinite(*number) || at == 0) throw InputError("", "a variable is declared as NAME=NUMBER");
    recipe.grammar.variables.emplace_back(one.substr(0, at), *number);
    begin = end + 1;
  }
}

}  // namespace

void setRecipeKey(CloudRecipe& recipe, const std::string& key, const std::string& value) {
  if (key == "variable") return declareVariables(recipe, value);
  const Document nowhere;
  for (const auto& keys :
       {topKeys(nowhere, recipe), turtleKeys(nowhere, recipe.turtle), sphereKeys(nowhere, recipe.spheres), limitKeys(nowhere, recipe)})
    for (const Key& candidate : keys) {
      if (candidate.name != key) continue;
      const bool is_text = key == "premise" || key == "context_ignore";
      candidate.read(is_text ? static_cast<const toml::node&>(toml::value<std::string>(value)) : *nodeOf(value));
      return;
    }
  throw InputError("", "unknown key \"" + key + "\"");
}

CloudRecipe readRecipe(const Path& file) { return parseRecipe(readText(file), file.string()); }

CloudRecipe parseRecipe(const std::string& text, const std::string& name) {
  checkTomlText(text, name);
  const Document document{name, splitLines(text)};
  CloudRecipe recipe;
  recipe.grammar.file = document.file;
  std::vector<Key> keys = topKeys(document, recipe);
  keys.insert(keys.end(),
              {variablesKey(document, recipe.grammar.variables), tableKey(document, "turtle", turtleKeys(document, recipe.turtle)),
               tableKey(document, "spheres", sphereKeys(document, recipe.spheres)),
               tableKey(document, "limits", limitKeys(document, recipe)), bakeKey(document, recipe.bake_options)});
  try {
    readTable(document, toml::parse(text, document.file), "", keys);
  } catch (const toml::parse_error& error) {
    const auto place = error.source().begin;
    throw InputError(document.file, int(place.line), int(place.column), "not valid TOML: " + std::string(error.description()));
  }
  if (recipe.grammar.premise.text.empty()) throw InputError(document.file, "no premise: add a line such as premise = 'FFFA'");
  return recipe;
}

CloudRecipe readRules(const Path& file) { return parseRules(readText(file), file.string()); }

CloudRecipe parseRules(const std::string& text, const std::string& name) {
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
        throw InputError(recipe.grammar.file, int(k) + 1, int(first) + 1, "\"" + std::string(label) + "\" stands twice: keep one");
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
