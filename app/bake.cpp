// cloudbake bake SCULPT -o out.glb: sculpt, or the surface of a VDB → integration field → bake on the artist's own vertices → GLB.
#include "app/commands.h"
#include "pipeline/asset.h"
#include "pipeline/sources/volume.h"

namespace cloudbake {

ExitCode runBake(Settings settings, const ApplyCommandLine& apply_command_line) {
  apply_command_line(settings);
  checkVolumeOptions(settings);
  BakeReport report;
  report.command = "bake";
  Stopwatch watch;
  const Scene scene = readScene(settings, report, watch);
  resolveInfo(settings, scene, report, watch);
  writeAsset(scene, settings, report, watch);
  tellReport(settings, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
