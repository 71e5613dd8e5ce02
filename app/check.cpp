// cloudbake check ASSET.glb: checks whether a baked asset is right, and still intact after other programs.
#include <fmt/format.h>

#include "app/commands.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "pipeline/check/check.h"

namespace cloudbake {

ExitCode runCheck(const CommandLine& line) {
  const Settings settings = settingsOf(line, line.given);
  const CheckReport report = checkAsset(settings);
  enforceStrict(settings.run.strict, report.run);
  if (settings.run.json) writeFileAtomically(*settings.run.json, checkJson(report));
  say(stderr, warningLines(report.run));
  if (!settings.run.quiet) say(stdout, checkText(report));
  if (!report.verdict) return ExitCode::kDone;
  std::fflush(stdout);
  say(stderr, fmt::format("cloudbake: {}: {}; {}\n", report.run.input, report.verdict->what, report.verdict->cure));
  return ExitCode::kBound;
}

}  // namespace cloudbake
