// cloudbake grow PRESET|FILE.toml -o out.glb: grammar → spheres → level set → surface → bake → GLB.
#include "pipeline/sources/grown.h"
#include "app/commands.h"
#include "pipeline/asset.h"
#include "io/volume/spheres.h"
#include "io/volume/vdb.h"
#include "io/file/write_file.h"

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
    const std::string vdb = settings.vdb ? namingFile(settings.vdb->string(), [&] { return encodeVdb(*scene.level_set); }) : "";
    writeAsset(scene, settings, report, watch);
    if (settings.spheres) writeFileAtomically(*settings.spheres, encodeSpheres(scene.spheres, sphereFormatOf(*settings.spheres)));
    if (settings.vdb) writeFileAtomically(*settings.vdb, vdb);
  }
  tellReport(settings, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
