// glTF 2.0: "glTF 2.0 Specification" (Khronos, ISO/IEC 12113:2022). tinygltf parses the geometry. The rest of the document stays in the
// JSON tree that the writer edits, so tinygltf sees no buffers, images, materials or extras.
#include "io/gltf/sculpt/read.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <span>

#include "core/error.h"
#include "core/first_where.h"
#include "core/text/json.h"
#include "core/text/plain_text.h"
#include "io/file/neighbour.h"
#include "io/file/write_file.h"
#include "io/gltf/accessor.h"
#include "io/gltf/document.h"
#include "io/gltf/named_files.h"
#include "io/gltf/nodes.h"
#include "io/gltf/sculpt/animate.h"
#include "io/gltf/sculpt/budget.h"
#include "io/gltf/sculpt/buffers.h"
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
  std::string mended;
  JsonFault fault;
  std::optional<Json> json = parseJson(plainText(text, file.string(), mended), &fault);
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
                          name == "KHR_node_visibility" || name == "KHR_texture_basisu" || name == "EXT_texture_webp" ||
                          name == "EXT_texture_avif" || name == "MSFT_texture_dds" || name == "KHR_lights_punctual" ||
                          name == "KHR_animation_pointer" || name.starts_with("KHR_materials_");
    if (!harmless) refuse(name, "the file requires it; export without it");
  }
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

}  // namespace

tinygltf::Model parseGeometry(const fs::path& file, const Json& json, GltfBuffers buffers) {
  Json parts = {{"asset", {{"version", "2.0"}}}};
  for (const char* key : {"scene", "scenes", "nodes", "meshes", "accessors", "bufferViews", "skins"})
    if (json.contains(key)) parts[key] = json[key];
  const std::string glb = joinGlb(file, parts.dump(), "");
  tinygltf::Model model;
  std::string error, warning;
  if (!tinygltf::TinyGLTF().LoadBinaryFromMemory(&model, &error, &warning, reinterpret_cast<const unsigned char*>(glb.data()),
                                                 unsigned(glb.size()))) {
    while (!error.empty() && error.back() == '\n') error.pop_back();
    std::replace(error.begin(), error.end(), '\n', ' ');
    throw InputError(file.string(), "not a readable glTF: " + error + "; export the file again");
  }
  checkPrimitives(file, parts, model);
  model.buffers.resize(buffers.size());
  for (size_t i = 0; i < buffers.size(); ++i) model.buffers[i].data = std::move(buffers[i]);
  return model;
}

namespace {

// How often each mesh is drawn.
std::vector<uint64_t> drawsOf(const tinygltf::Model& model, const std::vector<PlacedNode>& nodes, const std::vector<uint64_t>& instances) {
  std::vector<uint64_t> draws(model.meshes.size());
  for (const PlacedNode& one : nodes) {
    const int mesh = model.nodes[size_t(one.node)].mesh;
    if (!one.hidden && mesh >= 0 && size_t(mesh) < draws.size())
      draws[size_t(mesh)] += size_t(one.node) < instances.size() ? instances[size_t(one.node)] : 1;
  }
  return draws;
}

// Gives primitives that use few vertices of a shared buffer vertices of their own.
void separateVertices(const fs::path& file, const std::vector<uint64_t>& draws, uint64_t limit, LoadedGltf& loaded) {
  const std::vector<FewVertices> few = fewOfShared(file, loaded.model, loaded.bundles, draws, limit);
  if (few.empty()) return;
  GltfDocument& document = *loaded.document;
  for (tinygltf::Buffer& buffer : loaded.model.buffers) document.buffers.push_back(std::move(buffer.data));
  giveOwnVertices(document, few);
  loaded.model = parseGeometry(file, document.json, std::move(document.buffers));
  document.buffers.clear();
  loaded.bundles = findBundles(loaded.model);
  size_t primitives = 0;
  for (const FewVertices& one : few) primitives += one.bundle.size();
  loaded.notes.push_back(std::to_string(primitives) + (primitives == 1 ? " primitive" : " primitives") +
                         " got vertices of their own, which used few of a shared buffer");
}

// The plain document: without compression, and a node per instance. The scene's nodes.
std::vector<PlacedNode> plainNodes(const fs::path& file, std::string_view binary, const ReadSettings& settings, LoadedGltf& loaded,
                                   Warnings& warnings) {
  Json& json = loaded.document->json;
  GltfBuffers buffers = loadBuffers(file, json, binary, settings);
  for (const std::string& name : unpackGltf(file, json, buffers, settings.memory_limit)) loaded.notes.push_back(name + " unpacked");
  loaded.model = parseGeometry(file, json, std::move(buffers));
  loaded.bundles = findBundles(loaded.model);
  std::vector<PlacedNode> nodes = walkScene(file, loaded.model, settings.scene_index);
  if (settings.moment) {
    loaded.sculpt.animation_seconds = poseByAnimation(file, *settings.moment, nodes, json, loaded.model, warnings);
    nodes = walkScene(file, loaded.model, settings.scene_index);
  }
  const std::vector<uint64_t> instance_counts = instanceCounts(json);
  separateVertices(file, drawsOf(loaded.model, nodes, instance_counts), settings.memory_limit, loaded);
  checkBudget(file, loaded.model, loaded.bundles, nodes, instance_counts, settings.memory_limit);
  std::vector<bool> hidden(loaded.model.nodes.size());
  for (const PlacedNode& one : nodes) hidden[size_t(one.node)] = one.hidden;
  if (const size_t instances = unpackInstances(file, json, loaded.model, hidden, warnings); instances > 0) {
    loaded.notes.push_back(std::to_string(instances) + " instances became nodes");
    nodes = walkScene(file, loaded.model, settings.scene_index);
  }
  return nodes;
}

void checkIndices(const fs::path& file, std::span<const uint32_t> indices, size_t vertices, const std::string& owner) {
  const size_t wrong = firstWhere(indices.size(), [&](size_t i) { return indices[i] >= vertices; });
  if (wrong < indices.size())
    throw InputError(file.string(), owner + " uses vertex " + std::to_string(indices[wrong]) + " of " + std::to_string(vertices) +
                                        "; the file is damaged, export it again");
}

std::vector<Triangle> trianglesOf(const fs::path& file, const std::vector<uint32_t>& indices, int mode, size_t vertices,
                                  const std::string& owner) {
  checkIndices(file, indices, vertices, owner);
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

// Adds weight·target to every vertex, for POSITION and NORMAL. Uses the node's weights if it has its own, else the mesh's.
void applyMorphTargets(const fs::path& file, const GltfAccessors& accessors, const tinygltf::Primitive& primitive,
                       const std::vector<double>& weights, const std::string& owner, SculptPart& part) {
  for (size_t target = 0; target < primitive.targets.size() && target < weights.size(); ++target) {
    if (weights[target] == 0) continue;
    for (const auto& [attribute, accessor] : primitive.targets[target]) {
      std::vector<Vec3>* moved = attribute == "POSITION" ? &part.positions : attribute == "NORMAL" ? &part.normals : nullptr;
      if (!moved || moved->empty()) continue;
      const std::vector<Vec3> delta = accessors.readVectors(accessor, owner + "'s morph target");
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
  if (const std::vector<std::string> names = vertexExtensions(primitive); !names.empty()) return "has the extension " + names.front();
  for (const auto& [name, index] : primitive.attributes) {
    if (index < 0 || size_t(index) >= model.accessors.size() || model.accessors[size_t(index)].count != vertices)
      return "has a damaged attribute " + name;
    if (!isBlendable(name, model.accessors[size_t(index)])) return "has the attribute " + name + ", which cannot be blended";
  }
  return "";
}

// Reads the parts of one file.
class PartReader {
 public:
  // `is_animated`: the nodes have been posed by an animation.
  PartReader(const fs::path& file, const std::vector<PlacedNode>& nodes, bool is_animated, LoadedGltf& loaded, Warnings& warnings)
      : file_(file),
        nodes_(nodes),
        is_animated_(is_animated),
        loaded_(loaded),
        model_(loaded.model),
        warnings_(warnings),
        poser_(file, loaded.model, nodes) {}

  // Reads what the visible nodes of the scene draw. Parts under a scale of 0 are left out, unless there are no others.
  void read() {
    for (const PlacedNode& placed : nodes_) {
      const int mesh = model_.nodes[size_t(placed.node)].mesh;
      if (mesh < 0) continue;
      if (size_t(mesh) >= model_.meshes.size())
        throw InputError(file_.string(), nodeLabel(model_, placed.node) + " uses a mesh that does not exist; export the file again");
      if (placed.hidden)
        countHidden(placed);
      else
        readNode(placed);
    }
    const bool is_empty = loaded_.sculpt.parts.empty();
    if (is_empty && !singular_.empty()) throw InputError(file_.string(), singular_ + "; correct the scale");
    if (is_empty && hidden_ > 0)
      throw InputError(file_.string(), "KHR_node_visibility hides every mesh (" + std::to_string(hidden_) +
                                           (hidden_ == 1 ? " node" : " nodes") + " with one); make what is to be baked visible");
    if (!skinned_.empty())
      loaded_.notes.push_back(std::to_string(skinned_.size()) + (skinned_.size() == 1 ? " skinned node" : " skinned nodes") +
                              " posed by joints");
  }

 private:
  const tinygltf::Mesh& meshOf(const PlacedNode& placed) const { return model_.meshes[size_t(model_.nodes[size_t(placed.node)].mesh)]; }
  const tinygltf::Primitive& primitiveOf(const PlacedNode& placed, int index) const { return meshOf(placed).primitives[size_t(index)]; }

  std::string ownerText(const PlacedNode& placed, int index) const {
    const std::string& name = meshOf(placed).name;
    return "primitive " + std::to_string(index) + " of mesh " + std::to_string(model_.nodes[size_t(placed.node)].mesh) +
           (name.empty() ? "" : " ('" + name + "')");
  }

  void countHidden(const PlacedNode& placed) {
    ++hidden_;
    warnings_.add(WarningKind::kHiddenPart, file_.string() + ": " + nodeLabel(model_, placed.node) +
                                                " is hidden by KHR_node_visibility: it gets no lobes and shades nothing");
  }

  void readNode(const PlacedNode& placed) {
    const std::vector<GltfBundle>& bundles = loaded_.bundles.of_meshes[size_t(model_.nodes[size_t(placed.node)].mesh)];
    for (const GltfBundle& bundle : bundles) countPose(placed, primitiveOf(placed, bundle.front()));
    countOthers(placed);
    for (const GltfBundle& bundle : bundles) {
      GltfPlace place{placed.node, model_.nodes[size_t(placed.node)].mesh, {}};
      auto part = readBundle(placed, bundle, place);
      if (!part) continue;
      if (!part->vertex_to_scene.empty()) {
        skinned_.insert(placed.node);
      } else if (!inverted(part->to_scene)) {
        singular_ = nodeLabel(model_, placed.node) + " has a singular transform (a scale is 0)";
        warnings_.add(WarningKind::kSingularTransform, file_.string() + ": " + singular_ + "; its mesh gets no lobes");
        continue;
      }
      loaded_.sculpt.parts.push_back(std::move(*part));
      loaded_.document->places.push_back(std::move(place));
    }
  }

  // Counts what is not baked as an animation would show it.
  void countPose(const PlacedNode& placed, const tinygltf::Primitive& primitive) {
    const std::string owner = file_.string() + ": " + nodeLabel(model_, placed.node);
    if (!primitive.targets.empty() && !is_animated_)
      warnings_.add(WarningKind::kPoseIgnored, owner + " has morph targets; the file's weights are baked");
    if (model_.nodes[size_t(placed.node)].skin >= 0 && !primitive.attributes.contains("JOINTS_0"))
      warnings_.add(WarningKind::kPoseIgnored, owner + " has a skin, but its mesh has no joints; it is baked where the node places it");
  }

  // Counts the primitives that consist of points or lines.
  void countOthers(const PlacedNode& placed) {
    for (size_t i = 0; i < meshOf(placed).primitives.size(); ++i) {
      const std::string owner = ownerText(placed, int(i));
      const tinygltf::Primitive& primitive = primitiveOf(placed, int(i));
      if (primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        throw InputError(file_.string(), owner + " has an unknown mode; export the file again");
      if (!hasSurface(primitive))
        warnings_.add(WarningKind::kPartIgnored, file_.string() + ": " + owner + " has no surface (points, lines or no positions)");
    }
  }

  // Primitives of the same vertices as one part; nothing if they have no vertices.
  std::optional<SculptPart> readBundle(const PlacedNode& placed, const GltfBundle& bundle, GltfPlace& place) {
    const tinygltf::Node& node = model_.nodes[size_t(placed.node)];
    const tinygltf::Mesh& mesh = meshOf(placed);
    const tinygltf::Primitive& primitive = primitiveOf(placed, bundle.front());
    const std::string owner = ownerText(placed, bundle.front());
    const GltfAccessors accessors{file_, model_};
    SculptPart part;
    part.name = !node.name.empty() ? node.name : !mesh.name.empty() ? mesh.name : "node " + std::to_string(placed.node);
    part.object = placed.node;
    part.positions = accessors.readVectors(primitive.attributes.at("POSITION"), owner);
    if (part.positions.empty()) {
      warnings_.add(WarningKind::kPartIgnored, file_.string() + ": " + owner + " has no vertices", bundle.size());
      return std::nullopt;
    }
    const auto normal = primitive.attributes.find("NORMAL");
    if (normal != primitive.attributes.end()) part.normals = accessors.readVectors(normal->second, owner);
    applyMorphTargets(file_, accessors, primitive, node.weights.empty() ? mesh.weights : node.weights, owner, part);
    for (const int index : bundle) {
      std::vector<Triangle> own = readTriangles(accessors, placed, index, part.positions.size());
      place.stretches.push_back({index, own.size()});
      if (part.triangles.empty())
        part.triangles = std::move(own);
      else
        part.triangles.insert(part.triangles.end(), own.begin(), own.end());
    }
    part.fixed = fixedBecause(model_, primitive, node.skin >= 0, part.positions.size());
    if (node.skin >= 0) part.vertex_to_scene = poser_.mapsOf(primitive, node.skin, part.positions, owner, warnings_);
    if (part.vertex_to_scene.empty()) part.to_scene = placed.to_scene;  // glTF ignores the node of a skinned mesh
    return part;
  }

  std::vector<Triangle> readTriangles(const GltfAccessors& accessors, const PlacedNode& placed, int index, size_t vertices) const {
    const tinygltf::Primitive& primitive = primitiveOf(placed, index);
    const std::string owner = ownerText(placed, index);
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode == TINYGLTF_MODE_TRIANGLES && primitive.indices >= 0 && size_t(primitive.indices) < model_.accessors.size() &&
        model_.accessors[size_t(primitive.indices)].count % 3 == 0) {
      std::vector<Triangle> triangles = accessors.readTriangles(primitive.indices, owner);
      checkIndices(file_, {triangles.empty() ? nullptr : triangles.front().data(), 3 * triangles.size()}, vertices, owner);
      return triangles;
    }
    std::vector<uint32_t> indices;
    if (primitive.indices >= 0) {
      indices = accessors.readIndices(primitive.indices, owner);
    } else {
      indices.resize(vertices);
      std::iota(indices.begin(), indices.end(), 0U);
    }
    return trianglesOf(file_, indices, mode, vertices, owner);
  }

  const fs::path& file_;
  const std::vector<PlacedNode>& nodes_;
  bool is_animated_;
  LoadedGltf& loaded_;
  const tinygltf::Model& model_;
  Warnings& warnings_;
  Poser poser_;
  std::set<int> skinned_;
  std::string singular_;
  size_t hidden_ = 0;  // nodes with meshes
};

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
    if (document.json.contains("animations") && !settings.moment)
      warnings.add(WarningKind::kPoseIgnored, file.string() + ": animations; the default pose is baked",
                   document.json["animations"].size());
  } catch (const Json::exception& error) {
    throw InputError(file.string(), std::string("a value of the glTF has the wrong type (") + error.what() + "); export the file again");
  }
  countOtherScenes(file, loaded.model, nodes, warnings);
  if (settings.scene_index) document.json["scene"] = *settings.scene_index;
  PartReader(file, nodes, settings.moment.has_value(), loaded, warnings).read();
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
  return std::move(loaded.sculpt);
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
