// cloudbake grow PRESET|FILE.toml -o out.glb: grammar → spheres → level set → surface → bake → GLB.
#include "app/cloud.h"
#include "app/commands.h"
#include "app/pipeline.h"
#include "io/spheres.h"
#include "io/write_file.h"

namespace cloudbake {

ExitCode runGrow(Settings settings, const ApplyCommandLine& apply_command_line) {
  BakeReport report;
  report.command = "grow";
  Stopwatch watch;
  const Scene scene = growScene(settings, apply_command_line, report, watch);
  if (settings.dry_run) {
    enforceStrict(settings, report);
  } else {
    resolveInfo(settings, scene, report, watch);
    writeAsset(scene, settings, report, watch);
    if (settings.spheres) writeFileAtomically(*settings.spheres, encodeSpheres(scene.spheres, sphereFormatOf(*settings.spheres)));
  }
  tellReport(settings, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
