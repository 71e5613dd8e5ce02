// The string of modules that rules rewrite and the turtle reads.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace cloudbake {

/// One symbol with its arguments.
struct Module {
  char symbol = 0;
  uint16_t argument_count = 0;
  int32_t birth = 0;            ///< the pass that created it; 0 = premise
  uint32_t first_argument = 0;  ///< index into ModuleString::arguments
  int32_t text = -1;            ///< index into ModuleString::texts if the first argument is a text
  uint64_t key = 0;             ///< place in the derivation (lsystem/keys.h)
};

/// The value of an argument that was not given, such as the first two of J(,,4).
constexpr double kOmittedArgument = std::numeric_limits<double>::quiet_NaN();

struct ModuleString {
  std::vector<Module> modules;
  std::vector<double> arguments;  ///< finite, or kOmittedArgument
  std::vector<std::string> texts;
  int passes = 0;       ///< n: the number of times that the premise was rewritten
  double fraction = 1;  ///< f in (0, 1]: how far the modules born in the last pass have grown
  std::string file;     ///< the grammar's file, for errors
};

/// Argument k of a module, or `fallback` if the argument was not given.
inline double argumentOr(const ModuleString& string, const Module& module, size_t k, double fallback) {
  if (k >= module.argument_count) return fallback;
  const double value = string.arguments[module.first_argument + k];
  return std::isnan(value) ? fallback : value;
}

/// How far a module has grown: f for those born in the last pass, else 1.
inline double growthOf(const ModuleString& string, const Module& module) {
  return string.passes > 0 && module.birth == string.passes ? string.fraction : 1;
}

/// The string as text, e.g. `F(1)+(90)J(,,4)`. If `limit` > 0, the text is cut off there and ends with an ellipsis.
std::string printModules(const ModuleString& string, bool with_arguments = true, size_t limit = 0);

}  // namespace cloudbake
