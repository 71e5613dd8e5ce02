// cloudbake bake SCULPT -o out.glb: sculpt, or the surface of a VDB → integration field → bake on the artist's own vertices → GLB.
#include <utility>

#include "app/commands.h"
#include "app/progress.h"
#include "app/tell.h"
#include "pipeline/asset/asset.h"

namespace cloudbake {

ExitCode runBake(const CommandLine& line) {
  BakeReport report;
  report.command = "bake";
  Stopwatch watch = watchOnTerminal(line.quiet);
  auto [settings, cloud] = resolveCloud(line, report, watch);
  writeAsset(std::move(cloud), settings, report, watch);
  tellReport(settings.run, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
