#include "pipeline/picture/folder_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "core/error.h"
#include "core/memory_budget.h"
#include "io/file/write_file.h"
#include "io/gltf/asset/decode.h"
#include "io/gltf/impostor/impostor_file.h"
#include "io/gltf/sequence/sequence_file.h"
#include "pipeline/options/resolve.h"
#include "pipeline/picture/picture.h"
#include "preview/compare/lettering.h"
#include "preview/compare/sheet.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

std::string kindOf(const fs::path& file) {
  const SourceKind kind = sourceKindOf(file);
  if (kind == SourceKind::kVolume) return "volume";
  if (isGrown(kind)) return "recipe";
  const std::string bytes = readFileBytes(file);
  return isImpostor(bytes) ? "impostor" : isSequence(bytes) ? "sequence" : isBakedAsset(file, bytes) ? "baked asset" : "sculpt";
}

// The text of an error without the folder of its file, which the title of the panel has, and without its name where no line follows.
std::string causeOf(const FolderPanel& panel, const fs::path& file) {
  if (!panel.error.starts_with(file.string())) return panel.error;
  const std::string rest = panel.error.substr(file.string().size());
  return rest.starts_with(": ") ? rest.substr(2) : file.filename().string() + rest;
}

// A dark picture that has the cause as text.
Image pictureOfFailure(const FolderPanel& panel, const fs::path& file, int width, int height) {
  constexpr Vec3 kGround{0.22F, 0.12F, 0.11F}, kText{1, 0.86F, 0.8F};
  Image image{width, height, {}};
  image.pixels.assign(size_t(width) * size_t(height), kGround);
  const Lettering lettering{std::clamp(float(height) / 16, 11.0F, 20.0F), false};
  const int margin = int(lettering.size_px);
  drawText(image, margin, margin,
           wrapText(fmt::format("exit code {}\n{}", panel.code, causeOf(panel, file)), width - 2 * margin, lettering), lettering, kText);
  return image;
}

Panel panelOf(const FolderPanel& panel, Image image) {
  if (panel.code != 0) return {panel.name, "cannot be shown", std::move(image)};
  return {panel.name, fmt::format("{}, {} vertices", panel.kind, panel.vertices), std::move(image)};
}

}  // namespace

size_t FolderSheet::failures() const {
  return size_t(std::count_if(panels.begin(), panels.end(), [](const FolderPanel& panel) { return panel.code != 0; }));
}

int sheetColumns(size_t panels) { return std::clamp(int(std::ceil(std::sqrt(double(panels)))), 1, 8); }

Scenery readFolderFile(const fs::path& file, const Settings& settings, std::span<const Given> given, BakeReport& report) {
  Settings one = settings;
  one.source.input = file;
  one.source.kind = sourceKindOf(file);
  return bakeScenery(one, given, report);
}

std::pair<int, std::string> failureOf(const fs::path& file, const std::function<void()>& show) {
  try {
    namingFile(file.string(), show);
  } catch (const Error& error) {
    return {int(error.code), error.what()};
  } catch (const std::bad_alloc&) {
    return {int(ExitCode::kInput), file.string() + ": not enough memory: give it more with --memory"};
  } catch (const std::exception& error) {
    return {int(ExitCode::kInternal), file.string() + ": internal error: " + error.what()};
  }
  return {0, ""};
}

FolderSheet drawFolder(const FolderFiles& files, const Settings& settings, std::span<const Given> given, BakeReport& report,
                       Stopwatch& watch) {
  Settings each = settings;
  PictureSettings& view = each.picture;
  if (!isGiven(given, "size")) view.width = kPanelWidth, view.height = kPanelHeight;
  requireMemory({fmt::format("a sheet of {} pictures of {}x{} pixels", files.files.size(), view.width, view.height),
                 3.0 * sizeof(Vec3) * view.width * view.height * double(files.files.size()), "use a smaller --size"},
                view.memory_limit);
  FolderSheet folder;
  std::vector<Panel> panels;
  for (const fs::path& file : files.files) {
    FolderPanel panel{files.nameOf(file), "", 0};
    Image picture;
    std::tie(panel.code, panel.error) = failureOf(file, [&] {
      panel.kind = kindOf(file);
      const Scenery scenery = readFolderFile(file, each, given, report);
      watch.lap(report.seconds, "read");
      panel.vertices = report.vertices;
      StageSeconds seconds;
      picture = stillPicture(scenery, seconds);
      watch.lap(report.seconds, "render");
    });
    if (panel.code != 0) picture = pictureOfFailure(panel, file, view.width, view.height);
    panels.push_back(panelOf(panel, std::move(picture)));
    folder.panels.push_back(std::move(panel));
  }
  folder.sheet = sheet(panels, sheetColumns(panels.size()));
  return folder;
}

Json folderJson(const FolderSheet& sheet) {
  Json files = Json::array();
  for (const FolderPanel& panel : sheet.panels) {
    Json file = {{"name", panel.name}, {"kind", panel.kind}, {"vertices", panel.vertices}, {"code", panel.code}};
    if (panel.code != 0) file["error"] = panel.error;
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace cloudbake
