// Sculpts: read, examined, repaired where that is asked for, as a cloud.
#pragma once

#include <string>
#include <vector>

#include "io/report/report.h"
#include "pipeline/cloud.h"
#include "pipeline/settings.h"
#include "pipeline/stopwatch.h"

namespace cloudbake {

/// Reads the sculpt, counts what is odd about its mesh, and does what --repair, --remesh, --vertices and --close ask for.
Cloud readSculpt(const Settings& settings, BakeReport& report, Stopwatch& watch);

/// The same of a sculpt that was read already, and checked (checkSculpt).
Cloud cloudOfSculpt(Sculpt sculpt, const MeshSettings& settings, BakeReport& report, Stopwatch& watch);

/// One cloud per object of a sculpt, in order of the parts: what --separate bakes. Each is closed or open by itself.
std::vector<Cloud> separateObjects(const Cloud& cloud, const MeshSettings& settings, BakeReport& report);

/// "triangle 12 of 'Body'": an index of the cloud's surface as the artist counts.
std::string placeInSculpt(const Sculpt& sculpt, uint32_t index, bool is_vertex);

}  // namespace cloudbake
