// OpenVDB files in and out: volumes as level sets.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/types.h"

namespace cloudbake {

struct VdbSettings {
  std::optional<std::string> grid;  ///< name; unset: "surface", else "density", else the first scalar grid, counted where others would do
  std::optional<double> iso;        ///< fog volumes: the value at the surface; unset: 5 % of the mean active value, counted
  uint64_t memory_limit = 8ULL << 30;  ///< bytes; a file or an estimate above is refused
};

struct VdbVolume {
  LevelSet level_set;    ///< on the file's lattice, its origin moved to the middle of the shape
  std::string grid;      ///< its name in the file
  bool was_fog = false;  ///< made from a fog volume
};

/// Reads a level set or a fog volume of floats, halves or doubles from the bytes of `file`, which is for messages. A fog volume, and a level set whose band is narrower than
/// kBandHalfWidth_voxels (counted), get the distance to their surface; the sign of every voxel stays the file's, so that cavities stay.
/// Throws InputError where it is damaged, larger than a limit, or has no grid of the name;
/// and for a grid that is empty, holds no scalars, is of an unknown class, or whose voxels are no cubes along the axes. Throws UsageError
/// for an iso value with a level set.
VdbVolume decodeVdb(const std::filesystem::path& file, std::string bytes, const VdbSettings& settings, Warnings& warnings);

/// The bytes of a .vdb with one level set, "surface", in world units. The same level set gives the same bytes.
/// Throws InputError where the voxels are too small for OpenVDB's transforms.
std::string encodeVdb(const LevelSet& level_set);

}  // namespace cloudbake
