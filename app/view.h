// Makes the page of `view`, and serves it.
#pragma once

#include <vector>

#include "app/commands.h"
#include "pipeline/page/live_scene.h"

namespace cloudbake {

/// Reads the assets or the scene of the command line, or bakes what `line.input` names for --watch. Throws as the readers and the bake do.
std::vector<LiveScene> readLiveScenes(const CommandLine& line, BakeReport& report);

/// Serves the page of `view`, and with --watch what is new in it, until a signal ends the process. Throws if
/// there is nothing to show yet or the port cannot be used.
ExitCode serveView(const CommandLine& line, const Settings& settings);

}  // namespace cloudbake
