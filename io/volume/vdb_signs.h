// Where the values of a grid change sign. A surface lies between neighbours of opposite sign, also where the active voxels end before it: a
// level set that was clipped has such places.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "core/level_set_type.h"

namespace cloudbake {

/// Which values are inside: those of a level set are below 0, those of a fog volume above a value.
struct InsideRule {
  bool is_fog = false;
  double iso = 0;
  bool operator()(float value) const { return is_fog ? value > iso : value < 0; }
};

/// A box of voxels. Places in a damaged file may be at the ends of int, so it has wider numbers.
struct IndexBox {
  std::array<int64_t, 3> low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};

  bool isEmpty() const { return low[0] > high[0]; }
  void add(const openvdb::Coord& first, int64_t side);  ///< a cube, by its first voxel
  void add(const IndexBox& other);

 private:
  static constexpr int64_t kFar = std::numeric_limits<int64_t>::max() / 4;
};

/// The box of all active voxels and tiles.
IndexBox activeBox(const openvdb::FloatGrid& grid);
/// The box of all voxels and tiles inside, active or not.
IndexBox insideBox(const openvdb::FloatGrid& grid, const InsideRule& inside);
/// Whether there are voxels or tiles inside that are not active.
bool isInactiveInside(const openvdb::FloatGrid& grid, const InsideRule& inside);

/// Pairs of neighbours (voxels with a face in common) of which one is inside and the other is not.
struct SignChanges {
  uint64_t both_active = 0, one_active = 0, none_active = 0;
  double blocks = 0;  ///< 8×8×8 voxels along borders between tiles, which a surface there makes to leaves

  uint64_t all() const { return both_active + one_active + none_active; }
};

/// Counts them. The background must not be inside, and insideBox must be within 2^30 voxels of the origin.
SignChanges countSignChanges(const openvdb::FloatGrid& grid, const InsideRule& inside);

/// A mask of all voxels with such a neighbour. It has a leaf wherever one of these voxels, or one of its 26 neighbours, lies.
openvdb::MaskTree::Ptr surfaceMask(const openvdb::FloatGrid& grid, const InsideRule& inside);

}  // namespace cloudbake
