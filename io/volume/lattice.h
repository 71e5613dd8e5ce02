// Writes spherical harmonics of the transmittance on a regular lattice as 3D textures. They can light any place inside and around a cloud.
#pragma once

#include <array>
#include <span>
#include <string>
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
};

/// The name and bytes of a file of the lattice.
struct LatticeFile {
  std::string name, bytes;
};

/// STEM.0.ktx2 and up with the coefficients 4 i to 4 i + 3 as RGBA of texture i in 32-bit floats, and as the last file STEM.json, schema
/// "cloudbake-lattice-1".
std::vector<LatticeFile> encodeLattice(const HarmonicLattice& lattice, const std::string& stem);

/// A 3D texture as KTX 2.0: four floats per texel, x fastest, one level.
std::string encodeKtxVolume(std::array<int, 3> size, std::span<const float> rgba);

}  // namespace cloudbake
