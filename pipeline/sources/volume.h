// Reads VDB files as clouds: their level set and its surface.
#pragma once

#include "io/report/report.h"
#include "pipeline/fields/cloud.h"
#include "pipeline/fields/stopwatch.h"
#include "pipeline/options/settings.h"

namespace cloudbake {

/// Reads a level set. The cloud's only part is its surface, named after the file. The integration lattice uses the file's voxel size,
/// unless --bake-voxels is given.
Cloud readVolume(const Settings& settings, BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
