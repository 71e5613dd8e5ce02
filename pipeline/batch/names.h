// The names of outputs that are made from the stems of files: which of several files with one stem gets which name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/batch/plan.h"

namespace cloudbake {

/// The three names that an asset may have instead of `name`, in the order in which they are tried: with the extension of its file, with its
/// folder, and with both: "puff_obj.glb", "puff_towers.glb", "puff_towers_obj.glb". A word that is empty is left out.
std::vector<std::string> namesWith(const std::string& name, const std::string& extension, const std::string& folder);

/// Gives assets whose names are equal, also if only the case differs, names of their own, from their `other_names`. An asset keeps the name
/// under which `output` has a record of its source. Assets without other names keep theirs. Returns a line for people per name that several
/// assets had.
std::vector<std::string> separateNames(std::vector<PlannedAsset>& assets, const std::filesystem::path& output);

}  // namespace cloudbake
