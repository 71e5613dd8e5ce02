// What can be said of a baked asset from its file alone: where its lobes are, and what another program did to their carriers.
#pragma once

#include <string>
#include <vector>

#include "core/lobe_packing.h"
#include "io/gltf/gltf.h"

namespace cloudbake {

/// Something about an asset. `cause` is a short key, the same in every version; the others are for people.
struct AssetFault {
  std::string cause, what, cure;
};

struct AssetExamination {
  int first_set = -1;                ///< n: lobes were read from n and n+1; −1: nowhere
  std::vector<LobeUvs> uvs;          ///< of all vertices, in order of the parts; what hides or halves the numbers is undone
  bool undone = false;               ///< something was: an engine reads other numbers than `uvs`
  std::vector<AssetFault> faults;    ///< what an engine would get wrong, worst first
  std::vector<AssetFault> harmless;  ///< what it would not
};

/// Finds the lobes: in the sets that the metadata names, else in the first pair that holds unit vectors. Integers are read as what they
/// stand for, KHR_texture_transform is undone where the numbers are lobes only then.
///
/// Causes of faults: "stripped" (no such sets), "moved" (in another pair), "quantised", "texture-transform", "not-finite", "zeros",
/// "negative-density", "not-unit" (‖o‖ off by more than 0.2 % at more than 1 % of the vertices). Harmless: "no-metadata",
/// "odd-metadata", "half-float". Throws InputError where nothing hints at a bake: no metadata, and no pair that holds unit vectors.
AssetExamination examineAsset(const std::filesystem::path& file, const StoredAsset& asset);

/// Lowest and highest number of the UV sets that every part has, as "TEXCOORD_0 to TEXCOORD_3", or "none".
std::string uvSetsText(const StoredAsset& asset);

}  // namespace cloudbake
