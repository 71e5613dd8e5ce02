// glTF 2.0, section 3.9: every texture of a material multiplies a factor, so white is neutral as base colour, as metallic-roughness,
// as occlusion (1 = no occlusion) and as emission (the factor stays). It is also neutral in KHR_materials_clearcoat, whose factor is 0 if
// the material had no clear coat.
#include "io/gltf/keep_alive.h"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "io/gltf/value_types.h"

namespace cloudbake {

namespace {

// Two white pixels, 8-bit RGBA, alpha 255 and 250. No slot used here reads alpha. The difference matters to gltf-transform: its prune
// replaces an image of a single colour by a factor, and a second prune would then drop the UV sets.
constexpr std::array<unsigned char, 69> kWhitePng{0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48,
                                                  0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00,
                                                  0x00, 0xF4, 0x22, 0x7F, 0x8A, 0x00, 0x00, 0x00, 0x0C, 0x49, 0x44, 0x41, 0x54, 0x78,
                                                  0xDA, 0x63, 0xF8, 0x0F, 0x01, 0xBF, 0x00, 0x23, 0xE0, 0x07, 0xF4, 0xE8, 0xCB, 0xB7,
                                                  0xC1, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};

constexpr const char* kClearcoat = "KHR_materials_clearcoat";

// A texture slot of a material: the path from the material to the object that contains it, and its name there.
struct Slot {
  std::vector<std::string> object;
  std::string name;
};

bool isFree(const Json& material, const Slot& slot) {
  const Json* object = &material;
  for (const std::string& key : slot.object) {
    if (!object->contains(key)) return true;
    object = &(*object)[key];
  }
  return !object->contains(slot.name);
}

void fill(Json& material, const Slot& slot, int texture, int set) {
  Json* object = &material;
  for (const std::string& key : slot.object) object = &(*object)[key];
  (*object)[slot.name] = {{"index", texture}, {"texCoord", set}};
}

// The UV sets that must be bound so that the lobes stay in their sets: the two sets themselves and then all lower ones (gltf-transform's
// prune moves sets above a gap down), without those that a texture of the material already uses. `owner`: of the material, for messages.
std::vector<int> setsToBind(const Json& material, int set, const std::string& owner) {
  std::set<int64_t> used;
  std::vector<const Json*> stack{&material};
  while (!stack.empty()) {
    const Json& top = *stack.back();
    stack.pop_back();
    if (!top.is_object()) continue;
    if (top.contains("index")) {  // a texture, maybe of an extension
      const Json texcoord = top.value("texCoord", Json(0));
      if (!texcoord.is_number_integer())
        throw InputError("",
                         owner + ": the texCoord of a texture is " + valueText(texcoord) + ", not a whole number; export the file again");
      used.insert(texcoord.get<int64_t>());
    }
    for (const auto& [key, member] : top.items())
      if (key != "extras") stack.push_back(&member);
  }
  std::vector<int> sets{set, set + 1};
  for (int lower = 0; lower < set; ++lower) sets.push_back(lower);
  std::erase_if(sets, [&](int candidate) { return used.contains(candidate); });
  return sets;
}

// All free slots in which white is neutral, best first.
std::vector<Slot> freeSlots(const Json& material, KeepAliveTexture mode) {
  std::vector<Slot> slots{{{"pbrMetallicRoughness"}, "baseColorTexture"},
                          {{}, "occlusionTexture"},
                          {{"pbrMetallicRoughness"}, "metallicRoughnessTexture"},
                          {{}, "emissiveTexture"}};
  const Json extensions = material.value("extensions", Json::object());
  // The extension's specification forbids it together with these two.
  const bool allows_clearcoat = !extensions.contains("KHR_materials_unlit") && !extensions.contains("KHR_materials_pbrSpecularGlossiness");
  if (mode == KeepAliveTexture::kForce && allows_clearcoat)
    for (const char* name : {"clearcoatTexture", "clearcoatRoughnessTexture"}) slots.push_back({{"extensions", kClearcoat}, name});
  const bool reads_alpha = material.value("alphaMode", "OPAQUE") != "OPAQUE";
  std::erase_if(slots, [&](const Slot& slot) { return !isFree(material, slot) || (reads_alpha && slot.name == "baseColorTexture"); });
  return slots;
}

void appendOnce(Json& json, const char* key, const std::string& value) {
  Json& list = json[key];
  if (!list.is_array()) list = Json::array();
  if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
}

int append(Json& json, const char* key, Json value) {
  Json& list = json[key];
  if (!list.is_array()) list = Json::array();
  list.push_back(std::move(value));
  return int(list.size()) - 1;
}

int addWhiteTexture(Json& json, const std::function<int(std::string_view)>& add_image) {
  const int image = append(json, "images", {{"name", "white"}, {"mimeType", "image/png"}, {"bufferView", add_image(whitePng())}});
  const int sampler = append(json, "samplers", {{"magFilter", 9728}, {"minFilter", 9728}, {"wrapS", 10497}, {"wrapT", 10497}});
  return append(json, "textures", {{"name", "white"}, {"sampler", sampler}, {"source", image}});
}

// Materials that are also used by a primitive without the two sets. They must not get a texture that uses the sets.
std::vector<bool> materialsInUseElsewhere(const Json& json, const std::string& needed_set, size_t count) {
  std::vector<bool> used(count);
  for (const Json& mesh : json.at("meshes"))
    for (const Json& primitive : mesh.at("primitives")) {
      if (primitive.at("attributes").contains(needed_set) || !primitive.contains("material")) continue;
      const auto material = uint64_t(wholeNumber(primitive["material"]));
      if (material < count) used[material] = true;
    }
  return used;
}

}  // namespace

std::string_view whitePng() { return {reinterpret_cast<const char*>(kWhitePng.data()), kWhitePng.size()}; }

void bindKeepAliveTextures(Json& json, const std::vector<GltfPrimitive>& primitives, int set, KeepAliveTexture mode, int texture,
                           const std::function<int(std::string_view)>& add_image, const std::string& file, Warnings& warnings) {
  const std::vector<bool> shared = materialsInUseElsewhere(json, uvSetName(set + 1), json.value("materials", Json::array()).size());
  std::map<int64_t, int64_t> done;  // material before → after; −1 is glTF's default material
  for (const GltfPrimitive& place : primitives) {
    // Looked up again each time, because a new key in an ordered_json moves its neighbours in memory.
    const auto primitive = [&]() -> Json& { return primitiveOf(json, place); };
    const int64_t before = wholeNumber(primitive(), "material", -1);
    const auto [entry, added] = done.try_emplace(before, before);
    if (added) {
      if (before >= int64_t(shared.size()))
        throw InputError(file, "a primitive uses material " + std::to_string(before) + " of " + std::to_string(shared.size()) +
                                   "; the file is damaged, export it again");
      Json material = before >= 0 ? json.at("materials").at(size_t(before)) : Json{{"name", kOwnMaterialName}};
      const std::vector<int> sets = setsToBind(material, set, "material " + std::to_string(before));
      const std::vector<Slot> slots = freeSlots(material, mode);
      if (sets.empty()) continue;
      if (slots.size() < sets.size()) {
        const std::string name = material.value("name", "");
        warnings.add(WarningKind::kKeepAlive, file + ": material " + std::to_string(before) + (name.empty() ? "" : " ('" + name + "')") +
                                                  " has " + std::to_string(slots.size()) + " free texture slots of " +
                                                  std::to_string(sets.size()) +
                                                  " needed: an optimiser may drop the UV sets (see --keep-alive-texture)");
        continue;
      }
      if (texture < 0) texture = addWhiteTexture(json, add_image);
      for (size_t i = 0; i < sets.size(); ++i) {
        fill(material, slots[i], texture, sets[i]);
        if (!slots[i].object.empty() && slots[i].object.back() == kClearcoat) appendOnce(json, "extensionsUsed", kClearcoat);
      }
      if (before >= 0 && !shared[size_t(before)])
        json["materials"][size_t(before)] = std::move(material);
      else
        entry->second = append(json, "materials", std::move(material));
    }
    if (entry->second >= 0) primitive()["material"] = entry->second;
  }
}

}  // namespace cloudbake
