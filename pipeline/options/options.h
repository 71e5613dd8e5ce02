// The table of all options of all commands: name, unit, the values that it takes and the setting that they set, help, and what the option
// excludes or needs. The command line, the [bake] table of a recipe, the manifest of a batch, Python, the page that bakes and Blender's
// add-on use it. It is here and not in app/ because manifests, recipes and other front ends set options too.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/text/value_form.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// The commands that accept an option, as bits.
enum Command : unsigned {
  kGrow = 1,
  kBake = 2,
  kPreview = 4,
  kMeasure = 8,
  kBatch = 16,
  kCheck = 32,
  kView = 64,
  kShader = 128,
  kShadow = 256,
  kImpostor = 512,
  kPlan = 1024,
  kSequence = 2048
};

/// Where an option is offered, as bits.
enum OptionBits : unsigned {
  kInRecipe = 1,          ///< in the [bake] table of a recipe
  kOfRun = 2,             ///< is about the run, not about an asset: no key of a manifest
  kOfInputFile = 4,       ///< is about the file that is read: not for a mesh in memory
  kOfOutputFiles = 8,     ///< is about files that are written: no keyword of Python
  kNotOnPage = 16,        ///< the page that bakes does not show it, which has no use for it or lacks its library (web/refusals.cpp)
  kNotInBlender = 32,     ///< the add-on sets it itself, or has no use for it
  kInBlendersPanel = 64,  ///< has a field of its own in the panel of the add-on
  kRepeats = 128          ///< may be given several times
};

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

struct Option;

/// The values that an option takes, and what they set (pipeline/options/option_values.h makes one for a field of the settings).
struct OptionValue {
  void (*set)(Settings& settings, const Option& option, const std::string& value) = nullptr;  ///< throws UsageError
  ValueForm form;
  /// The value that is in the settings from the start; empty if there is none.
  std::string (*initial)(const Settings& settings, const Option& option) = nullptr;
};

struct Option {
  const char* name;             ///< long name without dashes; in TOML with _ for -
  const char* label = "";       ///< what the page that bakes calls it, with its unit; empty where that does not show it
  const char* unit = "";        ///< placeholder in the help, empty for a flag; in brackets if the command line may leave the value out
  OptionValue value{};          ///< sets nothing if stands_for is set
  const char* group = "";       ///< heading in the help
  unsigned commands = 0;        ///< that accept it
  unsigned common = 0;          ///< those of them whose --help shows it; --help-all shows every option
  unsigned inputs = kAnyInput;  ///< InputBits: the kinds of input that it applies to
  unsigned bits = 0;            ///< OptionBits
  const char* help = "";
  const char* fallback = "";  ///< what holds without it, where that is not value.initial; of a value that may be left out, that value
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

/// Whether only `sequence` has the option: what it takes of the frames, not how it bakes them.
inline bool isOfSequence(const Option& option) { return option.commands == kSequence; }

/// The heading of the option in the help of a command.
std::string groupOf(const Option& option, Command command);

/// The default as text, empty if there is none.
std::string defaultOf(const Option& option);

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
