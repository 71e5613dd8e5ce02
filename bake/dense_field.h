// Level set → bricks that a march reads without a tree.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// Copies the band, and fills what lies between it with constant bricks. Memory goes with the surface, about 4 bytes × 9³ per leaf of the tree.
DenseField denseFromLevelSet(const LevelSet& level_set);

}  // namespace cloudbake
