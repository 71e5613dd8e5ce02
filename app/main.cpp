// The command line. Every error that ends a run becomes one line on stderr and its exit code here.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>

#include "app/allocation.h"
#include "app/commands.h"
#include "app/print_docs.h"
#include "app/signals.h"
#include "app/supervise.h"
#include "app/terminal.h"
#include "core/parallel.h"
#include "core/text/markup.h"
#include "io/file/process.h"
#include "io/file/write_file.h"
#include "io/report/report.h"
#include "io/sculpt/child_reader.h"
#include "pipeline/kit/engine_kit.h"
#include "pipeline/options/presets.h"
#include "pipeline/options/version.h"

namespace cloudbake {

namespace {

constexpr const char* kBatchExamples =
    "Examples:\n  cloudbake batch sculpts/ -o baked\n  cloudbake batch --init clouds.toml\n  cloudbake batch clouds.toml -o baked --html "
    "report.html\n"
    "  cloudbake batch clouds.toml -o baked --shard 2/8 --json shard2.json\n  cloudbake batch --merge shard*.json --junit report.xml";

const CommandSpec kCommands[] = {
    {kGrow, "grow", "PRESET|FILE.toml", "preset, or a recipe", "grow a cloud with an L-system and bake it to a GLB",
     "Examples:\n  cloudbake grow humilis -o cloud.glb\n  cloudbake grow congestus --seed 7 --vertices 10000 -o tower.glb\n"
     "  cloudbake grow --rules rules.txt --generations 5 -o mine.glb\n  cloudbake grow humilis --explain --dry-run\n"
     "  cloudbake grow --from-spheres scatter.csv --blend 2.5% -o mine.glb\n  cloudbake grow hero --vdb hero.vdb -o hero.glb",
     "FILE", runGrow, "file to write", ".glb"},
    {kBake, "bake", "SCULPT", "sculpt or volume to bake",
     "bake a sculpt (glTF, GLB, FBX, OBJ, PLY, STL, OFF) on its own vertices, or a volume (VDB), to a GLB",
     "Examples:\n  cloudbake bake sculpt.obj -o sculpt.glb\n  cloudbake bake sculpt.fbx --target-error 0.5 --json report.json -o "
     "sculpt.glb\n"
     "  cloudbake bake sculpt.stl --as-published -o published.glb\n  cloudbake bake smoke.vdb --grid density --iso 0.05 -o smoke.glb",
     "FILE", runBake, "file to write", ".glb"},
    {kPreview, "preview", "ASSET.glb|FOLDER", "baked asset to draw, or a folder for a sheet of all that is in it",
     "light a baked asset with the lobe formula and draw it to a PNG",
     "Examples:\n  cloudbake preview cloud.glb -o cloud.png\n  cloudbake preview cloud.glb --sun 120,20 --size 1280x720 -o evening.png\n"
     "  cloudbake preview cloud.glb --compare --suns 64 -o sheet.png\n  cloudbake preview --scene scene.toml --turntable 48 -o turn.png\n  "
     "cloudbake preview sculpts/ -o sheet.png",
     "FILE", runPreview, "file to write", ".png .apng"},
    {kView, "view", "ASSET.glb|FOLDER", "baked assets, scenes (.toml) or folders to show",
     "make a page that shows baked assets live in a browser, or serve it",
     "Examples:\n  cloudbake view cloud.glb -o cloud.html\n  cloudbake view a.glb b.glb --compare -o clouds.html\n  cloudbake view --scene "
     "scene.toml --sun 170,20 -o scene.html\n  cloudbake view data/scenes/*.toml -o gallery.html\n  cloudbake view cloud.glb --serve\n  "
     "cloudbake view sculpts/ --serve\n  "
     "cloudbake view --watch sculpt.obj --voxels 150",
     "FILE", runView, "file to write, unless it is served", ".html"},
    {kShader, "shader", "ENGINE [ASSET.glb]", "engine to write for, and an asset whose constants the shaders get",
     "write the shaders and scripts that draw clouds in an engine, with the constants of an asset and a scene",
     "Examples:\n  cloudbake shader godot4 cloud.glb -o project/cloudbake\n  cloudbake shader unity cloud.glb -o Assets/Cloudbake\n"
     "  cloudbake shader npm cloud.glb --scene scene.toml -o package\n  cloudbake shader glsl -o shaders",
     "DIR", runShader, "folder to write the files to"},
    {kShadow, "shadow", "ASSET.glb", "baked asset that casts the shadow",
     "draw the shadow that a baked asset casts under a sun, as a grey PNG for decals and light cookies",
     "Examples:\n  cloudbake shadow cloud.glb -o shadow.png\n  cloudbake shadow cloud.glb --sun 0,90 --size 512 -o noon.png\n  cloudbake "
     "shadow --scene scene.toml -o ground.png",
     "FILE", runShadow, "file to write; its frame is written beside it, as .json", ".png"},
    {kImpostor, "impostor", "ASSET.glb", "baked asset to take pictures of",
     "make pictures of a baked asset from all sides that any light can shine on, for clouds that are far away",
     "Examples:\n  cloudbake impostor cloud.glb -o far\n  cloudbake impostor cloud.glb --views 12 --frame 128 -o far\n"
     "  cloudbake impostor cloud.glb --of mesh --half-lambert 0.3 -o far",
     "DIR", runImpostor, "folder to write the files to", "",
     "impostor.glb impostor_lobe.png impostor_rest.png impostor_six_way_1.png impostor_six_way_2.png"},
    {kPlan, "plan", "SCENE.toml", "scene to plan for",
     "choose how the clouds of a scene are drawn at each distance, at the least cost, and write the assets for it",
     "Examples:\n  cloudbake plan sky.toml -o planned\n  cloudbake plan sky.toml --hours 7,12,17 --region -40,2,-40:40,6,40 -o planned\n"
     "  cloudbake plan sky.toml --budget change=2,vertices=100000 --path 0,2,60:0,2,-60 -o planned",
     "DIR", runPlan, "folder to write the assets and scene.toml to", "", "scene.toml"},
    {kSequence, "sequence", "FRAMES",
     "frames: a pattern in quotes such as 'smoke.####.vdb', a folder, a glTF or FBX with an animation, or a preset or recipe with --vary",
     "bake a cloud that changes, from the frames of a simulation, an animation or a growing cloud, to one GLB",
     "Examples:\n  cloudbake sequence 'smoke.####.vdb' --fps 24 -o smoke.glb\n  cloudbake sequence frames/ --loop --as picture -o "
     "loop.glb\n  cloudbake sequence walk.glb --animation Walk -o walking.glb\n"
     "  cloudbake sequence congestus --vary size=0.5:1 --frame-count 48 -o grows.glb",
     "FILE", runSequence, "file to write", ".glb"},
    {kCheck, "check", "ASSET.glb", "baked asset to check",
     "check that a baked asset is right, and still intact after an optimiser or importer",
     "Examples:\n  cloudbake check cloud.glb\n  cloudbake check cloud.glb --max-angle 2 --json check.json\n"
     "  cloudbake check packed.glb --against cloud.glb",
     "", runCheck},
    {kMeasure, "measure", "INPUT", "preset, recipe, sculpt or volume",
     "measure the error of a bake against an independent truth, and the seconds per stage",
     "Examples:\n  cloudbake measure humilis --vertices 10000\n  cloudbake measure sculpt.obj --rays 1000 --json figures.json\n"
     "  cloudbake measure sculpt.obj --threads 1 -o curve",
     "DIR", runMeasure, "folder for the speed-error curve of all methods: CSV, JSON, SVG", "", "curve.csv curve.json curve.svg"},
    {kBatch, "batch", "MANIFEST.toml|FOLDER", "manifest, or a folder of sculpts",
     "bake the changed clouds of a manifest or a folder, in parallel", kBatchExamples, "DIR", runBatch,
     "folder for the assets; required except for --init and --merge"},
};

constexpr const char* kPrintDocs = "print-docs";  // hidden, for packagers

std::string optionHelp(const Option& option) {
  const std::string fallback = defaultOf(option);
  return option.help + (fallback.empty() ? "" : " [" + fallback + "]");
}

// Options that only --help-all shows are in no group, so that CLI11 does not show them.
void addOptions(CLI::App& command, Command bit, bool show_all, std::vector<Given>& given) {
  for (const Option& option : optionTable()) {
    if (!(option.commands & bit)) continue;
    const std::string flag = "--" + std::string(option.name);
    const std::string group = show_all ? groupOf(option, bit) : option.common & bit ? "Options" : "";
    const auto give = [&given, &option](const std::string& value) { given.push_back({&option, value, "", 0, 0}); };
    if (!*option.unit) {
      command
          .add_flag_callback(
              flag, [give] { give("true"); }, optionHelp(option))
          ->group(group);
    } else if (option.bits & kRepeats) {
      command
          .add_option_function<std::vector<std::string>>(
              flag, [give](const std::vector<std::string>& values) { std::for_each(values.begin(), values.end(), give); },
              optionHelp(option))
          ->allow_extra_args(false)
          ->type_name(option.unit)
          ->group(group);
    } else {
      command.add_option_function<std::string>(flag, give, optionHelp(option))->type_name(option.unit)->group(group);
    }
  }
}

// The words of the command line from the command on, in reverse order, as CLI11 wants them. After an option whose value may be left out,
// the next word is the value unless it is an option or, because of a dot or a slash, a file; the default is put in for a value that is left
// out.
std::vector<std::string> wordsToParse(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  const auto isNumber = [](const std::string& word) { return word.size() > 1 && std::isdigit(static_cast<unsigned char>(word[1])); };
  for (const CommandSpec& command : kCommands) {
    if (words.empty() || words.front() != command.name) continue;
    for (size_t i = 1; i < words.size() && words[i] != "--"; ++i) {
      const Option* option = words[i].starts_with("--") ? findOption(words[i].substr(2), command.bit) : nullptr;
      if (!option || !isOptionalUnit(option->unit)) continue;
      const bool has_value = i + 1 < words.size() && words[i + 1].find_first_of("./") == std::string::npos &&
                             (!words[i + 1].starts_with('-') || isNumber(words[i + 1]));
      words[i] += "=" + (has_value ? words[i + 1] : defaultOf(*option));
      if (has_value) words.erase(words.begin() + std::ptrdiff_t(i) + 1);
    }
  }
  std::reverse(words.begin(), words.end());
  return words;
}

std::string exitCodeHelp() {
  std::string text = "Exit codes:";
  for (const auto& [code, meaning] : kExitCodes) {
    if (code != ExitCode::kDone) text += ";";
    text += (code == ExitCode::kInput ? "\n" : " ") + std::to_string(int(code)) + " " + meaning;
  }
  return text + ".";
}

std::string engineHelp() {
  std::string text = "Engines:\n";
  for (const std::string& name : engineNames()) text += fmt::format("  {:<9}{}\n", name, engineTitle(name));
  return text;
}

std::string commandList() {
  std::string names;
  for (const CommandSpec& command : kCommands) names += (names.empty() ? "" : ", ") + std::string(command.name);
  return names;
}

// Whether a file may be replaced by an error: it is a report of ours, or nothing yet.
bool isReport(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) || std::filesystem::is_empty(file, error)) return true;
  std::string begin(100, '\0');
  std::ifstream(file).read(begin.data(), std::streamsize(begin.size()));
  constexpr const char* kSchemas[] = {"report", "check", "batch", "error"};
  return begin.starts_with('{') && std::any_of(std::begin(kSchemas), std::end(kSchemas), [&](const char* schema) {
           return begin.find(fmt::format("\"schema\": \"cloudbake-{}-", schema)) != begin.npos;
         });
}

// What ends this run in any way, also without a word, must not leave the report of an earlier one.
void removeOldReport(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_regular_file(file, error) && isReport(file)) std::filesystem::remove(followLinks(file), error);
}

// Writes the error as a line on stderr, and as an object to the file of --json.
ExitCode tellError(const Error& error, const std::string& json_file) {
  fmt::print(stderr, "cloudbake: {}\n", onOneLine(error.what()));
  if (json_file.empty()) return error.code;
  if (!isReport(json_file)) {
    fmt::print(stderr, "cloudbake: --json: '{}' is not a report: it stays as it is\n", onOneLine(json_file));
    return error.code;
  }
  try {
    writeFileAtomically(json_file, errorJson(error));
  } catch (const Error& second) {
    if (std::string_view(second.what()) != error.what()) fmt::print(stderr, "cloudbake: {}\n", onOneLine(second.what()));
  }
  return error.code;
}

// The file of --json, for an error of any kind, also of this command line itself: none if another word of it, which may be an input, leads
// to the same file, and none among the records of a batch.
std::string jsonFileIn(std::span<const std::string> words) {
  constexpr std::string_view kOption = "--json";
  std::string file;
  size_t place = 0;
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == kOption && i + 1 < words.size() && !words[i + 1].starts_with('-')) file = words[place = i + 1];
    if (words[i].starts_with(std::string(kOption) + "=")) file = words[place = i].substr(kOption.size() + 1);
  }
  RunFiles files;
  if (!file.empty()) files.outputs.push_back({file, std::string(kOption)});
  for (size_t i = 0; i < words.size(); ++i)
    if (i != place) files.inputs.push_back({words[i], "another word"});
  try {
    refuseSharedFiles(files);
    refuseRecords(files, {}, {});
    return file;
  } catch (const Error&) {
    return "";
  }
}

std::string valueOf(const CommandLine& line, std::string_view name) {
  std::string value;
  for (const Given& given : line.given)
    if (name == given.option->name) value = given.value;
  return value;
}

// Throws if an input or output that the command needs is missing.
void requireFiles(const CommandSpec& command, const CommandLine& line) {
  const bool serves = isGiven(line.given, "serve") || isGiven(line.given, "watch");
  if (serves && !line.output.empty())
    throw UsageError("-o and --serve (or --watch): choose one, because a page that is served is not written");
  if (requiresOutput(command) && line.output.empty() && !isGiven(line.given, "dry-run") && !serves)
    throw UsageError("-o " + std::string(command.output) + " is needed: where to write" + (command.bit == kView ? ", or --serve" : ""));
  const bool has_input = !line.input.empty() || !line.inputs.empty() || isGiven(line.given, "rules") ||
                         isGiven(line.given, "from-spheres") ||
                         ((command.bit & (kPreview | kView | kShadow)) && isGiven(line.given, "scene")) || isGiven(line.given, "watch");
  if (command.bit == kShader && !has_input) throw UsageError(fmt::format("ENGINE is needed: one of {}", fmt::join(engineNames(), ", ")));
  if (command.bit != kBatch && !has_input) throw UsageError(std::string(command.input) + " is needed: what to " + command.name);
}

// Finds out whether everything can be written, and what must not be replaced, before anything is read.
void prepareOutputs(const CommandSpec& command, const CommandLine& line, bool force, RunFiles files) {
  const bool writes = !isGiven(line.given, "dry-run");
  if (!writes) std::erase_if(files.outputs, [](const RunFile& output) { return output.role != "--json"; });
  if (!force) refuseForeignFiles(files);
  if (isGiven(line.given, "json")) removeOldReport(valueOf(line, "json"));
  probeOutputs(files, writes && std::string_view(command.output) == "DIR" ? line.output : "");
  for (const Given& given : line.given)
    if (std::string_view(given.option->name) == "cache" && writes) probeFolder(given.value);
}

ExitCode runCommand(const CommandSpec& command, CommandLine line) {
  const std::string input = line.input.string();
  const std::string json_file = jsonFileIn(line.words);
  try {
    const RunFiles files = filesOf(command, line);
    refuseSharedFiles(files);
    refuseRecords(files, command.bit == kBatch ? line.output : "", valueOf(line, "cache"));
    requireFiles(command, line);
    Settings scratch;  // a wrong value is reported before any work, and before what is missing
    for (const Given& given : line.given)
      if (given.option->value.set) given.option->value.set(scratch, *given.option, given.value);
    if (!line.is_worker) prepareOutputs(command, line, scratch.run.force, files);
    const ThreadLimit limit(scratch.run.threads);
    line.memory_limit = scratch.run.memory.value_or(defaultMemoryLimit());
    if (command.bit != kBatch || line.is_worker) limitMemory(line.memory_limit);  // the worker of a batch is limited, not its supervisor
    return inStage("this command", "give it more with --memory, or a smaller input", [&] { return command.run(line); });
  } catch (const MemoryError& error) {
    return tellError(error.file.empty() ? MemoryError(input, error.message) : error, json_file);
  } catch (const Error& error) {
    return tellError(error, json_file);
  } catch (const std::bad_alloc&) {
    return tellError(MemoryError(input, "not enough memory to begin: give it more with --memory"), json_file);
  } catch (const std::filesystem::filesystem_error& error) {
    return tellError(IoError(error.path1().string(), error.code().message() + "; check the path and its permissions"), json_file);
  } catch (const std::exception& error) {
    return tellError(Error(ExitCode::kInternal, input, 0, 0, std::string("internal error: ") + error.what()), json_file);
  }
}

ExitCode printDocs(const std::string& what) {
  try {
    const std::string text = docsText(what, kCommands);
    std::fwrite(text.data(), 1, text.size(), stdout);
    return ExitCode::kDone;
  } catch (const Error& error) {
    return tellError(error, "");
  }
}

// Reports an unknown command, because CLI11 would only report that a command is missing.
void checkCommand(const std::string& name) {
  if (name == kPrintDocs) return;
  for (const CommandSpec& command : kCommands)
    if (name == command.name) return;
  throw CLI::ExtrasError("unknown command '" + name + "': the commands are " + commandList(), CLI::ExitCodes::ExtrasError);
}

// A report that did not reach its reader is an error too.
ExitCode flushOutput(ExitCode code, const std::string& json_file) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  return tellError(IoError("standard output", "cannot be written: it is closed, or the disk is full"), json_file);
}

int runMain(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == kChildReaderCommand) return serveChildReader(argc - 1, argv + 1);
  prepareForSignals();
  CommandLine line;
  if (argc > 1 && std::string_view(argv[1]) == kBatchWorker) {
    line.is_worker = true;
    argv[1] = argv[0];
    --argc, ++argv;
  }
  line.words.assign(argv, argv + argc);
  CLI::App app{"cloudbake bakes mesh clouds: where the cloud's bulk lies and how thick it is, four floats per vertex in UV channels.",
               "cloudbake"};
  app.set_version_flag("--version", versionText());
  app.allow_windows_style_options(false);  // a path may begin with a slash
  app.footer("cloudbake COMMAND --help shows the options of a command.\n" + exitCodeHelp());

  line.child_program = thisProgram();
  const bool show_all = std::any_of(argv + 1, argv + argc, [](const char* word) { return std::string_view(word) == "--help-all"; });
  std::string docs;
  for (const CommandSpec& command : kCommands) {
    CLI::App* sub = app.add_subcommand(command.name, command.help);
    sub->set_help_flag("-h,--help,--help-all", "Print this help; --help-all lists every option");
    if (command.bit & (kBatch | kView | kShader))
      sub->add_option("inputs", line.inputs, command.input_help)->type_name(command.input);
    else
      sub->add_option("input", line.input, command.input_help)->type_name(command.input);
    if (*command.output) sub->add_option("-o,--output", line.output, command.output_help)->type_name(command.output);
    addOptions(*sub, command.bit, show_all, line.given);
    sub->add_flag("-q,--quiet", line.quiet, kQuietHelp);
    std::string footer = command.examples;
    if (command.bit == kGrow) footer += "\nPresets: " + presetNames();
    if (show_all) footer += "\n" + exitCodeHelp();
    sub->footer(footer);
    if (command.bit == kShader) sub->footer(engineHelp);  // before the examples
  }
  app.add_subcommand(kPrintDocs, "print the man page, the completion script of a shell, or a schema")
      ->group("")
      ->add_option("what", docs, std::string("one of ") + kDocs)
      ->type_name("WHAT");
  try {
    if (argc > 1 && argv[1][0] != '-') checkCommand(argv[1]);
    app.parse(wordsToParse(argc, argv));
    if (app.get_subcommands().empty()) throw CLI::RequiredError("a command is needed: " + commandList(), CLI::ExitCodes::RequiredError);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return int(tellError(UsageError(fmt::format("{} (see cloudbake --help)", error.what())), jsonFileIn(line.words)));
  }
  ExitCode code = ExitCode::kUsage;
  if (app.got_subcommand(kPrintDocs)) code = printDocs(docs);
  for (const CommandSpec& command : kCommands) {
    if (!app.got_subcommand(command.name)) continue;
    line.command = command.bit;
    code = runCommand(command, line);
  }
  return int(flushOutput(code, jsonFileIn(line.words)));
}

}  // namespace

}  // namespace cloudbake

int main(int argc, char** argv) {
  cloudbake::prepareTerminal(argc, argv);
  return cloudbake::runMain(argc, argv);
}
