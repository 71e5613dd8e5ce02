// assimp gives a material as keys and values (assimp/material.h). Physically-based keys are taken where the file has them; otherwise those
// of the Phong model: the diffuse colour becomes the base colour, and the exponent n the roughness sqrt(2 / (n + 2)). The colours of a 3MF
// are sRGB (Core Specification 1.3, 5.1), and assimp puts "id1_" before the names of its materials.
#include "io/sculpt/assimp_materials.h"

#include <assimp/material.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/srgb.h"
#include "core/text/scan.h"
#include "io/sculpt/sculpt_images.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

struct AssimpConverter {
  const fs::path& file;
  const aiScene& scene;
  const aiMaterial& in;
  ImageCollector& images;
  Warnings& warnings;
  std::string name = in.GetName().C_Str();

  std::string owner() const { return "material '" + name + "'"; }

  std::optional<float> number(const char* key, unsigned type, unsigned index) const {
    ai_real value = 0;
    if (in.Get(key, type, index, value) != aiReturn_SUCCESS || !std::isfinite(value)) return std::nullopt;
    return float(value);
  }
  float limited(float value, float most) const {
    const float kept = std::clamp(value, 0.0F, most);
    if (kept != value)
      warnings.add(WarningKind::kMaterialIgnored, file.string() + ": a value of " + owner() + " is out of range and was limited");
    return kept;
  }
  std::optional<aiColor4D> color(const char* key, unsigned type, unsigned index) const {
    aiColor4D value;
    if (in.Get(key, type, index, value) != aiReturn_SUCCESS) return std::nullopt;
    if (!std::isfinite(value.r) || !std::isfinite(value.g) || !std::isfinite(value.b)) return std::nullopt;
    return value;
  }

  // The image of a texture: embedded in the scene, or a file.
  int imageOf(const std::string& written) const {
    const aiTexture* embedded = scene.GetEmbeddedTexture(written.c_str());
    if (!embedded) return images.fromFile(written, owner());
    const std::string stored = embedded->mFilename.length > 0 ? embedded->mFilename.C_Str() : written;
    if (embedded->mHeight == 0)
      return images.fromBytes(stored, {reinterpret_cast<const char*>(embedded->pcData), embedded->mWidth}, owner());
    warnings.add(WarningKind::kImageNotEmbedded,
                 file.string() + ": image '" + stored + "' of " + owner() + " is stored as plain pixels; it was left out");
    return -1;
  }

  SculptTexture texture(aiTextureType type) const {
    SculptTexture use;
    aiString path;
    if (in.GetTextureCount(type) == 0 || in.GetTexture(type, 0, &path) != aiReturn_SUCCESS || path.length == 0) return use;
    use.image = imageOf(path.C_Str());
    int set = 0, mode = aiTextureMapMode_Wrap;
    if (in.Get(AI_MATKEY_UVWSRC(type, 0), set) == aiReturn_SUCCESS && set >= 0 && set < 8) use.uv_set = set;
    if (in.Get(AI_MATKEY_MAPPINGMODE_U(type, 0), mode) == aiReturn_SUCCESS)
      use.wrap = mode == aiTextureMapMode_Clamp    ? TextureWrap::kClamp
                 : mode == aiTextureMapMode_Mirror ? TextureWrap::kMirror
                                                   : TextureWrap::kRepeat;
    aiUVTransform transform;
    if (in.Get(AI_MATKEY_UVTRANSFORM(type, 0), transform) != aiReturn_SUCCESS) return use;
    const bool sound = std::isfinite(transform.mScaling.x) && std::isfinite(transform.mScaling.y) &&
                       std::isfinite(transform.mTranslation.x) && std::isfinite(transform.mTranslation.y);
    if (sound && transform.mRotation == 0) {  // in assimp v grows upwards
      use.scale = {transform.mScaling.x, transform.mScaling.y};
      use.offset = {transform.mTranslation.x, 1 - transform.mScaling.y - transform.mTranslation.y};
    } else {
      warnings.add(WarningKind::kTextureIgnored, file.string() + ": the rotation of a texture of " + owner() + " is not kept");
    }
    return use;
  }
  // The first of two types that the material has.
  SculptTexture texture(aiTextureType first, aiTextureType second) const { return texture(in.GetTextureCount(first) > 0 ? first : second); }

  void colors(SculptMaterial& out) const {
    auto base = color(AI_MATKEY_BASE_COLOR);
    if (!base) base = color(AI_MATKEY_COLOR_DIFFUSE);
    out.base_color_texture = texture(aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE);
    if (base) out.base_color = {limited(base->r, 1), limited(base->g, 1), limited(base->b, 1), 1};
    const auto opacity = number(AI_MATKEY_OPACITY);
    out.base_color[3] = opacity ? limited(*opacity, 1) : 1;
    out.blended =
        out.base_color[3] < 1 || (in.GetTextureCount(aiTextureType_OPACITY) > 0 && sameImage(aiTextureType_OPACITY, aiTextureType_DIFFUSE));
    if (const auto emission = color(AI_MATKEY_COLOR_EMISSIVE)) {
      const float strength = number(AI_MATKEY_EMISSIVE_INTENSITY).value_or(1);
      out.emission = {limited(emission->r * strength, 1e6F), limited(emission->g * strength, 1e6F), limited(emission->b * strength, 1e6F)};
    }
    out.emissive_texture = texture(aiTextureType_EMISSION_COLOR, aiTextureType_EMISSIVE);
    if (out.emissive_texture.image >= 0 && out.emission == std::array<float, 3>{}) out.emission = {1, 1, 1};
    int two_sided = 0;
    out.double_sided = in.Get(AI_MATKEY_TWOSIDED, two_sided) == aiReturn_SUCCESS && two_sided != 0;
  }

  bool sameImage(aiTextureType a, aiTextureType b) const {
    aiString first, second;
    return in.GetTexture(a, 0, &first) == aiReturn_SUCCESS && in.GetTexture(b, 0, &second) == aiReturn_SUCCESS && first == second;
  }

  void surface(SculptMaterial& out) const {
    if (const auto metallic = number(AI_MATKEY_METALLIC_FACTOR)) out.metallic = limited(*metallic, 1);
    const auto roughness = number(AI_MATKEY_ROUGHNESS_FACTOR), exponent = number(AI_MATKEY_SHININESS);
    if (roughness)
      out.roughness = limited(*roughness, 1);
    else if (exponent && *exponent > 0)
      out.roughness = std::sqrt(2 / (*exponent + 2));
    out.normal_texture = texture(aiTextureType_NORMAL_CAMERA, aiTextureType_NORMALS);
    if (out.normal_texture.image >= 0) return;
    const SculptTexture bump = texture(aiTextureType_HEIGHT);
    if (bump.image < 0) return;
    if (looksLikeNormalMap(images.images[size_t(bump.image)].bytes))
      out.normal_texture = bump;
    else
      ignore("a height map, which glTF does not have");
  }

  void ignore(const std::string& what) const {
    warnings.add(WarningKind::kTextureIgnored, file.string() + ": a texture of " + owner() + " was left out: " + what);
  }
  void countIgnored() const {
    static constexpr std::array<std::pair<aiTextureType, const char*>, 9> kOthers{{{aiTextureType_SPECULAR, "specular"},
                                                                                   {aiTextureType_AMBIENT, "ambient"},
                                                                                   {aiTextureType_SHININESS, "shininess"},
                                                                                   {aiTextureType_DISPLACEMENT, "displacement"},
                                                                                   {aiTextureType_LIGHTMAP, "light map"},
                                                                                   {aiTextureType_REFLECTION, "reflection"},
                                                                                   {aiTextureType_METALNESS, "metalness"},
                                                                                   {aiTextureType_DIFFUSE_ROUGHNESS, "roughness"},
                                                                                   {aiTextureType_AMBIENT_OCCLUSION, "ambient occlusion"}}};
    for (const auto& [type, what] : kOthers)
      if (in.GetTextureCount(type) > 0 && !sameImage(type, aiTextureType_DIFFUSE)) ignore(std::string(what) + " is not kept");
    if (in.GetTextureCount(aiTextureType_OPACITY) > 0 && !sameImage(aiTextureType_OPACITY, aiTextureType_DIFFUSE))
      ignore("glTF needs opacity as the alpha of the base colour");
    for (const aiTextureType type : {aiTextureType_DIFFUSE, aiTextureType_NORMALS, aiTextureType_EMISSIVE})
      if (in.GetTextureCount(type) > 1) ignore("it is a second layer");
  }
};

// Whether a material is not of the file, but what assimp gives a mesh without one. For a PLY that is grey and has no name.
bool isDefault(const fs::path& file, const aiMaterial& material) {
  const std::string name = const_cast<aiMaterial&>(material).GetName().C_Str();
  if (material.GetTextureCount(aiTextureType_DIFFUSE) > 0) return false;
  aiColor4D color;
  const bool is_colored =
      material.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS && lowerCase(file.extension().string()) != ".ply";
  return name == AI_DEFAULT_MATERIAL_NAME || (name.empty() && !is_colored);
}

void finish3mf(SculptMaterial& material) {
  for (size_t i = 0; i < 3; ++i) material.base_color[i] = linearOfSrgb(material.base_color[i]);
  const size_t end = material.name.find('_');
  if (material.name.starts_with("id") && end != std::string::npos) material.name.erase(0, end + 1);
}

}  // namespace

void keepMaterials(const fs::path& file, const aiScene& scene, const ReadSettings& settings, Sculpt& sculpt, Warnings& warnings) {
  ImageCollector images{file, settings, sculpt.images, warnings};
  std::map<int, int> known;
  for (SculptPart& part : sculpt.parts) {
    const auto [entry, added] = known.try_emplace(part.material, -1);
    const bool exists = part.material >= 0 && unsigned(part.material) < scene.mNumMaterials;
    if (added && exists && !isDefault(file, *scene.mMaterials[part.material])) {
      const AssimpConverter converter{file, scene, *scene.mMaterials[part.material], images, warnings};
      SculptMaterial material;
      material.name = converter.name.empty() ? "material" : converter.name;
      converter.colors(material);
      converter.surface(material);
      converter.countIgnored();
      if (lowerCase(file.extension().string()) == ".3mf") finish3mf(material);
      entry->second = int(sculpt.materials.size());
      sculpt.materials.push_back(std::move(material));
    }
    part.material = entry->second;
  }
}

}  // namespace cloudbake
