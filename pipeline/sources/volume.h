// VDB files as clouds: their level set, and its surface.
#pragma once

#include "pipeline/asset.h"

namespace cloudbake {

/// Throws UsageError where the input is a .vdb and an option of sculpts or of a lattice of ours is set, and where it is none and an option
/// of volumes is. To be called before a recipe or a file sets anything.
void checkVolumeOptions(const Settings& settings);

/// Reads a level set; the scene's one part is its surface, named after the file. The integration lattice gets the file's voxel size, unless
/// --bake-voxels is given.
Scene readVolume(Settings& settings, BakeReport& report, Stopwatch& watch);

}  // namespace cloudbake
