// Derivation: rewrites the premise, all modules at once, as often as asked.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/types.h"
#include "lsystem/grammar.h"
#include "lsystem/module_string.h"
#include "lsystem/turtle.h"

namespace cloudbake {

using SymbolCounts = std::map<char, uint64_t>;

struct DeriveSettings {
  double generations = 7;                  ///< G >= 0; ceil(G) passes, the last one grown by the fraction
  uint64_t seed = 1;                       ///< of all random draws
  bool context_includes_siblings = false;  ///< contexts also see the sibling branches
  std::vector<Sphere> inner_shape;         ///< what in(x,y,z) asks about
  uint64_t max_modules = 2'000'000;        ///< 1 … 200 000 000
  int max_passes = 1000;
  std::optional<uint64_t>
      max_steps;  ///< work of all passes: modules, rules tried, neighbours, terms; about 3 ns each; unset: 50 max_modules, at least 1e8
};

/// Derives the string. The turtle's settings supply the variables a and T, and x y z A L U V W where a rule reads them.
/// Throws InputError where a limit would be exceeded (naming generation and rule), a value is not finite, or a setting is out of
/// range. Warns (kGrammar) of missing arguments, divisions by 0, clamped arcs, probabilities over 1 or below 0.
/// Adds to `generations`, if given, how often each symbol stands in the string, from the premise on.
ModuleString derive(const Grammar& grammar, const DeriveSettings& settings, const TurtleSettings& turtle, Warnings& warnings,
                    std::vector<SymbolCounts>* generations = nullptr);

}  // namespace cloudbake
