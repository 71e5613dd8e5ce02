// cloudbake grow PRESET|FILE.toml -o out.glb: grammar → spheres → level set → surface → bake → GLB.
#include "app/commands.h"
#include "app/progress.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "io/volume/spheres.h"
#include "io/volume/vdb.h"
#include "pipeline/asset/asset.h"

namespace cloudbake {

ExitCode runGrow(const CommandLine& line) {
  BakeReport report;
  report.command = "grow";
  Stopwatch watch = watchOnTerminal(line.quiet);
  const auto [settings, cloud] = resolveCloud(line, report, watch);
  const OutputSettings& output = settings.output;
  if (settings.source.spheres_only) {
    enforceStrict(settings.run.strict, report);
  } else {
    const std::string vdb = output.vdb ? namingFile(output.vdb->string(), [&, &grown = cloud] { return encodeVdb(*grown.level_set); }) : "";
    writeAsset(cloud, settings, report, watch);
    if (output.spheres) writeFileAtomically(*output.spheres, encodeSpheres(cloud.spheres, sphereFormatOf(*output.spheres)));
    if (output.vdb) writeFileAtomically(*output.vdb, vdb);
  }
  tellReport(settings.run, report);
  return ExitCode::kDone;
}

}  // namespace cloudbake
