// A .vdb's bytes → one grid of floats, as OpenVDB holds it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/level_set_type.h"

namespace cloudbake {

/// Makes OpenVDB's types known; any number of times.
void initializeVdb();

/// The grid of that name, or the likeliest scalar one: values, name, class and transform as in the bytes of `file`. Doubles become floats.
/// Throws InputError for damaged bytes, a file over the limit, an unknown name, a grid that holds no scalars.
openvdb::FloatGrid::Ptr readScalarGrid(const std::filesystem::path& file, std::string bytes, const std::optional<std::string>& name,
                                       uint64_t memory_limit, Warnings& warnings);

}  // namespace cloudbake
