// Spherical harmonics of the transmittance on a regular lattice in and around a cloud: they light any place there.
#pragma once

#include <array>
#include <vector>

#include "core/vec3.h"

namespace cloudbake {

/// Cells of equal size. The centre of the first cell is `origin`, in scene space.
struct HarmonicLattice {
  Vec3 origin;
  float cell_size = 0;
  std::array<int, 3> cells{};       ///< number of cells along x, y, z
  int order = 0;                    ///< 1 … 3
  float extinction = 0;             ///< the σ that T is for, per world unit
  std::vector<float> coefficients;  ///< #cells × (order + 1)², cell by cell, x fastest

  /// The box of the centres of all cells.
  Box box() const {
    const auto far = [this](size_t axis) { return cell_size * float(cells[axis] - 1); };
    return {origin, origin + Vec3{far(0), far(1), far(2)}};
  }
};

/// T from a point towards a unit direction, by coefficients that are mixed linearly between cells. From outside the lattice there is
/// nothing in between up to its box: T is that of the place where the way enters the box, and 1 if it does not.
float latticeTransmittance(const HarmonicLattice& lattice, Vec3 point, Vec3 to_light);

}  // namespace cloudbake
