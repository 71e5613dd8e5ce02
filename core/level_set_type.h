// The level set as it crosses stages; apart from types.h so that stages without OpenVDB never see it.
#pragma once

#include <openvdb/openvdb.h>

#include "core/types.h"

namespace cloudbake {

/// Half width of the narrow band, voxels. Beyond it the signed distance is clipped to this value.
constexpr float kBandHalfWidth_voxels = 3;

/// A narrow-band signed distance, negative inside, in index space: voxel size 1, values in voxels, interior filled.
struct LevelSet {
  openvdb::FloatGrid::Ptr grid;
  GridFrame frame;
};

}  // namespace cloudbake
