// Recursive descent for the grammar of the L-system notes, section 2. Operators from loosest to tightest:
//   | · & · == = != · < <= > >= · + - · * / % · unary - + ! · ^ (right-associative, so that -2^2 = -4)
// `if`, `&` and `|` evaluate only the operands that they need. A rand() call is numbered by its place in the text of the rule, so
// that no draw depends on which operands were evaluated. Angles are in degrees.
#include "lsystem/expression.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/error.h"
#include "core/portable_math.h"
#include "core/text/nearest.h"
#include "core/text/scan.h"
#include "lsystem/keys.h"

namespace cloudbake {

namespace {

struct Function {
  const char* name;
  int arguments;
  Operation operation;
};
constexpr std::array<Function, 20> kFunctions{
    {{"min", 2, Operation::kMin},   {"max", 2, Operation::kMax},     {"sin", 1, Operation::kSin},     {"cos", 1, Operation::kCos},
     {"tan", 1, Operation::kTan},   {"asin", 1, Operation::kAsin},   {"acos", 1, Operation::kAcos},   {"atan2", 2, Operation::kAtan2},
     {"abs", 1, Operation::kAbs},   {"floor", 1, Operation::kFloor}, {"ceil", 1, Operation::kCeil},   {"round", 1, Operation::kRound},
     {"sqrt", 1, Operation::kSqrt}, {"pow", 2, Operation::kPower},   {"clamp", 3, Operation::kClamp}, {"fit01", 3, Operation::kFit01},
     {"if", 3, Operation::kIf},     {"in", 3, Operation::kIn},       {"rand", 1, Operation::kRandOf}, {"rand", 0, Operation::kRandCall}}};

struct BinaryOperator {
  std::string_view symbol;
  int level;  // 0 binds loosest
  Operation operation;
};
// Longer symbols first, so that `<=` is not read as `<`.
constexpr std::array<BinaryOperator, 14> kOperators{{{"==", 2, Operation::kEqual},
                                                     {"!=", 2, Operation::kNotEqual},
                                                     {"<=", 3, Operation::kLessEqual},
                                                     {">=", 3, Operation::kGreaterEqual},
                                                     {"|", 0, Operation::kOr},
                                                     {"&", 1, Operation::kAnd},
                                                     {"=", 2, Operation::kEqual},
                                                     {"<", 3, Operation::kLess},
                                                     {">", 3, Operation::kGreater},
                                                     {"+", 4, Operation::kAdd},
                                                     {"-", 4, Operation::kSubtract},
                                                     {"*", 5, Operation::kMultiply},
                                                     {"/", 5, Operation::kDivide},
                                                     {"%", 5, Operation::kModulo}}};

// Number of extra steps that a slow term counts as, proportional to its time.
constexpr uint64_t kSlowSteps = 15, kLongDivisionSteps = 200;
constexpr bool isSlow(Operation o) {
  return o == Operation::kPower || o == Operation::kModulo || (o >= Operation::kSin && o <= Operation::kAtan2);
}

bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

struct Parser {
  const PlainText& text;
  size_t position, end;
  const NameScope& scope;
  int& rand_calls;
  int depth = 0;
  Expression expression{};
  std::vector<int> heights{};  // height of the tree under each node

  std::string_view rest() const { return std::string_view(text.characters).substr(position, end - position); }
  bool at(char c) const { return position < end && text.characters[position] == c; }
};

int parseLevel(Parser& parser, int level);

int addNode(Parser& parser, const ExpressionNode& node) {
  int height = 1;
  for (const int operand : node.operands)
    if (operand >= 0) height = std::max(height, parser.heights[size_t(operand)] + 1);
  if (height > kMaxExpressionDepth)
    failAt(parser.text, parser.position, "this expression is more than 200 levels deep: split it over several arguments or rules");
  parser.expression.nodes.push_back(node);
  parser.heights.push_back(height);
  return int(parser.expression.nodes.size()) - 1;
}

int parseLiteral(Parser& parser) {
  const char* first = parser.text.characters.data() + parser.position;
  const char* last = parser.text.characters.data() + parser.end;
  double value = 0;
  const auto [stop, error] = std::from_chars(first, last, value);
  if (error == std::errc::result_out_of_range)
    failAt(parser.text, parser.position,
           "the number " + quotedWord({first, size_t(stop - first)}) + " is beyond what can be computed with: 1e-300 to 1e300");
  if (error != std::errc()) failAt(parser.text, parser.position, "this number cannot be read: write it as 12, 0.5 or 1e-3");
  parser.position += size_t(stop - first);
  return addNode(parser, {Operation::kConstant, {-1, -1, -1}, 0, value});
}

int indexOf(const std::vector<std::string>& names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : int(found - names.begin());
}

int parseVariable(Parser& parser, const std::string& name, size_t start) {
  if (const int local = indexOf(parser.scope.locals, name); local >= 0) return addNode(parser, {Operation::kLocal, {-1, -1, -1}, local, 0});
  if (const int variable = indexOf(parser.scope.variables, name); variable >= 0)
    return addNode(parser, {Operation::kVariable, {-1, -1, -1}, variable, 0});
  for (size_t i = 0; i < kBuiltinNames.size(); ++i)
    if (name == kBuiltinNames[i]) return addNode(parser, {Operation::kBuiltin, {-1, -1, -1}, int(i), 0});

  std::vector<std::string> known = parser.scope.locals;
  known.insert(known.end(), parser.scope.variables.begin(), parser.scope.variables.end());
  known.insert(known.end(), kBuiltinNames.begin(), kBuiltinNames.end());
  std::string cure = name.size() > 1 ? nearestName(name, known) : "";
  if (cure.empty()) cure = ": make it an argument on the rule's left side, or declare it under [variables]";
  failAt(parser.text, start, "unknown variable \"" + name + "\"" + cure);
}

void refuseUnknownFunction(const Parser& parser, const std::string& name, size_t start) {
  for (const char* houdini : {"ch", "chs", "chf", "chan", "pic"})
    if (name == houdini)
      failAt(parser.text, start,
             name + "() reads a Houdini scene, which is not available here: write its value, or declare a variable for it");
  std::vector<std::string> known;
  std::string list;
  for (const Function& f : kFunctions) {
    if (name == f.name) return;
    known.emplace_back(f.name);
    if (f.arguments > 0) list += std::string(" ") + f.name;
  }
  const std::string nearest = nearestName(name, known);
  failAt(parser.text, start, "unknown function \"" + name + "\"" + (nearest.empty() ? ": the functions are" + list : nearest));
}

int parseCall(Parser& parser, const std::string& name, size_t start) {
  refuseUnknownFunction(parser, name, start);
  std::vector<int> arguments;
  ++parser.position;
  while (!parser.at(')')) {
    arguments.push_back(parseLevel(parser, 0));
    if (parser.at(',') && parser.position + 1 < parser.end) {
      ++parser.position;
      if (parser.at(')')) failAt(parser.text, parser.position, "an argument of " + name + "() is missing here");
    } else if (!parser.at(')')) {
      failAt(parser.text, parser.position, "expected \",\" or \")\" in the arguments of " + name + "()");
    }
  }
  ++parser.position;
  std::string counts;
  for (const Function& f : kFunctions) {
    if (name != f.name) continue;
    if (size_t(f.arguments) != arguments.size()) {
      counts += (counts.empty() ? "" : " or ") + std::to_string(f.arguments);
      continue;
    }
    ExpressionNode node{f.operation, {-1, -1, -1}, 0, 0};
    std::copy(arguments.begin(), arguments.end(), node.operands.begin());
    if (f.operation == Operation::kRandCall) node.index = parser.rand_calls++;
    return addNode(parser, node);
  }
  failAt(parser.text, start, name + "() takes " + counts + " argument(s), not " + std::to_string(arguments.size()));
}

int parsePrimary(Parser& parser) {
  if (parser.position >= parser.end) failAt(parser.text, parser.position, "the expression ends where a value is expected");
  const size_t start = parser.position;
  const char c = parser.text.characters[start];
  if (isDigit(c) || c == '.') return parseLiteral(parser);
  if (isLetter(c)) {
    while (parser.position < parser.end &&
           (isLetter(parser.text.characters[parser.position]) || isDigit(parser.text.characters[parser.position])))
      ++parser.position;
    const std::string name = parser.text.characters.substr(start, parser.position - start);
    return parser.at('(') ? parseCall(parser, name, start) : parseVariable(parser, name, start);
  }
  if (c == '(') {
    ++parser.position;
    const int inner = parseLevel(parser, 0);
    if (!parser.at(')')) failAt(parser.text, start, "this \"(\" is never closed: add a \")\"");
    ++parser.position;
    return inner;
  }
  if (c == '$')
    failAt(parser.text, start, "Houdini variables such as $F are not available here: write the value, or declare a variable for it");
  if (c == '"') failAt(parser.text, start, "a text can only be the first argument of a(\"name\",…)");
  failAt(parser.text, start, std::string("expected a value, found \"") + c + "\"");
}

// unary := (- | + | !) unary | primary [^ unary]
int parseUnary(Parser& parser) {
  if (++parser.depth > kMaxExpressionDepth)
    failAt(parser.text, parser.position, "this expression is more than 200 levels deep: split it over several arguments or rules");
  int node = -1;
  if (parser.at('-') || parser.at('!')) {
    const Operation operation = parser.at('-') ? Operation::kNegate : Operation::kNot;
    ++parser.position;
    node = addNode(parser, {operation, {parseUnary(parser), -1, -1}, 0, 0});
  } else if (parser.at('+')) {
    ++parser.position;
    node = parseUnary(parser);
  } else {
    node = parsePrimary(parser);
    if (parser.at('^')) {
      ++parser.position;
      node = addNode(parser, {Operation::kPower, {node, parseUnary(parser), -1}, 0, 0});
    }
  }
  --parser.depth;
  return node;
}

const BinaryOperator* operatorAt(const Parser& parser) {
  for (const BinaryOperator& candidate : kOperators)
    if (parser.rest().starts_with(candidate.symbol)) return &candidate;
  return nullptr;
}

// All binary operators are left-associative: precedence climbing.
int parseLevel(Parser& parser, int level) {
  int left = parseUnary(parser);
  for (;;) {
    const BinaryOperator* found = operatorAt(parser);
    if (found == nullptr || found->level < level) return left;
    parser.position += found->symbol.size();
    const int right = parseLevel(parser, found->level + 1);
    left = addNode(parser, {found->operation, {left, right, -1}, 0, 0});
  }
}

bool insideShape(std::span<const Sphere> shape, double x, double y, double z) {
  return std::any_of(shape.begin(), shape.end(), [=](const Sphere& s) {
    const double dx = x - s.center.x, dy = y - s.center.y, dz = z - s.center.z;
    return dx * dx + dy * dy + dz * dz <= double(s.radius) * s.radius;
  });
}

// Clamps to [-1, 1]. Counts only values that rounding cannot explain.
double clampUnit(double x, EvaluationContext& context) {
  if (std::fabs(x) > 1 + 1e-6) ++context.clamped_arguments;
  return std::clamp(x, -1.0, 1.0);
}

// x/0 = x%0 = 0; such divisions are counted.
double divide(double a, double b, bool remainder, EvaluationContext& context) {
  if (b == 0) {
    ++context.divisions_by_zero;
    return 0;
  }
  if (!remainder) return a / b;
  // fmod is exact in either precision. Long double is far quicker if a is much larger than b.
  if (std::fabs(a) * 0x1p-63 > std::fabs(b)) context.steps += kLongDivisionSteps;
  return double(std::fmod(static_cast<long double>(a), static_cast<long double>(b)));
}

double applyFunction(Operation operation, const double (&v)[3], EvaluationContext& context) {
  switch (operation) {
    case Operation::kMin: return v[1] < v[0] ? v[1] : v[0];
    case Operation::kMax: return v[1] > v[0] ? v[1] : v[0];
    case Operation::kSin: return sinCosDegrees(v[0]).sin;
    case Operation::kCos: return sinCosDegrees(v[0]).cos;
    case Operation::kTan: return tanDegrees(v[0]);
    case Operation::kAsin: return asinDegrees(clampUnit(v[0], context));
    case Operation::kAcos: return acosDegrees(clampUnit(v[0], context));
    case Operation::kAtan2: return atan2Degrees(v[0], v[1]);
    case Operation::kAbs: return std::fabs(v[0]);
    case Operation::kFloor: return std::floor(v[0]);
    case Operation::kCeil: return std::ceil(v[0]);
    case Operation::kRound: return std::round(v[0]);
    case Operation::kSqrt: return std::sqrt(v[0]);
    case Operation::kClamp: return v[0] < v[1] ? v[1] : v[0] > v[2] ? v[2] : v[0];
    case Operation::kFit01: return v[1] + (v[2] - v[1]) * (v[0] < 0 ? 0 : v[0] > 1 ? 1 : v[0]);
    case Operation::kRandOf: return drawUniform(mix64(std::bit_cast<uint64_t>(v[0] + 0.0) ^ context.root), DrawChannel::kFunction, 0);
    case Operation::kIn: context.steps += context.inner_shape.size(); return insideShape(context.inner_shape, v[0], v[1], v[2]);
    default: return std::nan("");
  }
}

double applyOperator(Operation operation, const double (&v)[3], EvaluationContext& context) {
  switch (operation) {
    case Operation::kEqual: return nearlyEqual(v[0], v[1]);
    case Operation::kNotEqual: return !nearlyEqual(v[0], v[1]);
    case Operation::kLess: return v[0] < v[1] && !nearlyEqual(v[0], v[1]);
    case Operation::kLessEqual: return v[0] < v[1] || nearlyEqual(v[0], v[1]);
    case Operation::kGreater: return v[0] > v[1] && !nearlyEqual(v[0], v[1]);
    case Operation::kGreaterEqual: return v[0] > v[1] || nearlyEqual(v[0], v[1]);
    case Operation::kAdd: return v[0] + v[1];
    case Operation::kSubtract: return v[0] - v[1];
    case Operation::kMultiply: return v[0] * v[1];
    case Operation::kDivide: return divide(v[0], v[1], false, context);
    case Operation::kModulo: return divide(v[0], v[1], true, context);
    case Operation::kPower: return portablePow(v[0], v[1]);
    default: return applyFunction(operation, v, context);
  }
}

double evaluateNode(const Expression& expression, int root, EvaluationContext& context) {
  const ExpressionNode& node = expression.nodes[size_t(root)];
  context.steps += 1 + (isSlow(node.operation) ? kSlowSteps : 0);
  const auto operand = [&](size_t k) { return evaluateNode(expression, node.operands[k], context); };
  switch (node.operation) {
    case Operation::kConstant: return node.value;
    case Operation::kLocal: {
      const double value = context.locals[size_t(node.index)];
      if (!std::isnan(value)) return value;
      ++context.missing_arguments;
      return 0;
    }
    case Operation::kVariable: return context.variables[size_t(node.index)];
    case Operation::kBuiltin: return context.builtins[size_t(node.index)];
    case Operation::kOr: return operand(0) != 0 || operand(1) != 0;
    case Operation::kAnd: return operand(0) != 0 && operand(1) != 0;
    case Operation::kNegate: return -operand(0);
    case Operation::kNot: return operand(0) == 0;
    case Operation::kIf: return operand(0) != 0 ? operand(1) : operand(2);
    case Operation::kRandCall: return drawUniform(context.key, DrawChannel::kFunction, uint64_t(node.index));
    default: break;
  }

  // All other operators need the values of all their operands, left to right.
  double v[3] = {0, 0, 0};
  for (size_t k = 0; k < 3 && node.operands[k] >= 0; ++k) v[k] = operand(k);
  return applyOperator(node.operation, v, context);
}

template <class Predicate>
bool anyNode(const Expression& expression, Predicate predicate) {
  return std::any_of(expression.nodes.begin(), expression.nodes.end(), predicate);
}

}  // namespace

bool nearlyEqual(double a, double b) { return a == b || std::fabs(a - b) <= 1e-6 * std::max({1.0, std::fabs(a), std::fabs(b)}); }

Expression compileExpression(const PlainText& text, size_t begin, size_t end, const NameScope& scope, int& rand_calls) {
  Parser parser{text, begin, end, scope, rand_calls};
  parseLevel(parser, 0);
  if (parser.position < end) {
    const char c = text.characters[parser.position];
    failAt(text, parser.position, std::string("unexpected \"") + c + "\" in the expression: add an operator before it, or remove it");
  }
  return std::move(parser.expression);
}

double evaluate(const Expression& expression, EvaluationContext& context) {
  return evaluateNode(expression, int(expression.nodes.size()) - 1, context);
}

std::optional<double> constantValue(const Expression& expression) {
  const bool varies = anyNode(expression, [](const ExpressionNode& node) {
    return (node.operation >= Operation::kLocal && node.operation <= Operation::kBuiltin) || node.operation >= Operation::kRandCall;
  });
  if (varies) return std::nullopt;
  EvaluationContext context;
  return evaluate(expression, context);
}

bool readsTurtle(const Expression& expression) {
  return anyNode(expression,
                 [](const ExpressionNode& node) { return node.operation == Operation::kBuiltin && node.index >= int(Builtin::kX); });
}

bool readsShape(const Expression& expression) {
  return anyNode(expression, [](const ExpressionNode& node) { return node.operation == Operation::kIn; });
}

}  // namespace cloudbake
