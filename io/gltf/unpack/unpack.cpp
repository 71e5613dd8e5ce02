// What the extensions have in common: bytes are checked before they are decoded, and afterwards all views are laid out anew in one buffer,
// so that the compressed bytes are gone.
#include "io/gltf/unpack/unpack.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "core/error.h"
#include "core/memory_budget.h"
#include "io/gltf/accessor.h"
#include "io/gltf/nodes.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

constexpr const char* kMeshoptNames[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};
constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

bool uses(const Json& object, const std::string& name) {
  return object.is_object() && object.contains("extensions") && object["extensions"].is_object() && object["extensions"].contains(name);
}

void eraseExtension(Json& object, const std::string& name) {
  if (!uses(object, name)) return;
  object["extensions"].erase(name);
  if (object["extensions"].empty()) object.erase("extensions");
}

// Removes a name from the lists of extensions. glTF allows no empty list.
void forgetExtension(Json& json, const std::string& name) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (!json.contains(list) || !json[list].is_array()) continue;
    Json kept = Json::array();
    for (const Json& one : json[list])
      if (one != name) kept.push_back(one);
    if (kept.size() == json[list].size()) continue;
    if (kept.empty())
      json.erase(list);
    else
      json[list] = std::move(kept);
  }
}

bool anyUses(const Json& json, const char* list, const std::string& name) {
  if (!json.contains(list) || !json[list].is_array()) return false;
  return std::any_of(json[list].begin(), json[list].end(), [&](const Json& one) { return uses(one, name); });
}

bool usesDraco(const Json& json) {
  if (!json.contains("meshes") || !json["meshes"].is_array()) return false;
  for (const Json& mesh : json["meshes"])
    if (mesh.is_object() && anyUses(mesh, "primitives", kDraco)) return true;
  return false;
}

// Lays the data of all views out anew in one buffer. Views of the same bytes share them.
void layOutViews(Unpacking& unpacking, GltfBuffers& buffers) {
  std::vector<unsigned char> all;
  std::map<std::tuple<uint64_t, uint64_t, uint64_t>, size_t> known;
  Json& views = unpacking.json["bufferViews"];
  for (size_t i = 0; i < views.size(); ++i) {
    const std::string owner = "buffer view " + std::to_string(i);
    std::string_view bytes = unpacking.decoded_views[i];
    size_t at = (all.size() + 3) / 4 * 4;
    if (!unpacking.is_decoded[i]) {
      const uint64_t buffer = countAt(unpacking, views[i], "buffer", 0, owner),
                     offset = countAt(unpacking, views[i], "byteOffset", 0, owner),
                     length = countAt(unpacking, views[i], "byteLength", 0, owner);
      bytes = unpacking.bytesOf(buffer, offset, length, owner);
      const auto [entry, is_new] = known.try_emplace({buffer, offset, length}, at);
      if (is_new) unpacking.reserve(length + 3, owner);
      at = entry->second;
    }
    if (at >= all.size()) {
      all.resize(at);
      all.insert(all.end(), bytes.begin(), bytes.end());
    }
    views[i]["buffer"] = 0;
    views[i]["byteOffset"] = at;
    views[i]["byteLength"] = bytes.size();
    for (const char* name : kMeshoptNames) eraseExtension(views[i], name);
  }
  unpacking.json["buffers"] = Json::array({{{"byteLength", all.size()}}});
  buffers.clear();
  buffers.push_back(std::move(all));
}

// The accessors of a node's instances, by the names of the attributes.
const Json* instanceAttributes(const Json& node) {
  if (!uses(node, kInstancing)) return nullptr;
  const Json& extension = node["extensions"][kInstancing];
  return extension.is_object() && extension.contains("attributes") && extension["attributes"].is_object() ? &extension["attributes"]
                                                                                                          : nullptr;
}

std::vector<double> valuesAt(const std::vector<float>& floats, size_t index, size_t width) {
  return {floats.begin() + ptrdiff_t(index * width), floats.begin() + ptrdiff_t((index + 1) * width)};
}

struct Instances {
  size_t count = 0;
  std::vector<float> translations, rotations, scales;
};

Instances readInstances(const fs::path& file, const tinygltf::Model& model, const Json& attributes, size_t count,
                        const std::string& owner) {
  const GltfAccessors accessors{file, model};
  Instances all;
  all.count = count;
  const auto read = [&](const char* name, int width, std::vector<float>& values) {
    if (!attributes.contains(name)) return;
    values = accessors.readFloats(int(wholeNumber(attributes[name])), width, owner);
    if (values.size() != count * size_t(width))
      throw InputError(file.string(), owner + " have attributes of different lengths; export the file again");
  };
  read("TRANSLATION", 3, all.translations);
  read("ROTATION", 4, all.rotations);
  read("SCALE", 3, all.scales);
  return all;
}

}  // namespace

void Unpacking::fail(const std::string& what) const { throw InputError(file.string(), what + "; the file is damaged, export it again"); }

void Unpacking::reserve(uint64_t bytes, const std::string& owner) {
  requireMemory({owner + ", unpacked beside " + std::to_string(decoded_bytes) + " bytes of other data,",
                 double(decoded_bytes) + double(bytes), "use fewer vertices"},
                limit, file.string());
  decoded_bytes += bytes;
}

std::string_view Unpacking::bytesOf(uint64_t buffer, uint64_t offset, uint64_t length, const std::string& owner) const {
  if (buffer >= buffers.size()) fail(owner + " uses buffer " + std::to_string(buffer) + " of " + std::to_string(buffers.size()));
  const std::vector<unsigned char>& bytes = buffers[buffer];
  if (offset > bytes.size() || length > bytes.size() - offset)
    fail(owner + " ends beyond its buffer of " + std::to_string(bytes.size()) + " bytes");
  return {reinterpret_cast<const char*>(bytes.data()) + offset, size_t(length)};
}

uint64_t countAt(const Unpacking& unpacking, const Json& object, const char* key, uint64_t fallback, const std::string& owner) {
  if (!object.is_object() || !object.contains(key)) return fallback;
  const Json& value = object[key];
  if (!value.is_number_integer() || (!value.is_number_unsigned() && value.get<int64_t>() < 0))
    unpacking.fail(owner + ": " + key + " is not a whole number");
  return value.get<uint64_t>();
}

std::vector<std::string> unpackGltf(const fs::path& file, Json& json, GltfBuffers& buffers, uint64_t limit) {
  std::vector<std::string> found;
  for (const char* name : kMeshoptNames)
    if (anyUses(json, "bufferViews", name)) found.emplace_back(name);
  if (usesDraco(json)) found.emplace_back(kDraco);
  if (!found.empty()) {
    Unpacking unpacking{file, json, buffers, limit};
    if (!json.contains("bufferViews") || !json["bufferViews"].is_array()) unpacking.fail("compressed data without buffer views");
    unpacking.decoded_views.resize(json["bufferViews"].size());
    unpacking.is_decoded.resize(json["bufferViews"].size());
    for (const std::string& name : found)
      if (name != kDraco) unpackMeshopt(unpacking, name);
    if (usesDraco(json)) unpackDraco(unpacking);
    layOutViews(unpacking, buffers);
  }
  for (const std::string name : {kMeshoptNames[0], kMeshoptNames[1], kDraco}) forgetExtension(json, name);
  return found;
}

std::vector<uint64_t> instanceCounts(const Json& json) {
  std::vector<uint64_t> counts;
  if (!json.contains("nodes") || !json["nodes"].is_array()) return counts;
  for (const Json& node : json["nodes"]) {
    counts.push_back(1);
    const Json* attributes = instanceAttributes(node);
    if (!attributes) continue;
    for (const Json& accessor : *attributes) {
      if (!accessor.is_number_unsigned() || !json.contains("accessors") || accessor.get<uint64_t>() >= json["accessors"].size()) continue;
      const Json& one = json["accessors"][accessor.get<size_t>()];
      if (one.is_object() && one.contains("count") && one["count"].is_number_unsigned()) counts.back() = one["count"].get<uint64_t>();
      break;
    }
  }
  return counts;
}

size_t unpackInstances(const fs::path& file, Json& json, tinygltf::Model& model, const std::vector<bool>& hidden, Warnings& warnings) {
  const std::vector<uint64_t> counts = instanceCounts(json);
  size_t total = 0;
  bool are_left = false;
  for (size_t index = 0; index < counts.size(); ++index) {
    if (hidden[index]) {
      are_left = are_left || uses(json["nodes"][index], kInstancing);
      continue;
    }
    const Json* found = instanceAttributes(json["nodes"][index]);
    if (uses(json["nodes"][index], kInstancing) && (!found || found->empty()))
      throw InputError(file.string(), "the instances of " + nodeLabel(model, int(index)) + " have no attributes; export the file again");
    if (!found || !json["nodes"][index].contains("mesh")) continue;
    const std::string owner = "the instances of " + nodeLabel(model, int(index));
    for (const auto& [name, accessor] : found->items())
      if (name != "TRANSLATION" && name != "ROTATION" && name != "SCALE")
        warnings.add(WarningKind::kPartIgnored, file.string() + ": " + owner + " have the attribute " + name + ", which nodes cannot have");
    const Instances all = readInstances(file, model, *found, counts[index], owner);
    total += all.count;
    // Copies, because new nodes move the others.
    Json plain = json["nodes"][index];
    Json child = {{"mesh", plain["mesh"]}};
    tinygltf::Node own = model.nodes[index], copy;
    copy.mesh = own.mesh, copy.skin = own.skin, copy.weights = own.weights;
    own.mesh = own.skin = -1, own.weights.clear();
    for (const char* key : {"skin", "weights"})
      if (plain.contains(key)) child[key] = plain[key];
    for (const char* key : {"mesh", "skin", "weights"}) plain.erase(key);
    for (size_t i = 0; i < all.count; ++i) {
      Json& node = json["nodes"].emplace_back(child);
      copy.name = (own.name.empty() ? "instance" : own.name) + " " + std::to_string(i);
      node["name"] = copy.name;
      const auto place = [&](const char* key, const std::vector<float>& values, size_t width, std::vector<double>& target) {
        if (values.empty()) return;
        target = valuesAt(values, i, width);
        node[key] = target;
      };
      place("translation", all.translations, 3, copy.translation);
      place("rotation", all.rotations, 4, copy.rotation);
      place("scale", all.scales, 3, copy.scale);
      plain["children"].push_back(model.nodes.size());
      own.children.push_back(int(model.nodes.size()));
      model.nodes.push_back(copy);
    }
    eraseExtension(plain, kInstancing);
    json["nodes"][index] = std::move(plain);
    model.nodes[index] = std::move(own);
  }
  for (size_t index = 0; index < counts.size(); ++index)
    if (!hidden[index]) eraseExtension(json["nodes"][index], kInstancing);
  if (!are_left) forgetExtension(json, kInstancing);
  return total;
}

}  // namespace cloudbake
