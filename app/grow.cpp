// cloudbake grow PRESET|FILE.toml -o out.glb: grammar → spheres → level set → surface → bake → GLB.
#include "app/commands.h"
#include "app/pipeline.h"

namespace cloudbake {

ExitCode runGrow(Settings settings, const ApplyCommandLine& apply_command_line) {
  BakeReport report;
  report.command = "grow";
  Stopwatch watch;
  const Scene scene = growScene(settings, apply_command_line, report, watch);
  resolveInfo(settings, scene, report, watch);
  writeAsset(scene, settings, report, watch);
  tellReport(settings, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
