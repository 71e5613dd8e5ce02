// glTF 2.0: "glTF 2.0 Specification" (Khronos, ISO/IEC 12113:2022). tinygltf parses the geometry and loads the buffers. The rest of
// the document stays in the JSON tree that the writer edits, so tinygltf sees no images, materials or extras.
#include "io/gltf/sculpt/read.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <exception>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/memory_budget.h"
#include "core/text/json.h"
#include "core/text/numbers.h"
#include "io/file/neighbour.h"
#include "io/file/write_file.h"
#include "io/gltf/accessor.h"
#include "io/gltf/document.h"
#include "io/gltf/named_files.h"
#include "io/gltf/nodes.h"
#include "io/gltf/sculpt/budget.h"
#include "io/gltf/sculpt/earlier_bake.h"
#include "io/gltf/sculpt/load.h"
#include "io/gltf/sculpt/skin.h"
#include "io/gltf/tinygltf.h"
#include "io/gltf/unpack/unpack.h"
#include "io/gltf/value_types.h"

namespace cloudbake {

namespace {

namespace fs = std::filesystem;

Json parseDocument(const fs::path& file, std::string_view text) {
  JsonFault fault;
  std::optional<Json> json = parseJson(text, &fault);
  if (!json) throw InputError(file.string(), fault.line, "the JSON " + fault.why + "; export the file again");
  if (!json->is_object()) throw InputError(file.string(), "not a glTF: its JSON is not an object; export the file again");
  return std::move(*json);
}

// A glTF 1 has other types, so this comes first.
void checkVersion(const fs::path& file, const Json& json) {
  const Json asset = json.value("asset", Json()), version = asset.is_object() ? asset.value("version", Json()) : Json();
  if (version.is_string() && !version.get<std::string>().starts_with("2."))
    throw InputError(file.string(), "glTF version " + version.get<std::string>() + " is not supported; convert the file to glTF 2.0");
}

// Rejects extensions that change where vertices are stored or how often they are drawn. Extensions of materials, lights, … are kept.
void checkExtensions(const fs::path& file, const Json& json) {
  const auto refuse = [&](const std::string& name, const std::string& cure) {
    throw InputError(file.string(), "the glTF extension " + name + " is not supported; " + cure);
  };
  const auto list = [&](const char* key) { return json.contains(key) && json[key].is_array() ? json[key] : Json::array(); };
  for (const Json& required : list("extensionsRequired")) {
    const std::string name = required.is_string() ? required.get<std::string>() : "?";
    const bool harmless = name == "EXT_meshopt_compression" || name == "KHR_meshopt_compression" || name == "KHR_draco_mesh_compression" ||
                          name == "EXT_mesh_gpu_instancing" || name == "KHR_mesh_quantization" || name == "KHR_texture_transform" ||
                          name == "KHR_texture_basisu" || name == "EXT_texture_webp" || name == "EXT_texture_avif" ||
                          name == "MSFT_texture_dds" || name == "KHR_lights_punctual" || name == "KHR_animation_pointer" ||
                          name.starts_with("KHR_materials_");
    if (!harmless) refuse(name, "the file requires it; export without it");
  }
}

// Reads buffers beside the file or below its folder, like every other file. tinygltf itself would also look in the working folder.
struct NeighbourFiles {
  fs::path file;
  const ReadSettings& settings;
  std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
  std::exception_ptr error = nullptr;  // carried across the library, which does not support exceptions
};

tinygltf::FsCallbacks callbacksFor(NeighbourFiles& files) {
  const auto exists = [](const std::string& path, void* user) {
    return path.starts_with(static_cast<NeighbourFiles*>(user)->folder + "/");
  };
  const auto expand = [](const std::string& path, void*) { return path; };
  const auto read = [](std::vector<unsigned char>* out, std::string* message, const std::string& path, void* user) {
    auto& all = *static_cast<NeighbourFiles*>(user);
    try {
      const std::string bytes = readNeighbour(all.file, path, all.settings);
      out->assign(bytes.begin(), bytes.end());
      return true;
    } catch (const Error& error) {
      all.error = std::current_exception();
      *message = error.what();
      return false;
    }
  };
  const auto write = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; };
  return {exists, expand, read, write, &files};
}

// Images keep their bytes. A GLB in another folder must embed them. An image that cannot be read stays a file name.
void readImages(GltfDocument& document, const ReadSettings& settings, Warnings& warnings) {
  const Json images = document.json.value("images", Json::array());
  for (size_t i = 0; i < images.size(); ++i) {
    const std::string uri =
        images[i].is_object() && images[i].contains("uri") && images[i]["uri"].is_string() ? images[i]["uri"] : Json("");
    if (uri.empty() || uri.starts_with("data:")) continue;
    const auto leave = [&](const std::string& why) {
      warnings.add(WarningKind::kImageNotEmbedded, document.file.string() + ": image '" + uri + "' " + why + ": only its name was kept");
    };
    const fs::path named = document.file.parent_path() / percentDecoded(uri);
    if (uri.find("://") != uri.npos) {
      leave("is not a file");
    } else {
      try {
        std::string bytes = readNeighbour(document.file, named, settings);
        if (imageMimeType(bytes).empty())
          leave("is of an unknown type");
        else
          document.image_files[i] = std::move(bytes);
      } catch (const InputError&) {
        leave("is not used: " + *refusalOfNeighbour(document.file, named, settings.allow_outside));
      } catch (const IoError&) {
        leave("cannot be read");
      }
    }
  }
}

// tinygltf skips a primitive that it cannot parse. The places of the following primitives would shift.
void checkPrimitives(const fs::path& file, const Json& json, const tinygltf::Model& model) {
  for (size_t i = 0; i < model.meshes.size(); ++i)
    if (json.at("meshes").at(i).value("primitives", Json::array()).size() != model.meshes[i].primitives.size())
      throw InputError(file.string(),
                       "mesh " + std::to_string(i) +
                           " has a primitive whose attributes are missing or not whole numbers; the file is damaged, export it again");
}

// Runs tinygltf on some parts of the document, as a GLB in memory.
tinygltf::Model parseParts(const fs::path& file, const Json& parts, std::string_view binary, const ReadSettings& settings) {
  const std::string glb = joinGlb(file, parts.dump(), binary);
  tinygltf::Model model;
  tinygltf::TinyGLTF loader;
  std::string error, warning;
  NeighbourFiles files{file, settings};
  loader.SetFsCallbacks(callbacksFor(files));
  bool loaded = false;
  try {
    loaded = loader.LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(glb.data()), unsigned(glb.size()),
                                         files.folder);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& thrown) {  // a buffer of length 0 makes it index an empty vector
    error += thrown.what();
  }
  if (loaded) {
    checkPrimitives(file, parts, model);
    return model;
  }
  if (files.error) std::rethrow_exception(files.error);
  while (!error.empty() && error.back() == '\n') error.pop_back();
  for (char& c : error) c = c == '\n' ? ' ' : c;
  throw InputError(file.string(), "not a readable glTF: " + error + "; export the file again");
}

// A buffer whose bytes are all made by decoding others has no bytes of its own.
bool isFallback(const Json& buffer) {
  if (!buffer.is_object() || buffer.contains("uri") || !buffer.contains("extensions") || !buffer["extensions"].is_object()) return false;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (buffer["extensions"].contains(name)) return true;
  return false;
}

// Whether a buffer is the binary chunk of a GLB, or its beginning.
bool isChunk(const Json& buffer, std::string_view binary) {
  return buffer.is_object() && !buffer.contains("uri") && buffer.contains("byteLength") && buffer["byteLength"].is_number_unsigned() &&
         buffer["byteLength"] > 0 && buffer["byteLength"] <= binary.size();
}

// The bytes of all buffers, wherever they are. tinygltf loads what is not in the chunk, and says what is wrong.
GltfBuffers loadBuffers(const fs::path& file, const Json& json, std::string_view binary, const ReadSettings& settings) {
  Json parts = {{"asset", {{"version", "2.0"}}}, {"buffers", Json::array()}};
  GltfBuffers buffers;
  std::vector<size_t> loaded;  // the buffers of `parts`
  double total = 0;
  int own = 0;  // buffers with bytes of their own
  for (const Json& buffer : json.value("buffers", Json::array())) {
    const bool first = buffers.empty();
    buffers.emplace_back();
    if ((!first || binary.empty()) && isFallback(buffer)) continue;
    ++own;
    if (buffer.is_object() && buffer.contains("byteLength") && buffer["byteLength"].is_number())
      total += buffer["byteLength"].get<double>();
    if (first && isChunk(buffer, binary)) {
      buffers.back().assign(binary.begin(), binary.begin() + std::ptrdiff_t(buffer["byteLength"].get<size_t>()));
      continue;
    }
    loaded.push_back(buffers.size() - 1);
    parts["buffers"].push_back(buffer);
  }
  if (own > 1)
    requireMemory({"the " + shortestText(total) + " bytes that its buffers declare", total, "split the file"}, settings.memory_limit,
                  file.string());
  if (loaded.empty()) return buffers;
  tinygltf::Model model = parseParts(file, parts, binary, settings);
  for (size_t i = 0; i < loaded.size() && i < model.buffers.size(); ++i) buffers[loaded[i]] = std::move(model.buffers[i].data);
  return buffers;
}

}  // namespace

tinygltf::Model parseGeometry(const fs::path& file, const Json& json, GltfBuffers buffers) {
  Json parts = {{"asset", {{"version", "2.0"}}}};
  for (const char* key : {"scene", "scenes", "nodes", "meshes", "accessors", "bufferViews", "skins"})
    if (json.contains(key)) parts[key] = json[key];
  tinygltf::Model model = parseParts(file, parts, "", {});
  model.buffers.resize(buffers.size());
  for (size_t i = 0; i < buffers.size(); ++i) model.buffers[i].data = std::move(buffers[i]);
  return model;
}

namespace {

// The plain document: without compression, and a node per instance. The scene's nodes.
std::vector<PlacedNode> plainNodes(const fs::path& file, std::string_view binary, const ReadSettings& settings, LoadedGltf& loaded,
                                   Warnings& warnings) {
  Json& json = loaded.document->json;
  GltfBuffers buffers = loadBuffers(file, json, binary, settings);
  for (const std::string& name : unpackGltf(file, json, buffers, settings.memory_limit)) loaded.notes.push_back(name + " unpacked");
  loaded.model = parseGeometry(file, json, std::move(buffers));
  std::vector<PlacedNode> nodes = walkScene(file, loaded.model, settings.scene_index);
  checkBudget(file, loaded.model, nodes, instanceCounts(json), settings.memory_limit);
  if (const size_t instances = unpackInstances(file, json, loaded.model, warnings); instances > 0) {
    loaded.notes.push_back(std::to_string(instances) + " instances became nodes");
    nodes = walkScene(file, loaded.model, settings.scene_index);
  }
  return nodes;
}

std::vector<Triangle> trianglesOf(const fs::path& file, const std::vector<uint32_t>& indices, int mode, size_t vertices,
                                  const std::string& owner) {
  for (const uint32_t index : indices)
    if (index >= vertices)
      throw InputError(file.string(), owner + " uses vertex " + std::to_string(index) + " of " + std::to_string(vertices) +
                                          "; the file is damaged, export it again");
  std::vector<Triangle> triangles;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    if (indices.size() % 3 != 0)
      throw InputError(file.string(),
                       owner + " has " + std::to_string(indices.size()) + " indices, which is not a multiple of 3; export the file again");
    for (size_t i = 0; i + 2 < indices.size(); i += 3) triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
    return triangles;
  }
  for (size_t i = 0; i + 2 < indices.size(); ++i) {
    const Triangle t = mode == TINYGLTF_MODE_TRIANGLE_FAN ? Triangle{indices[i + 1], indices[i + 2], indices[0]}
                                                          : Triangle{indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
  }
  return triangles;
}

std::vector<Vec3> readVec3(const GltfAccessors& accessors, int accessor, const std::string& owner) {
  const std::vector<float> floats = accessors.readFloats(accessor, 3, owner);
  std::vector<Vec3> result(floats.size() / 3);
  for (size_t i = 0; i < result.size(); ++i) result[i] = {floats[3 * i], floats[3 * i + 1], floats[3 * i + 2]};
  return result;
}

// Adds weight·target to every vertex, for POSITION and NORMAL. Uses the node's weights if it has its own, else the mesh's.
void applyMorphTargets(const fs::path& file, const GltfAccessors& accessors, const tinygltf::Primitive& primitive,
                       const std::vector<double>& weights, const std::string& owner, SculptPart& part) {
  for (size_t target = 0; target < primitive.targets.size() && target < weights.size(); ++target) {
    if (weights[target] == 0) continue;
    for (const auto& [attribute, accessor] : primitive.targets[target]) {
      std::vector<Vec3>* moved = attribute == "POSITION" ? &part.positions : attribute == "NORMAL" ? &part.normals : nullptr;
      if (!moved || moved->empty()) continue;
      const std::vector<Vec3> delta = readVec3(accessors, accessor, owner + "'s morph target");
      if (delta.size() != moved->size())
        throw InputError(file.string(), owner + " has a morph target of a different size; export the file again");
      for (size_t i = 0; i < delta.size(); ++i) (*moved)[i] += delta[i] * float(weights[target]);
    }
  }
}

// Whether values of an attribute can be blended: they are floats, fractions, or whole numbers of a kind that stands for a place.
bool isBlendable(const std::string& name, const tinygltf::Accessor& accessor) {
  for (const char* of_numbers : {"JOINTS_", "WEIGHTS_", "_FEATURE_ID_", "_BATCHID"})
    if (name.starts_with(of_numbers)) return false;
  const bool is_place = name == "POSITION" || name == "NORMAL" || name == "TANGENT" || name.starts_with("TEXCOORD_");
  return (accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT || accessor.normalized || is_place) &&
         (accessor.type == TINYGLTF_TYPE_SCALAR || accessor.type == TINYGLTF_TYPE_VEC2 || accessor.type == TINYGLTF_TYPE_VEC3 ||
          accessor.type == TINYGLTF_TYPE_VEC4);
}

// Why no vertices can be added to a primitive between its own; empty if they can.
std::string fixedBecause(const tinygltf::Model& model, const tinygltf::Primitive& primitive, bool is_skinned, size_t vertices) {
  if (is_skinned) return "is skinned";
  if (!primitive.targets.empty()) return "has morph targets";
  for (const auto& [name, extension] : primitive.extensions)
    if (name != "KHR_materials_variants") return "has the extension " + name;
  for (const auto& [name, index] : primitive.attributes) {
    if (index < 0 || size_t(index) >= model.accessors.size() || model.accessors[size_t(index)].count != vertices)
      return "has a damaged attribute " + name;
    if (!isBlendable(name, model.accessors[size_t(index)])) return "has the attribute " + name + ", which cannot be blended";
  }
  return "";
}

// One primitive as a part; nothing if it consists of points or lines.
std::optional<SculptPart> readPrimitive(const fs::path& file, const tinygltf::Model& model, const PlacedNode& placed, size_t index,
                                        Poser& poser, Warnings& warnings) {
  const tinygltf::Node& node = model.nodes[size_t(placed.node)];
  const tinygltf::Mesh& mesh = model.meshes[size_t(node.mesh)];
  const tinygltf::Primitive& primitive = mesh.primitives[index];
  const std::string owner =
      "primitive " + std::to_string(index) + " of mesh " + std::to_string(node.mesh) + (mesh.name.empty() ? "" : " ('" + mesh.name + "')");
  const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  if (mode > TINYGLTF_MODE_TRIANGLE_FAN) throw InputError(file.string(), owner + " has an unknown mode; export the file again");
  const auto position = primitive.attributes.find("POSITION"), normal = primitive.attributes.find("NORMAL");
  if (mode < TINYGLTF_MODE_TRIANGLES || position == primitive.attributes.end()) {
    warnings.add(WarningKind::kPartIgnored, file.string() + ": " + owner + " has no surface (points, lines or no positions)");
    return std::nullopt;
  }

  const GltfAccessors accessors{file, model};
  SculptPart part;
  part.name = !node.name.empty() ? node.name : !mesh.name.empty() ? mesh.name : "node " + std::to_string(placed.node);
  part.object = placed.node;
  part.positions = readVec3(accessors, position->second, owner);
  if (part.positions.empty()) {
    warnings.add(WarningKind::kPartIgnored, file.string() + ": " + owner + " has no vertices");
    return std::nullopt;
  }
  if (normal != primitive.attributes.end()) part.normals = readVec3(accessors, normal->second, owner);
  applyMorphTargets(file, accessors, primitive, node.weights.empty() ? mesh.weights : node.weights, owner, part);
  std::vector<uint32_t> indices;
  if (primitive.indices >= 0) {
    indices = accessors.readIndices(primitive.indices, owner);
  } else {
    for (size_t i = 0; i < part.positions.size(); ++i) indices.push_back(uint32_t(i));
  }
  part.triangles = trianglesOf(file, indices, mode, part.positions.size(), owner);
  part.fixed = fixedBecause(model, primitive, node.skin >= 0, part.positions.size());
  if (node.skin >= 0) part.vertex_to_scene = poser.mapsOf(primitive, node.skin, part.positions, owner, warnings);
  if (part.vertex_to_scene.empty()) part.to_scene = placed.to_scene;  // glTF ignores the node of a skinned mesh
  return part;
}

// Counts what is not baked as an animation would show it.
void countPoses(const fs::path& file, const tinygltf::Model& model, const tinygltf::Node& node, int index, Warnings& warnings) {
  for (const tinygltf::Primitive& primitive : model.meshes[size_t(node.mesh)].primitives) {
    if (!primitive.targets.empty())
      warnings.add(WarningKind::kPoseIgnored,
                   file.string() + ": " + nodeLabel(model, index) + " has morph targets; the file's weights are baked");
    if (node.skin >= 0 && !primitive.attributes.contains("JOINTS_0"))
      warnings.add(WarningKind::kPoseIgnored, file.string() + ": " + nodeLabel(model, index) +
                                                  " has a skin, but its mesh has no joints; it is baked where the node places it");
  }
}

// Reads what the nodes of the scene draw. Parts under a scale of 0 are left out, unless there are no others.
void readParts(const fs::path& file, const std::vector<PlacedNode>& nodes, LoadedGltf& loaded, Warnings& warnings) {
  const tinygltf::Model& model = loaded.model;
  Poser poser(file, model, nodes);
  std::set<int> skinned;
  std::string singular;
  for (const PlacedNode& placed : nodes) {
    const tinygltf::Node& node = model.nodes[size_t(placed.node)];
    if (node.mesh < 0) continue;
    const std::string label = nodeLabel(model, placed.node);
    if (size_t(node.mesh) >= model.meshes.size())
      throw InputError(file.string(), label + " uses a mesh that does not exist; export the file again");
    countPoses(file, model, node, placed.node, warnings);
    for (size_t i = 0; i < model.meshes[size_t(node.mesh)].primitives.size(); ++i) {
      auto part = readPrimitive(file, model, placed, i, poser, warnings);
      if (!part) continue;
      if (!part->vertex_to_scene.empty()) {
        skinned.insert(placed.node);
      } else if (!inverted(part->to_scene)) {
        singular = label + " has a singular transform (a scale is 0)";
        warnings.add(WarningKind::kSingularTransform, file.string() + ": " + singular + "; its mesh gets no lobes");
        continue;
      }
      loaded.sculpt.parts.push_back(std::move(*part));
      loaded.document->places.push_back({placed.node, node.mesh, int(i)});
    }
  }
  if (loaded.sculpt.parts.empty() && !singular.empty()) throw InputError(file.string(), singular + "; correct the scale");
  if (!skinned.empty())
    loaded.notes.push_back(std::to_string(skinned.size()) + (skinned.size() == 1 ? " skinned node" : " skinned nodes") +
                           " posed by joints");
}

}  // namespace

LoadedGltf loadGltf(const fs::path& file, std::string_view bytes, const ReadSettings& settings, Warnings& warnings) {
  const GlbChunks chunks = splitGlb(file, bytes);
  LoadedGltf loaded;
  loaded.document = std::make_shared<GltfDocument>();
  GltfDocument& document = *loaded.document;
  document.file = file;
  document.json = parseDocument(file, chunks.json);
  std::vector<PlacedNode> nodes;
  try {
    checkVersion(file, document.json);
    checkValueTypes(file, document.json);
    checkExtensions(file, document.json);
    nodes = plainNodes(file, chunks.binary, settings, loaded, warnings);
    if (document.json.contains("animations"))
      warnings.add(WarningKind::kPoseIgnored, file.string() + ": animations; the default pose is baked",
                   document.json["animations"].size());
  } catch (const Json::exception& error) {
    throw InputError(file.string(), std::string("a value of the glTF has the wrong type (") + error.what() + "); export the file again");
  }
  countOtherScenes(file, loaded.model, nodes, warnings);
  if (settings.scene_index) document.json["scene"] = *settings.scene_index;
  readParts(file, nodes, loaded, warnings);
  loaded.sculpt.gltf = loaded.document;
  return loaded;
}

Sculpt readGltf(const fs::path& file, std::string_view bytes, const ReadSettings& settings, Warnings& warnings) {
  if ((file.extension() == ".glb" || file.extension() == ".GLB") && !bytes.starts_with("glTF"))
    throw InputError(file.string(), "not a GLB: it does not begin with 'glTF'; export the file again");
  LoadedGltf loaded = loadGltf(file, bytes, settings, warnings);
  for (tinygltf::Buffer& buffer : loaded.model.buffers) loaded.document->buffers.push_back(std::move(buffer.data));
  try {
    removeEarlierBake(*loaded.document);
  } catch (const Json::exception& error) {
    throw InputError(file.string(), std::string("the data of an earlier bake is damaged (") + error.what() + "); bake the sculpt itself");
  }
  readImages(*loaded.document, settings, warnings);
  loaded.sculpt.frame_note = frameText(1, 'Y', false, "glTF's frame");
  for (const std::string& note : loaded.notes) loaded.sculpt.frame_note += "; " + note;
  return loaded.sculpt;
}

std::string sourceHash(const Sculpt& sculpt, std::string_view bytes) {
  if (!sculpt.gltf || !sculpt.gltf->was_baked) return hashBytes(bytes);
  Json json = sculpt.gltf->json;
  json["asset"].erase("generator");
  json["asset"]["extras"].erase("cloudbake");
  std::string hashes = hashBytes(json.dump(-1, ' ', false, Json::error_handler_t::replace));
  for (const std::vector<unsigned char>& buffer : sculpt.gltf->buffers)
    hashes += hashBytes({reinterpret_cast<const char*>(buffer.data()), buffer.size()});
  for (const auto& [image, of_image] : sculpt.gltf->image_files) hashes += hashBytes(of_image);
  return hashBytes(hashes);
}

}  // namespace cloudbake
