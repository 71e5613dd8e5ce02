// The whole chain of growSpheres (lsystem/recipe.h) on one input: text → grammar → string → path → spheres.
#include "tests/fuzz/lsystem_fuzz.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "core/error.h"
#include "tests/fuzz/recipe_maker.h"

namespace cloudbake {

namespace {

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "lsystem_fuzz: %s\n", what);
  std::abort();
}

CloudRecipe recipeFrom(const uint8_t* data, size_t size) {
  const uint8_t reader = size > 2 ? data[2] : 0;
  Choices choices{data, size, std::min(size, kFuzzHeader)};
  if (!fuzzesText(data, size)) return makeRecipe(choices);
  const std::string text(reinterpret_cast<const char*>(data) + choices.used, size - choices.used);
  return reader % 2 == 0 ? parseRecipe(text, "fuzz.toml") : parseRules(text, "fuzz.rules");
}

// Small enough that an input takes milliseconds, also with sanitizers.
void lowerLimits(CloudRecipe& recipe) {
  recipe.derive.max_modules = 20'000;
  recipe.derive.max_passes = 60;
  recipe.derive.max_steps = 1'000'000;
  recipe.turtle.max_points = 20'000;
  recipe.spheres.max_spheres = 5'000;
}

void resetLimits(CloudRecipe& recipe) {
  recipe.derive.max_modules = DeriveSettings{}.max_modules;
  recipe.derive.max_passes = DeriveSettings{}.max_passes;
  recipe.derive.max_steps = DeriveSettings{}.max_steps;
  recipe.turtle.max_depth = TurtleSettings{}.max_depth;
  recipe.turtle.max_points = TurtleSettings{}.max_points;
  recipe.spheres.max_spheres = 250'000;  // a million take seconds with sanitizers
}

std::vector<Sphere> grow(const CloudRecipe& recipe) {
  Warnings warnings;
  const ModuleString string = derive(parseGrammar(recipe.grammar, warnings), recipe.derive, recipe.turtle, warnings);
  require(printModules(string, true, 4000).size() <= 4000 + std::strlen("…"), "a printed string is longer than asked for");
  return spheresFromPath(runTurtle(string, recipe.turtle, warnings), recipe.spheres, warnings);
}

void checkSpheres(const std::vector<Sphere>& spheres) {
  require(!spheres.empty(), "a cloud without spheres was not refused");
  for (const Sphere& sphere : spheres) {
    require(isFinite(sphere.center), "the centre of a sphere is not finite");
    require(std::isfinite(sphere.radius) && sphere.radius > 0, "the radius of a sphere is not positive and finite");
  }
}

}  // namespace

bool growFuzzInput(const uint8_t* data, size_t size, std::string& message) {
  try {
    CloudRecipe recipe = recipeFrom(data, size);
    resetLimits(recipe);
    if (!fuzzesDefaultLimits(data, size)) lowerLimits(recipe);
    const std::vector<Sphere> spheres = grow(recipe);
    checkSpheres(spheres);
    // Most inputs are spared the second time.
    if (size % 4 != 0) return true;
    Warnings warnings;
    const std::vector<Sphere> again = growSpheres(recipe, recipe.derive.seed, warnings);
    require(again.size() == spheres.size() && std::memcmp(again.data(), spheres.data(), spheres.size() * sizeof(Sphere)) == 0,
            "the same seed gives other spheres");
    return true;
  } catch (const InputError& error) {
    message = error.what();
    return false;
  }
}

std::string describeFuzzInput(const uint8_t* data, size_t size) {
  if (fuzzesText(data, size))
    return {reinterpret_cast<const char*>(data) + std::min(size, kFuzzHeader), size - std::min(size, kFuzzHeader)};
  const CloudRecipe recipe = recipeFrom(data, size);
  std::string text = "premise: " + recipe.grammar.premise.text + "\ncontext_ignore: " + recipe.grammar.context_ignore + "\n";
  for (const SourceLine& rule : recipe.grammar.rules) text += rule.text + "\n";
  return text + "# generations " + std::to_string(recipe.derive.generations) + ", segments " + std::to_string(recipe.turtle.segments) +
         ", spheres of " + std::to_string(recipe.derive.inner_shape.size()) + " in the inner shape\n";
}

}  // namespace cloudbake

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::string message;
  cloudbake::growFuzzInput(data, size, message);
  return 0;
}
