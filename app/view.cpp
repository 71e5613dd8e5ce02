// cloudbake view ASSET.glb -o view.html: assets or a scene live in a browser, in one page.
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "pipeline/picture/live_page.h"
#include "pipeline/picture/picture.h"

namespace cloudbake {

ExitCode runView(const CommandLine& line) {
  BakeReport report;
  report.command = "view";
  Stopwatch watch;
  std::vector<LiveScene> scenes;
  Settings settings;
  std::vector<std::filesystem::path> inputs = line.inputs;
  if (inputs.empty()) inputs.emplace_back();  // --scene
  for (const std::filesystem::path& input : inputs) {
    CommandLine one = line;
    one.input = input;
    settings = settingsOf(one, line.given);
    const std::filesystem::path file = settings.scene ? *settings.scene : input;
    report.input += (report.input.empty() ? "" : ", ") + file.string();
    const Scenery scenery = readScenery(settings, line.given, report);
    scenes.push_back(namingFile(file.string(), [&] { return liveScene(scenery, file.stem().string()); }));
  }
  report.output = settings.output.file.string();
  watch.lap(report.seconds, "read");
  const std::string page = livePage(scenes);
  enforceStrict(settings.run.strict, report);
  writeFileAtomically(settings.output.file, page);
  watch.lap(report.seconds, "write");
  tellReport(settings.run, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
