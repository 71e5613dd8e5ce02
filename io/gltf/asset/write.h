// Writes baked GLBs. docs/asset_format.md defines the layout.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/sculpt.h"
#include "io/gltf/gltf_settings.h"

namespace cloudbake {

/// The first of the two UV sets that encodeGlb will use. An asset that was already baked gets the same sets again.
/// Throws InputError if no two neighbouring sets below 8 are free, or if `settings.uv_set` is taken.
int chooseUvSet(const Sculpt& sculpt, const GltfSettings& settings);

/// The bytes of a GLB with a sculpt and its lobes. `lobes` are #parts lists of #V lobes in scene space; they are stored in each part's own
/// space. A glTF sculpt keeps its whole document. Another sculpt gets a new document of its nodes, materials and
/// images, with a mesh per node and a primitive per part.
/// The same input gives the same bytes. `info.first_uv_set` is ignored: chooseUvSet decides.
/// `harmonics` has #all vertices × (info.harmonic_order + 1)² coefficients, in order of the parts, for the attributes _TRANSMITTANCE_SH_0
/// and up, or is empty. Counts kMissingUvSet, kKeepAlive. Throws InputError, also if the result would exceed 4 GiB.
std::string encodeGlb(const Sculpt& sculpt, std::span<const std::span<const Lobe>> lobes_per_part, const AssetInfo& info,
                      const GltfSettings& settings, Warnings& warnings, std::span<const float> harmonics = {});
std::string encodeGlb(const Sculpt& sculpt, std::span<const std::vector<Lobe>> lobes_per_part, const AssetInfo& info,
                      const GltfSettings& settings, Warnings& warnings, std::span<const float> harmonics = {});

}  // namespace cloudbake
