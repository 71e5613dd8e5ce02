// glTF 2.0, sections 3.5 (nodes) and 3.9 (materials), and the extensions KHR_materials_emissive_strength and KHR_texture_transform.
#include "io/gltf/asset/sculpt_document.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "io/gltf/document.h"

namespace cloudbake {

namespace {

constexpr int kRepeat = 10497, kClampToEdge = 33071, kMirroredRepeat = 33648;

Json numbers(std::initializer_list<float> values) {
  Json array = Json::array();
  for (const float value : values) array.push_back(shortest(value));
  return array;
}

int append(Json& json, const char* key, Json value) {
  Json& list = json[key];
  if (!list.is_array()) list = Json::array();
  const auto known = std::find(list.begin(), list.end(), value);
  if (known != list.end()) return int(known - list.begin());
  list.push_back(std::move(value));
  return int(list.size()) - 1;
}

// Writes the images that materials use, in the order of first use.
struct Textures {
  const Sculpt& sculpt;
  const std::function<int(std::string_view)>& add_image;
  Json& json;
  std::map<int, int> images{};  // of the sculpt → of the document

  // The texture info of glTF.
  Json add(const SculptTexture& texture) {
    const auto [image, is_new] = images.try_emplace(texture.image, 0);
    if (is_new) {
      const SculptImage& source = sculpt.images.at(size_t(texture.image));
      json["images"].push_back({{"name", source.name}, {"mimeType", source.mime_type}, {"bufferView", add_image(source.bytes)}});
      image->second = int(json["images"].size()) - 1;
    }
    const int wrap = texture.wrap == TextureWrap::kClamp ? kClampToEdge : texture.wrap == TextureWrap::kMirror ? kMirroredRepeat : kRepeat;
    const int sampler = append(json, "samplers", {{"wrapS", wrap}, {"wrapT", wrap}});
    const std::string& name = sculpt.images[size_t(texture.image)].name;
    Json info = {{"index", append(json, "textures", {{"name", name}, {"sampler", sampler}, {"source", image->second}})},
                 {"texCoord", texture.uv_set}};
    if (texture.offset == Vec2{0, 0} && texture.scale == Vec2{1, 1}) return info;
    append(json, "extensionsUsed", "KHR_texture_transform");
    info["extensions"]["KHR_texture_transform"] = {{"offset", numbers({texture.offset.x, texture.offset.y})},
                                                   {"scale", numbers({texture.scale.x, texture.scale.y})}};
    return info;
  }
};

void writeEmission(const SculptMaterial& material, Json& out, Json& json) {
  const auto& e = material.emission;
  const float strength = std::max({e[0], e[1], e[2], 1.0F});
  if (e[0] > 0 || e[1] > 0 || e[2] > 0) out["emissiveFactor"] = numbers({e[0] / strength, e[1] / strength, e[2] / strength});
  if (strength == 1) return;
  append(json, "extensionsUsed", "KHR_materials_emissive_strength");
  out["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", shortest(strength)}};
}

Json materialJson(const SculptMaterial& material, Textures& textures, Json& json) {
  Json pbr = Json::object();
  const auto& color = material.base_color;
  if (color != std::array<float, 4>{1, 1, 1, 1}) pbr["baseColorFactor"] = numbers({color[0], color[1], color[2], color[3]});
  if (material.base_color_texture.image >= 0) pbr["baseColorTexture"] = textures.add(material.base_color_texture);
  pbr["metallicFactor"] = shortest(material.metallic);
  pbr["roughnessFactor"] = shortest(material.roughness);
  if (material.metallic_roughness_texture.image >= 0) pbr["metallicRoughnessTexture"] = textures.add(material.metallic_roughness_texture);
  Json out = {{"name", material.name}, {"pbrMetallicRoughness", std::move(pbr)}};
  if (material.normal_texture.image >= 0) {
    out["normalTexture"] = textures.add(material.normal_texture);
    if (material.normal_scale != 1) out["normalTexture"]["scale"] = shortest(material.normal_scale);
  }
  if (material.occlusion_texture.image >= 0) out["occlusionTexture"] = textures.add(material.occlusion_texture);
  if (material.emissive_texture.image >= 0) out["emissiveTexture"] = textures.add(material.emissive_texture);
  writeEmission(material, out, json);
  if (material.blended) out["alphaMode"] = "BLEND";
  out["doubleSided"] = material.double_sided;
  return out;
}

// Whether the columns are orthogonal, as those of a product of translation, rotation and scale are.
bool hasOrthogonalColumns(const Affine& m) {
  const auto column = [&](int a, int b) {
    double sum = 0;
    for (int r = 0; r < 3; ++r) sum += m.linear[r][a] * m.linear[r][b];
    return sum;
  };
  for (int a = 0; a < 3; ++a)
    for (int b = a + 1; b < 3; ++b)
      if (std::abs(column(a, b)) > 1e-6 * std::sqrt(column(a, a) * column(b, b))) return false;
  return true;
}

Json matrixJson(const Affine& m) {
  Json matrix = Json::array();
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) matrix.push_back(m.linear[r][c]);
    matrix.push_back(0);
  }
  for (const double value : m.offset) matrix.push_back(value);
  matrix.push_back(1);
  return matrix;
}

}  // namespace

void writeMaterials(const Sculpt& sculpt, const std::function<int(std::string_view)>& add_image, Json& json) {
  Json materials = Json::array();
  Textures textures{sculpt, add_image, json};
  for (const SculptMaterial& material : sculpt.materials) materials.push_back(materialJson(material, textures, json));
  if (std::any_of(sculpt.parts.begin(), sculpt.parts.end(), [](const SculptPart& part) { return part.material < 0; }))
    materials.push_back(
        {{"name", kOwnMaterialName}, {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}, {"doubleSided", false}});
  json["materials"] = std::move(materials);
}

std::vector<PlacedSculptNode> placeNodes(const std::vector<SculptNode>& nodes, Warnings& warnings) {
  std::vector<PlacedSculptNode> placed;
  std::vector<Affine> to_scene;
  for (const SculptNode& node : nodes) {
    to_scene.push_back(node.parent < 0 ? node.local : compose(to_scene[size_t(node.parent)], node.local));
    const bool parent_moved = node.parent >= 0 && placed[size_t(node.parent)].in_scene_space;
    if (!parent_moved && hasOrthogonalColumns(node.local)) {
      placed.push_back({node.parent, node.local, false});
      continue;
    }
    const bool is_sheared = !hasOrthogonalColumns(to_scene.back());
    placed.push_back({-1, is_sheared ? Affine{} : to_scene.back(), is_sheared});
    if (node.parent >= 0)
      warnings.add(
          WarningKind::kHierarchyChanged,
          "node '" + node.name + "' became a root of the scene, because glTF cannot store the sheared transform of it or of its parent");
  }
  return placed;
}

void writeNodes(const std::vector<SculptNode>& nodes, const std::vector<PlacedSculptNode>& placed, const std::vector<int>& mesh_of_node,
                Json& json) {
  std::vector<Json> children(placed.size(), Json::array());
  for (size_t i = 0; i < placed.size(); ++i)
    (placed[i].parent < 0 ? json["scenes"][0]["nodes"] : children[size_t(placed[i].parent)]).push_back(i);
  for (size_t i = 0; i < placed.size(); ++i) {
    Json node = {{"name", nodes[i].name}};
    if (mesh_of_node[i] >= 0) node["mesh"] = mesh_of_node[i];
    if (!children[i].empty()) node["children"] = std::move(children[i]);
    const Affine identity;
    if (placed[i].local.linear != identity.linear || placed[i].local.offset != identity.offset)
      node["matrix"] = matrixJson(placed[i].local);
    json["nodes"].push_back(std::move(node));
  }
}

}  // namespace cloudbake
