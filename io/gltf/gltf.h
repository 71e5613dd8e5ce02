// Reads glTF sculpts, writes baked GLBs and reads baked GLBs. docs/asset_format.md defines the layout.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/lobe_packing.h"
#include "core/sculpt.h"
#include "io/file/read_settings.h"

namespace cloudbake {

/// The name of a UV set's attribute.
inline std::string uvSetName(int set) { return "TEXCOORD_" + std::to_string(set); }

/// Whether to bind a white texture of two pixels to the two UV sets (and to lower sets that nothing uses), so that optimisers keep the sets
/// in place. White is neutral in every slot that is used.
enum class KeepAliveTexture {
  kAuto,   ///< use free core slots of each material; if too few are free, bind nothing and count kKeepAlive
  kForce,  ///< like kAuto, but use slots of KHR_materials_clearcoat if others are missing
  kOff
};

struct GltfSettings {
  std::optional<int> uv_set;  ///< first of the two sets, 0 … 6; unset = the lowest n with n and n+1 free in every primitive
  bool attribute = false;     ///< also write _OCCLUSION (VEC4: o.x, o.y, o.z, d)
  KeepAliveTexture keep_alive_texture = KeepAliveTexture::kAuto;
};

/// Reads a .gltf or .glb. Every triangle primitive of a mesh under a node of the scene (settings.scene_index, else the default scene, else
/// scene 0, else all root nodes) becomes a part, in order of the nodes, depth first. Skinned parts are posed by their joints. Strips and
/// fans become triangles; triangles with two equal corners only join a strip and are dropped. Morph targets are applied with the file's
/// weights. `Sculpt.gltf` keeps the document and all its buffers, unpacked: compressed data (Draco, meshopt) is decoded, and instances
/// become nodes. The lobes of an earlier bake are taken out. `file` is for messages, and for finding buffers and images beside it or in
/// folders below. Images are read so that the GLB can embed them. Counts kPartIgnored (points, lines), kPoseIgnored (morph targets,
/// animations), kJointFallback, kOtherScene, kSingularTransform, kImageNotEmbedded. Throws IoError, or InputError for a damaged file, no
/// such scene, cyclic nodes, an unknown required extension, parts over settings.memory_limit, or a buffer outside the file's folder (unless
/// settings.allow_outside).
Sculpt readGltf(const std::filesystem::path& file, std::string_view bytes, const ReadSettings& settings, Warnings& warnings);

/// Identifies the source of a bake: the hash of its bytes. For a baked asset that is baked again, the hash of what remains of it without
/// the earlier bake, so that it is the same after every bake.
std::string sourceHash(const Sculpt& sculpt, std::string_view bytes);

/// The paths of buffers and images that a .gltf or .glb refers to, in their order, whether they exist or not. None for a damaged file.
std::vector<std::filesystem::path> filesNamedByGltf(const std::filesystem::path& file, std::string_view bytes);

/// Decodes percent-encoding (%41 → A, RFC 3986).
std::string percentDecoded(std::string_view uri);

/// The MIME type of an image, recognised by its first bytes, for the types of glTF and its extensions; empty for others.
std::string_view imageMimeType(std::string_view bytes);

/// The first of the two UV sets that encodeGlb will use. An asset that was already baked gets the same sets again.
/// Throws InputError if no two neighbouring sets below 8 are free, or if `settings.uv_set` is taken.
int chooseUvSet(const Sculpt& sculpt, const GltfSettings& settings);

/// The bytes of a GLB with a sculpt and its lobes. `lobes` are #parts lists of #V lobes in scene space; they are stored in each part's own
/// space. A glTF sculpt keeps its whole document. Another sculpt gets a new document of its nodes, materials and
/// images, with a mesh per node and a primitive per part.
/// The same input gives the same bytes. `info.first_uv_set` is ignored: chooseUvSet decides.
/// `harmonics` has #all vertices × (info.harmonic_order + 1)² coefficients, in order of the parts, for the attributes _TRANSMITTANCE_SH_0
/// and up, or is empty. Counts kMissingUvSet, kKeepAlive. Throws InputError, also if the result would exceed 4 GiB.
std::string encodeGlb(const Sculpt& sculpt, std::span<const std::vector<Lobe>> lobes_per_part, const AssetInfo& info,
                      const GltfSettings& settings, Warnings& warnings, std::span<const float> harmonics = {});

/// Whether a part's vertices move by joints or morph targets.
bool isDeformed(const Sculpt& sculpt, size_t part);

/// Per vertex of all parts, the first vertex of its part with the same values of every attribute; itself if something moves the part.
/// Throws InputError if an attribute of a glTF is damaged.
std::vector<uint32_t> firstAlike(const Sculpt& sculpt);

/// The vertices that the triangles use, ascending.
std::vector<uint32_t> usedVertices(std::span<const Triangle> triangles, size_t vertex_count);

/// The sculpt with other triangles (#parts lists of own vertices) and without the vertices that they leave unused, which keep their order.
/// What remains is unchanged: every attribute of a vertex, nodes, materials, and of glTF the rest of the document. A part with an empty
/// list stays whole. Throws InputError if an attribute of the document is damaged.
Sculpt withTriangles(const Sculpt& sculpt, std::span<const std::vector<Triangle>> triangles_per_part);

/// Reads a baked asset. All parts are merged in scene space, and missing normals are computed. `file` is for messages and for finding
/// buffers. Throws InputError if the file is damaged or not a baked asset (no metadata, or a part without the UV sets).
BakedMesh decodeGlb(const std::filesystem::path& file, std::string_view bytes, Warnings& warnings, const ReadSettings& settings = {});

/// Whether a .gltf or .glb is a baked asset, as far as its metadata shows; false for a damaged file.
bool isBakedAsset(const std::filesystem::path& file, std::string_view bytes);

/// A UV set of a part as stored. Normalised integers are converted to 0 … 1 or −1 … 1.
struct StoredUvSet {
  std::string type;  ///< type of the accessor's components: "float", "normalised 16-bit integer", …
  std::vector<Vec2> values;
  std::optional<std::pair<Vec2, Vec2>> transform;  ///< offset and scale in the KHR_texture_transform of a texture that uses the set
  bool isFloat() const { return type == "float"; }
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
