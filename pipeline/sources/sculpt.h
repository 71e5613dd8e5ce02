// Reads a sculpt as a cloud, examines its mesh, and repairs it on request.
#pragma once

#include <string>
#include <vector>

#include "io/report/report.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// Reads the sculpt, counts the defects of its mesh, and applies --repair, --remesh, --vertices and --close.
Cloud readSculpt(const Settings& settings, BakeReport& report, Stopwatch& watch);

/// The same for a sculpt that has already been read and checked (checkSculpt).
Cloud cloudOfSculpt(Sculpt sculpt, const MeshSettings& settings, BakeReport& report, Stopwatch& watch);

/// Examines the sculpt's parts again after their vertices and triangles have changed: the surface, and what bounds its volume.
void takePartsAnew(Cloud& cloud, const MeshSettings& settings, BakeReport& report);

/// One cloud per object of a sculpt, in the order of the parts, for --separate. Each is closed or open on its own.
std::vector<Cloud> separateObjects(const Cloud& cloud, const MeshSettings& settings, BakeReport& report);

/// An index into the cloud's surface as the artist counts: "triangle 12 of 'Body'".
std::string placeInSculpt(const Sculpt& sculpt, uint32_t index, bool is_vertex);

}  // namespace cloudbake
