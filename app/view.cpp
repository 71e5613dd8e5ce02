// cloudbake view ASSET.glb -o view.html: assets or a scene live in a browser, in one page, which is written or served.
#include "app/view.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "app/commands.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "pipeline/options/resolve.h"
#include "pipeline/page/live_page.h"
#include "pipeline/picture/folder_sheet.h"
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

// The files of a folder, each as a scene of the page with its name in the folder.
void addFolder(const std::filesystem::path& folder, const Settings& settings, std::span<const Given> given, LiveScenes& live,
               BakeReport& report) {
  const FolderFiles files = filesToShow(folder);
  for (const std::string& one : files.unread) say(stderr, "cloudbake: " + one + "\n");
  int code = 0;
  std::string error;
  const size_t before = live.scenes.size();
  for (const std::filesystem::path& file : files.files) {
    std::tie(code, error) =
        failureOf(file, [&] { live.scenes.push_back(liveScene(readFolderFile(file, settings, given, report), files.nameOf(file))); });
    if (code == 0) continue;
    ++live.failed;
    say(stderr, "cloudbake: " + error + "\n");
  }
  if (live.scenes.size() == before) throw InputError(folder.string(), fmt::format("none of its {} files can be shown", files.files.size()));
}

// Scenes of one name are told apart by the paths of their files.
void separateScenes(const std::vector<std::string>& paths, std::vector<LiveScene>& scenes) {
  std::map<std::string, size_t> named;
  for (const LiveScene& one : scenes) ++named[one.scene["name"].get<std::string>()];
  for (size_t i = 0; i < scenes.size(); ++i)
    if (named.at(scenes[i].scene["name"].get<std::string>()) > 1) scenes[i].scene["name"] = paths[i];
}

}  // namespace

LiveScenes readLiveScenes(const CommandLine& line, BakeReport& report) {
  LiveScenes live;
  std::vector<std::string> paths;
  std::vector<std::filesystem::path> inputs = line.inputs;
  if (inputs.empty()) inputs.push_back(line.input);  // --watch, or nothing for --scene
  for (const std::filesystem::path& input : inputs) {
    const CommandLine one = withInput(line, input);
    Settings settings = settingsOf(one, one.given);
    settings.picture.is_live = true;
    if (std::filesystem::is_directory(input)) {
      const std::string shown = report.input + (report.input.empty() ? "" : ", ") + input.string();
      addFolder(input, settings, one.given, live, report);
      report.input = shown;  // and not the file that was baked last
      for (size_t i = paths.size(); i < live.scenes.size(); ++i)
        paths.push_back((input / live.scenes[i].scene["name"].get<std::string>()).generic_string());
      continue;
    }
    const std::filesystem::path file = settings.scene ? *settings.scene : input;
    report.input += (report.input.empty() ? "" : ", ") + file.string();
    const Scenery scenery = settings.serve.watch ? bakeScenery(settings, one.given, report) : readScenery(settings, one.given, report);
    live.scenes.push_back(namingFile(file.string(), [&] { return liveScene(scenery, file.stem().string()); }));
    paths.push_back(file.generic_string());
  }
  separateScenes(paths, live.scenes);
  return live;
}

ExitCode runView(const CommandLine& given) {
  const CommandLine line = withWatchedInput(given);
  const Settings settings = settingsOf(line, line.given);
  if (settings.serve.port || settings.serve.watch) return serveView(line, settings);
  BakeReport report;
  report.command = "view";
  report.output = settings.output.file.string();
  Stopwatch watch;
  const LiveScenes live = readLiveScenes(line, report);
  watch.lap(report.seconds, "read");
  const std::string page = livePage(live.scenes);
  enforceStrict(settings.run.strict, report);
  writeFileAtomically(settings.output.file, page);
  watch.lap(report.seconds, "write");
  tellReport(settings.run, report);
  if (live.failed == 0) return ExitCode::kDone;
  say(stderr, fmt::format("cloudbake: {} of {} files cannot be shown\n", live.failed, live.failed + live.scenes.size()));
  return ExitCode::kBound;
}

}  // namespace cloudbake
