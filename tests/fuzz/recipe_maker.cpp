// Premise and rules are built from the dialect's own pieces; names in expressions are mostly those that are known there. A last
// step breaks the text of one recipe in eight.
#include "tests/fuzz/recipe_maker.h"

#include <array>
#include <string_view>

namespace cloudbake {

namespace {

constexpr std::string_view kSymbols = "AABBCXSAAFFFFFFFFFF[[[[[[[+-&^\\/|*~$fGHhJKMT\"_!?;@'#]{.}%gaaQBAX";
constexpr std::string_view kCounters = "AAAABBFXFSCQJ";
// Rules that grow fast, or whose cost is easily underestimated.
constexpr std::array<const char*, 16> kHardRules{"A=AA",     "F=FF",           "A=[A]A",          "A(k):k<12=A(k+1)A(k+1)",
                                                 "A>B=FA",   "F<F=FB",         "B=F[+B]~",        "X=a(\"p\",1)X",
                                                 "A=A[[B]]", "A:in(x,y,z)=FA", "F=!F~",           "A=AB",
                                                 "B=A",      "F=F+F--F+F",     "A=~(90)F(t)[A]A", "A(k)=A(k+0.1)J(k)"};
constexpr std::array<const char*, 14> kNumbers{"0",    "1",     "0.5",   "2",      "3",         "60",     "137.5",
                                               "1e30", "1e-30", "1e308", "1e-320", "720000001", "0.0001", "1e5"};
constexpr std::array<const char*, 17> kVariables{"t", "g", "i", "a", "T", "b", "c", "d", "n", "x", "y", "z", "A", "L", "W", "U", "V"};
constexpr std::array<const char*, 15> kOperators{"+", "-", "*", "/", "%", "^", "<", ">", "<=", ">=", "=", "==", "!=", "&", "|"};
struct Function {
  const char* name;
  int arguments;
};
constexpr std::array<Function, 21> kFunctions{{{"rand", 0}, {"rand", 1},  {"sin", 1}, {"cos", 1},   {"tan", 1},   {"asin", 1},
                                               {"acos", 1}, {"atan2", 2}, {"abs", 1}, {"floor", 1}, {"ceil", 1},  {"round", 1},
                                               {"sqrt", 1}, {"pow", 2},   {"min", 2}, {"max", 2},   {"clamp", 3}, {"fit01", 3},
                                               {"if", 3},   {"in", 3},    {"ch", 1}}};

using Names = std::string;  // single letters

std::string makeExpression(Choices& choices, const Names& locals, int depth) {
  const auto inner = [&] { return makeExpression(choices, locals, depth + 1); };
  switch (choices.below(depth < 5 ? 12 : 5)) {
    case 1: return locals.empty() ? "2" : std::string(1, locals[choices.below(locals.size())]);
    case 2: return kNumbers[choices.below(kNumbers.size())];
    case 3: return kVariables[choices.below(choices.oneIn(4) ? kVariables.size() : 9)];
    case 4: return std::to_string(choices.byte()) + "." + std::to_string(choices.below(10));
    case 5:
    case 6:
    case 7: {
      const std::string left = inner();
      return left + kOperators[choices.below(kOperators.size())] + inner();
    }
    case 8: return "(" + inner() + ")";
    case 9: return (choices.oneIn(2) ? "-" : "!") + inner();
    case 10:
    case 11: {
      const Function& function = kFunctions[choices.below(choices.oneIn(16) ? kFunctions.size() : 19)];
      std::string text = function.name + std::string("(");
      for (int k = 0; k < function.arguments; ++k) text += (k > 0 ? "," : "") + inner();
      return text + ")";
    }
    default: return std::to_string(choices.below(10));
  }
}

std::string makeArguments(Choices& choices, char symbol, const Names& locals) {
  std::string text = "(";
  if (symbol == 'a') text += choices.oneIn(2) ? "\"pscale\"," : std::string("\"n") + std::to_string(choices.byte()) + "\",";
  // An argument of a counter often counts.
  if (kCounters.find(symbol) != std::string_view::npos && !locals.empty() && choices.oneIn(2)) return text + locals[0] + "+1)";
  for (size_t count = 1 + choices.below(4), k = 0; k < count; ++k) {
    if (k > 0) text += ",";
    if (!choices.oneIn(8)) text += makeExpression(choices, locals, 0);
    if (choices.oneIn(2)) break;
  }
  return text + ")";
}

std::string makeModules(Choices& choices, const Names& locals, int depth) {
  std::string text;
  for (size_t count = choices.below(depth == 0 ? 10 : 5); count > 0; --count) {
    const char symbol = kSymbols[choices.below(kSymbols.size())];
    text += symbol;
    if (symbol == '[' && depth < 6) {
      text += makeModules(choices, locals, depth + 1);
      if (!choices.oneIn(32)) text += "]";
    } else if (choices.below(4) > 1) {
      text += makeArguments(choices, symbol, locals);
    }
  }
  return text;
}

std::string makePattern(Choices& choices, Names& locals) {
  std::string text(1, choices.oneIn(24) ? kSymbols[choices.below(kSymbols.size())] : kCounters[choices.below(kCounters.size())]);
  if (!choices.oneIn(2)) return text;
  text += "(";
  for (size_t count = 1 + choices.below(3), k = 0; k < count; ++k) {
    const char name = "nkjsilwmpqrxA"[locals.size() % 13];
    text += (k > 0 ? "," : "") + std::string(1, name);
    locals += name;
  }
  return text + ")";
}

std::string makeRule(Choices& choices) {
  if (choices.oneIn(5)) return kHardRules[choices.below(kHardRules.size())];
  Names locals;
  std::string rule;
  if (choices.oneIn(6)) rule += makePattern(choices, locals) + (choices.oneIn(4) ? makePattern(choices, locals) : "") + "<";
  rule += makePattern(choices, locals);
  if (choices.oneIn(6)) rule += ">" + makePattern(choices, locals);
  if (choices.oneIn(3))
    rule += ":" + (locals.empty() || choices.oneIn(3) ? makeExpression(choices, locals, 0)
                                                      : locals.substr(0, 1) + "<" + std::to_string(choices.below(40)));
  rule += choices.oneIn(4) ? "->" : "=";
  rule += makeModules(choices, locals, 0);
  if (choices.oneIn(5)) rule += ":" + (choices.oneIn(4) ? makeExpression(choices, locals, 0) : "0." + std::to_string(choices.below(100)));
  return rule;
}

// --- Settings ---

double makeNumber(Choices& choices) {
  constexpr std::array<double, 24> kValues{0,    1,     -1,   0.5,   2,     0.1,    0.9,   30,  90,   137.5,  360,  -45,
                                           1e30, 1e-30, 1e38, 1e-38, -1e30, 1e-310, 1e300, 7e8, 1e15, -1e-30, 0.25, 1.0001};
  return kValues[choices.below(kValues.size())];
}

// Changes a setting in one of four recipes, mostly to something that the setting allows.
void change(Choices& choices, double& setting, double low, double high) {
  if (!choices.oneIn(4)) return;
  setting = choices.oneIn(6) ? makeNumber(choices) : low + (high - low) * choices.byte() / 255;
}
void change(Choices& choices, bool& setting) {
  if (choices.oneIn(4)) setting = !setting;
}
void change(Choices& choices, std::optional<double>& setting, double low, double high) {
  if (choices.oneIn(4)) change(choices, setting.emplace(low), low, high);
}

void changeTurtle(Choices& choices, TurtleSettings& turtle) {
  change(choices, turtle.step, 0.01, 2);
  change(choices, turtle.step_scale, 0.5, 1.5);
  change(choices, turtle.angle, 0, 180);
  change(choices, turtle.angle_scale, 0, 2);
  change(choices, turtle.thickness, 0.1, 2);
  change(choices, turtle.thickness_scale, 0.5, 1.5);
  change(choices, turtle.gravity, -90, 90);
  change(choices, turtle.uv_increment, -1, 1);
  change(choices, turtle.vertical_increment, 0, 2);
  change(choices, turtle.random_scale, 0, 1);
  change(choices, turtle.random_scale_all);
  if (choices.oneIn(8)) turtle.segments = int(choices.byte() * (choices.oneIn(4) ? 40 : 1));
  change(choices, turtle.continuous_length);
  change(choices, turtle.continuous_angles);
  change(choices, turtle.continuous_width);
  change(choices, turtle.pitch_up);
  for (double* setting : {&turtle.start_position.x, &turtle.start_position.y, &turtle.start_rotation.x, &turtle.start_rotation.z})
    if (choices.oneIn(8)) *setting = makeNumber(choices);
}

void changeSpheres(Choices& choices, SphereSettings& spheres) {
  if (choices.oneIn(4)) spheres.emit = Emit(choices.below(3));
  change(choices, spheres.size, 0.01, 2);
  change(choices, spheres.leaf_size, 0.01, 2);
  change(choices, spheres.width_power, -2, 3);
  change(choices, spheres.generation_power, -2, 3);
  change(choices, spheres.radius_min, 0.1, 1);
  change(choices, spheres.radius_max, 1, 10);
  change(choices, spheres.top_falloff, 0, 1);
  change(choices, spheres.jitter, 0, 3);
  change(choices, spheres.base, -1, 1);
  change(choices, spheres.ceiling, -1, 4);
  if (spheres.base || choices.oneIn(64)) {
    change(choices, spheres.squash, 0, 1);
    change(choices, spheres.flat, 0, 1);
  }
  if (choices.oneIn(2)) spheres.connect = choices.oneIn(8) ? false : true;
  if (choices.oneIn(8)) spheres.count = 1 + choices.below(200);
  if (choices.oneIn(8)) spheres.floor = spheres.base;
  if (choices.oneIn(4)) {
    spheres.domain = Double3{1, 2, 0};
    for (double* side : {&spheres.domain->x, &spheres.domain->y, &spheres.domain->z}) change(choices, *side, 0, 8);
  }
}

void changeDerivation(Choices& choices, CloudRecipe& recipe) {
  DeriveSettings& derive = recipe.derive;
  derive.generations = double(choices.below(choices.oneIn(2) ? 41 : 13));
  if (choices.oneIn(4)) derive.generations += choices.byte() / 256.0;
  if (choices.oneIn(64)) derive.generations = makeNumber(choices);
  change(choices, derive.context_includes_siblings);
  constexpr std::array<const char*, 8> kIgnored{"F+-", "", "[]", "F[]+-", "ABFX", "A", "[", "+-&^\\/|*~$"};
  if (choices.oneIn(4)) recipe.grammar.context_ignore = kIgnored[choices.below(kIgnored.size())];
  if (choices.oneIn(2))
    for (size_t count = 1 + choices.below(4); count > 0; --count)
      derive.inner_shape.push_back({{choices.byte() / 64.0F, choices.byte() / 64.0F, 0}, 1 + choices.byte() / 64.0F});
  if (choices.oneIn(4)) recipe.grammar.variables = {{"n", double(choices.byte())}, {"b", makeNumber(choices)}};
}

}  // namespace

void mutateText(std::string& text, Choices& choices) {
  constexpr std::string_view kTokens = "()<>=:,[]%\"#$-+.{}\\'`1e9 \n\tFAa~\xC3";
  for (size_t count = 1 + choices.below(4); count > 0 && !text.empty(); --count) {
    const size_t place = (choices.byte() * 256U + choices.byte()) % text.size(), length = 1 + choices.below(8);
    switch (choices.below(5)) {
      case 0: text[place] = kTokens[choices.below(kTokens.size())]; break;
      case 1: text.insert(place, 1, kTokens[choices.below(kTokens.size())]); break;
      case 2: text.erase(place, length); break;
      case 3: text.insert(place, text.substr(place, length * length)); break;
      default: text[place] = char(choices.byte()); break;
    }
  }
}

CloudRecipe makeRecipe(Choices& choices) {
  CloudRecipe recipe;
  GrammarText& grammar = recipe.grammar;
  grammar.file = "fuzz";
  // The settings come first, so that short inputs vary them too; a declared n keeps most expressions known.
  grammar.variables = {{"n", 3}};
  changeDerivation(choices, recipe);
  if (choices.oneIn(2)) changeTurtle(choices, recipe.turtle);
  if (choices.oneIn(2)) changeSpheres(choices, recipe.spheres);

  const size_t rules = choices.below(9);
  std::string premise = makeModules(choices, "", 0) + kCounters[choices.below(kCounters.size())];
  if (choices.oneIn(4)) premise += "(" + std::to_string(choices.below(3)) + ")";
  if (!choices.oneIn(8)) premise = "F" + premise;
  for (size_t doublings = choices.oneIn(16) ? choices.below(8) : 0; doublings > 0; --doublings) premise += premise;
  grammar.premise = {premise, 1, 1};
  for (size_t k = 0; k < rules; ++k) grammar.rules.push_back({makeRule(choices), int(k) + 2, 1});
  if (choices.oneIn(8)) {
    mutateText(grammar.premise.text, choices);
    for (SourceLine& rule : grammar.rules)
      if (choices.oneIn(2)) mutateText(rule.text, choices);
  }
  return recipe;
}

}  // namespace cloudbake
