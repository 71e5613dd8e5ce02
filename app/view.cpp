// cloudbake view ASSET.glb -o view.html: the asset or scene live in a browser, in one page.
#include "app/commands.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "pipeline/picture/live_page.h"
#include "pipeline/picture/picture.h"

namespace cloudbake {

ExitCode runView(const CommandLine& line) {
  const Settings settings = settingsOf(line, line.given);
  BakeReport report;
  report.command = "view";
  const std::filesystem::path input = settings.scene ? *settings.scene : settings.source.input;
  report.input = input.string();
  report.output = settings.output.file.string();
  Stopwatch watch;
  const Scenery scenery = readScenery(settings, line.given, report);
  watch.lap(report.seconds, "read");
  const std::string page = livePage(scenery, input.stem().string());
  enforceStrict(settings.run.strict, report);
  writeFileAtomically(settings.output.file, page);
  watch.lap(report.seconds, "write");
  tellReport(settings.run, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
