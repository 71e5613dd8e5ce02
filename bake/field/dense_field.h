// Converts a level set to bricks, so that a march can read it without a tree.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// A narrow-band signed distance field, copied from its tree into bricks of 8³ cells. Bricks that the band does not touch share constant
/// bricks. Lattice positions are index positions relative to `first`. Every brick on the border is outside the shape.
struct DenseField {
  static constexpr int kBrick = 8;
  static constexpr int kRow = 2 * (kBrick + 1), kPlane = kRow * kBrick, kBrickValues = kPlane * (kBrick + 1);
  GridFrame frame;
  std::array<int, 3> first{}, bricks{};  ///< index position of the lowest corner; bricks per axis
  float band = 0;                        ///< |φ| is clamped to this, voxels
  std::vector<int32_t> offsets;          ///< per brick, x fastest: where it begins in `values`
  /// φ in voxels. Rows are stored in pairs, so that the four corners of a cell's face are contiguous: a brick holds the corners (i, j, k)
  /// and (i, j + 1, k) at k·kPlane + j·kRow + 2 i. |φ| > band in constant bricks. A march may assume everywhere that φ keeps its sign
  /// within 0.9 |φ|.
  std::vector<float> values;
  int block_bits = 0;  ///< a block has 2^block_bits cells per side; a brick contains a whole number of blocks
  /// A number n per octant of directions (bit a of the octant's number: component a < 0) and per block, x fastest. From any position in the
  /// block and in any direction of the octant, φ keeps its sign for n block sides along the direction's largest component. Everything
  /// beyond the box is outside.
  std::vector<uint8_t> clearances;
};

/// Copies the band and uses constant bricks elsewhere. Memory grows with the surface: about 5 kB per leaf of the tree. The clearances take
/// at most as much again, or 2 MB if that is more; blocks are enlarged for this, but not beyond a brick.
DenseField denseFromLevelSet(const LevelSet& level_set);

}  // namespace cloudbake
