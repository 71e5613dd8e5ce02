// Sculpts: read, examined, repaired where that is asked for, as a scene.
#pragma once

#include "pipeline/asset.h"

namespace cloudbake {

/// Reads the sculpt, counts what is odd about its mesh, and does what --repair, --remesh, --vertices and --close say.
Scene readSculpt(Settings& settings, BakeReport& report, Stopwatch& watch);

/// One scene per object of a sculpt, in order of the parts: what --separate bakes. Each is closed or open by itself.
std::vector<Scene> separateObjects(const Scene& scene, const Settings& settings, BakeReport& report);

/// "triangle 12 of 'Body'": an index of the scene's surface as the artist counts.
std::string placeInSculpt(const Sculpt& sculpt, uint32_t index, bool is_vertex);

}  // namespace cloudbake
