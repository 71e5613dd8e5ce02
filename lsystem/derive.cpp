// Parallel rewriting with contexts, conditions and probabilities (L-system notes, sections 3, 5, 6; The Algorithmic Beauty of
// Plants, chapter 1). Conditions, contexts and arguments see the old string. A module keeps its key unless it is rewritten;
// child j of a replacement gets childKey(parent, j), so that a draw depends only on its place in the derivation.
#include "lsystem/derive.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "lsystem/keys.h"

namespace cloudbake {

namespace {

constexpr double kBytesPerModule = sizeof(Module) + 2 * sizeof(double);  // with as many arguments as most have
constexpr uint64_t kMaxArgumentsPerModule = 8;                           // on average; with max_modules it bounds the memory

// Number of steps that each kind of work counts as, proportional to its time.
constexpr uint64_t kStepsOfModule = 3, kStepsOfRule = 3, kStepsOfArgument = 1, kStepsOfTurtle = 30;

struct Derivation {
  const Grammar& grammar;
  const DeriveSettings& settings;
  std::array<std::vector<const Rule*>, 128> rules_of{};
  EvaluationContext context{};
  std::vector<double> locals{};
  std::vector<uint32_t> partners{};  // matching bracket of each bracket; set if a rule has a context
  bool has_contexts = false;
  int pass = 0;
  const Rule* tried = nullptr;  // the rule that was tried last
  uint64_t percentages = 0, negative_probabilities = 0;
  std::string first_arithmetic{};  // the first rule that the context counted a warning for
  TurtleWalk walk{};
  bool follows_turtle = false;
};

// A number ≥ 0.
std::string formatNumber(double value) {
  char buffer[32];
  if (value == std::floor(value) && value < 1e6) return std::to_string(int64_t(value));
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 2).ptr};
}

// --- Limits ---

struct GrowthBound {
  double length = 0;              // upper bound of the modules after the next pass
  bool exact = true;              // whether `length` is exact
  const Rule* fastest = nullptr;  // the rule that adds most modules
};

std::array<uint64_t, 128> countSymbols(const ModuleString& string) {
  std::array<uint64_t, 128> counts{};
  for (const Module& module : string.modules) ++counts[symbolIndex(module.symbol)];
  return counts;
}

// Σ count(symbol) · longest replacement.
GrowthBound boundGrowth(const Derivation& derivation, const ModuleString& string) {
  const std::array<uint64_t, 128> counts = countSymbols(string);
  GrowthBound bound;
  double fastest = 0;
  for (size_t symbol = 0; symbol < counts.size(); ++symbol) {
    if (counts[symbol] == 0) continue;
    const auto& rules = derivation.rules_of[symbol];
    const Rule* longest = nullptr;
    for (const Rule* rule : rules)
      if (longest == nullptr || rule->replacement.size() > longest->replacement.size()) longest = rule;
    const bool certain = rules.empty() || (rules.size() == 1 && rules[0]->condition.nodes.empty() && rules[0]->probability.nodes.empty() &&
                                           rules[0]->left.empty() && rules[0]->right.empty());
    bound.exact = bound.exact && certain;
    const double size = longest == nullptr ? 1 : double(longest->replacement.size());
    bound.length += double(counts[symbol]) * (certain ? size : std::max(1.0, size));
    const double gain = double(counts[symbol]) * (size - 1);
    if (longest != nullptr && gain > fastest) {
      fastest = gain;
      bound.fastest = longest;
    }
  }
  return bound;
}

[[noreturn]] void failLimit(const Derivation& derivation, const GrowthBound& bound) {
  const int line = bound.fastest != nullptr ? bound.fastest->line : derivation.grammar.premise_source.line;
  std::string message = "generation " + std::to_string(derivation.pass) + " would hold " + (bound.exact ? "about " : "up to ") +
                        formatNumber(bound.length) + " symbols (limit " + formatNumber(double(derivation.settings.max_modules)) +
                        "): use fewer generations or raise max_modules";
  if (bound.fastest != nullptr) message += "; \"" + bound.fastest->text + "\" grows fastest";
  throw InputError(derivation.grammar.file, line, message);
}

// Counts work. Throws when the limit is exceeded.
void spend(Derivation& derivation, uint64_t steps) {
  derivation.context.steps += steps;
  const uint64_t limit = derivation.settings.max_steps.value_or(std::max<uint64_t>(100'000'000, 50 * derivation.settings.max_modules));
  if (derivation.context.steps <= limit) return;
  const Rule* rule = derivation.tried;
  const int line = rule != nullptr ? rule->line : derivation.grammar.premise_source.line;
  std::string message = "generation " + std::to_string(derivation.pass) + " goes beyond " + formatNumber(double(limit)) +
                        " steps (modules, rules tried, neighbours visited, terms evaluated): use fewer generations, contexts whose "
                        "neighbours are near, or raise max_steps";
  if (rule != nullptr) message += "; the last rule tried was \"" + rule->text + "\"";
  throw InputError(derivation.grammar.file, line, message);
}

// --- Contexts ---

constexpr uint32_t kNoPartner = 0xFFFFFFFF;

void findPartners(Derivation& derivation, const ModuleString& string) {
  derivation.partners.assign(string.modules.size(), kNoPartner);
  std::vector<uint32_t> open;
  for (size_t i = 0; i < string.modules.size(); ++i) {
    if (string.modules[i].symbol == '[') open.push_back(uint32_t(i));
    if (string.modules[i].symbol != ']' || open.empty()) continue;
    derivation.partners[i] = open.back();
    derivation.partners[open.back()] = uint32_t(i);
    open.pop_back();
  }
}

void bindFormals(Derivation& derivation, const ModulePattern& pattern, const ModuleString& string, const Module& module) {
  for (size_t k = 0; k < pattern.formals.size(); ++k)
    if (pattern.formals[k] >= 0) derivation.locals[size_t(pattern.formals[k])] = argumentOr(string, module, k, kOmittedArgument);
}

// Scans from `index` to the left (direction -1) or right (+1) along the module's own branch and binds one pattern after the other.
bool matchContext(Derivation& derivation, const std::vector<ModulePattern>& patterns, const ModuleString& string, size_t index,
                  int direction) {
  const auto& ignore = derivation.grammar.context_ignore;
  const char enters = direction > 0 ? '[' : ']', leaves = direction > 0 ? ']' : '[';
  const int64_t size = int64_t(string.modules.size());
  size_t matched = 0;
  int depth = 0;
  for (int64_t i = int64_t(index) + direction; matched < patterns.size() && i >= 0 && i < size; i += direction) {
    const Module& module = string.modules[size_t(i)];
    ++derivation.context.steps;
    if (ignore.test(symbolIndex(module.symbol))) continue;
    if (module.symbol == enters) {
      const uint32_t partner = derivation.partners[size_t(i)];
      const bool skips = depth == 0 && partner != kNoPartner;  // skips a whole sub-branch
      if (skips)
        i = partner;
      else
        ++depth;
    } else if (module.symbol == leaves) {
      --depth;
      if (depth < 0 && !derivation.settings.context_includes_siblings) return false;
    } else if (depth == 0) {
      const ModulePattern& pattern = direction > 0 ? patterns[matched] : patterns[patterns.size() - 1 - matched];
      if (pattern.symbol != module.symbol) return false;
      bindFormals(derivation, pattern, string, module);
      ++matched;
    }
  }
  return matched == patterns.size();
}

// --- Choice of a rule ---

// Evaluates an expression and remembers the first rule that needs a warning.
double evaluateFor(Derivation& derivation, const Expression& expression, std::string_view rule) {
  const double value = evaluate(expression, derivation.context);
  const EvaluationContext& c = derivation.context;
  if (derivation.first_arithmetic.empty() && c.missing_arguments + c.divisions_by_zero + c.clamped_arguments > 0)
    derivation.first_arithmetic = rule;
  return value;
}

[[noreturn]] void failValue(const Derivation& derivation, const std::string& what, const std::string& rule, int line, int column) {
  throw InputError(derivation.grammar.file, line, column,
                   what + " of \"" + rule + "\" is not a finite number in generation " + std::to_string(derivation.pass) +
                       ": look for an overflow, tan(90), a root or power of a negative number");
}

double probabilityOf(Derivation& derivation, const Rule& rule) {
  if (rule.probability.nodes.empty()) return 1;
  const double p = evaluateFor(derivation, rule.probability, rule.text);
  if (!std::isfinite(p)) failValue(derivation, "the probability", rule.text, rule.line, rule.column);
  if (p < 0) {
    ++derivation.negative_probabilities;
    return 0;
  }
  if (p <= 1 + 1e-6) return p;
  ++derivation.percentages;
  return p / 100;
}

bool matches(Derivation& derivation, const Rule& rule, const ModuleString& string, size_t index) {
  derivation.tried = &rule;
  spend(derivation, kStepsOfRule + uint64_t(rule.local_count));
  derivation.locals.assign(size_t(rule.local_count), kOmittedArgument);
  derivation.context.locals = derivation.locals;
  bindFormals(derivation, rule.predecessor, string, string.modules[index]);
  if (!rule.left.empty() && !matchContext(derivation, rule.left, string, index, -1)) return false;
  if (!rule.right.empty() && !matchContext(derivation, rule.right, string, index, 1)) return false;
  if (rule.condition.nodes.empty()) return true;
  const double condition = evaluateFor(derivation, rule.condition, rule.text);
  if (std::isnan(condition)) failValue(derivation, "the condition", rule.text, rule.line, rule.column);
  return condition != 0;
}

// The rule that rewrites module `index`, or nullptr. The rule's locals stay bound.
const Rule* chooseRule(Derivation& derivation, const ModuleString& string, size_t index) {
  const Module& module = string.modules[index];
  const auto& rules = derivation.rules_of[symbolIndex(module.symbol)];
  if (rules.empty()) return nullptr;

  // Values that expressions read at this module
  EvaluationContext& c = derivation.context;
  c.key = module.key;
  c[Builtin::kAge] = derivation.pass - 1 - module.birth;
  c[Builtin::kIndex] = double(index);
  const TurtleState& turtle = derivation.walk.state;
  if (derivation.follows_turtle) {
    c[Builtin::kX] = turtle.position.x;
    c[Builtin::kY] = turtle.position.y;
    c[Builtin::kZ] = turtle.position.z;
    c[Builtin::kArc] = turtle.arc;
    c[Builtin::kStep] = turtle.step;
    c[Builtin::kWidth] = turtle.width;
    c[Builtin::kU] = turtle.u;
    c[Builtin::kV] = turtle.v;
  }

  // One draw against the running sum of the probabilities
  double sum = 0;
  const double draw = drawUniform(module.key, DrawChannel::kRule, uint64_t(derivation.pass));
  for (const Rule* rule : rules) {
    if (!matches(derivation, *rule, string, index)) continue;
    sum += probabilityOf(derivation, *rule);
    if (draw < sum) return rule;
  }
  return nullptr;
}

// --- Appending ---

void appendArguments(Derivation& derivation, const ModuleTemplate& source, const std::string& rule, int line, int column,
                     ModuleString& out) {
  for (size_t k = 0; k < source.arguments.size(); ++k) {
    const Expression& argument = source.arguments[k];
    spend(derivation, kStepsOfArgument);
    if (argument.nodes.empty()) {
      out.arguments.push_back(kOmittedArgument);
      continue;
    }
    const double value = evaluateFor(derivation, argument, rule);
    if (!std::isfinite(value))
      failValue(derivation, "argument " + std::to_string(k + 1) + " of " + source.symbol + " in the replacement", rule, line, column);
    out.arguments.push_back(value);
  }
}

void appendReplacement(Derivation& derivation, const Rule& rule, const Module& parent, ModuleString& next) {
  bool inherits = true;  // the first module with the predecessor's letter keeps its birth
  for (size_t j = 0; j < rule.replacement.size(); ++j) {
    const ModuleTemplate& source = rule.replacement[j];
    Module child;
    child.symbol = source.symbol;
    child.text = source.text;
    child.argument_count = uint16_t(source.arguments.size());
    child.first_argument = uint32_t(next.arguments.size());
    child.birth = inherits && source.symbol == parent.symbol ? parent.birth : derivation.pass;
    inherits = inherits && source.symbol != parent.symbol;
    child.key = childKey(parent.key, j);
    appendArguments(derivation, source, rule.text, rule.line, rule.column, next);
    next.modules.push_back(child);
  }
}

void appendUnchanged(const ModuleString& string, const Module& module, ModuleString& next) {
  next.modules.push_back(module);
  next.modules.back().first_argument = uint32_t(next.arguments.size());
  const auto first = string.arguments.begin() + module.first_argument;
  next.arguments.insert(next.arguments.end(), first, first + module.argument_count);
}

// `%` deletes everything after it in its branch, up to the bracket that closes the branch.
void cutBranches(ModuleString& string) {
  auto& modules = string.modules;
  if (std::none_of(modules.begin(), modules.end(), [](const Module& m) { return m.symbol == '%'; })) return;
  size_t kept = 0;
  for (size_t i = 0; i < modules.size(); ++i) {
    modules[kept++] = modules[i];
    if (modules[i].symbol != '%') continue;
    int depth = 0;
    for (; i + 1 < modules.size(); ++i) {
      const char next = modules[i + 1].symbol;
      if (next == ']' && depth == 0) break;
      depth += next == '[' ? 1 : next == ']' ? -1 : 0;
    }
  }
  modules.resize(kept);
}

ModuleString makePremise(Derivation& derivation) {
  const Grammar& grammar = derivation.grammar;
  ModuleString string;
  string.file = grammar.file;
  // The premise has no predecessor: the seed's root key takes its place, and the turtle is at its start.
  derivation.context.key = derivation.context.root;
  const SourceLine& source = grammar.premise_source;
  if (grammar.premise.size() > derivation.settings.max_modules)
    throw InputError(grammar.file, source.line,
                     "the premise holds " + std::to_string(grammar.premise.size()) + " symbols (limit " +
                         formatNumber(double(derivation.settings.max_modules)) + "): shorten it or raise max_modules");
  for (size_t k = 0; k < grammar.premise.size(); ++k) {
    const ModuleTemplate& symbol = grammar.premise[k];
    derivation.context[Builtin::kIndex] = double(k);
    Module module;
    module.symbol = symbol.symbol;
    module.text = symbol.text;
    module.argument_count = uint16_t(symbol.arguments.size());
    module.first_argument = uint32_t(string.arguments.size());
    module.key = premiseKey(derivation.context.root, k);
    appendArguments(derivation, symbol, source.text, source.line, source.column, string);
    string.modules.push_back(module);
  }
  return string;
}

// --- Passes ---

ModuleString rewrite(Derivation& derivation, const ModuleString& string, const TurtleSettings& turtle) {
  const uint64_t limit = derivation.settings.max_modules;
  spend(derivation, derivation.grammar.rules.size());
  const GrowthBound bound = boundGrowth(derivation, string);
  if (bound.exact && bound.length > double(limit)) failLimit(derivation, bound);
  const double most = std::min(bound.length, double(limit));
  requireMemory({"generation " + std::to_string(derivation.pass) + " with up to " + countText(most) + " symbols",
                 kBytesPerModule * (most + double(string.modules.size())), "use fewer generations, or lower max_modules"},
                derivation.settings.memory_limit, derivation.grammar.file);
  ModuleString next;
  next.file = string.file;
  next.modules.reserve(size_t(most));
  if (derivation.has_contexts) findPartners(derivation, string);
  if (derivation.follows_turtle) {
    derivation.walk = startWalk(string, turtle);
    derivation.walk.records = false;
  }

  derivation.context[Builtin::kPass] = derivation.pass;
  for (size_t i = 0; i < string.modules.size(); ++i) {
    throwIfLoopsStop();
    spend(derivation, kStepsOfModule + string.modules[i].argument_count);
    const Rule* rule = chooseRule(derivation, string, i);
    if (next.modules.size() + (rule == nullptr ? 1 : rule->replacement.size()) > limit) failLimit(derivation, bound);
    if (rule == nullptr)
      appendUnchanged(string, string.modules[i], next);
    else
      appendReplacement(derivation, *rule, string.modules[i], next);
    if (next.arguments.size() > kMaxArgumentsPerModule * std::max<uint64_t>(limit, 100'000))
      throw InputError(string.file, "generation " + std::to_string(derivation.pass) + " holds more than " +
                                        formatNumber(double(next.arguments.size())) +
                                        " arguments: use fewer generations or fewer arguments");
    if (derivation.follows_turtle) {
      spend(derivation, kStepsOfTurtle);
      stepTurtle(derivation.walk, string, i);
    }
  }
  next.passes = derivation.pass;
  cutBranches(next);
  return next;
}

void report(const Derivation& derivation, Warnings& warnings) {
  const std::string place = derivation.grammar.file.empty() ? "" : derivation.grammar.file + ": ";
  const EvaluationContext& c = derivation.context;
  const std::string where = " (first in \"" + derivation.first_arithmetic + "\")";
  if (c.missing_arguments > 0)
    warnings.add(WarningKind::kGrammar, place + "a rule reads an argument that a symbol does not have; it counts as 0" + where);
  warnings.add(WarningKind::kGrammar, place + "an expression divides by 0; the result counts as 0" + where, c.divisions_by_zero);
  warnings.add(WarningKind::kGrammar, place + "asin or acos of a number beyond ±1; it counts as ±1" + where, c.clamped_arguments);
  if (derivation.percentages > 0) warnings.add(WarningKind::kGrammar, place + "a probability over 1 was read as a percentage");
  warnings.add(WarningKind::kGrammar, place + "a probability below 0 was read as 0", derivation.negative_probabilities);
}

// Checks that the settings are in range and returns the number of passes.
int checkedPasses(const Grammar& grammar, const DeriveSettings& settings) {
  if (!(settings.generations >= 0) || !std::isfinite(settings.generations)) throw InputError(grammar.file, "generations must be 0 or more");
  if (std::ceil(settings.generations) > settings.max_passes)
    throw InputError(grammar.file, formatNumber(settings.generations) + " generations are more than " +
                                       std::to_string(settings.max_passes) + ": use fewer generations or raise max_passes");
  if (settings.max_modules < 1 || settings.max_modules > 200'000'000)
    throw InputError(grammar.file, "max_modules must be from 1 to 200000000");
  if (grammar.reads_shape && settings.inner_shape.empty())
    throw InputError(grammar.file, "in(x,y,z) needs a shape: set inner_shape = [[x, y, z, radius], …]");
  return int(std::ceil(settings.generations));
}

void noteGeneration(const ModuleString& string, std::vector<SymbolCounts>* generations) {
  if (generations == nullptr) return;
  const std::array<uint64_t, 128> counts = countSymbols(string);
  SymbolCounts& noted = generations->emplace_back();
  for (size_t symbol = 0; symbol < counts.size(); ++symbol)
    if (counts[symbol] > 0) noted[char(symbol)] = counts[symbol];
}

}  // namespace

ModuleString derive(const Grammar& grammar, const DeriveSettings& settings, const TurtleSettings& turtle, Warnings& warnings,
                    std::vector<SymbolCounts>* generations) {
  const int passes = checkedPasses(grammar, settings);
  Derivation derivation{grammar, settings};
  derivation.follows_turtle = grammar.reads_turtle;
  for (const Rule& rule : grammar.rules) {
    derivation.rules_of[symbolIndex(rule.predecessor.symbol)].push_back(&rule);
    derivation.has_contexts = derivation.has_contexts || !rule.left.empty() || !rule.right.empty();
  }
  EvaluationContext& context = derivation.context;
  context.variables = grammar.variables;
  context.root = rootKey(settings.seed);
  context.inner_shape = settings.inner_shape;
  context[Builtin::kAngle] = turtle.angle;
  context[Builtin::kGravity] = turtle.gravity;
  context[Builtin::kX] = turtle.start_position.x;
  context[Builtin::kY] = turtle.start_position.y;
  context[Builtin::kZ] = turtle.start_position.z;
  context[Builtin::kStep] = turtle.step;
  context[Builtin::kWidth] = turtle.thickness;

  ModuleString string = makePremise(derivation);
  cutBranches(string);
  noteGeneration(string, generations);
  for (derivation.pass = 1; derivation.pass <= passes; ++derivation.pass) {
    string = rewrite(derivation, string, turtle);
    noteGeneration(string, generations);
  }
  string.texts = grammar.texts;
  const double whole = std::floor(settings.generations);
  string.fraction = settings.generations > whole ? settings.generations - whole : 1;
  report(derivation, warnings);
  return string;
}

}  // namespace cloudbake
