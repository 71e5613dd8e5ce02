// The command line. The only place that catches: every error becomes one line on stderr and its exit code.
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "pipeline/batch/plan.h"
#include "pipeline/sources/grown.h"
#include "app/commands.h"
#include "pipeline/options.h"
#include "pipeline/asset.h"
#include "app/print_docs.h"
#include "pipeline/version.h"
#include "io/sculpt/child_reader.h"
#include "io/report/report.h"
#include "io/file/write_file.h"

namespace cloudbake {

namespace {

constexpr const char* kBatchExamples =
    "Examples:\n  cloudbake batch sculpts/ -o baked\n  cloudbake batch --init clouds.toml\n  cloudbake batch clouds.toml -o baked --html "
    "report.html\n"
    "  cloudbake batch clouds.toml -o baked --shard 2/8 --json shard2.json\n  cloudbake batch --merge shard*.json --junit report.xml";

const CommandSpec kCommands[] = {
    {kGrow, "grow", "PRESET|FILE.toml", "grow a cloud with an L-system and bake it to a GLB",
     "Examples:\n  cloudbake grow humilis -o cloud.glb\n  cloudbake grow congestus --seed 7 --vertices 10000 -o tower.glb\n"
     "  cloudbake grow --rules rules.txt --generations 5 -o mine.glb\n  cloudbake grow humilis --explain --dry-run\n"
     "  cloudbake grow --from-spheres scatter.csv --blend 2.5% -o mine.glb\n  cloudbake grow hero --vdb hero.vdb -o hero.glb",
     "FILE", runGrow},
    {kBake, "bake", "SCULPT", "bake a sculpt (glTF, GLB, FBX, OBJ, PLY, STL, OFF) on its own vertices, or a volume (VDB), to a GLB",
     "Examples:\n  cloudbake bake sculpt.obj -o sculpt.glb\n  cloudbake bake sculpt.fbx --target-error 0.5 --json report.json -o "
     "sculpt.glb\n"
     "  cloudbake bake sculpt.stl --as-published -o published.glb\n  cloudbake bake smoke.vdb --grid density --iso 0.05 -o smoke.glb",
     "FILE", runBake},
    {kPreview, "preview", "ASSET.glb", "light a baked asset with the lobe formula and draw it to a PNG",
     "Examples:\n  cloudbake preview cloud.glb -o cloud.png\n  cloudbake preview cloud.glb --sun 120,20 --size 1280x720 -o evening.png\n"
     "  cloudbake preview cloud.glb --compare --suns 64 -o sheet.png\n  cloudbake preview --scene scene.toml --turntable 48 -o turn.png",
     "FILE", runPreview},
    {kCheck, "check", "ASSET.glb", "is a baked asset right, and still whole after an optimiser or importer?",
     "Examples:\n  cloudbake check cloud.glb\n  cloudbake check cloud.glb --max-angle 2 --json check.json\n"
     "  cloudbake check packed.glb --against cloud.glb",
     "", runCheck},
    {kMeasure, "measure", "INPUT", "error of a bake against an independent truth, and seconds per stage",
     "Examples:\n  cloudbake measure humilis --vertices 10000\n  cloudbake measure sculpt.obj --rays 1000 --json figures.json\n"
     "  cloudbake measure sculpt.obj --threads 1 -o curve",
     "DIR", runMeasure, "folder for the speed-error curve of all methods: CSV, JSON, SVG"},
    {kBatch, "batch", "MANIFEST.toml|FOLDER", "bake all of a manifest or a folder of sculpts, in parallel: only what has changed",
     kBatchExamples, "DIR", nullptr, "folder for the assets; needed, but for --init and --merge"},
};

constexpr const char* kPrintDocs = "print-docs";  // hidden: for who packages cloudbake

struct Given {
  const Option* option;
  std::string value;
};

std::string optionHelp(const Option& option) {
  std::string help = option.help;
  if (*option.fallback) help += " [" + std::string(option.fallback) + "]";
  return help;
}

void addOptions(CLI::App& command, unsigned bit, std::vector<Given>& given) {
  for (const Option& option : optionTable()) {
    if (!(option.commands & bit)) continue;
    const std::string flag = "--" + std::string(option.name);
    if (std::string_view(option.name) == "variable") {  // the one that may be given several times
      command
          .add_option_function<std::vector<std::string>>(
              flag,
              [&given, &option](const std::vector<std::string>& values) {
                for (const std::string& value : values) given.push_back({&option, value});
              },
              optionHelp(option))
          ->allow_extra_args(false)
          ->type_name(option.unit)
          ->group(option.group);
    } else if (*option.unit) {
      command
          .add_option_function<std::string>(
              flag,
              [&given, &option](const std::string& value) {
                given.push_back({&option, value});
              },
              optionHelp(option))
          ->type_name(option.unit)
          ->group(option.group);
    } else {
      command
          .add_flag_callback(
              flag,
              [&given, &option] {
                given.push_back({&option, "true"});
              },
              optionHelp(option))
          ->group(option.group);
    }
  }
}

std::string exitCodeHelp() {
  std::string text = "Exit codes:";
  for (const auto& [code, meaning] : kExitCodes) {
    if (code != ExitCode::kDone) text += ";";
    text += (code == ExitCode::kInput ? "\n" : " ") + std::to_string(int(code)) + " " + meaning;
  }
  return text + ".";
}

// The line on stderr, and the object of --json.
ExitCode tellError(const Error& error, const Settings& settings) {
  std::fprintf(stderr, "cloudbake: %s\n", error.what());
  if (settings.json) {
    try {
      writeFileAtomically(*settings.json, errorJson(error));
    } catch (const Error& second) {
      std::fprintf(stderr, "cloudbake: %s\n", second.what());
    }
  }
  return error.code;
}

// Of a batch the command line's own options; those of assets go to every asset that they suit.
Settings batchSettings(const Settings& settings, const Settings& probe) {
  Settings batch = probe;
  batch.output = settings.output;
  batch.batch.inputs = settings.batch.inputs;
  return batch;
}

std::vector<AssetOption> assetOptions(const std::vector<Given>& given) {
  std::vector<AssetOption> options;
  for (const auto& [option, value] : given)
    if (findAssetOption(option->name)) options.push_back({option, value, "", 0, 0});
  return options;
}

ExitCode runCommand(const CommandSpec& command, Settings settings, const std::vector<Given>& given) {
  try {
    const ApplyCommandLine apply = [&given](Settings& s) {
      for (const auto& [option, value] : given) option->set(s, *option, value);
    };
    Settings probe = settings;  // so that a wrong option is told before any work, and --threads and --json are known
    for (const auto& [option, value] : given) {
      option->set(probe, *option, value);
      if (std::string_view(option->name) == "json") settings.json = value;
    }
    if (std::string_view(command.output) == "FILE" && settings.output.empty() && !probe.dry_run)
      throw UsageError("-o FILE is needed: where to write");
    if (command.bit != kBatch && settings.input.empty() && !probe.rules && !probe.from_spheres && !(command.bit == kPreview && probe.scene))
      throw UsageError(std::string(command.input) + " is needed: what to " + command.name);
    std::optional<tbb::global_control> limit;
    if (probe.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(probe.threads));
    return command.bit == kBatch ? runBatch(batchSettings(settings, probe), assetOptions(given)) : command.run(settings, apply);
  } catch (const Error& error) {
    return tellError(error, settings);
  } catch (const std::bad_alloc&) {
    return tellError(InputError(settings.input.string(), "not enough memory: fewer --voxels, or a smaller input"), settings);
  } catch (const std::exception& error) {
    return tellError(Error(ExitCode::kInternal, settings.input.string(), 0, 0, std::string("internal error: ") + error.what()), settings);
  }
}

ExitCode printDocs(const std::string& what) {
  try {
    const std::string text = docsText(what, kCommands);
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
      throw IoError("standard output", "cannot be written: the disk may be full");
    return ExitCode::kDone;
  } catch (const Error& error) {
    return tellError(error, {});
  }
}

// CLI11 would only say that a command is missing.
void checkCommand(const std::string& name) {
  if (name == kPrintDocs) return;
  std::string names;
  for (const CommandSpec& command : kCommands) {
    if (name == command.name) return;
    names += (names.empty() ? "" : ", ") + std::string(command.name);
  }
  throw CLI::ExtrasError("unknown command '" + name + "': the commands are " + names, CLI::ExitCodes::ExtrasError);
}

int runMain(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == kChildReaderCommand) return serveChildReader(argc - 1, argv + 1);
  CLI::App app{"cloudbake bakes mesh clouds: where the cloud's bulk lies and how thick it is, four floats per vertex in UV channels.",
               "cloudbake"};
  app.set_version_flag("--version", versionText());
  app.footer("cloudbake COMMAND --help shows the options of a command.\n" + exitCodeHelp());

  Settings settings;
  settings.read.child_program = "/proc/self/exe";
  std::vector<Given> given;
  std::string input, output, docs;
  std::vector<std::string> inputs;
  for (const CommandSpec& command : kCommands) {
    CLI::App* sub = app.add_subcommand(command.name, command.help);
    if (command.bit == kBatch)
      sub->add_option("inputs", inputs)->type_name(command.input);
    else
      sub->add_option("input", input)->type_name(command.input);
    if (*command.output) sub->add_option("-o,--output", output, command.output_help)->type_name(command.output);
    addOptions(*sub, command.bit, given);
    sub->add_flag("-q,--quiet", settings.quiet, kQuietHelp);
    std::string footer = command.examples;
    if (command.bit == kGrow) footer += "\nPresets: " + presetNames();
    sub->footer(footer + "\n" + exitCodeHelp());
  }
  app.add_subcommand(kPrintDocs, "print the man page, or the completion script of a shell")
      ->group("")
      ->add_option("what", docs, "man, bash, zsh or fish")
      ->type_name("WHAT");
  try {
    if (argc > 1 && argv[1][0] != '-') checkCommand(argv[1]);
    app.parse(argc, argv);
    if (app.get_subcommands().empty())
      throw CLI::RequiredError("a command is needed: grow, bake, preview, check, measure, batch", CLI::ExitCodes::RequiredError);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::fprintf(stderr, "cloudbake: %s (see cloudbake --help)\n", error.what());
    return int(ExitCode::kUsage);
  }
  if (app.got_subcommand(kPrintDocs)) return int(printDocs(docs));
  settings.input = input;
  settings.batch.inputs.assign(inputs.begin(), inputs.end());
  settings.output = output;
  for (const CommandSpec& command : kCommands)
    if (app.got_subcommand(command.name)) return int(runCommand(command, settings, given));
  return int(ExitCode::kUsage);
}

}  // namespace

}  // namespace cloudbake

int main(int argc, char** argv) { return cloudbake::runMain(argc, argv); }
