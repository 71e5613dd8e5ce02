// cloudbake plan SCENE.toml -o DIR: chooses how the clouds of a scene are drawn at each distance, and writes the assets for it.
#include <nlohmann/json.hpp>
#include <vector>

#include "app/allocation.h"
#include "app/commands.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "pipeline/plan/plan.h"

namespace cloudbake {

ExitCode runPlan(const CommandLine& line) {
  keepLargeBlocks();
  Settings settings = settingsOf(line, line.given);
  settings.scene = line.input;
  BakeReport report;
  report.command = "plan";
  report.input = line.input.string();
  Stopwatch watch;
  const ScenePlan plan = namingFile(report.input, [&] { return planScene(settings, line.given, report, watch); });
  enforceStrict(settings.run.strict, report);
  createFolder(settings.output.file);
  std::vector<FileBytes> together;
  Json names = Json::array();
  for (const ScenePlan::File& file : plan.files) {
    together.push_back({file.file, file.bytes});
    names.push_back(file.file.string());
  }
  writeFilesTogether(together);
  for (const std::filesystem::path& stale : plan.stale) std::filesystem::remove(stale);
  report.output = plan.files.back().file.string();
  report.vertices = report.triangles = 0;  // of the clouds that the scene draws now, which is not what a plan is about
  report.info = {};
  watch.lap(report.seconds, "write");
  Json json = plan.json;
  json["files"] = names;
  tellReport(settings.run, report, {{"plan", json}}, plan.text);
  return ExitCode::kDone;
}

}  // namespace cloudbake
