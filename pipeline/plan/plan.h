// `plan`: chooses for all clouds of a scene how they are drawn at each size, so that its pictures hardly change and cost the least.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "io/report/report.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/options.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// The files of a plan, the text about it, and the same as JSON.
struct ScenePlan {
  struct File {
    std::filesystem::path file;
    std::string bytes;
  };
  std::vector<File> files;                   ///< the scene last
  std::vector<std::filesystem::path> stale;  ///< levels of an earlier plan in the folder that no longer belong to it
  std::string text;
  Json json;
};

/// Plans the scene settings.scene for settings.output.file, a folder. Throws Error with kBound if a limit of cost cannot be kept, and
/// InputError for a scene without clouds, or with a file that the plan would replace.
ScenePlan planScene(const Settings& settings, std::span<const Given> given, BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
