// Reads one grid of floats from the bytes of a .vdb.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/level_set_type.h"

namespace cloudbake {

/// Registers OpenVDB's types. It may be called any number of times.
void initializeVdb();

/// The grid of that name, or the most likely scalar grid, with values, class and transform as in the bytes of `file`. Of several grids of
/// one name, the first is taken (counted) unless `name` is OpenVDB's unique name, "density[1]", which is also the name of the result.
/// Doubles become floats. Throws InputError for damaged bytes, a file over the limit, an unknown name or a grid that does not contain
/// scalars.
openvdb::FloatGrid::Ptr readScalarGrid(const std::filesystem::path& file, std::string bytes, const std::optional<std::string>& name,
                                       uint64_t memory_limit, Warnings& warnings);

}  // namespace cloudbake
