// The table of all options of all commands: name, unit, range, default, help, the setting, and what the option excludes or needs. The
// command line, the [bake] table of a recipe and the manifest of a batch use it. It is in pipeline/ and not in app/ because manifests,
// recipes and other front ends set options too.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/settings.h"

namespace cloudbake {

/// The commands that accept an option, as bits.
enum Command : unsigned { kGrow = 1, kBake = 2, kPreview = 4, kMeasure = 8, kBatch = 16, kCheck = 32, kView = 64, kShader = 128 };

/// A rule for an option that was given. `broken` tests the final settings. The error is "--NAME" followed by `message`.
struct OptionRule {
  bool (*broken)(const Settings& settings) = nullptr;
  const char* message = "";
};

/// The kind of file that the value of an option names.
struct FileUse {
  enum Kind {
    kNone,
    kRead,     ///< a file
    kWritten,  ///< a file, and more whose names begin like its own
    kStem,     ///< the beginning of the names of several files, or a file if it has the extension
    kLevels    ///< nothing, but a list with a level of detail per value, each of which is written beside the output (levelFile)
  } kind = kNone;
  const char* extensions = "";  ///< of what is written, joined by spaces, the usual one first; empty: checked elsewhere
  const char* endings = "";     ///< of the further files, joined by spaces; patterns of fnmatch(3)
};

struct Option {
  const char* name;      ///< long name without dashes; in TOML with _ for -
  const char* unit;      ///< placeholder in the help, empty for a flag; in brackets if the command line may leave the value out: `fallback`
  const char* fallback;  ///< default as text, empty if there is none
  const char* help;
  unsigned commands;  ///< that accept it
  unsigned common;    ///< those of them whose --help shows it; --help-all shows every option
  unsigned inputs;    ///< InputBits: the kinds of input that it applies to
  bool in_recipe;     ///< may be set in a [bake] table
  void (*set)(Settings& settings, const Option& option, const std::string& value);  ///< throws UsageError; null if stands_for is set
  const char* group = "Options";                                                    ///< heading in the help
  std::array<OptionRule, 3> rules{};
  const char* stands_for = "";  ///< "NAME=VALUE NAME=VALUE …": the flag is a shorthand for these options
  FileUse files{};
};

/// The table, in the order of the help.
std::span<const Option> optionTable();

/// The command's option of this name, written with _ or -; null if there is none.
const Option* findOption(std::string_view name, Command command);
/// The option of this name, written with _ or -, if it applies to a single asset, so that a manifest may set it; else null.
const Option* findAssetOption(std::string_view name);

/// Whether the command line may leave out the value of an option with this unit.
inline bool isOptionalUnit(std::string_view unit) { return unit.starts_with('['); }

/// Whether this is an option of the bake of `view --watch`. Without --watch, view does not take it.
inline bool needsWatch(const Option& option) { return (option.commands & (kBake | kView | kPreview)) == (kBake | kView); }

/// Whether the option is about a file that is read, so that it does not apply to a mesh in memory.
bool isOfFiles(const Option& option);

/// The heading of the option in the help of a command.
std::string_view groupOf(const Option& option, Command command);

/// The possible values of an option that takes one of a few names, for completion; empty for numbers, files, free text and flags.
std::vector<std::string> optionChoices(const Option& option);

/// Whether the name ends in .vdb, in lower or upper case.
bool isVdbFile(const std::filesystem::path& file);

/// An option that was given, with its value and place.
struct Given {
  const Option* option = nullptr;
  std::string value;
  std::string file;  ///< empty: on the command line
  int line = 0, column = 0;
};

/// Whether an option of this name was given.
bool isGiven(std::span<const Given> given, std::string_view name);

}  // namespace cloudbake
