// A sheet of all that a folder has: a picture per baked asset, sculpt, volume and recipe, with its name.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"
#include "io/gltf/asset_info.h"
#include "io/report/report.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/options.h"
#include "pipeline/picture/scene_picture.h"
#include "pipeline/sources/folder_files.h"

namespace cloudbake {

/// A file of the folder, and what came of it.
struct FolderPanel {
  std::string name;     ///< relative to the folder
  std::string kind;     ///< "baked asset", "impostor", "sculpt", "volume", "recipe"
  size_t vertices = 0;  ///< of what was drawn
  int code = 0;         ///< the exit code that its failure alone would have
  std::string error{};  ///< what is wrong with it, and the cure
};

struct FolderSheet {
  Image sheet;
  std::vector<FolderPanel> panels;
  size_t failures() const;
};

/// Pixels of a picture of the sheet without --size.
inline constexpr int kPanelWidth = 360, kPanelHeight = 240;

/// The columns of a sheet of so many pictures: as many as rows or one more, and at most 8.
int sheetColumns(size_t panels);

/// Draws a sheet of the files, each with the options `given`; what is not baked yet is baked in memory with the defaults. A file that
/// cannot be shown has a panel with the cause. Throws MemoryError if the sheet would not fit.
FolderSheet drawFolder(const FolderFiles& files, const Settings& settings, std::span<const Given> given, BakeReport& report,
                       Stopwatch& watch);

/// Reads a file of a folder for a picture or a page as bakeScenery does.
Scenery readFolderFile(const std::filesystem::path& file, const Settings& settings, std::span<const Given> given, BakeReport& report);

/// Runs `show` for a file of a folder. Returns how it failed: the exit code and the text, else 0.
std::pair<int, std::string> failureOf(const std::filesystem::path& file, const std::function<void()>& show);

/// The panels as an array of JSON objects.
Json folderJson(const FolderSheet& sheet);

}  // namespace cloudbake
