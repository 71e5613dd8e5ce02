// Examines a baked asset from its file alone: where its lobes are, and what another program did to the UV sets that store them.
#pragma once

#include <string>
#include <vector>

#include "core/lobe_packing.h"
#include "io/gltf/asset/decode.h"

namespace cloudbake {

/// A finding about an asset. `cause` is a short key that is the same in every version; the other texts are for people.
struct AssetFault {
  std::string cause, what, cure;
};

struct AssetExamination {
  int first_set = -1;                ///< n: lobes were read from sets n and n+1; −1: none were found
  std::vector<LobeUvs> uvs;          ///< of all vertices, in order of the parts, after undoing what hides or scales the numbers
  std::optional<AssetFault> fatal;   ///< nothing else can be judged
  bool undone = false;               ///< something was undone: an engine reads other numbers than `uvs`
  std::vector<AssetFault> faults;    ///< findings that make an engine's result wrong, worst first
  std::vector<AssetFault> harmless;  ///< findings that do not
};

/// Finds the lobes in the sets that the metadata names, else in the first pair that contains unit vectors. Integers are converted to the
/// numbers that they represent. KHR_texture_transform is undone if the numbers are lobes only then.
///
/// Causes of faults: "stripped" (no such sets), "moved" (in another pair), "quantised", "texture-transform", "not-finite", "zeros",
/// "negative-density", "not-unit" (‖o‖ off by more than 0.2 % at more than 1 % of the vertices), "attribute" (_OCCLUSION differs). Fatal:
/// "odd-metadata" (of an unknown layout, version or kind of lobe, or incomplete). Harmless: "no-metadata", "half-float". Throws InputError
/// if nothing indicates a bake: no metadata, and no pair that contains unit vectors.
AssetExamination examineAsset(const std::filesystem::path& file, const StoredAsset& asset);

/// The UV sets that every part has, from the lowest to the highest number, e.g. "TEXCOORD_0 to TEXCOORD_3", or "none".
std::string uvSetsText(const StoredAsset& asset);

}  // namespace cloudbake
