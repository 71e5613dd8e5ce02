// cloudbake shadow ASSET.glb -o shadow.png: the shadow that an asset casts under a sun, as a picture for decals and light cookies.
#include <nlohmann/json.hpp>
#include <vector>

#include "app/commands.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "pipeline/picture/picture.h"
#include "pipeline/picture/shadow_picture.h"

namespace cloudbake {

namespace {

ShadowPicture shadowOfAsset(const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const std::filesystem::path& file = settings.source.input;
  const BakedMesh mesh = decodeGlb(file, readFileBytes(file), report.warnings, settings.source.read);
  report.info = mesh.info;
  enforceStrict(settings.run.strict, report);
  watch.lap(report.seconds, "read");
  return namingFile(report.input, [&] { return drawShadow(mesh, settings); });
}

ShadowPicture shadowOfScene(const CommandLine& line, const Settings& settings, BakeReport& report, Stopwatch& watch) {
  const Scenery scenery = readScenery(settings, line.given, report);
  enforceStrict(settings.run.strict, report);
  watch.lap(report.seconds, "read");
  return namingFile(report.input, [&] { return drawShadow(scenery, settings.shadow); });
}

}  // namespace

ExitCode runShadow(const CommandLine& line) {
  const Settings settings = settingsOf(line, line.given);
  BakeReport report;
  report.command = "shadow";
  report.input = (settings.scene ? *settings.scene : settings.source.input).string();
  Stopwatch watch;
  const ShadowPicture picture = settings.scene ? shadowOfScene(line, settings, report, watch) : shadowOfAsset(settings, report, watch);
  watch.lap(report.seconds, "draw");
  const ShadowFiles files = encodeShadow(picture);
  writeFilesTogether(std::vector<FileBytes>{{shadowFrameFile(settings.output.file), files.frame}, {settings.output.file, files.png}});
  report.output = settings.output.file.string();
  watch.lap(report.seconds, "write");
  tellReport(settings.run, report, {{"frame", Json::parse(files.frame)}}, "wrote       " + shadowFrameFile(report.output).string() + "\n");
  return ExitCode::kDone;
}

}  // namespace cloudbake
