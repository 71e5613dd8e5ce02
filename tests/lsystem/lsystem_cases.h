// Short ways to grow an L-system in a test.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "core/error.h"
#include "lsystem/derive.h"
#include "lsystem/grammar.h"
#include "lsystem/turtle.h"

namespace cloudbake {

/// One L-system with all its settings; step 1 and seed 1 unless a test says otherwise.
struct Case {
  GrammarText text;
  DeriveSettings settings;
  TurtleSettings turtle;
  Warnings warnings;

  Case(const std::string& premise, const std::vector<std::string>& rules, double angle = 90) {
    text.file = "test.rules";
    text.premise = {premise, 1, 1};
    for (const std::string& rule : rules) text.rules.push_back({rule, int(text.rules.size()) + 2, 1});
    turtle.step = 1;
    turtle.angle = angle;
  }

  Grammar grammar() { return parseGrammar(text, warnings); }
  ModuleString grow(double generations) {
    settings.generations = generations;
    return derive(grammar(), settings, turtle, warnings);
  }
  std::string string(double generations) { return printModules(grow(generations)); }
  std::string letters(double generations) { return printModules(grow(generations), false); }
  TurtlePath path(double generations) { return runTurtle(grow(generations), turtle, warnings); }
  /// Where the turtle stands at the end.
  Double3 end(double generations) {
    const ModuleString modules = grow(generations);
    TurtleWalk walk = startWalk(modules, turtle);
    for (size_t i = 0; i < modules.modules.size(); ++i) stepTurtle(walk, modules, i);
    return walk.state.position;
  }
  bool warned() const { return !warnings.empty(); }
  std::string warning() const { return warned() ? warnings.entries().begin()->second.first : ""; }
};

inline size_t countSymbol(const ModuleString& string, char symbol) {
  size_t count = 0;
  for (const Module& module : string.modules) count += module.symbol == symbol;
  return count;
}

inline void expectNear(Double3 actual, Double3 expected, double tolerance = 1e-6) {
  EXPECT_NEAR(actual.x, expected.x, tolerance);
  EXPECT_NEAR(actual.y, expected.y, tolerance);
  EXPECT_NEAR(actual.z, expected.z, tolerance);
}

/// Runs `action`, which must throw an InputError whose text holds `piece`; returns it.
inline InputError expectInputError(const std::function<void()>& action, const std::string& piece) {
  try {
    action();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(piece), std::string::npos) << error.what();
    return error;
  }
  ADD_FAILURE() << "no InputError; expected one with: " << piece;
  return {"", ""};
}

}  // namespace cloudbake
