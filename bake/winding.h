// Winding numbers on a lattice, by scan conversion of the triangles into columns along z.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// Where the surface crosses each lattice column (x, y) = integers, sorted along z.
struct WindingColumns {
  struct Crossing {
    float z;
    int32_t sign;  ///< +1: the surface is entered along +z (its normal has negative z), −1: left
  };
  int x0 = 0, y0 = 0, columns_x = 0, columns_y = 0;
  std::vector<uint32_t> first;  ///< #columns+1 offsets into crossings, column (x, y) at (y−y0)·columns_x + (x−x0)
  std::vector<Crossing> crossings;
};

/// Scan-converts a mesh whose positions are index coordinates, |coordinate| < 8192. Positions are rounded to 2⁻¹⁶ voxel, edges
/// are then decided in exact integers with one owner per shared edge and vertex, so a closed mesh closes in every column.
WindingColumns windingColumns(std::span<const Vec3> positions_index, std::span<const Triangle> triangles);

/// Winding number of the lattice column (x, y) at height z: crossings below, with their signs.
int windingNumber(const WindingColumns& columns, int x, int y, float z);

}  // namespace cloudbake
