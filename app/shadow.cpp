// cloudbake shadow ASSET.glb -o shadow.png: the shadow that an asset casts under a sun, as a picture for decals and light cookies.
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "pipeline/picture/shadow_picture.h"

namespace cloudbake {

ExitCode runShadow(const CommandLine& line) {
  const Settings settings = settingsOf(line, line.given);
  BakeReport report;
  report.command = "shadow";
  report.input = line.input.string();
  Stopwatch watch;
  const BakedMesh mesh = decodeGlb(line.input, readFileBytes(line.input), report.warnings, settings.source.read);
  report.info = mesh.info;
  enforceStrict(settings.run.strict, report);
  watch.lap(report.seconds, "read");
  const ShadowPicture picture = namingFile(report.input, [&] { return drawShadow(mesh, settings); });
  watch.lap(report.seconds, "draw");
  const ShadowFiles files = encodeShadow(picture);
  writeFileAtomically(shadowFrameFile(settings.output.file), files.frame);
  writeFileAtomically(settings.output.file, files.png);
  report.output = settings.output.file.string();
  watch.lap(report.seconds, "write");
  tellReport(settings.run, report, {{"frame", Json::parse(files.frame)}}, "wrote       " + shadowFrameFile(report.output).string() + "\n");
  return ExitCode::kDone;
}

}  // namespace cloudbake
