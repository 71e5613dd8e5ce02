// The text of an L-system and its parsed form: premise and rules in the dialect of Houdini's L-System node.
#pragma once

#include <bitset>
#include <string>
#include <utility>
#include <vector>

#include "lsystem/expression.h"

namespace cloudbake {

/// What an artist wrote. Blank rule lines and those that begin with `#` are ignored.
struct GrammarText {
  std::string file;  ///< named in every error
  SourceLine premise;
  std::vector<SourceLine> rules;
  std::string context_ignore = "F+-";                     ///< symbols that contexts skip
  std::vector<std::pair<std::string, double>> variables;  ///< declared names; b, c and d are 0 unless declared
};

/// A module that a premise or a replacement makes.
struct ModuleTemplate {
  char symbol = 0;
  int text = -1;                        ///< index into Grammar::texts where the first argument is a text
  std::vector<Expression> arguments{};  ///< without nodes = not given; a text's place is not given either
};

/// A module that a rule looks for. `formals[k]` is the local that takes argument k, -1 = unnamed.
struct ModulePattern {
  char symbol = 0;
  std::vector<int> formals{};
};

/// [left<] symbol [>right] [:condition] = replacement [:probability]
struct Rule {
  ModulePattern predecessor;
  std::vector<ModulePattern> left, right;  ///< in the order written
  Expression condition, probability;       ///< without nodes = not given
  std::vector<ModuleTemplate> replacement;
  int local_count = 0;
  int line = 0, column = 0;  ///< where the rule begins in the file
  std::string text;          ///< as written, without blanks
};

struct Grammar {
  std::string file;
  SourceLine premise_source;
  std::vector<ModuleTemplate> premise;
  std::vector<Rule> rules;
  std::bitset<128> context_ignore;
  std::vector<double> variables;   ///< values, in the order the expressions were compiled with
  std::vector<std::string> texts;  ///< texts of a("name",…)
  bool reads_turtle = false;       ///< a rule needs the turtle's state
  bool reads_shape = false;        ///< an expression calls in()
};

/// Parses premise and rules. Throws InputError with file, line and column. Warns (kGrammar) of rules that can never fire, are
/// shadowed, or whose probabilities exceed 1; of formals that hide a variable; of symbols that mean something else elsewhere.
Grammar parseGrammar(const GrammarText& text, Warnings& warnings);

}  // namespace cloudbake
