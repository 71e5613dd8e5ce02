// --target-error: the cheapest sweep that keeps an error.
#pragma once

#include "pipeline/parameters.h"

namespace cloudbake {

/// The parameters with the N and the voxels that keep settings.lobe.target_error at least cost, as measured on a sample of vertices against
/// exact chords; `target` says what was chosen. `parameters` holds everything else. Throws Error with ExitCode::kBound where nothing within
/// reach keeps it.
BakeParameters keepingTarget(const Cloud& cloud, const Settings& settings, const BakeParameters& parameters);

}  // namespace cloudbake
