// The commands, and what the help, the man page and the shells' completions tell of all of them. Each takes its settings (input and
// output set) and runs to its exit code; errors are thrown.
#pragma once

#include <functional>

#include "pipeline/options.h"
#include "core/error.h"

namespace cloudbake {

/// Sets on Settings what the command line gave: applied last, over a recipe's own [bake] table.
using ApplyCommandLine = std::function<void(Settings&)>;

struct CommandSpec {
  Command bit;
  const char* name;
  const char* input;  ///< placeholder of what it works on
  const char* help;
  const char* examples;  ///< "Examples:", then a command per line
  const char* output;    ///< placeholder of -o: a FILE is needed, a DIR is not; empty: there is no -o
  ExitCode (*run)(Settings, const ApplyCommandLine&);
  const char* output_help = "file to write";
};

inline constexpr const char* kQuietHelp = "print warnings and errors only";

struct ExitCodeText {
  ExitCode code;
  const char* meaning;
};
inline constexpr ExitCodeText kExitCodes[] = {
    {ExitCode::kDone, "done"},
    {ExitCode::kUsage, "wrong command line"},
    {ExitCode::kSystem, "the system refused (missing file, permission, disk)"},
    {ExitCode::kInput, "an input is unusable or over a limit"},
    {ExitCode::kInternal, "internal error"},
    {ExitCode::kBound, "a bound was exceeded, or some assets of a batch failed"},
    {ExitCode::kTryAgain, "try again later"},
    {ExitCode::kInterrupted, "stopped by SIGINT (Ctrl-C)"},
    {ExitCode::kTerminated, "stopped by SIGTERM"},
};

ExitCode runGrow(Settings settings, const ApplyCommandLine& apply_command_line);
ExitCode runBake(Settings settings, const ApplyCommandLine& apply_command_line);
ExitCode runPreview(Settings settings, const ApplyCommandLine& apply_command_line);
ExitCode runCheck(Settings settings, const ApplyCommandLine& apply_command_line);
ExitCode runMeasure(Settings settings, const ApplyCommandLine& apply_command_line);

struct AssetOption;
/// `given` are the options of assets on the command line.
ExitCode runBatch(Settings settings, const std::vector<AssetOption>& given);

}  // namespace cloudbake
