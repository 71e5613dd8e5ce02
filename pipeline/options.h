// Every option of every command, in one table: name, unit, range, default, help, what it sets, what it excludes or needs. The command line,
// the [bake] table of a recipe and the manifest of a batch read the same table. It lies in pipeline/ and not in app/ because manifests,
// recipes and other front ends set options too.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/settings.h"

namespace cloudbake {

/// Commands that an option belongs to, as bits.
enum Command : unsigned { kGrow = 1, kBake = 2, kPreview = 4, kMeasure = 8, kBatch = 16, kCheck = 32 };

/// What an option that was given does not go with: `broken` sees the settings as they will be. The message follows "--NAME".
struct OptionRule {
  bool (*broken)(const Settings& settings) = nullptr;
  const char* message = "";
};

struct Option {
  const char* name;      ///< long name without dashes; in TOML with _ for -
  const char* unit;      ///< placeholder in the help, empty for a flag
  const char* fallback;  ///< default as text, empty where there is none
  const char* help;
  unsigned commands;  ///< that take it
  unsigned common;    ///< of these, those whose --help shows it; --help-all shows all
  unsigned inputs;    ///< InputBits: what it means something to
  bool in_recipe;     ///< may be set in a [bake] table
  void (*set)(Settings& settings, const Option& option, const std::string& value);  ///< throws UsageError; null where stands_for is set
  const char* group = "Options";                                                    ///< heading in the help
  std::array<OptionRule, 3> rules{};
  const char* stands_for = "";  ///< "NAME=VALUE NAME=VALUE …": the flag is a short name for these options
};

/// The table, in the order of the help.
std::span<const Option> optionTable();

/// The option of that name, with _ or -, of a command; null where there is none.
const Option* findOption(std::string_view name, Command command);
/// The option of that name, with _ or -, if it is one of a single asset: what a manifest may set. Else null.
const Option* findAssetOption(std::string_view name);

/// The values of an option that takes one of a few names, for completion; empty for numbers, files, free text and flags.
std::vector<std::string> optionChoices(const Option& option);

/// Whether the name ends in .vdb, in any case.
bool isVdbFile(const std::filesystem::path& file);

/// An option that was given, and where.
struct Given {
  const Option* option = nullptr;
  std::string value;
  std::string file;  ///< empty: on the command line
  int line = 0, column = 0;
};

/// Whether an option of that name is among them.
bool isGiven(std::span<const Given> given, std::string_view name);

}  // namespace cloudbake
