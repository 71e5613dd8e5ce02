// Level set → bricks that a march reads without a tree.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// A narrow-band signed distance copied out of its tree into bricks of 8³ cells. Bricks that the band does not meet share constant ones.
/// Lattice positions are index positions relative to `first`; every brick on the border is outside.
struct DenseField {
  static constexpr int kBrick = 8;
  static constexpr int kRow = 2 * (kBrick + 1), kPlane = kRow * kBrick, kBrickValues = kPlane * (kBrick + 1);
  GridFrame frame;
  std::array<int, 3> first{}, bricks{};  ///< index position of the lowest corner; bricks per axis
  float band = 0;                        ///< where |φ| is clipped, voxels
  std::vector<int32_t> offsets;          ///< per brick, x fastest: where in `values` it begins
  /// φ, voxels, rows in pairs so that the four corners of a cell's face follow each other: at k·kPlane + j·kRow + 2 i of a brick lie the
  /// corners (i, j, k) and (i, j + 1, k). |φ| > band in constant bricks; a march may take φ to keep its sign within 0.9 |φ| everywhere.
  std::vector<float> values;
  int block_bits = 0;  ///< blocks of 2^block_bits cells a side, a whole number of them in a brick
  /// Per octant of directions (bit a of its number: component a < 0) and block, x fastest, n: from anywhere in the block, φ keeps its sign
  /// on the way into that octant for n blocks' sides along the direction's largest component. Beyond the box all is outside.
  std::vector<uint8_t> clearances;
};

/// Copies the band, and fills what lies between it with constant bricks. Memory goes with the surface, about 5 kB per leaf of the tree; the
/// clearances take no more than that again, or 2 MB, as long as blocks no larger than a brick allow.
DenseField denseFromLevelSet(const LevelSet& level_set);

}  // namespace cloudbake
