// cloudbake preview ASSET.glb -o out.png: draws what an engine shows with the four floats and the lobe formula, for an asset or a scene,
// still or in motion, or compared with the truth.
#include "app/commands.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/allocation.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "io/image/image.h"
#include "io/report/figures.h"
#include "pipeline/picture/compare.h"
#include "pipeline/picture/folder_sheet.h"
#include "pipeline/picture/picture.h"

namespace cloudbake {

namespace {

ExitCode runComparison(const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const Comparison comparison = compareAsset(settings, report, watch);
  const std::string png = encodePng(comparison.sheet);
  enforceStrict(settings.run.strict, report);
  writeFileAtomically(settings.output.file, png);
  report.output = settings.output.file.string();
  watch.lap(report.seconds, "write");
  tellReport(settings.run, report, {{"comparison", comparisonJson(comparison)}}, comparisonText(comparison));
  return ExitCode::kDone;
}

// A folder has a sheet of still pictures.
void refuseOptionsOfOne(const CommandLine& line) {
  for (const char* name : {"scene", "compare", "turntable", "sun-sweep", "animate", "channels", "steps"})
    if (isGiven(line.given, name))
      throw UsageError(fmt::format("--{} is for one asset, but {} is a folder: name a file of it", name, line.input.string()));
}

ExitCode runFolder(const CommandLine& line, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  refuseOptionsOfOne(line);
  const FolderFiles files = filesToShow(line.input);
  const FolderSheet drawn = drawFolder(files, settings, line.given, report, watch);
  enforceStrict(settings.run.strict, report);
  writeFileAtomically(settings.output.file, encodePng(drawn.sheet));
  report.input = line.input.string();
  report.output = settings.output.file.string();
  report.vertices = report.triangles = 0;
  report.info = {};
  watch.lap(report.seconds, "write");
  for (const std::string& one : files.unread) say(stderr, "cloudbake: " + one + "\n");
  for (const FolderPanel& panel : drawn.panels)
    if (panel.code != 0) say(stderr, "cloudbake: " + panel.error + "\n");
  const size_t failed = drawn.failures();
  tellReport(settings.run, report, {{"files", folderJson(drawn)}},
             figureLine("sheet", "{} of {} files, {} columns", drawn.panels.size() - failed, drawn.panels.size(),
                        sheetColumns(drawn.panels.size())));
  if (failed == 0) return ExitCode::kDone;
  say(stderr, fmt::format("cloudbake: {} of {} files cannot be shown\n", failed, drawn.panels.size()));
  return ExitCode::kBound;
}

}  // namespace

ExitCode runPreview(const CommandLine& line) {
  keepLargeBlocks();
  const Settings settings = settingsOf(line, line.given);
  BakeReport report;
  report.command = "preview";
  report.input = (settings.scene ? *settings.scene : settings.source.input).string();
  Stopwatch watch;
  if (std::filesystem::is_directory(line.input)) return runFolder(line, settings, report, watch);
  if (settings.picture.compare) return runComparison(settings, report, watch);
  const Scenery scenery = readScenery(settings, line.given, report);
  watch.lap(report.seconds, "read");
  enforceStrict(settings.run.strict, report);  // all warnings are about what was read
  PendingFile output(settings.output.file);
  const PictureSink sink{[&](std::string_view bytes) { output.write(bytes); },
                         [](const std::filesystem::path& file, std::string_view bytes) { writeFileAtomically(file, bytes); }};
  const Pictures drawn = namingFile(report.input, [&] { return drawPictures(scenery, sink, report, watch); });
  output.commit();
  report.output = settings.output.file.string();
  watch.lap(report.seconds, "write");

  Json renderers = Json::object();
  std::string text;
  for (const auto& [name, seconds] : drawn.renderers) {
    renderers[name] = seconds;
    text += figureLine("of render", "{:8.3f} s {}", seconds, name);
  }
  if (drawn.renderers.size() < 2) text.clear();
  Json more = {{"renderers", renderers}};
  for (const DrawnField& field : scenery.fields) {
    text += figureLine("field", "{} clouds at {} places", field.clouds.size(), field.settings.count);
    more["fields"].push_back({{"places", field.settings.count}, {"clouds", field.clouds.size()}});
  }
  if (!drawn.film.moments.empty()) {
    text += filmText(drawn.film, settings.picture.frames_per_second);
    more["film"] = filmJson(drawn.film);
  }
  tellReport(settings.run, report, more, text);
  return ExitCode::kDone;
}

}  // namespace cloudbake
