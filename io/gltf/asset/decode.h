// Reads baked GLBs, and glTFs that other tools made of them. docs/asset_format.md defines the layout.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/lobe_packing.h"
#include "core/sculpt.h"
#include "io/file/read_settings.h"

namespace cloudbake {

/// Reads a baked asset. All parts are merged in scene space, and missing normals are computed. `file` is for messages and for finding
/// buffers. Throws InputError if the file is damaged or not a baked asset (no metadata, or a part without the UV sets).
BakedMesh decodeGlb(const std::filesystem::path& file, std::string_view bytes, Warnings& warnings, const ReadSettings& settings = {});

struct LoadedGltf;
/// The same of a glTF that was loaded. Only for io/gltf/asset.
BakedMesh decodeLoaded(const LoadedGltf& loaded);

/// The numbers in the two UV sets of a part, #V; of a packed asset those that dequantisedLobe takes. Throws InputError if a set is missing,
/// or of a type that `info`'s layout does not have. Only for io/gltf/asset.
std::vector<LobeUvs> storedNumbers(const LoadedGltf& loaded, size_t part, const AssetInfo& info);

/// The coefficients of a part, #V × (order + 1)²; none for order 0. Only for io/gltf/asset.
std::vector<float> storedHarmonics(const LoadedGltf& loaded, size_t part, int order);

/// Whether a .gltf or .glb is a baked asset, as far as its metadata shows; false for a damaged file.
bool isBakedAsset(const std::filesystem::path& file, std::string_view bytes);

/// A UV set of a part as stored. Normalised integers are converted to 0 … 1 or −1 … 1.
struct StoredUvSet {
  std::string type;  ///< type of the accessor's components: "float", "normalised 16-bit integer", …
  std::vector<Vec2> values;
  std::optional<std::pair<Vec2, Vec2>> transform;  ///< offset and scale in the KHR_texture_transform of a texture that uses the set
  bool isFloat() const { return type == "float"; }
  /// Whether a packed asset may have it.
  bool isPacked() const { return isFloat() || type == "normalised 16-bit integer"; }
};

/// A glTF as other tools left it, to find out what happened to its lobes.
struct StoredAsset {
  Sculpt sculpt;
  std::optional<AssetInfo> info;                 ///< set if the metadata is present and complete
  bool has_info = false;                         ///< whether there is any metadata
  std::string info_fault;                        ///< why the metadata cannot be used as it is; empty if it can
  std::vector<float> harmonics;                  ///< #all vertices × coefficients in scene axes, or empty
  std::vector<std::map<int, StoredUvSet>> sets;  ///< per part: UV sets by number
  std::vector<LobeUvs> occlusion;                ///< the same lobes in _OCCLUSION, of all vertices; empty if a part has none
  std::vector<std::string> materials;            ///< names of the materials
};
/// Accepts missing metadata, integer UVs and missing sets. Throws InputError if the file is damaged or has no triangles.
StoredAsset readStoredAsset(const std::filesystem::path& file, std::string_view bytes, Warnings& warnings,
                            const ReadSettings& settings = {});

}  // namespace cloudbake
