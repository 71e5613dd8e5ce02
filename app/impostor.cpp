// cloudbake impostor ASSET.glb -o DIR: pictures of a baked asset from all sides that any light can shine on.
#include <nlohmann/json.hpp>
#include <vector>

#include "app/commands.h"
#include "app/tell.h"
#include "io/file/write_file.h"
#include "io/image/image.h"
#include "pipeline/impostor/impostor.h"
#include "pipeline/impostor/picture_figures.h"

namespace cloudbake {

ExitCode runImpostor(const CommandLine& line) {
  const Settings settings = settingsOf(line, line.given);
  BakeReport report;
  report.command = "impostor";
  Stopwatch watch;
  const ImpostorSubject subject = readImpostorSubject(settings, report, watch);
  const BakedImpostor baked = bakeImpostor(subject, settings, report, watch);
  enforceStrict(settings.run.strict, report);
  const ImpostorFiles files = encodeImpostor(baked.impostor, billboardOf(baked.impostor));
  const std::filesystem::path folder = settings.output.file;
  std::vector<std::pair<const char*, std::string>> written{
      {"impostor.glb", files.glb}, {"impostor_lobe.png", files.lobe_png}, {"impostor_rest.png", files.rest_png}};
  if (baked.six_way) {
    written.emplace_back("impostor_six_way_1.png", encodeRgbaPng(baked.six_way->size, baked.six_way->size, baked.six_way->first));
    written.emplace_back("impostor_six_way_2.png", encodeRgbaPng(baked.six_way->size, baked.six_way->size, baked.six_way->second));
  }
  watch.lap(report.seconds, "encode");
  createFolder(folder);
  std::vector<FileBytes> together;
  Json names = Json::array();
  for (const auto& [name, bytes] : written) {
    together.push_back({folder / name, bytes});
    names.push_back((folder / name).string());
  }
  writeFilesTogether(together);
  report.output = (folder / written.front().first).string();
  watch.lap(report.seconds, "write");
  std::string text = impostorText(baked);
  Json json = impostorJson(baked);
  if (settings.impostor.measure) {
    const std::vector<SizeFigures> figures = pictureFigures(subject, settings, baked, report);
    watch.lap(report.seconds, "measure");
    text += pictureFiguresText(figures);
    json["pictures"] = pictureFiguresJson(figures);
  }
  for (size_t i = 0; i < written.size(); ++i) {
    text += "wrote       " + (folder / written[i].first).string() + "  " + std::to_string(written[i].second.size()) + " bytes\n";
  }
  json["files"] = names;
  tellReport(settings.run, report, {{"impostor", json}}, text);
  return ExitCode::kDone;
}

}  // namespace cloudbake
