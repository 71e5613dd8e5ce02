// The definition of a level set's grid. It is not in types.h so that few files include OpenVDB's headers.
#pragma once

#include <openvdb/openvdb.h>

#include "core/types.h"

namespace cloudbake {

/// Half the width of the narrow band, in voxels. Signed distances are clamped to ± this value.
constexpr float kBandHalfWidth_voxels = 3;

struct LevelSetGrid {
  openvdb::FloatGrid::Ptr vdb;
};

}  // namespace cloudbake
