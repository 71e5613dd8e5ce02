// glTF in, baked GLB out, baked GLB in. docs/asset_format.md states the layout.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/sculpt.h"
#include "io/file/read_settings.h"

namespace cloudbake {

/// Name of a UV set's attribute.
inline std::string uvSetName(int set) { return "TEXCOORD_" + std::to_string(set); }

/// Whether to bind a white texture of two pixels to the two UV sets (and to lower ones that nothing uses), so that optimisers keep
/// them in their place. White is neutral in every slot used.
enum class KeepAliveTexture {
  kAuto,   ///< in free core slots of each material; where too few are free: nothing, counted as kKeepAlive
  kForce,  ///< as kAuto, and where slots are missing those of KHR_materials_clearcoat
  kOff
};

struct GltfSettings {
  std::optional<int> uv_set;  ///< first of the two sets, 0 … 6; unset: the lowest n with n and n+1 free in every primitive
  bool attribute = false;     ///< also write _OCCLUSION (VEC4: o.x, o.y, o.z, d)
  KeepAliveTexture keep_alive_texture = KeepAliveTexture::kAuto;
};

/// Reads a .gltf or .glb. Every triangle primitive of a mesh under a node of the default scene (else scene 0, else all root nodes)
/// becomes a part, in order of the nodes, depth first; strips and fans become triangles (those with two equal corners are joints, not
/// surface); morph targets are applied with the file's weights. `Sculpt.gltf` keeps the document and all its buffers.
/// `file` is for messages, and for buffers and images beside it or in folders below; images are read so that the GLB holds them.
/// Counted: kPartIgnored (points, lines), kPoseIgnored (skins, morph targets, animations), kImageNotEmbedded.
/// Throws IoError, InputError: damaged, no scene, cyclic nodes, compressed (Draco, meshopt), an unknown required extension, a buffer
/// outside the file's folder (unless settings.allow_outside).
Sculpt readGltf(const std::filesystem::path& file, std::string_view bytes, const ReadSettings& settings, Warnings& warnings);

/// Buffers and images that a .gltf or .glb names: beside it, in their order, whether they exist or not. Of a damaged file none.
std::vector<std::filesystem::path> filesNamedByGltf(const std::filesystem::path& file, std::string_view bytes);

/// The first of the two UV sets that encodeGlb will use. An asset that was baked before gets the same sets again.
/// Throws InputError where no two neighbouring sets below 8 are free, or `settings.uv_set` is taken.
int chooseUvSet(const Sculpt& sculpt, const GltfSettings& settings);

/// A sculpt with its lobes as the bytes of a GLB: #parts lists of #V lobes in scene space, stored in each part's own space.
/// A glTF sculpt keeps its whole document; other sculpts become a new one, a node with mesh and material per part.
/// The same input gives the same bytes. `info.first_uv_set` is not used: chooseUvSet decides.
/// `harmonics`: #all vertices × (info.harmonic_order + 1)², in order of the parts, for attributes _TRANSMITTANCE_SH_0 and up; or empty.
/// Counted: kMissingUvSet, kKeepAlive. Throws InputError (also where the result would pass 4 GiB).
std::string encodeGlb(const Sculpt& sculpt, std::span<const std::vector<Lobe>> lobes_per_part, const AssetInfo& info,
                      const GltfSettings& settings, Warnings& warnings, std::span<const float> harmonics = {});

/// A baked asset: all parts merged in scene space, normals computed where it has none. `file` is for messages and buffers beside it.
/// Throws InputError where it is damaged, or no baked asset (no metadata, or a part without the UV sets).
BakedMesh decodeGlb(const std::filesystem::path& file, std::string_view bytes, Warnings& warnings);

/// A UV set of a part as it is stored; values of normalised integers as 0 … 1 or −1 … 1.
struct StoredUvSet {
  std::string type;  ///< of the accessor's components: "float", "normalised 16-bit integer", …
  std::vector<Vec2> values;
  std::optional<std::pair<Vec2, Vec2>> transform;  ///< KHR_texture_transform of a texture that uses the set: offset, scale
  bool isFloat() const { return type == "float"; }
};

/// A glTF as other tools left it, for those who ask what became of its lobes.
struct StoredAsset {
  Sculpt sculpt;
  std::optional<AssetInfo> info;                 ///< where its metadata is there and whole
  std::vector<std::map<int, StoredUvSet>> sets;  ///< per part: by number
  std::vector<std::string> materials;            ///< names
};
/// Takes everything that can be read: no metadata, integers, missing sets. Throws InputError where the file is damaged or has no triangles.
StoredAsset readStoredAsset(const std::filesystem::path& file, std::string_view bytes, Warnings& warnings);

}  // namespace cloudbake
