// Derivation: rewrites the premise, all modules in parallel, for a given number of passes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/memory_budget.h"
#include "core/types.h"
#include "lsystem/grammar.h"
#include "lsystem/module_string.h"
#include "lsystem/turtle.h"

namespace cloudbake {

using SymbolCounts = std::map<char, uint64_t>;

struct DeriveSettings {
  double generations = 7;                  ///< G >= 0: ceil(G) passes; modules of the last pass grow by the fraction
  uint64_t seed = 1;                       ///< seed of all random draws
  bool context_includes_siblings = false;  ///< contexts also see the sibling branches
  std::vector<Sphere> inner_shape;         ///< the shape that in(x,y,z) tests
  uint64_t max_modules = 2'000'000;        ///< 1 … 200 000 000
  int max_passes = 1000;
  std::optional<uint64_t> max_steps;  ///< limit of the work of all passes: modules, rules tried, neighbours, terms; about 3 ns each; unset
                                      ///< = 50 max_modules, at least 1e8
  uint64_t memory_limit = kMemoryLimit;  ///< bytes
};

/// Derives the string. The turtle's settings supply the variables a and T, and also x y z A L U V W if a rule reads them.
/// Throws InputError if a limit would be exceeded (it names generation and rule), a value is not finite, or a setting is out of
/// range. Warns (kGrammar) about missing arguments, divisions by 0, clamped arguments of asin and acos, and probabilities over 1 or below
/// 0. If `generations` is given, appends the number of each symbol in the string, one entry per generation from the premise on.
ModuleString derive(const Grammar& grammar, const DeriveSettings& settings, const TurtleSettings& turtle, Warnings& warnings,
                    std::vector<SymbolCounts>* generations = nullptr);

}  // namespace cloudbake
