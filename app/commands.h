// The commands, and the texts about them for the help, the man page and the shells' completions. Each command returns its exit code; errors
// are thrown.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/memory_budget.h"
#include "io/report/report.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/options.h"
#include "pipeline/options/run_files.h"
#include "pipeline/options/scene_needs.h"

namespace cloudbake {

struct CommandSpec;

/// The command line, before it is resolved to settings.
struct CommandLine {
  Command command;
  std::vector<Given> given;  ///< in order
  std::filesystem::path input, output;
  std::vector<std::filesystem::path> inputs;  ///< of a command that takes several
  bool quiet = false;
  uint64_t memory_limit = kMemoryLimit;  ///< bytes
  std::vector<std::string> words;        ///< all of argv
  bool is_worker = false;                ///< of a batch (app/supervise.h)
  std::filesystem::path child_program;   ///< for foreign readers (io/sculpt/child_reader.h)
};

/// Where the cloud comes from: --rules, --from-spheres or the input.
SourceSettings sourceOf(const CommandLine& line);
/// The settings of a run with these options. `scene` is as for resolve.
Settings settingsOf(const CommandLine& line, std::span<const Given> given, const std::optional<SceneNeeds>& scene = std::nullopt);
/// The files that a run reads and writes. Throws UsageError for an output whose name promises another format.
RunFiles filesOf(const CommandSpec& command, const CommandLine& line);
/// The file of -o, or the pattern of the files whose names are made of it.
RunFile outputOf(const CommandLine& line);
/// The needs of a bake from the file of --scene, if it is given.
std::optional<SceneNeeds> sceneOf(const CommandLine& line, Warnings& warnings);

/// A cloud with the settings that it was read or grown with.
struct ResolvedCloud {
  Settings settings;
  Cloud cloud;
};
/// Reads or grows the cloud that the command line names.
ResolvedCloud resolveCloud(const CommandLine& line, BakeReport& report, Stopwatch& watch);

struct CommandSpec {
  Command bit;
  const char* name;
  const char* input;  ///< placeholder of its input
  const char* input_help;
  const char* help;
  const char* examples;  ///< "Examples:", then a command per line
  const char* output;    ///< placeholder of -o, FILE or DIR; empty: there is no -o
  ExitCode (*run)(const CommandLine&);
  const char* output_help = "file to write";
  const char* output_extensions = "";  ///< of -o FILE, joined by spaces, the usual one first
  const char* output_names = "";       ///< files that are written into -o DIR, joined by spaces
};

/// Whether -o must be given; `view` may serve its page instead.
inline bool requiresOutput(const CommandSpec& command) {
  return std::string_view(command.output) == "FILE" || command.bit == kShader || command.bit == kImpostor || command.bit == kPlan;
}

inline constexpr const char* kQuietHelp = "print warnings and errors only";

struct ExitCodeText {
  ExitCode code;
  const char* meaning;
};
inline constexpr ExitCodeText kExitCodes[] = {
    {ExitCode::kDone, "done"},
    {ExitCode::kUsage, "wrong command line"},
    {ExitCode::kSystem, "a system error (missing file, permission, disk)"},
    {ExitCode::kInput, "an input is unusable or over a limit"},
    {ExitCode::kInternal, "internal error"},
    {ExitCode::kBound, "a bound was exceeded, or some assets of a batch failed"},
    {ExitCode::kTryAgain, "try again later"},
    {ExitCode::kHungUp, "stopped by SIGHUP (the terminal was closed)"},
    {ExitCode::kInterrupted, "stopped by SIGINT (Ctrl-C)"},
    {ExitCode::kBrokenPipe, "stopped because nobody reads its output"},
    {ExitCode::kTerminated, "stopped by SIGTERM"},
};

ExitCode runGrow(const CommandLine& line);
ExitCode runBake(const CommandLine& line);
ExitCode runPreview(const CommandLine& line);
ExitCode runView(const CommandLine& line);
ExitCode runShader(const CommandLine& line);
ExitCode runShadow(const CommandLine& line);
ExitCode runImpostor(const CommandLine& line);
ExitCode runPlan(const CommandLine& line);
ExitCode runSequence(const CommandLine& line);
ExitCode runCheck(const CommandLine& line);
ExitCode runMeasure(const CommandLine& line);
ExitCode runBatch(const CommandLine& line);

}  // namespace cloudbake
