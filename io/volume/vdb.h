// Reads and writes OpenVDB files. Volumes are read as level sets.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/memory_budget.h"
#include "core/types.h"
#include "io/file/read_settings.h"

namespace cloudbake {

struct VdbSettings {
  /// A name, or OpenVDB's unique name, "density[1]"; unset = "surface", else "density", else the first scalar grid. Counted if there are
  /// several of that name, or several scalar grids.
  std::optional<std::string> grid;
  std::optional<double> iso;             ///< fog volumes: the value at the surface; unset = 5 % of the mean active value (counted)
  uint64_t memory_limit = kMemoryLimit;  ///< bytes; a file or an estimate above this is an error
  UpAxis up_axis = UpAxis::kY;           ///< of the file, which does not say it. The axes are exchanged as those of sculpts are
};

struct VdbVolume {
  LevelSet level_set;         ///< on the file's lattice, with the origin moved to the middle of the shape
  std::string grid;           ///< the grid's name in the file; its unique name if there are several of that name
  std::optional<double> iso;  ///< of a fog volume: the value at the surface, as given or as chosen
};

/// Reads a level set or a fog volume of floats, halves or doubles from the bytes of `file`, whose name is used for messages. For a fog
/// volume, and for a level set whose band is narrower than kBandHalfWidth_voxels (counted), the distances to the surface are computed. The
/// sign of every voxel is taken from the file, so that cavities are kept. A level set whose band is not closed (counted), because it was
/// clipped for example, becomes what openvdb::tools::volumeToMesh makes of it, closed between inactive neighbours of opposite sign. Throws
/// InputError if the file is damaged, exceeds a limit or has no grid of that name; also for a grid that is empty, does not contain scalars,
/// has an unknown class, or whose voxels are not cubes along the axes. Throws UsageError for an iso value with a level set.
VdbVolume decodeVdb(const std::filesystem::path& file, std::string bytes, const VdbSettings& settings, Warnings& warnings);

/// The bytes of a .vdb with one level set, "surface", in world units. The same level set gives the same bytes.
/// Throws InputError if the voxels are too small for OpenVDB's transforms.
std::string encodeVdb(const LevelSet& level_set);

}  // namespace cloudbake
