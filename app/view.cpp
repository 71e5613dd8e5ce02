// cloudbake view ASSET.glb -o view.html: assets or a scene live in a browser, in one page, which is written or served.
#include "app/view.h"

#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "pipeline/options/resolve.h"
#include "pipeline/page/live_page.h"
#include "pipeline/picture/picture.h"

namespace cloudbake {

namespace {

// With --watch, its file is the only input. Without it, the options of a bake would be ignored.
CommandLine withWatchedInput(CommandLine line) {
  for (const Given& given : line.given)
    if (std::string_view(given.option->name) == "watch") line.input = given.value;
  if (line.input.empty()) {
    for (const Given& given : line.given)
      if (needsWatch(*given.option))
        throw UsageError("--" + std::string(given.option->name) + " needs --watch FILE: an asset is shown as it was baked");
  } else if (!line.inputs.empty()) {
    throw UsageError("--watch and '" + line.inputs.front().string() + "': give one of the two, because only one file is watched");
  } else if (sourceKindOf(line.input) == SourceKind::kPreset) {
    throw UsageError("--watch: '" + line.input.string() + "' is a preset, which never changes: give a file, such as a recipe (.toml)");
  }
  return line;
}

// One of several inputs, which may be a scene file among assets.
CommandLine withInput(const CommandLine& line, const std::filesystem::path& input) {
  CommandLine one = line;
  one.input = input;
  const bool is_scene = input.extension() == ".toml" && !isGiven(line.given, "watch") && !isGiven(line.given, "scene");
  if (!is_scene) return one;
  one.input.clear();
  one.given.push_back({findOption("scene", kView), input.string(), {}});
  return one;
}

}  // namespace

std::vector<LiveScene> readLiveScenes(const CommandLine& line, BakeReport& report) {
  std::vector<LiveScene> scenes;
  std::vector<std::filesystem::path> inputs = line.inputs;
  if (inputs.empty()) inputs.push_back(line.input);  // --watch, or nothing for --scene
  for (const std::filesystem::path& input : inputs) {
    const CommandLine one = withInput(line, input);
    Settings settings = settingsOf(one, one.given);
    settings.picture.is_live = true;
    const std::filesystem::path file = settings.scene ? *settings.scene : input;
    report.input += (report.input.empty() ? "" : ", ") + file.string();
    const Scenery scenery = settings.serve.watch ? bakeScenery(settings, one.given, report) : readScenery(settings, one.given, report);
    scenes.push_back(namingFile(file.string(), [&] { return liveScene(scenery, file.stem().string()); }));
  }
  return scenes;
}

ExitCode runView(const CommandLine& given) {
  const CommandLine line = withWatchedInput(given);
  const Settings settings = settingsOf(line, line.given);
  if (settings.serve.port || settings.serve.watch) return serveView(line, settings);
  BakeReport report;
  report.command = "view";
  report.output = settings.output.file.string();
  Stopwatch watch;
  const std::vector<LiveScene> scenes = readLiveScenes(line, report);
  watch.lap(report.seconds, "read");
  const std::string page = livePage(scenes);
  enforceStrict(settings.run.strict, report);
  writeFileAtomically(settings.output.file, page);
  watch.lap(report.seconds, "write");
  tellReport(settings.run, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
