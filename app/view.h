// Makes the page of `view`, and serves it.
#pragma once

#include <vector>

#include "app/commands.h"
#include "pipeline/page/live_scene.h"

namespace cloudbake {

/// What a page shows, and the files of folders that it cannot show.
struct LiveScenes {
  std::vector<LiveScene> scenes;
  size_t failed = 0;
};

/// Reads the assets, the scene or the folders of the command line, or bakes what `line.input` names for --watch. Throws as the readers and
/// the bake do; a file of a folder that fails is reported on stderr, unless it is the only one.
LiveScenes readLiveScenes(const CommandLine& line, BakeReport& report);

/// Serves the page of `view`, and with --watch what is new in it, until a signal ends the process. Throws if
/// there is nothing to show yet or the port cannot be used.
ExitCode serveView(const CommandLine& line, const Settings& settings);

}  // namespace cloudbake
