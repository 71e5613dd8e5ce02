// Winding numbers on a lattice, by scan conversion of the triangles into columns along an axis.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// Index positions rounded to 2⁻¹⁶ voxel, on which every decision is exact.
struct LatticePoints {
  std::vector<std::array<int32_t, 3>> fixed;  ///< #V, in units of 2⁻¹⁶ voxel
  std::array<int, 3> low{}, high{};           ///< whole voxels around all points
};

/// Rounds index coordinates; |coordinate| < 8192 voxels.
LatticePoints latticePoints(std::span<const Vec3> positions_index);

/// Where the surface crosses each lattice column (x, y) = integers, sorted along z. With another axis for z, x and y are the two
/// that follow it in the cycle x → y → z → x.
struct WindingColumns {
  struct Crossing {
    float z;
    int32_t sign;  ///< +1: the surface is entered along +z (its normal has negative z), −1: left
  };
  int x0 = 0, y0 = 0, columns_x = 0, columns_y = 0;
  std::vector<uint32_t> first;  ///< #columns+1 offsets into crossings, column (x, y) at (y−y0)·columns_x + (x−x0)
  std::vector<Crossing> crossings;
};

/// Scan-converts a mesh into columns along z: edges are decided in exact integers with one owner per shared edge and vertex, so a
/// closed mesh closes in every column.
WindingColumns windingColumns(const LatticePoints& points, std::span<const Triangle> triangles);

/// The same along x, y and z, in one pass over the triangles.
std::array<WindingColumns, 3> windingColumnsOfAxes(const LatticePoints& points, std::span<const Triangle> triangles);

/// Winding number of the lattice column (x, y) at height z: crossings below, with their signs.
int windingNumber(const WindingColumns& columns, int x, int y, float z);

}  // namespace cloudbake
