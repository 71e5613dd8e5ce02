// The GLB container (glTF 2.0, section 4): magic, version 2, length; then chunks of length, type, data, padded to four bytes
// (JSON with blanks, binary with zeros).
#include "io/gltf/document.h"

#include <charconv>
#include <cstring>
#include <exception>

#include "core/error.h"
#include "core/text/json.h"

namespace cloudbake {

namespace {

uint32_t loadWord(std::string_view bytes, size_t at) {
  uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, 4);
  return word;
}

void appendWord(std::string& bytes, size_t word) {
  const uint32_t value = uint32_t(word);
  bytes.append(reinterpret_cast<const char*>(&value), 4);
}

}  // namespace

Json& primitiveOf(Json& json, GltfPrimitive place) {
  return json.at("meshes").at(size_t(place.first)).at("primitives").at(size_t(place.second));
}

const Json& primitiveOf(const Json& json, GltfPrimitive place) {
  return json.at("meshes").at(size_t(place.first)).at("primitives").at(size_t(place.second));
}

std::set<size_t> accessorsInUse(const Json& json, const std::set<GltfPrimitive>& left_out) {
  std::set<size_t> used;
  const auto use = [&](const Json& accessor) {
    if (accessor.is_number_unsigned()) used.insert(accessor.get<size_t>());
  };
  for (size_t m = 0; m < json.at("meshes").size(); ++m)
    for (size_t p = 0; p < json["meshes"][m].at("primitives").size(); ++p) {
      if (left_out.contains({int(m), int(p)})) continue;
      const Json& primitive = json["meshes"][m]["primitives"][p];
      for (const Json& accessor : primitive.at("attributes")) use(accessor);
      for (const Json& target : primitive.value("targets", Json::array()))
        for (const Json& accessor : target) use(accessor);
      use(primitive.value("indices", Json()));
    }
  for (const Json& skin : json.value("skins", Json::array())) use(skin.value("inverseBindMatrices", Json()));
  for (const Json& animation : json.value("animations", Json::array()))
    for (const Json& sampler : animation.at("samplers")) use(sampler.at("input")), use(sampler.at("output"));
  for (const Json& node : json.value("nodes", Json::array())) {
    const Json instances = node.value("extensions", Json::object()).value("EXT_mesh_gpu_instancing", Json::object());
    for (const Json& accessor : instances.value("attributes", Json::object())) use(accessor);
  }
  return used;
}

GlbChunks splitGlb(const std::filesystem::path& file, std::string_view bytes) {
  const auto fail = [&](const std::string& what) { throw InputError(file.string(), what + "; the file is damaged, export it again"); };
  if (!bytes.starts_with("glTF")) return {bytes, {}};
  if (bytes.size() < 20) fail("the GLB ends inside its header");
  if (loadWord(bytes, 4) != 2)
    throw InputError(file.string(),
                     "GLB version " + std::to_string(loadWord(bytes, 4)) + " is not supported; convert the file to glTF 2.0");
  const size_t length = loadWord(bytes, 8);
  if (length > bytes.size())
    fail("the GLB declares " + std::to_string(length) + " bytes but has " + std::to_string(bytes.size()) + ": it is truncated");

  GlbChunks chunks;
  for (size_t at = 12, index = 0; at + 8 <= length; ++index) {
    const size_t chunk_length = loadWord(bytes, at);
    const uint32_t type = loadWord(bytes, at + 4);
    if (chunk_length > length - at - 8) fail("chunk " + std::to_string(index) + " of the GLB ends beyond the file");
    if (index == 0 && type != kGlbJsonChunk) fail("the first chunk of the GLB is not JSON");
    if (index == 0) chunks.json = bytes.substr(at + 8, chunk_length);
    if (index == 1 && type == kGlbBinaryChunk) chunks.binary = bytes.substr(at + 8, chunk_length);
    at += 8 + chunk_length;
  }
  return chunks;
}

std::string joinGlb(const std::filesystem::path& file, std::string_view json, std::span<const std::string_view> pieces) {
  const auto padding = [](size_t size) { return (4 - size % 4) % 4; };
  size_t binary = 0;
  for (const std::string_view piece : pieces) binary += piece.size();
  const size_t json_size = json.size() + padding(json.size()), binary_size = binary + padding(binary);
  const size_t length = 20 + json_size + (binary == 0 ? 0 : 8 + binary_size);
  if (length > UINT32_MAX)
    throw InputError(file.string(),
                     "the asset would take " + std::to_string(length) + " bytes, but a GLB holds at most 4 GiB; use fewer vertices");
  std::string glb;
  glb.reserve(length);
  appendWord(glb, kGlbMagic), appendWord(glb, 2), appendWord(glb, length);
  appendWord(glb, json_size), appendWord(glb, kGlbJsonChunk);
  glb.append(json).append(padding(json.size()), ' ');
  if (binary == 0) return glb;
  appendWord(glb, binary_size), appendWord(glb, kGlbBinaryChunk);
  for (const std::string_view piece : pieces) glb.append(piece);
  glb.append(padding(binary), '\0');
  return glb;
}

bool isGltfOfLayout(std::string_view bytes, const char* layout) {
  try {
    const std::string_view text = splitGlb("", bytes).json;
    if (text.find(layout) == text.npos) return false;  // most files, without the time to parse them
    const auto json = parseJson(text);
    return json && isOfLayout(*json, layout);
  } catch (const std::exception&) {
    return false;
  }
}

std::optional<std::string_view> imageIn(const std::filesystem::path& file, const GlbChunks& chunks, const Json& json, const char* name) {
  for (const Json& image : json.at("images")) {
    if (image.value("name", "") != name) continue;
    const Json& view = json.at("bufferViews").at(size_t(wholeNumber(image.at("bufferView"))));
    const auto offset = uint64_t(wholeNumber(view, "byteOffset", 0)), size = uint64_t(wholeNumber(view.at("byteLength")));
    if (offset > chunks.binary.size() || size > chunks.binary.size() - offset)
      throw InputError(file.string(), std::string("the picture '") + name + "' reaches beyond the file");
    return chunks.binary.substr(offset, size);
  }
  return std::nullopt;
}

Json numbersOf(Vec3 v) { return {shortest(v.x), shortest(v.y), shortest(v.z)}; }

Vec3 vectorOf(const Json& json) { return {json.at(0).get<float>(), json.at(1).get<float>(), json.at(2).get<float>()}; }

std::vector<int> separateMeshes(const GltfDocument& document, Json& json) {
  std::map<int, int> mesh_of_node, owner_of_mesh;
  std::vector<int> meshes;
  for (const GltfPlace& place : document.places) {
    const auto [entry, added] = mesh_of_node.try_emplace(place.node, place.mesh);
    if (added && owner_of_mesh.try_emplace(place.mesh, place.node).first->second != place.node) {
      Json copy = json.at("meshes").at(size_t(place.mesh));
      json.at("meshes").push_back(std::move(copy));
      entry->second = int(json.at("meshes").size()) - 1;
      json.at("nodes").at(size_t(place.node))["mesh"] = entry->second;
    }
    meshes.push_back(entry->second);
  }
  return meshes;
}

}  // namespace cloudbake
