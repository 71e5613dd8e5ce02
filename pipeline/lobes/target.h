// --target-error: finds the cheapest sweep that meets a target error.
#pragma once

#include "pipeline/lobes/parameters.h"

namespace cloudbake {

/// `parameters` with the N and the voxels that meet settings.lobe.target_error at the least cost, as measured on a sample of vertices
/// against exact chords. `target` of the result records the choice. Throws Error with ExitCode::kBound if nothing that it tries meets the
/// target.
BakeParameters keepingTarget(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters);

}  // namespace cloudbake
