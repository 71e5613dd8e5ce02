// Converts text to rules, as the L-system notes, section 1, describe it. The separator is the first `->` outside parentheses, else the
// last `=` outside parentheses that is not part of == != <= >=. The head ends at its first `:`; the probability follows the last `:`.
#include "lsystem/grammar.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace cloudbake {

namespace {

constexpr size_t kMaxNames = 100;  // limit for names on a rule's left side, for variables and for attributes

struct Range {
  size_t begin, end;
  bool empty() const { return begin >= end; }
};

struct GrammarParser {
  Grammar& grammar;
  NameScope& scope;
  Warnings& warnings;
};

void warn(GrammarParser& parser, const PlainText& text, const std::string& message) {
  const std::string place = text.file + (text.line > 0 ? ":" + std::to_string(text.line) : "");
  parser.warnings.add(WarningKind::kGrammar, place + ": " + message);
}

bool isNameStart(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool isName(std::string_view s) {
  return !s.empty() && isNameStart(s[0]) &&
         std::all_of(s.begin(), s.end(), [](char c) { return isNameStart(c) || (c >= '0' && c <= '9'); });
}

// Calls visit(position) for every character outside parentheses.
template <class Visit>
void forTopLevel(const PlainText& text, Range range, Visit visit) {
  for (size_t i = range.begin; i < range.end; ++i) {
    visit(i);
    if (text.characters[i] == '(') i = closingParenthesis(text, i, range.end);
  }
}

// The parts between the commas of an argument list. Commas in quotes or inner parentheses do not separate. `()` has no parts.
std::vector<Range> splitArguments(const PlainText& text, Range range) {
  std::vector<Range> parts;
  if (range.empty()) return parts;
  size_t begin = range.begin;
  bool quoted = false;
  for (size_t i = range.begin; i < range.end; ++i) {
    const char c = text.characters[i];
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '(') i = closingParenthesis(text, i, range.end);
    if (c != ',') continue;
    parts.push_back({begin, i});
    begin = i + 1;
  }
  parts.push_back({begin, range.end});
  return parts;
}

int internText(Grammar& grammar, const std::string& value, const PlainText& text, size_t position) {
  const auto found = std::find(grammar.texts.begin(), grammar.texts.end(), value);
  if (found != grammar.texts.end()) return int(found - grammar.texts.begin());
  if (grammar.texts.size() >= kMaxNames)
    failAt(text, position, "more than 100 names of attributes: use a(\"name\",v1,v2,v3) with fewer names");
  grammar.texts.push_back(value);
  return int(grammar.texts.size()) - 1;
}

void parseArguments(GrammarParser& parser, const PlainText& text, Range range, ModuleTemplate& module, int& rand_calls) {
  for (const Range& part : splitArguments(text, range)) {
    if (module.arguments.size() >= 65535) failAt(text, part.begin, "more than 65535 arguments: a symbol cannot hold more");
    module.arguments.emplace_back();
    if (part.empty()) continue;
    if (text.characters[part.begin] != '"') {
      module.arguments.back() = compileExpression(text, part.begin, part.end, parser.scope, rand_calls);
      parser.grammar.reads_shape = parser.grammar.reads_shape || readsShape(module.arguments.back());
      continue;
    }
    const std::string value = text.characters.substr(part.begin + 1, part.end - part.begin - 2);
    if (module.symbol != 'a' || module.arguments.size() > 1)
      failAt(text, part.begin, "a text can only be the first argument of a(\"name\",v1,v2,v3)");
    if (part.end - part.begin < 3 || text.characters[part.end - 1] != '"' || value.find('"') != std::string::npos)
      failAt(text, part.begin, "the name of the attribute must be one text in quotes: a(\"name\",…)");
    module.text = internText(parser.grammar, value, text, part.begin);
  }
}

std::vector<ModuleTemplate> parseModules(GrammarParser& parser, const PlainText& text, Range range, int& rand_calls) {
  std::vector<ModuleTemplate> modules;
  for (size_t i = range.begin; i < range.end; ++i) {
    const char c = text.characters[i];
    if (c == '(') failAt(text, i, "a \"(\" must follow a symbol: it encloses the symbol's arguments");
    if (c == ')') failAt(text, i, "this \")\" closes nothing: remove it, or add the missing \"(\"");
    if (c == ',') warn(parser, text, "\",\" outside parentheses does nothing here (in cpfg it changes the colour: use ' or #)");
    modules.push_back({c});
    if (i + 1 < range.end && text.characters[i + 1] == '(') {
      const size_t close = closingParenthesis(text, i + 1, range.end);
      parseArguments(parser, text, {i + 2, close}, modules.back(), rand_calls);
      i = close;
    }
    if (c == 'a' && modules.back().text < 0 && !modules.back().arguments.empty())
      warn(parser, text,
           "a(…) without a name in quotes does nothing: a(\"name\",value) sets an attribute; use another letter for a counter");
  }
  return modules;
}

// Parses symbols with names for their arguments, as in heads and contexts.
std::vector<ModulePattern> parsePatterns(GrammarParser& parser, const PlainText& text, Range range) {
  std::vector<ModulePattern> patterns;
  for (size_t i = range.begin; i < range.end; ++i) {
    const char c = text.characters[i];
    if (c == '(' || c == ')') failAt(text, i, std::string("unexpected \"") + c + "\" on the left side of the rule");
    patterns.push_back({c});
    if (i + 1 >= range.end || text.characters[i + 1] != '(') continue;
    const size_t close = closingParenthesis(text, i + 1, range.end);
    for (const Range& part : splitArguments(text, {i + 2, close})) {
      const std::string name = text.characters.substr(part.begin, part.end - part.begin);
      patterns.back().formals.push_back(name.empty() ? -1 : int(parser.scope.locals.size()));
      if (name.empty()) continue;
      if (!isName(name))
        failAt(text, part.begin, "arguments on the left side are names such as i or len; test their values in a condition: A(i):i=0=…");
      if (parser.scope.locals.size() >= kMaxNames)
        failAt(text, part.begin, "more than 100 names on the left side: leave out those not used");
      if (std::count(parser.scope.locals.begin(), parser.scope.locals.end(), name) > 0)
        failAt(text, part.begin, "the name \"" + name + "\" appears twice on the left side: use another one");
      if (name != "i" && std::find(kBuiltinNames.begin(), kBuiltinNames.end(), name) != kBuiltinNames.end())
        warn(parser, text, "the argument \"" + name + "\" hides the variable of that name inside this rule");
      parser.scope.locals.push_back(name);
    }
    i = close;
  }
  return patterns;
}

// Position and length of the separator between head and replacement.
Range findSeparator(const PlainText& text) {
  const std::string& s = text.characters;
  Range arrow{0, 0}, equals{0, 0};
  bool part_of_operator = false;
  forTopLevel(text, {0, s.size()}, [&](size_t i) {
    if (arrow.empty() && s[i] == '-' && i + 1 < s.size() && s[i + 1] == '>') arrow = {i, i + 2};
    if (part_of_operator) {
      part_of_operator = false;
      return;
    }
    const bool before_equals = i + 1 < s.size() && s[i + 1] == '=';
    if (before_equals && (s[i] == '=' || s[i] == '!' || s[i] == '<' || s[i] == '>'))
      part_of_operator = true;
    else if (s[i] == '=')
      equals = {i, i + 1};
  });
  if (!arrow.empty()) return arrow;
  if (equals.empty())
    failAt(text, 0, "no \"=\" between symbol and replacement: write A=FA (to rewrite \"!\", \"<\", \">\" or \"=\" write !->FA)");
  return equals;
}

void parseHead(GrammarParser& parser, const PlainText& text, Range head, Rule& rule) {
  size_t left = head.begin, right = head.end, right_begin = head.end;
  bool has_left = false, has_right = false;
  forTopLevel(text, head, [&](size_t i) {
    const char c = text.characters[i];
    if (c == '[' || c == ']') failAt(text, i, "a rule cannot rewrite or look for brackets: contexts see one branch only");
    if (c == '<' && !has_left && !has_right) {
      has_left = true;
      left = i;
    } else if (c == '>' && !has_right) {
      has_right = true;
      right = i;
      right_begin = i + 1;
    } else if (c == '<' || c == '>') {
      failAt(text, i, "the left side holds more than one \"<\" or \">\": write left<symbol>right");
    }
  });
  const Range strict{has_left ? left + 1 : head.begin, right};
  if ((has_left && left == head.begin) || (has_right && right_begin == head.end))
    failAt(text, has_left && left == head.begin ? left : right,
           "a context is missing here: write left<symbol>right, or leave out the sign");

  rule.left = has_left ? parsePatterns(parser, text, {head.begin, left}) : std::vector<ModulePattern>{};
  const auto predecessor = parsePatterns(parser, text, strict);
  rule.right = parsePatterns(parser, text, {right_begin, head.end});
  if (predecessor.size() != 1)
    failAt(text, strict.begin,
           "the left side must be one symbol, found \"" + text.characters.substr(strict.begin, strict.end - strict.begin) +
               "\": neighbours are written left<symbol>right");
  rule.predecessor = predecessor[0];
}

Rule parseRule(GrammarParser& parser, const PlainText& text) {
  Rule rule;
  rule.line = text.line;
  rule.column = text.columns.front();
  rule.text = text.characters;
  parser.scope.locals.clear();
  const Range separator = findSeparator(text);
  Range head{0, separator.begin}, replacement{separator.end, text.characters.size()};
  size_t condition = head.end, probability = replacement.end;
  forTopLevel(text, head, [&](size_t i) {
    if (text.characters[i] == ':' && condition == head.end) condition = i;
  });
  forTopLevel(text, replacement, [&](size_t i) {
    if (text.characters[i] == ':') probability = i;
  });

  // rand() calls are numbered through condition, probability and arguments.
  int rand_calls = 0;
  parseHead(parser, text, {head.begin, condition}, rule);
  rule.local_count = int(parser.scope.locals.size());
  if (condition < head.end) rule.condition = compileExpression(text, condition + 1, head.end, parser.scope, rand_calls);
  if (probability < replacement.end) {
    rule.probability = compileExpression(text, probability + 1, replacement.end, parser.scope, rand_calls);
    replacement.end = probability;
  }
  rule.replacement = parseModules(parser, text, replacement, rand_calls);

  // Whether the rule reads the turtle or the shape
  parser.grammar.reads_shape = parser.grammar.reads_shape || readsShape(rule.condition) || readsShape(rule.probability);
  bool reads_turtle = readsTurtle(rule.condition) || readsTurtle(rule.probability);
  for (const ModuleTemplate& module : rule.replacement)
    for (const Expression& argument : module.arguments) reads_turtle = reads_turtle || readsTurtle(argument);
  parser.grammar.reads_turtle = parser.grammar.reads_turtle || reads_turtle;
  return rule;
}

// Symbols that the premise and the rules can produce.
std::bitset<128> reachableSymbols(const Grammar& grammar) {
  std::bitset<128> reachable;
  std::array<std::bitset<128>, 128> made{};  // symbols made by the rules of each symbol
  for (const ModuleTemplate& module : grammar.premise) reachable.set(symbolIndex(module.symbol));
  for (const Rule& rule : grammar.rules)
    for (const ModuleTemplate& module : rule.replacement) made[symbolIndex(rule.predecessor.symbol)].set(symbolIndex(module.symbol));
  for (bool grown = true; grown;) {
    const auto before = reachable;
    for (size_t symbol = 0; symbol < made.size(); ++symbol)
      if (reachable.test(symbol)) reachable |= made[symbol];
    grown = reachable != before;
  }
  return reachable;
}

// The reason why a rule can never fire; empty if it can.
std::string deadReason(const Grammar& grammar, const Rule& rule, const std::bitset<128>& reachable) {
  const auto symbol_text = [](char c) { return std::string("\"") + c + "\""; };
  if (!reachable.test(symbolIndex(rule.predecessor.symbol)))
    return "neither the premise nor a rule produces a " + symbol_text(rule.predecessor.symbol);
  for (const auto* context : {&rule.left, &rule.right})
    for (const ModulePattern& pattern : *context) {
      if (grammar.context_ignore.test(symbolIndex(pattern.symbol)))
        return symbol_text(pattern.symbol) + " is among the ignored context symbols";
      if (!reachable.test(symbolIndex(pattern.symbol))) return "nothing produces the neighbour " + symbol_text(pattern.symbol);
    }
  if (!rule.condition.nodes.empty() && constantValue(rule.condition) == 0.0) return "its condition is always false";
  if (!rule.probability.nodes.empty() && constantValue(rule.probability) == 0.0) return "its probability is 0";
  return "";
}

// Warns about rules that can never fire, are shadowed by an earlier one, or whose stated probabilities sum to more than 1.
void reviewRules(GrammarParser& parser) {
  const Grammar& grammar = parser.grammar;
  const auto reachable = reachableSymbols(grammar);
  std::array<double, 128> certain{};  // sum of the probabilities of earlier rules that have no condition and no context
  for (const Rule& rule : grammar.rules) {
    const PlainText place{grammar.file, rule.text, rule.line, "", {}, 0};
    const std::string quoted = "rule \"" + rule.text + "\" ";
    if (const std::string reason = deadReason(grammar, rule, reachable); !reason.empty())
      warn(parser, place, quoted + "can never fire: " + reason);
    double& sum = certain[symbolIndex(rule.predecessor.symbol)];
    if (sum >= 1 - 1e-9) warn(parser, place, quoted + "can never fire: an earlier rule always rewrites the symbol");
    if (!rule.condition.nodes.empty() || !rule.left.empty() || !rule.right.empty()) continue;
    const bool stated = !rule.probability.nodes.empty();
    const auto value = stated ? constantValue(rule.probability) : std::optional<double>(1);
    if (!value || !(*value >= 0)) continue;
    const double share = stated && *value > 1 + 1e-6 ? *value / 100 : *value;
    if (stated && sum < 1 - 1e-9 && sum + share > 1 + 1e-6) warn(parser, place, quoted + "brings the sum of the probabilities over 1");
    sum += share;
  }
}

// In cpfg `~X` draws a surface; here it tumbles, which its author may not want.
void reviewTumbles(GrammarParser& parser, const PlainText& text, const std::bitset<128>& rewritten) {
  const std::string known = "FfGHhJKM[]";
  for (size_t i = 0; i + 1 < text.characters.size(); ++i) {
    const char next = text.characters[i + 1];
    if (text.characters[i] == '~' && isNameStart(next) && known.find(next) == std::string::npos && !rewritten.test(symbolIndex(next)))
      warn(parser, text, std::string("\"~") + next + "\" tumbles by up to 180 degrees (in cpfg it draws a surface: use J, K or M)");
  }
}

void declareVariables(const GrammarText& text, Grammar& grammar, NameScope& scope) {
  for (const char* name : {"b", "c", "d"}) {
    scope.variables.emplace_back(name);
    grammar.variables.push_back(0);
  }
  for (const auto& [name, value] : text.variables) {
    if (!isName(name))
      throw InputError(text.file, "the variable \"" + name + "\" is not a valid name: use letters, digits and _, and begin with a letter");
    if (std::find(kBuiltinNames.begin(), kBuiltinNames.end(), name) != kBuiltinNames.end())
      throw InputError(text.file, "the variable \"" + name + "\" is built in and cannot be declared: use another name");
    if (!std::isfinite(value)) throw InputError(text.file, "the variable \"" + name + "\" is not finite: give it a number");
    const auto known = std::find(scope.variables.begin(), scope.variables.end(), name);
    if (known != scope.variables.end()) {
      grammar.variables[size_t(known - scope.variables.begin())] = value;
      continue;
    }
    if (scope.variables.size() >= kMaxNames) throw InputError(text.file, "more than 100 variables: remove unused variables");
    scope.variables.push_back(name);
    grammar.variables.push_back(value);
  }
}

}  // namespace

Grammar parseGrammar(const GrammarText& text, Warnings& warnings) {
  Grammar grammar;
  NameScope scope;
  GrammarParser parser{grammar, scope, warnings};
  grammar.file = text.file;
  grammar.premise_source = text.premise;
  declareVariables(text, grammar, scope);
  for (const char c : text.context_ignore)
    if (c > ' ' && c < 127)
      grammar.context_ignore.set(symbolIndex(c));
    else if (c != ' ')
      throw InputError(text.file, "context_ignore holds a character that cannot be a symbol: use printable ASCII");

  // Premise
  const PlainText premise = plainText(text.file, text.premise);
  if (premise.characters.empty()) throw InputError(text.file, text.premise.line, "the premise is empty: give it at least one symbol");
  int rand_calls = 0;
  grammar.premise = parseModules(parser, premise, {0, premise.characters.size()}, rand_calls);

  // Rules
  std::vector<PlainText> lines{premise};
  for (const SourceLine& line : text.rules) {
    const size_t first = line.text.find_first_not_of(" \t\r\n\v\f");
    if (first == std::string::npos || line.text[first] == '#') continue;
    lines.push_back(plainText(text.file, line));
    grammar.rules.push_back(parseRule(parser, lines.back()));
  }
  reviewRules(parser);
  std::bitset<128> rewritten;
  for (const Rule& rule : grammar.rules) rewritten.set(symbolIndex(rule.predecessor.symbol));
  for (const PlainText& line : lines) reviewTumbles(parser, line, rewritten);
  return grammar;
}

}  // namespace cloudbake
