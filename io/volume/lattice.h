// Spherical harmonics of the transmittance on a regular lattice, as 3D textures: what lights any place inside and around a cloud.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/vec3.h"

namespace cloudbake {

/// Cells of one size; the first one's centre is `origin`, scene space.
struct HarmonicLattice {
  Vec3 origin;
  float cell_size = 0;
  std::array<int, 3> cells{};       ///< along x, y, z
  int order = 0;                    ///< 1 … 3
  float extinction = 0;             ///< that T is for, per world unit
  std::vector<float> coefficients;  ///< #cells × (order + 1)², cell by cell, x fastest
};

/// A file of the lattice: name and bytes.
struct LatticeFile {
  std::string name, bytes;
};

/// STEM.json, schema "cloudbake-lattice-1", and STEM.0.ktx2 and up: coefficients 4 i to 4 i + 3 as the RGBA of texture i, 32-bit floats.
/// The JSON is the last.
std::vector<LatticeFile> encodeLattice(const HarmonicLattice& lattice, const std::string& stem);

/// A 3D texture of four floats per texel, x fastest, one level, as KTX 2.0.
std::string encodeKtxVolume(std::array<int, 3> size, std::span<const float> rgba);

}  // namespace cloudbake
