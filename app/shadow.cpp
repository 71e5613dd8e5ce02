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
  // Both are written before one is replaced: a disk that is full must not leave a frame of another picture.
  PendingFile frame(shadowFrameFile(settings.output.file)), png(settings.output.file);
  frame.write(files.frame);
  png.write(files.png);
  frame.commit();
  png.commit();
  report.output = settings.output.file.string();
  watch.lap(report.seconds, "write");
  tellReport(settings.run, report, {{"frame", Json::parse(files.frame)}}, "wrote       " + shadowFrameFile(report.output).string() + "\n");
  return ExitCode::kDone;
}

}  // namespace cloudbake
