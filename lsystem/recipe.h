// A cloud as a file: grammar and settings in TOML, or a plain list of rules.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/text/value_form.h"
#include "lsystem/derive.h"
#include "lsystem/grammar.h"
#include "lsystem/spheres.h"
#include "lsystem/turtle.h"

namespace cloudbake {

/// A key of the tables [bake] and [sequence], which the command line's reader interprets. `value` is written as on the command line.
struct RecipeOption {
  std::string key, value;
  int line = 0;
};

/// Everything that a cloud is grown from. Fields may be changed before `growSpheres` is called.
struct CloudRecipe {
  GrammarText grammar;
  DeriveSettings derive;
  TurtleSettings turtle;
  SphereSettings spheres;
  std::vector<RecipeOption> bake_options;  ///< in the order of the file
  std::vector<RecipeOption> sequence_options;
};

struct RecipeReading;

/// A key of a recipe that is one value, and the option of the command line that sets it.
struct RecipeKey {
  const char* table;  ///< empty: the top level
  const char* name;
  void (*read)(const RecipeKey& key, RecipeReading& reading);
  ValueForm form;
  const char* unit;  ///< placeholder of the option's value; empty: the option of this name sets more than the recipe
  const char* help;
  bool is_common = false;  ///< --help shows it
};
/// All of them, table by table in the order of the help.
std::span<const RecipeKey> recipeKeys();

/// Reads a recipe in TOML: recipeKeys(), and
///   top level     rules (array of '…' or one '''…'''), inner_shape = [[x, y, z, radius], …]
///   [variables]   any name = number
///   [bake], [sequence]   not interpreted
/// `name` is the file name in errors. Throws InputError with file, line and column for more than 2 MiB, a syntax error, an unknown key
/// (with the nearest known one), a wrong type or a value out of range. The grammar itself is parsed by `parseGrammar`.
CloudRecipe parseRecipe(const std::string& text, const std::string& name);

/// Reads a plain list of rules, one per line. The header lines `premise: …` and `context_ignore: …` are optional. All settings keep
/// their defaults. `name` is the file name in errors. Throws InputError for more than 2 MiB and for a header that appears twice.
CloudRecipe parseRules(const std::string& text, const std::string& name);

/// Sets one of recipeKeys() from a command line. The value is a number, true or false, a text without
/// quotes, a list such as 4,2,4 or 4x2x4, or none for a key that may be left out. The key "variable" declares variables: its value is
/// `NAME=NUMBER` or `NAME=NUMBER,…`.
/// Throws InputError, without a place, for an unknown key or a value that the key does not accept.
void setRecipeKey(CloudRecipe& recipe, const std::string& key, const std::string& value);

/// Parses, derives, walks and makes the spheres. `seed` replaces the recipe's seed. Throws and warns as its four stages do.
/// Fills `summary` if it is given.
std::vector<Sphere> growSpheres(const CloudRecipe& recipe, uint64_t seed, Warnings& warnings, GrowthSummary* summary = nullptr);

}  // namespace cloudbake
