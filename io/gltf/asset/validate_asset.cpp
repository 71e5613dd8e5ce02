// The layout is that of docs/asset_format.md: TEXCOORD_n = (o.x, o.y), TEXCOORD_n+1 = (o.z, d), float32, ‖o‖ = 1. This norm identifies the
// pair of sets with lobes: in UVs made for textures hardly any vertex has u² + v² + u'² = 1.
#include "io/gltf/asset/validate_asset.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/error.h"
#include "io/gltf/document.h"

namespace cloudbake {

namespace {

constexpr double kUnitTolerance = 0.002,
                 kUnitTolerance_quantised = 0.05;  // the error of half floats is 0.0005, that of 12 bits over 44 units is 0.01
constexpr double kMostOff = 0.01, kEnough = 0.9;

std::string setNames(int first) { return uvSetName(first) + " and " + uvSetName(first + 1); }

bool haveSets(const StoredAsset& asset, int first) {
  return std::all_of(asset.sets.begin(), asset.sets.end(),
                     [&](const auto& sets) { return sets.contains(first) && sets.contains(first + 1); });
}

Vec2 undo(Vec2 uv, const std::optional<std::pair<Vec2, Vec2>>& transform) {
  if (!transform) return uv;
  const auto& [offset, scale] = *transform;
  return {offset.x + scale.x * uv.x, offset.y + scale.y * uv.y};
}

float densityMax(const StoredAsset& asset) { return asset.info ? asset.info->density_max : 0; }

// The numbers of a pair of sets, for all parts; those of a packed asset are decoded.
std::vector<LobeUvs> readPair(const StoredAsset& asset, int first, bool with_transform) {
  std::vector<LobeUvs> all;
  for (const auto& sets : asset.sets) {
    const StoredUvSet &a = sets.at(first), &b = sets.at(first + 1);
    for (size_t v = 0; v < a.values.size(); ++v)
      all.push_back(with_transform ? LobeUvs{undo(a.values[v], a.transform), undo(b.values[v], b.transform)}
                                   : LobeUvs{a.values[v], b.values[v]});
  }
  if (densityMax(asset) > 0)
    for (LobeUvs& one : all) one = dequantisedLobe(one, densityMax(asset));
  return all;
}

double norm(const LobeUvs& uvs) {
  const double x = uvs.first.x, y = uvs.first.y, z = uvs.second.x;
  return std::sqrt(x * x + y * y + z * z);
}

bool isFiniteLobe(const LobeUvs& uvs) {
  return std::isfinite(uvs.first.x) && std::isfinite(uvs.first.y) && std::isfinite(uvs.second.x) && std::isfinite(uvs.second.y);
}

LobeUvs flipped(const LobeUvs& uvs) { return {{uvs.first.x, 1 - uvs.first.y}, {uvs.second.x, 1 - uvs.second.y}}; }

uint64_t countOf(const std::vector<LobeUvs>& uvs, bool (*is)(const LobeUvs&)) {
  return uint64_t(std::count_if(uvs.begin(), uvs.end(), [&](const LobeUvs& one) { return is(one); }));
}

// The fraction of vertices with a unit vector.
double unitShare(const std::vector<LobeUvs>& uvs, double tolerance) {
  const auto is_unit = [&](const LobeUvs& one) { return std::fabs(norm(one) - 1) <= tolerance; };
  return uvs.empty() ? 0 : double(std::count_if(uvs.begin(), uvs.end(), is_unit)) / double(uvs.size());
}

// A type of the pair that the layout does not have; empty if there is none.
std::string typeOf(const StoredAsset& asset, int first) {
  for (const auto& sets : asset.sets)
    for (const int set : {first, first + 1})
      if (densityMax(asset) > 0 ? !sets.at(set).isPacked() : !sets.at(set).isFloat()) return sets.at(set).type;
  return "";
}

// Whether a pair contains lobes, possibly with V flipped or under a texture's transform.
bool looksLikeLobes(const StoredAsset& asset, int first) {
  if (!haveSets(asset, first)) return false;
  if (densityMax(asset) > 0) return typeOf(asset, first).empty();  // any numbers are lobes
  for (const bool with_transform : {false, true}) {
    std::vector<LobeUvs> uvs = readPair(asset, first, with_transform);
    if (2 * countOf(uvs, [](const LobeUvs& o) { return norm(o) == 0; }) > uvs.size())
      continue;  // these are fillers; flipped, they would look like (0, 1, 0)
    if (unitShare(uvs, kUnitTolerance_quantised) >= kEnough) return true;
    std::transform(uvs.begin(), uvs.end(), uvs.begin(), flipped);
    if (unitShare(uvs, kUnitTolerance_quantised) >= kEnough) return true;
  }
  return false;
}

// The pair that the metadata names, unless only another pair looks like lobes.
int findLobes(const StoredAsset& asset) {
  const int named = asset.info ? asset.info->first_uv_set : -1;
  if (named >= 0 && looksLikeLobes(asset, named)) return named;
  for (int first = 0; first < 7; ++first)
    if (looksLikeLobes(asset, first)) return first;
  return named >= 0 && haveSets(asset, named) ? named : -1;
}

// Whether all float32 numbers are also representable as half floats: the 13 last bits of the mantissa are 0.
bool areHalves(const std::vector<LobeUvs>& uvs) {
  uint64_t rounded = 0;
  for (const LobeUvs& one : uvs)
    for (const float x : {one.first.x, one.first.y, one.second.x, one.second.y}) {
      if (std::bit_cast<uint32_t>(x) & 0x1FFF) return false;
      rounded += x != 0 && std::fabs(x) != 1;
    }
  return rounded > 0;
}

void examineMetadata(const StoredAsset& asset, AssetExamination& found) {
  if (!asset.info) {
    found.harmless.push_back({"no-metadata", "asset.extras.cloudbake is gone: exponent, bias and extinction are not known from the file",
                              "keep the asset's extras, or the values as material settings"});
    return;
  }
  if (asset.info->lobe != "mean" && asset.info->lobe != "fit")
    found.fatal = AssetFault{"odd-metadata", "asset.extras.cloudbake: lobe '" + asset.info->lobe + "' is neither mean nor fit",
                             "bake again with `cloudbake bake`"};
}

// Describes how the numbers were changed before they were found.
void examineCarriers(const StoredAsset& asset, AssetExamination& found) {
  const int n = found.first_set;
  if (asset.info && n != asset.info->first_uv_set)
    found.faults.push_back({"moved",
                            "the lobes are in " + setNames(n) + ", the metadata says " + setNames(asset.info->first_uv_set) +
                                ": a tool dropped or reordered UV sets",
                            "read the sets where they are now, or keep all sets (docs/asset_format.md) and export again"});
  const std::string type = typeOf(asset, n);
  const std::vector<LobeUvs> raw = readPair(asset, n, false), transformed = readPair(asset, n, true);
  const double tolerance = type.empty() ? kUnitTolerance : kUnitTolerance_quantised;
  found.undone = unitShare(transformed, tolerance) > unitShare(raw, tolerance);
  found.uvs = found.undone ? transformed : raw;
  if (!type.empty()) {
    found.faults.push_back({"quantised",
                            setNames(n) + " are quantised (" + type + ")" +
                                (found.undone ? ", their scale hides in KHR_texture_transform" : "") + ", and a shader reads other numbers",
                            "optimise with float UVs (gltfpack -noq -kn), or bake last"});
    found.undone = true;
  } else if (found.undone) {
    found.faults.push_back({"texture-transform",
                            setNames(n) + " hold scaled numbers, their scale is in KHR_texture_transform: a shader that reads raw UVs "
                                          "does not see it",
                            "apply no texture transforms to UVs, or bake last"});
  }
}

// The attribute beside the sets, for engines that read it.
void examineAttribute(const StoredAsset& asset, AssetExamination& found) {
  constexpr float kHalfFloats = 2e-3F;
  if (asset.occlusion.size() != found.uvs.size()) return;
  const auto differs = [](float a, float b) { return !(std::fabs(a - b) <= kHalfFloats * std::max(1.0F, std::fabs(b))); };
  size_t different = 0;
  for (size_t v = 0; v < found.uvs.size(); ++v) {
    const LobeUvs &a = asset.occlusion[v], &b = found.uvs[v];
    different += differs(a.first.x, b.first.x) || differs(a.first.y, b.first.y) || differs(a.second.x, b.second.x) ||
                 differs(a.second.y, b.second.y);
  }
  if (different > 0)
    found.faults.push_back({"attribute", "_OCCLUSION and the UV sets have different lobes at " + std::to_string(different) + " vertices",
                            "bake again, or drop the attribute and read the sets"});
}

void examineNumbers(AssetExamination& found, bool quantised) {
  const std::string at = " of " + std::to_string(found.uvs.size()) + " vertices";
  const auto add = [&](const char* cause, uint64_t count, const std::string& what, const char* cure) {
    if (count > 0) found.faults.push_back({cause, what + " at " + std::to_string(count) + at, cure});
  };
  const uint64_t zeros = countOf(found.uvs, [](const LobeUvs& o) { return norm(o) == 0; });
  add("not-finite", countOf(found.uvs, [](const LobeUvs& o) { return !isFiniteLobe(o); }), "a lobe is not finite", "bake again");
  add("zeros", zeros, "o is zero, as fillers are,", "export with the UV sets of the file, or bake again");
  if (!quantised)
    add("negative-density", countOf(found.uvs, [](const LobeUvs& o) { return o.second.y < 0; }), "d is negative", "bake again");
  const double off = 1 - unitShare(found.uvs, quantised ? kUnitTolerance_quantised : kUnitTolerance);
  if (off > kMostOff && zeros < found.uvs.size())
    add("not-unit", uint64_t(std::lround(off * double(found.uvs.size()))), "o is no unit vector",
        "export UVs unscaled and unflipped, as float32");
  if (!quantised && areHalves(found.uvs))
    found.harmless.push_back({"half-float", "the UVs went through half floats: within 0.02 degrees and 0.05 % of d", "nothing"});
}

}  // namespace

AssetExamination examineAsset(const std::filesystem::path& file, const StoredAsset& asset) {
  AssetExamination found;
  if (asset.has_info && !asset.info_fault.empty()) {
    found.fatal =
        AssetFault{"odd-metadata", asset.info_fault, "check it with the program that baked it, or bake again with `cloudbake bake`"};
    return found;
  }
  found.first_set = findLobes(asset);
  if (found.first_set < 0 && !asset.info)
    throw InputError(file.string(), "not a baked asset: it has no asset.extras.cloudbake, and no two UV sets contain unit vectors (" +
                                        uvSetsText(asset) + "): an optimiser may have dropped them; bake it with `cloudbake bake`");
  examineMetadata(asset, found);
  if (found.first_set < 0) {
    found.faults.push_back({"stripped",
                            "the UV sets with the lobes are gone: the metadata says " + setNames(asset.info->first_uv_set) +
                                ", the file has " + uvSetsText(asset) + ": an optimiser drops sets that no texture uses",
                            "bake with --keep-alive-texture auto or force, and optimise as docs/asset_format.md says"});
    return found;
  }
  examineCarriers(asset, found);
  examineNumbers(found, !typeOf(asset, found.first_set).empty());
  if (!found.undone) examineAttribute(asset, found);
  return found;
}

std::string uvSetsText(const StoredAsset& asset) {
  std::vector<int> complete;
  for (int set = 0; set < 8; ++set)
    if (std::all_of(asset.sets.begin(), asset.sets.end(), [&](const auto& sets) { return sets.contains(set); })) complete.push_back(set);
  if (complete.empty()) return "none";
  return complete.size() == 1 ? "only " + uvSetName(complete[0]) : uvSetName(complete.front()) + " to " + uvSetName(complete.back());
}

}  // namespace cloudbake
