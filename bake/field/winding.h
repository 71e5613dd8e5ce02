// Computes winding numbers on a lattice, by scan conversion of the triangles into columns along an axis.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// Index positions rounded to 2⁻¹⁶ voxel, so that every decision is exact.
struct LatticePoints {
  std::vector<std::array<int32_t, 3>> fixed;  ///< #V, in units of 2⁻¹⁶ voxel
  std::array<int, 3> low{}, high{};           ///< bounds of all points, in whole voxels
};

/// Rounds index coordinates. Requires |coordinate| < 8192 voxels.
LatticePoints latticePoints(std::span<const Vec3> positions_index);

/// Where the surface crosses each lattice column (integer x, y), sorted along z. If another axis takes the place of z, then x and y are the
/// two axes that follow it in the cycle x → y → z → x.
struct WindingColumns {
  struct Crossing {
    float z;
    int32_t sign;  ///< +1: going along +z enters the solid here (the normal has negative z); −1: leaves it
  };
  int x0 = 0, y0 = 0, columns_x = 0, columns_y = 0;
  std::vector<uint32_t> first;  ///< #columns+1 offsets into crossings, column (x, y) at (y−y0)·columns_x + (x−x0)
  std::vector<Crossing> crossings;
};

/// Scan-converts a mesh into columns along z. Edge tests use exact integers, and each shared edge and vertex has one owner, so a closed
/// mesh closes in every column.
WindingColumns windingColumns(const LatticePoints& points, std::span<const Triangle> triangles);

/// The same along x, y and z, in one pass over the triangles.
std::array<WindingColumns, 3> windingColumnsOfAxes(const LatticePoints& points, std::span<const Triangle> triangles);

/// The winding number in lattice column (x, y) at height z: the sum of the signs of the crossings below.
int windingNumber(const WindingColumns& columns, int x, int y, float z);

}  // namespace cloudbake
