// The text of an L-system and its parsed form: premise and rules in the dialect of Houdini's L-System node.
#pragma once

#include <bitset>
#include <string>
#include <utility>
#include <vector>

#include "lsystem/expression.h"

namespace cloudbake {

/// The text that an artist wrote. Blank rule lines and lines that begin with `#` are ignored.
struct GrammarText {
  std::string file;  ///< file name for errors
  SourceLine premise;
  std::vector<SourceLine> rules;
  std::string context_ignore = "F+-";                     ///< symbols that contexts skip
  std::vector<std::pair<std::string, double>> variables;  ///< declared names; b, c and d are 0 unless declared
};

/// A module that a premise or a replacement creates.
struct ModuleTemplate {
  char symbol = 0;
  int text = -1;                        ///< index into Grammar::texts if the first argument is a text
  std::vector<Expression> arguments{};  ///< an argument without nodes was not given; the place of a text is also without nodes
};

/// A module that a rule looks for. `formals[k]` is the local that receives argument k; -1 = unnamed.
struct ModulePattern {
  char symbol = 0;
  std::vector<int> formals{};
};

/// [left<] symbol [>right] [:condition] = replacement [:probability]
struct Rule {
  ModulePattern predecessor;
  std::vector<ModulePattern> left, right;  ///< in the order written
  Expression condition, probability;       ///< without nodes if not given
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
  std::vector<double> variables;   ///< values, in the order that the expressions were compiled with
  std::vector<std::string> texts;  ///< texts of a("name",…)
  bool reads_turtle = false;       ///< a rule needs the turtle's state
  bool reads_shape = false;        ///< an expression calls in()
};

/// Parses premise and rules. Throws InputError with file, line and column. Warns (kGrammar) about rules that can never fire, are
/// shadowed, or whose probabilities exceed 1; about argument names that hide a variable; and about symbols that mean something else in
/// other programs.
Grammar parseGrammar(const GrammarText& text, Warnings& warnings);

}  // namespace cloudbake
