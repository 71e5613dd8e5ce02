// Estimates what the parts of a glTF take, before a mesh is read once per node. Only for io/gltf.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "io/gltf/nodes.h"
#include "io/gltf/sculpt/bundles.h"
#include "io/gltf/tinygltf.h"

namespace cloudbake {

/// Throws InputError if the visible parts under `placed` need more than `limit` bytes of memory, or if the lobes alone fill a GLB of 4 GiB.
/// `instances` is the number of instances per node (instanceCounts).
void checkBudget(const std::filesystem::path& file, const tinygltf::Model& model, const GltfBundles& bundles,
                 const std::vector<PlacedNode>& placed, const std::vector<uint64_t>& instances, uint64_t limit);

}  // namespace cloudbake
