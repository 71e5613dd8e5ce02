// Level set → bricks that a march reads without a tree.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// Copies the band, and fills what lies between it with constant bricks. Memory goes with the surface, about 5 kB per leaf of the tree; the
/// clearances take no more than that again, or 2 MB, as long as blocks no larger than a brick allow.
DenseField denseFromLevelSet(const LevelSet& level_set);

}  // namespace cloudbake
