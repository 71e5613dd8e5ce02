// Lattices of spherical harmonics as files: a description and 3D textures.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/harmonic_lattice.h"

namespace cloudbake {

/// The name and bytes of a file of the lattice.
struct LatticeFile {
  std::string name, bytes;
};

/// STEM.0.ktx2 and up with the coefficients 4 i to 4 i + 3 as RGBA of texture i in 32-bit floats, and as the last file STEM.json, schema
/// "cloudbake-lattice-1".
std::vector<LatticeFile> encodeLattice(const HarmonicLattice& lattice, const std::string& stem);

/// Reads what encodeLattice writes. `file` is the name of the description, for messages; read(name) gives the bytes of a texture beside it.
/// Throws InputError for anything else, and for numbers that are not finite.
HarmonicLattice decodeLattice(const std::filesystem::path& file, std::string_view bytes,
                              const std::function<std::string(const std::string& name)>& read);

/// A 3D texture as KTX 2.0: four floats per texel, x fastest, one level.
std::string encodeKtxVolume(std::array<int, 3> size, std::span<const float> rgba);

}  // namespace cloudbake
