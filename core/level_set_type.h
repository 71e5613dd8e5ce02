// The inside of a level set; apart from types.h so that few files read OpenVDB's headers.
#pragma once

#include <openvdb/openvdb.h>

#include "core/types.h"

namespace cloudbake {

/// Half width of the narrow band, voxels. Beyond it the signed distance is clipped to this value.
constexpr float kBandHalfWidth_voxels = 3;

struct LevelSetGrid {
  openvdb::FloatGrid::Ptr vdb;
};

}  // namespace cloudbake
