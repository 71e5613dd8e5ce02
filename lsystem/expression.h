// Arithmetic in arguments, conditions and probabilities of an L-system. Each expression is compiled once to a small tree.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"
#include "lsystem/source_text.h"

namespace cloudbake {

/// Variables that every expression knows, in the order of `kBuiltinNames`.
enum class Builtin {
  kAngle,    ///< a, the angle setting, degrees
  kGravity,  ///< T, the gravity setting
  kPass,     ///< t, number of the current pass; 0 in the premise
  kAge,      ///< g, number of passes since the first pass that could rewrite the symbol
  kIndex,    ///< i, index of the module in the string being rewritten
  kX,        ///< x, y, z: the turtle's position at the module
  kY,
  kZ,
  kArc,    ///< A, length walked from the root
  kStep,   ///< L
  kWidth,  ///< W
  kU,      ///< U, V: colour index
  kV
};
constexpr std::array<const char*, 13> kBuiltinNames{"a", "T", "t", "g", "i", "x", "y", "z", "A", "L", "W", "U", "V"};

enum class Operation : uint8_t {
  kConstant,
  kLocal,
  kVariable,
  kBuiltin,
  kOr,
  kAnd,
  kEqual,
  kNotEqual,
  kLess,
  kLessEqual,
  kGreater,
  kGreaterEqual,
  kAdd,
  kSubtract,
  kMultiply,
  kDivide,
  kModulo,
  kNegate,
  kNot,
  kPower,
  kMin,
  kMax,
  kSin,
  kCos,
  kTan,
  kAsin,
  kAcos,
  kAtan2,
  kAbs,
  kFloor,
  kCeil,
  kRound,
  kSqrt,
  kClamp,
  kFit01,
  kIf,
  kRandCall,
  kRandOf,
  kIn
};

struct ExpressionNode {
  Operation operation = Operation::kConstant;
  std::array<int, 3> operands{-1, -1, -1};  ///< indices of nodes
  int index = 0;                            ///< index of the local, variable or built-in; for rand(), the number of the call
  double value = 0;                         ///< value of a constant
};

/// A compiled expression; the last node is the root.
struct Expression {
  std::vector<ExpressionNode> nodes;
};

/// The names that an expression may use besides the built-in ones. Locals hide variables, and variables hide built-ins.
struct NameScope {
  std::vector<std::string> locals;     ///< names of the rule's arguments
  std::vector<std::string> variables;  ///< declared for the grammar
};

constexpr int kMaxExpressionDepth = 200;

/// Compiles the characters [begin, end) of a line. `rand_calls` counts the rand() calls of one rule, so that each has its own number.
/// Throws InputError with line and column for a syntax error, an unknown name, a wrong number of arguments or a Houdini expression.
Expression compileExpression(const PlainText& text, size_t begin, size_t end, const NameScope& scope, int& rand_calls);

/// The inputs and counters of an evaluation. A local that is NaN is an argument that was not given; it is read as 0.
struct EvaluationContext {
  std::span<const double> locals, variables;
  std::array<double, kBuiltinNames.size()> builtins{};
  uint64_t key = 0;                     ///< key of the module being rewritten, for rand()
  uint64_t root = 0;                    ///< rootKey(seed), for rand(x)
  std::span<const Sphere> inner_shape;  ///< for in(x,y,z)
  uint64_t missing_arguments = 0, divisions_by_zero = 0, clamped_arguments = 0;
  uint64_t steps = 0;  ///< counts the work: terms evaluated (slow functions more than once), spheres compared

  double& operator[](Builtin builtin) { return builtins[size_t(builtin)]; }
};

/// The value of an expression. It may be infinite or NaN, which callers must reject.
double evaluate(const Expression& expression, EvaluationContext& context);

/// The value of a constant expression; nothing if it depends on anything.
std::optional<double> constantValue(const Expression& expression);
/// Whether the expression reads the turtle's state (x y z A L W U V).
bool readsTurtle(const Expression& expression);
/// Whether the expression calls in().
bool readsShape(const Expression& expression);

/// The dialect's equality: |a-b| <= 1e-6 max(1, |a|, |b|).
bool nearlyEqual(double a, double b);

}  // namespace cloudbake
