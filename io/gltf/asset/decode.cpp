// Reads baked GLBs in two ways: strictly, for code that lights them, and as they are stored, for code that examines them.
// KHR_texture_transform (Khronos): uv' = offset + scale·uv, given per texture of a material. A shader that reads raw UVs does not see it.
#include "io/gltf/asset/decode.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/harmonics.h"
#include "core/lobe_packing.h"
#include "core/text/json.h"
#include "io/gltf/accessor.h"
#include "io/gltf/document.h"
#include "io/gltf/sculpt/load.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

// The first primitive of a part. The others have the same vertices.
const tinygltf::Primitive& firstPrimitive(const LoadedGltf& loaded, size_t part) {
  const auto [mesh, primitive] = loaded.document->places[part].first();
  return loaded.model.meshes[size_t(mesh)].primitives[size_t(primitive)];
}

std::string componentName(const tinygltf::Accessor& accessor) {
  if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) return "float";
  const int bytes = tinygltf::GetComponentSizeInBytes(uint32_t(accessor.componentType));
  return (accessor.normalized ? "normalised " : "") + std::to_string(8 * bytes) + "-bit integer";
}

// A part's UV set; nothing if it has none of that name.
std::optional<StoredUvSet> readUvSet(const LoadedGltf& loaded, size_t part_index, int set) {
  const fs::path& file = loaded.document->file;
  const SculptPart& part = loaded.sculpt.parts[part_index];
  const std::string name = uvSetName(set);
  const auto& attributes = firstPrimitive(loaded, part_index).attributes;
  const auto found = attributes.find(name);
  if (found == attributes.end()) return std::nullopt;
  const std::string owner = name + " of '" + part.name + "'";
  const std::vector<float> floats = GltfAccessors{file, loaded.model}.readFloats(found->second, 2, owner);
  if (floats.size() != 2 * part.positions.size())
    throw InputError(file.string(), owner + " has a different number of vertices; run `cloudbake bake`");
  StoredUvSet uvs{componentName(loaded.model.accessors[size_t(found->second)]), {}, {}};
  for (size_t i = 0; i < floats.size(); i += 2) uvs.values.push_back({floats[i], floats[i + 1]});
  return uvs;
}

// A part's lobes in _OCCLUSION; none if it has none, or not a VEC4 for every vertex.
std::vector<LobeUvs> readOcclusion(const LoadedGltf& loaded, size_t part_index) {
  const auto& attributes = firstPrimitive(loaded, part_index).attributes;
  const auto found = attributes.find("_OCCLUSION");
  std::vector<LobeUvs> lobes;
  if (found == attributes.end()) return lobes;
  const size_t index = size_t(found->second);
  const auto& accessors = loaded.model.accessors;
  if (index < accessors.size() && accessors[index].type != TINYGLTF_TYPE_VEC4) return lobes;  // readFloats refuses others
  const std::vector<float> floats = GltfAccessors{loaded.document->file, loaded.model}.readFloats(found->second, 4, "_OCCLUSION");
  for (size_t i = 0; i + 4 <= floats.size(); i += 4) lobes.push_back({{floats[i], floats[i + 1]}, {floats[i + 2], floats[i + 3]}});
  if (lobes.size() != loaded.sculpt.parts[part_index].positions.size()) lobes.clear();
  return lobes;
}

// The lobes of one part, converted back to scene space.
void decodePart(const LoadedGltf& loaded, size_t part_index, const AssetInfo& info, std::vector<Lobe>& lobes) {
  const fs::path& file = loaded.document->file;
  const SculptPart& part = loaded.sculpt.parts[part_index];
  const std::vector<LobeUvs> stored = storedNumbers(loaded, part_index, info);
  for (size_t v = 0; v < part.positions.size(); ++v) {
    const Lobe lobe = unpackLobe(info.density_max > 0 ? dequantisedLobe(stored[v], info.density_max) : stored[v], part.toScene(v));
    if (!isFinite(lobe.direction) || !std::isfinite(lobe.thickness))
      throw InputError(file.string(),
                       "the lobe of vertex " + std::to_string(v) + " of '" + part.name + "' is not finite; run `cloudbake bake`");
    lobes.push_back(lobe);
  }
}

// The coefficients of one part, if all its attributes exist.
void decodeHarmonics(const LoadedGltf& loaded, size_t part_index, int order, std::vector<float>& harmonics) {
  const fs::path& file = loaded.document->file;
  const SculptPart& part = loaded.sculpt.parts[part_index];
  const auto& attributes = firstPrimitive(loaded, part_index).attributes;
  const size_t count = harmonicCount(order), begin = harmonics.size();
  harmonics.resize(begin + part.positions.size() * count);
  for (size_t first = 0; first < count; first += 4) {
    const std::string name = harmonicsName(int(first / 4));
    const auto found = attributes.find(name);
    if (found == attributes.end())
      throw InputError(file.string(), "'" + part.name + "' has no " + name +
                                          ", but the asset has spherical harmonics: an optimiser dropped it; run `cloudbake bake` last");
    const std::vector<float> four = GltfAccessors{file, loaded.model}.readFloats(found->second, 4, name + " of '" + part.name + "'");
    if (four.size() != 4 * part.positions.size())
      throw InputError(file.string(), name + " of '" + part.name + "' has a different number of vertices; run `cloudbake bake`");
    for (size_t v = 0; v < part.positions.size(); ++v)
      std::copy_n(&four[4 * v], std::min<size_t>(4, count - first), &harmonics[begin + v * count + first]);
  }
  for (size_t i = begin; i < harmonics.size(); ++i)
    if (!std::isfinite(harmonics[i]))
      throw InputError(file.string(), "a coefficient of '" + part.name + "' is not finite; run `cloudbake bake`");
}

void checkPositions(const fs::path& file, const SurfaceMesh& surface) {
  if (surface.triangles.empty())
    throw InputError(file.string(), "there are no triangles in it; run `cloudbake bake` on a sculpt with faces");
  for (size_t i = 0; i < surface.positions.size(); ++i)
    if (!isFinite(surface.positions[i]))
      throw InputError(file.string(),
                       "the position of vertex " + std::to_string(i) + " is not finite; repair the sculpt and bake it again");
}

// Offset and scale per UV set, from the textures below a material.
void collectTransforms(const Json& node, std::map<int, std::pair<Vec2, Vec2>>& transforms) {
  if (!node.is_object()) return;
  if (node.contains("index") && node.contains("extensions") && node["extensions"].contains("KHR_texture_transform")) {
    const Json& own = node["extensions"]["KHR_texture_transform"];
    const auto pair = [&](const char* key, float fallback) {
      return own.contains(key) ? Vec2{own[key].at(0), own[key].at(1)} : Vec2{fallback, fallback};
    };
    transforms.try_emplace(int(wholeNumber(own, "texCoord", wholeNumber(node, "texCoord", 0))), pair("offset", 0), pair("scale", 1));
  }
  for (const Json& member : node) collectTransforms(member, transforms);
}

// Those of all materials of a part. Wrong types in parts that do not matter here are no reason to reject the file.
std::map<int, std::pair<Vec2, Vec2>> transformsOf(const LoadedGltf& loaded, size_t part) {
  std::map<int, std::pair<Vec2, Vec2>> transforms;
  const GltfPlace& place = loaded.document->places[part];
  std::set<int> materials;
  for (const GltfStretch& stretch : place.stretches)
    materials.insert(loaded.model.meshes[size_t(place.mesh)].primitives[size_t(stretch.primitive)].material);
  for (const int material : materials) try {
      if (material >= 0) collectTransforms(loaded.document->json.at("materials").at(size_t(material)), transforms);
    } catch (const Json::exception&) {
    }
  return transforms;
}

std::vector<std::string> materialNames(const Json& json) {
  std::vector<std::string> names;
  if (!json.contains("materials") || !json["materials"].is_array()) return names;
  for (const Json& material : json["materials"])
    names.push_back(material.is_object() && material.contains("name") && material["name"].is_string() ? material["name"] : Json(""));
  return names;
}

}  // namespace

std::vector<LobeUvs> storedNumbers(const LoadedGltf& loaded, size_t part_index, const AssetInfo& info) {
  const fs::path& file = loaded.document->file;
  const SculptPart& part = loaded.sculpt.parts[part_index];
  std::vector<Vec2> uvs[2];
  for (int i = 0; i < 2; ++i) {
    const std::string name = uvSetName(info.first_uv_set + i);
    std::optional<StoredUvSet> stored = readUvSet(loaded, part_index, info.first_uv_set + i);
    if (!stored)
      throw InputError(file.string(),
                       "'" + part.name + "' has no " + name + ": an optimiser dropped it, or it was never baked; run `cloudbake bake`");
    if (info.density_max > 0 ? !stored->isPacked() : !stored->isFloat())
      throw InputError(file.string(),
                       name + " of '" + part.name + "' is quantised; optimise without it (gltfpack -noq), or run `cloudbake bake` last");
    uvs[i] = std::move(stored->values);
  }
  std::vector<LobeUvs> numbers;
  for (size_t v = 0; v < part.positions.size(); ++v) numbers.push_back({uvs[0][v], uvs[1][v]});
  return numbers;
}

std::vector<float> storedHarmonics(const LoadedGltf& loaded, size_t part_index, int order) {
  std::vector<float> harmonics;
  if (order > 0) decodeHarmonics(loaded, part_index, order, harmonics);
  return harmonics;
}

BakedMesh decodeLoaded(const LoadedGltf& loaded) {
  const fs::path& file = loaded.document->file;
  BakedMesh baked;
  baked.info = requireInfo(file, loaded.document->json);
  baked.surface = surfaceInScene(loaded.sculpt);
  checkPositions(file, baked.surface);
  for (size_t i = 0; i < loaded.sculpt.parts.size(); ++i) {
    decodePart(loaded, i, baked.info, baked.lobes);
    if (baked.info.harmonic_order > 0) decodeHarmonics(loaded, i, baked.info.harmonic_order, baked.harmonics);
  }
  return baked;
}

BakedMesh decodeGlb(const fs::path& file, std::string_view bytes, Warnings& warnings, const ReadSettings& settings) {
  return decodeLoaded(loadGltf(file, bytes, settings, warnings));
}

bool isBakedAsset(const fs::path& file, std::string_view bytes) {
  try {
    const std::optional<Json> json = parseJson(splitGlb(file, bytes).json);
    return json && readInfo(*json).has_value();
  } catch (const InputError&) {
    return false;
  }
}

StoredAsset readStoredAsset(const fs::path& file, std::string_view bytes, Warnings& warnings, const ReadSettings& settings) {
  const LoadedGltf loaded = loadGltf(file, bytes, settings, warnings);
  const Json& json = loaded.document->json;
  StoredAsset asset;
  asset.sculpt = loaded.sculpt;
  asset.info = readInfo(json);
  asset.has_info = hasInfo(json);
  asset.info_fault = infoFault(file, json);
  asset.materials = materialNames(json);
  checkPositions(file, surfaceInScene(loaded.sculpt));
  bool all_have_occlusion = true;
  for (size_t i = 0; i < loaded.sculpt.parts.size(); ++i) {
    const auto transforms = transformsOf(loaded, i);
    auto& sets = asset.sets.emplace_back();
    for (int set = 0; set < 8; ++set)
      if (std::optional<StoredUvSet> uvs = readUvSet(loaded, i, set)) {
        if (const auto found = transforms.find(set); found != transforms.end()) uvs->transform = found->second;
        sets.emplace(set, std::move(*uvs));
      }
    if (asset.info && asset.info->harmonic_order > 0) decodeHarmonics(loaded, i, asset.info->harmonic_order, asset.harmonics);
    const std::vector<LobeUvs> occlusion = readOcclusion(loaded, i);
    if (occlusion.empty()) all_have_occlusion = false;
    asset.occlusion.insert(asset.occlusion.end(), occlusion.begin(), occlusion.end());
  }
  if (!all_have_occlusion) asset.occlusion.clear();
  return asset;
}

}  // namespace cloudbake
