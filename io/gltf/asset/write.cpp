// Writes the layout of docs/asset_format.md. A glTF sculpt's own JSON tree is edited, so that unknown content is preserved; tinygltf's
// writer would drop everything that its model has no field for. The order of keys and the text of numbers depend only on the input.
#include "io/gltf/asset/write.h"

#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/first_where.h"
#include "core/harmonics.h"
#include "core/lobe_packing.h"
#include "core/parallel.h"
#include "core/seal.h"
#include "core/text/base64.h"
#include "core/text/maker.h"
#include "core/text/utf8.h"
#include "io/file/write_file.h"
#include "io/gltf/accessor.h"
#include "io/gltf/asset/pack.h"
#include "io/gltf/asset/sculpt_document.h"
#include "io/gltf/document.h"
#include "io/gltf/keep_alive.h"
#include "io/gltf/named_files.h"
#include "io/gltf/sculpt/load.h"

namespace cloudbake {

namespace {

constexpr int kMaxUvSets = 8;

// The document being written and its single buffer, in pieces: those of a sculpt's own buffers are not copied until all are joined.
struct Output {
  Json json;
  std::vector<std::string_view> pieces{};
  std::deque<std::string> owned{};                  // bytes of pieces that nothing else keeps
  std::deque<SculptPart> moved{};                   // parts of which pieces are
  size_t size = 0;                                  // of all pieces
  std::map<std::string, int> known_accessors{};     // hash of bytes and type → accessor: primitives that share vertices share lobes
  std::set<size_t> free_accessors{}, free_views{};  // stubs in the place of what an earlier bake wrote
  SealMaker seal{};
};

// The results of the bake, per part.
struct Baked {
  std::span<const std::span<const Lobe>> lobes;
  std::span<const float> harmonics;
  size_t per_vertex = 0;
  std::span<const float> harmonicsOf(size_t part) const {
    if (harmonics.empty()) return {};
    size_t first = 0;
    for (size_t i = 0; i < part; ++i) first += lobes[i].size();
    return harmonics.subspan(first * per_vertex, lobes[part].size() * per_vertex);
  }
};

Json& arrayOf(Json& object, const char* key) {
  Json& array = object[key];
  if (!array.is_array()) array = Json::array();
  return array;
}

// Puts a value in the first free place of an array, or at its end. Returns its number.
int put(Json& array, std::set<size_t>& free, Json value) {
  if (free.empty()) {
    array.push_back(std::move(value));
    return int(array.size()) - 1;
  }
  const size_t place = free.extract(free.begin()).value();
  array.at(place) = std::move(value);
  return int(place);
}

// Adds a piece at the next multiple of four bytes. It must last as long as the output.
void addPiece(Output& out, std::string_view bytes) {
  static constexpr char kZeros[4] = {};
  for (const std::string_view piece : {std::string_view(kZeros, (4 - out.size % 4) % 4), bytes})
    if (!piece.empty()) out.pieces.push_back(piece), out.size += piece.size();
}

// Of bytes that last as long as the output: those of the sculpt.
int addBufferView(Output& out, std::string_view lasting, int target, size_t stride = 0) {
  if (out.size + lasting.size() > UINT32_MAX)
    throw InputError("", "the asset would take more than " + std::to_string(out.size + lasting.size()) +
                             " bytes, but a GLB holds at most 4 GiB; use fewer vertices");
  addPiece(out, lasting);
  Json view = {{"buffer", 0}, {"byteOffset", out.size - lasting.size()}, {"byteLength", lasting.size()}};
  if (stride != 0) view["byteStride"] = stride;
  if (target != 0) view["target"] = target;
  return put(arrayOf(out.json, "bufferViews"), out.free_views, std::move(view));
}
int addBufferView(Output& out, std::string own, int target, size_t stride = 0) {
  return addBufferView(out, std::string_view(out.owned.emplace_back(std::move(own))), target, stride);
}

template <typename T>
std::string_view bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

template <typename T>
std::string copiedBytesOf(const std::vector<T>& values) {
  return std::string(bytesOf(values));
}

// Adds an accessor, or returns the existing one with the same bytes. They last as long as the output, or are a std::string.
template <class Bytes>
int addAccessor(Output& out, Bytes bytes, int component_type, const char* type, size_t count, const Json& bounds = {}) {
  const std::string key = hashBytes(bytes) + type + std::to_string(component_type);
  if (const auto known = out.known_accessors.find(key); known != out.known_accessors.end()) return known->second;
  Json accessor = {{"bufferView", addBufferView(out, std::move(bytes), bounds.contains("index") ? kIndexTarget : kVertexTarget)}};
  accessor["componentType"] = component_type;
  accessor["count"] = count;
  accessor["type"] = type;
  if (bounds.contains("min")) accessor["min"] = bounds["min"], accessor["max"] = bounds["max"];
  return out.known_accessors[key] = put(arrayOf(out.json, "accessors"), out.free_accessors, std::move(accessor));
}

int addIndices(Output& out, std::span<const Triangle> triangles, size_t vertices) {
  const Json bounds = {{"index", true}};
  const std::string_view bytes(reinterpret_cast<const char*>(triangles.data()), triangles.size_bytes());
  if (vertices > 65535) return addAccessor(out, bytes, kUnsignedInt, "SCALAR", 3 * triangles.size(), bounds);
  std::vector<uint16_t> narrow;
  for (const Triangle& t : triangles)
    for (const uint32_t index : t) narrow.push_back(uint16_t(index));
  return addAccessor(out, copiedBytesOf(narrow), kUnsignedShort, "SCALAR", narrow.size(), bounds);
}

std::set<int> takenUvSets(const Sculpt& sculpt) {
  std::set<int> taken;
  for (const SculptPart& part : sculpt.parts) {
    if (!part.uvs.empty()) taken.insert(0);
    for (size_t i = 0; i < part.more_uvs.size(); ++i) taken.insert(int(i) + 1);
  }
  if (!sculpt.gltf) return taken;
  for (const Json& mesh : sculpt.gltf->json.at("meshes"))
    for (const Json& primitive : mesh.at("primitives"))
      for (int set = 0; set < kMaxUvSets; ++set)
        if (primitive.at("attributes").contains(uvSetName(set))) taken.insert(set);
  return taken;
}

// Writes the two sets, fillers for missing lower sets, and the attribute, for one primitive.
void writeLobes(Output& out, const SculptPart& part, std::span<const Lobe> lobes, std::span<const float> harmonics, int set, bool attribute,
                Json& attributes, Warnings& warnings) {
  for (int lower = 0; lower < set; ++lower) {
    if (attributes.contains(uvSetName(lower))) continue;
    attributes[uvSetName(lower)] = addAccessor(out, copiedBytesOf(std::vector<Vec2>(lobes.size())), kFloat, "VEC2", lobes.size());
    warnings.add(WarningKind::kMissingUvSet,
                 "'" + part.name + "' has no " + uvSetName(lower) + "; zeros were written, because glTF allows no gap");
  }
  constexpr size_t kGrain = 1 << 14;
  const auto from_scene = inverted(part.to_scene);
  const size_t count = lobes.size();
  const bool is_skinned = !part.vertex_to_scene.empty();
  if (firstWhere(is_skinned ? count : 1, [&](size_t v) { return !(is_skinned ? inverted(part.vertex_to_scene[v]) : from_scene); }) <
      (is_skinned ? count : 1))
    throw InputError("", "'" + part.name + "' has a singular transform (a scale is 0); correct the scale");
  std::vector<LobeUvs> stored(count);
  parallelBlocks(count, kGrain, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) stored[v] = packLobe(lobes[v], is_skinned ? *inverted(part.vertex_to_scene[v]) : *from_scene);
  });
  out.seal.add(part, stored, harmonics);
  const auto add = [&](int width, const char* type, const auto& values_of) {
    std::string bytes(count * size_t(width) * sizeof(float), '\0');
    parallelBlocks(count, kGrain, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v)
        std::memcpy(&bytes[v * size_t(width) * sizeof(float)], values_of(stored[v]), size_t(width) * sizeof(float));
    });
    return addAccessor(out, std::move(bytes), kFloat, type, count);
  };
  static_assert(sizeof(LobeUvs) == 4 * sizeof(float));
  attributes[uvSetName(set)] = add(2, "VEC2", [](const LobeUvs& uvs) { return &uvs.first; });
  attributes[uvSetName(set + 1)] = add(2, "VEC2", [](const LobeUvs& uvs) { return &uvs.second; });
  if (attribute) attributes["_OCCLUSION"] = addAccessor(out, copiedBytesOf(stored), kFloat, "VEC4", count);
}

// Writes attributes of four coefficients each; the last one is padded with zeros.
void writeHarmonics(Output& out, std::span<const float> coefficients, size_t vertices, Json& attributes) {
  if (coefficients.empty()) return;
  const size_t count = coefficients.size() / vertices;
  for (size_t first = 0; first < count; first += 4) {
    std::vector<float> four(4 * vertices, 0);
    for (size_t v = 0; v < vertices; ++v) std::copy_n(&coefficients[v * count + first], std::min<size_t>(4, count - first), &four[4 * v]);
    attributes[harmonicsName(int(first / 4))] = addAccessor(out, copiedBytesOf(four), kFloat, "VEC4", vertices);
  }
}

// Merges all buffers of the document into the GLB's single binary chunk.
void foldBuffers(const GltfDocument& document, Output& out) {
  std::vector<size_t> starts;
  for (const std::vector<unsigned char>& buffer : document.buffers) {
    addPiece(out, {reinterpret_cast<const char*>(buffer.data()), buffer.size()});
    starts.push_back(out.size - buffer.size());
  }
  for (Json& view : arrayOf(out.json, "bufferViews")) {
    const auto buffer = uint64_t(wholeNumber(view.at("buffer")));
    if (buffer >= starts.size())
      throw InputError(document.file.string(), "a buffer view uses a buffer that does not exist; export the file again");
    if (starts[buffer] > 0) view["byteOffset"] = uint64_t(wholeNumber(view, "byteOffset", 0)) + starts[buffer];
    view["buffer"] = 0;
  }
  Json& buffers = arrayOf(out.json, "buffers");
  while (buffers.size() > 1) buffers.erase(buffers.size() - 1);
  if (!buffers.empty()) buffers[0].erase("uri");
}

void embedImage(Output& out, size_t image, std::string_view bytes, std::string_view mime_type) {
  const int view = addBufferView(out, std::string(bytes), 0);
  Json& json = out.json["images"][image];
  json.erase("uri");
  json["mimeType"] = mime_type;
  json["bufferView"] = view;
}

// Embeds images from files and from data URIs in the GLB. Other URIs stay.
void embedImages(const GltfDocument& document, Output& out) {
  if (!out.json.contains("images")) return;
  for (const auto& [image, bytes] : document.image_files) {
    Json& json = out.json["images"][image];
    if (!json.contains("name"))
      json["name"] = asUtf8(std::filesystem::path(percentDecoded(json.value("uri", ""))).stem().string());  // as its file is named
    embedImage(out, image, bytes, imageMimeType(bytes));
  }
  for (size_t i = 0; i < out.json["images"].size(); ++i) {
    const std::string uri = out.json["images"][i].value("uri", "");
    const size_t comma = uri.find(";base64,");
    if (!uri.starts_with("data:image/") || comma == std::string::npos) continue;
    const auto bytes = decodeBase64(std::string_view(uri).substr(comma + 8));
    if (bytes) embedImage(out, i, *bytes, uri.substr(5, uri.find(';') - 5));
  }
}

Json boundsOf(const std::vector<Vec3>& positions) {
  Box box;
  for (const Vec3 p : positions) box.add(p);
  return {{"min", {box.low.x, box.low.y, box.low.z}}, {"max", {box.high.x, box.high.y, box.high.z}}};
}

// Stores values of an accessor in its own type. Elements are padded to whole words, as glTF requires of vertices.
int addLike(Output& out, const tinygltf::Accessor& model, const std::vector<float>& values, size_t width) {
  const int type = model.normalized ? model.componentType : kFloat;  // whole numbers that stand for a place get fractions
  const auto size = size_t(tinygltf::GetComponentSizeInBytes(uint32_t(type)));
  const size_t stride = (size * width + 3) / 4 * 4, count = values.size() / width;
  const bool is_signed = type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_SHORT;
  const double largest = std::ldexp(1.0, int(8 * size) - (is_signed ? 1 : 0)) - 1;
  std::string bytes(stride * count, '\0');
  for (size_t i = 0; i < values.size(); ++i) {
    char* const at = &bytes[i / width * stride + i % width * size];
    const auto whole = type == kFloat ? int64_t(0) : int64_t(std::llround(largest * double(values[i])));  // little-endian
    std::memcpy(at, type == kFloat ? static_cast<const void*>(&values[i]) : &whole, size);
  }
  constexpr std::array kTypes{"SCALAR", "VEC2", "VEC3", "VEC4"};
  Json accessor = {{"bufferView", addBufferView(out, std::move(bytes), kVertexTarget, stride == size * width ? 0 : stride)},
                   {"componentType", type}};
  if (type != kFloat) accessor["normalized"] = true;
  accessor["count"] = count;
  accessor["type"] = kTypes[width - 1];
  return put(arrayOf(out.json, "accessors"), out.free_accessors, std::move(accessor));
}

// Gives an attribute the values of the vertices that --refine added. Directions keep their length, and tangents their handedness.
int addRefined(Output& out, const GltfAccessors& stored, int index, const std::string& name, const SculptPart& part) {
  const tinygltf::Accessor& accessor = stored.model.accessors.at(size_t(index));
  const int width = tinygltf::GetNumComponentsInType(uint32_t(accessor.type));
  std::vector<float> values = stored.readFloats(index, width, name + " of '" + part.name + "'");
  const size_t old = values.size();
  const bool is_tangent = name == "TANGENT" && width == 4;
  const auto direction = [&](size_t v) { return Vec3{values[4 * v], values[4 * v + 1], values[4 * v + 2]}; };
  for (const auto& [a, b] : part.midpoints) {
    std::vector<float> middle;
    for (size_t c = 0; c < size_t(width); ++c) middle.push_back(0.5F * (values[a * size_t(width) + c] + values[b * size_t(width) + c]));
    if (is_tangent) {
      const Vec3 between = directionBetween(direction(a), direction(b));
      middle = {between.x, between.y, between.z, values[4 * a + 3]};
    }
    values.insert(values.end(), middle.begin(), middle.end());
  }
  for (size_t v = old / 4; is_tangent && v < values.size() / 4; ++v) {
    const Vec3 unit = normalized(direction(v)).value_or(direction(v));
    std::tie(values[4 * v], values[4 * v + 1], values[4 * v + 2]) = std::tuple(unit.x, unit.y, unit.z);
  }
  return addLike(out, accessor, values, size_t(width));
}

// Gives all attributes but normals, which are written with the triangles, the vertices that --refine added.
void writeMidpoints(Output& out, const GltfAccessors& stored, const SculptPart& part, Json& attributes) {
  for (auto& [name, index] : attributes.items())
    if (name != "POSITION" && name != "NORMAL") index = addRefined(out, stored, int(wholeNumber(index)), name, part);
  attributes["POSITION"] = addAccessor(out, bytesOf(part.positions), kFloat, "VEC3", part.positions.size(), boundsOf(part.positions));
}

void replaceIndices(Output& out, std::span<const Triangle> triangles, size_t vertices, Json& primitive) {
  primitive["indices"] = addIndices(out, triangles, vertices);
  primitive["mode"] = 4;
}

// Writes the triangles that --repair or --refine has changed, and the normals if there are any.
void replaceTriangles(Output& out, const SculptPart& part, Json& primitive, Json& attributes) {
  replaceIndices(out, part.triangles, part.positions.size(), primitive);
  if (attributes.contains("NORMAL")) attributes["NORMAL"] = addAccessor(out, bytesOf(part.normals), kFloat, "VEC3", part.normals.size());
}

// Whether triangles have the vertex whose index is the largest number of its type. glTF forbids it, because WebGL2 ends a strip there.
bool usesRestartIndex(const Json& json, const Json& primitive, std::span<const Triangle> triangles) {
  if (!primitive.contains("indices")) return false;
  const int64_t type = wholeNumber(json.at("accessors").at(size_t(wholeNumber(primitive["indices"]))).at("componentType"));
  const uint32_t largest = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ? 255 : type == kUnsignedShort ? 65535 : UINT32_MAX;
  return std::any_of(triangles.begin(), triangles.end(),
                     [&](const Triangle& t) { return std::find(t.begin(), t.end(), largest) != t.end(); });
}

// Gives all primitives of a part the attributes of the first. Those that they already have are of the same vertices.
template <class Find>
void writeStretches(Output& out, const SculptPart& part, const std::vector<GltfStretch>& stretches, const Json& attributes,
                    const Find& primitive) {
  size_t first = 0;
  for (const GltfStretch& stretch : stretches) {
    const auto triangles = std::span(part.triangles).subspan(first, stretches.size() > 1 ? stretch.triangles : part.triangles.size());
    first += stretch.triangles;
    if (!part.repaired && part.midpoints.empty() && usesRestartIndex(out.json, primitive(stretch), triangles))
      replaceIndices(out, triangles, part.positions.size(), primitive(stretch));
    Json& own = primitive(stretch)["attributes"];
    if (&stretch == &stretches.front())
      own = attributes;
    else
      for (const auto& [name, accessor] : attributes.items())
        if (!own.contains(name)) own[name] = accessor;
  }
}

// Input with a document: adds the sets to the same document.
void extendDocument(const Sculpt& sculpt, const Baked& baked, int set, const GltfSettings& settings, Output& out, Warnings& warnings) {
  const GltfDocument& document = *sculpt.gltf;
  out.json = document.json;
  out.free_accessors = document.free_accessors;
  out.free_views = document.free_views;
  foldBuffers(document, out);
  embedImages(document, out);
  const std::vector<int> meshes = separateMeshes(document, out.json);
  std::vector<GltfPrimitive> primitives;
  const bool is_refined = std::any_of(sculpt.parts.begin(), sculpt.parts.end(), [](const auto& part) { return !part.midpoints.empty(); });
  const tinygltf::Model model = is_refined ? parseGeometry(document.file, document.json, document.buffers) : tinygltf::Model();
  for (size_t i = 0; i < sculpt.parts.size(); ++i) {
    const SculptPart& part = sculpt.parts[i];
    const std::vector<GltfStretch>& stretches = document.places[i].stretches;
    const auto primitive = [&](const GltfStretch& of) -> Json& { return primitiveOf(out.json, {meshes[i], of.primitive}); };
    Json attributes = primitive(stretches.front()).at("attributes");  // a copy, because a new key moves its neighbours in memory
    const bool has_midpoints = !part.midpoints.empty(), is_changed = part.repaired || has_midpoints;
    if (is_changed && stretches.size() > 1) throw Error(ExitCode::kInternal, "", 0, 0, "new triangles need a part per primitive");
    if (has_midpoints) writeMidpoints(out, {document.file, model}, part, attributes);
    writeLobes(out, part, baked.lobes[i], baked.harmonicsOf(i), set, settings.attribute, attributes, warnings);
    writeHarmonics(out, baked.harmonicsOf(i), part.positions.size(), attributes);
    if (is_changed) replaceTriangles(out, part, primitive(stretches.front()), attributes);
    writeStretches(out, part, stretches, attributes, primitive);
    for (const GltfStretch& stretch : stretches) primitives.emplace_back(meshes[i], stretch.primitive);
  }
  if (settings.keep_alive_texture == KeepAliveTexture::kOff || primitives.empty()) return;
  const auto add_image = [&](std::string_view png) { return addBufferView(out, std::string(png), 0); };
  bindKeepAliveTextures(out.json, primitives, set, settings.keep_alive_texture, document.white_texture, add_image, document.file.string(),
                        warnings);
}

// Moves the vertices of a part to scene space. This is for a sheared transform, which glTF does not allow.
SculptPart movedToScene(const SculptPart& part) {
  Sculpt one;
  one.parts = {part};
  SurfaceMesh surface = surfaceInScene(one);
  if (part.normals.empty()) surface.normals.clear();
  SculptPart moved = part;
  moved.positions = std::move(surface.positions);
  moved.normals = std::move(surface.normals);
  moved.triangles = std::move(surface.triangles);
  moved.to_scene = {};
  return moved;
}

// The nodes of a sculpt; one per part if it has none.
std::vector<SculptNode> nodesOf(const Sculpt& sculpt) {
  std::vector<SculptNode> nodes = sculpt.nodes;
  if (nodes.empty())
    for (const SculptPart& part : sculpt.parts) nodes.push_back({part.name, -1, part.to_scene});
  return nodes;
}

// Vertex colours as VEC3, or as VEC4 if an alpha is not 1.
int addColors(Output& out, const std::vector<std::array<float, 4>>& colors) {
  if (std::any_of(colors.begin(), colors.end(), [](const auto& color) { return color[3] != 1; }))
    return addAccessor(out, bytesOf(colors), kFloat, "VEC4", colors.size());
  std::vector<float> opaque;
  for (const auto& color : colors) opaque.insert(opaque.end(), color.begin(), color.begin() + 3);
  return addAccessor(out, copiedBytesOf(opaque), kFloat, "VEC3", colors.size());
}

// What a part has before the bake, without its indices.
Json attributesOf(Output& out, const SculptPart& part) {
  const size_t count = part.positions.size();
  Json attributes;
  attributes["POSITION"] = addAccessor(out, bytesOf(part.positions), kFloat, "VEC3", count, boundsOf(part.positions));
  if (!part.normals.empty()) attributes["NORMAL"] = addAccessor(out, bytesOf(part.normals), kFloat, "VEC3", count);
  if (!part.uvs.empty()) attributes["TEXCOORD_0"] = addAccessor(out, bytesOf(part.uvs), kFloat, "VEC2", count);
  for (size_t i = 0; i < part.more_uvs.size(); ++i)
    attributes[uvSetName(int(i) + 1)] = addAccessor(out, bytesOf(part.more_uvs[i]), kFloat, "VEC2", count);
  if (!part.colors.empty()) attributes["COLOR_0"] = addColors(out, part.colors);
  return attributes;
}

// Input of another format: makes a new document with its nodes and materials, a mesh per node and a primitive per part.
void buildDocument(const Sculpt& sculpt, const Baked& baked, int set, const GltfSettings& settings, Output& out, Warnings& warnings) {
  Json& json = out.json;
  json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", Json::array({{{"nodes", Json::array()}}})}};
  for (const char* key : {"nodes", "meshes", "materials"}) json[key] = Json::array();
  const auto add_image = [&](std::string_view bytes) { return addBufferView(out, std::string(bytes), 0); };
  writeMaterials(sculpt, add_image, json);
  const std::vector<SculptNode> nodes = nodesOf(sculpt);
  const std::vector<PlacedSculptNode> placed = placeNodes(nodes, warnings);
  std::vector<int> mesh_of_node(placed.size(), -1);
  std::vector<GltfPrimitive> written;
  for (size_t i = 0; i < sculpt.parts.size(); ++i) {
    const size_t node = sculpt.nodes.empty() ? i : size_t(sculpt.parts[i].node);
    const SculptPart& part = placed.at(node).in_scene_space ? out.moved.emplace_back(movedToScene(sculpt.parts[i])) : sculpt.parts[i];
    if (part.triangles.empty()) throw InputError("", "'" + part.name + "' has no triangles; leave it out");
    Json attributes = attributesOf(out, part);
    writeLobes(out, part, baked.lobes[i], baked.harmonicsOf(i), set, settings.attribute, attributes, warnings);
    writeHarmonics(out, baked.harmonicsOf(i), part.positions.size(), attributes);
    const size_t material = part.material < 0 ? sculpt.materials.size() : size_t(part.material);
    if (mesh_of_node[node] < 0) {
      mesh_of_node[node] = int(json["meshes"].size());
      json["meshes"].push_back({{"name", nodes[node].name}, {"primitives", Json::array()}});
    }
    Json& primitives = json["meshes"][size_t(mesh_of_node[node])]["primitives"];
    written.emplace_back(mesh_of_node[node], int(primitives.size()));
    primitives.push_back({{"attributes", std::move(attributes)},
                          {"indices", addIndices(out, part.triangles, part.positions.size())},
                          {"material", material}});
  }
  writeNodes(nodes, placed, mesh_of_node, json);
  if (settings.keep_alive_texture != KeepAliveTexture::kOff)
    bindKeepAliveTextures(json, written, set, settings.keep_alive_texture, -1, add_image, "", warnings);
}

// Writes generator and metadata. The source's own generator is kept in the metadata.
AssetInfo writeAsset(const AssetInfo& info, int set, const SealMaker& seal, Json& json) {
  Json& asset = json["asset"];
  AssetInfo resolved = info;
  resolved.first_uv_set = set;
  resolved.layout = kLayoutName, resolved.density_max = 0, resolved.certificate.reset();
  if (const AssetSeal finished = seal.finished(info); isFinite(finished)) resolved.seal = finished;
  Json metadata = writeInfo(resolved);
  const std::string generator = asset.value("generator", "");
  if (!generator.empty() && !generator.starts_with("cloudbake ")) metadata["source_generator"] = generator;
  asset["generator"] = kMaker;
  if (asset.contains("extras") && !asset["extras"].is_object()) asset["extras"] = {{"source_extras", asset["extras"]}};
  if (asset.contains("extras") && generator.starts_with("cloudbake ")) {
    const Json earlier = asset["extras"].value("cloudbake", Json::object());
    if (earlier.is_object() && earlier.contains("source_generator")) metadata["source_generator"] = earlier["source_generator"];
  }
  asset["extras"]["cloudbake"] = std::move(metadata);
  return resolved;
}

void checkShapes(const Sculpt& sculpt, const Baked& baked) {
  bool fits = baked.lobes.size() == sculpt.parts.size();
  size_t vertices = 0;
  for (size_t i = 0; fits && i < baked.lobes.size(); ++i) {
    vertices += baked.lobes[i].size();
    fits = baked.lobes[i].size() == sculpt.parts[i].positions.size();
  }
  if (!fits || baked.harmonics.size() != vertices * baked.per_vertex)
    throw Error(ExitCode::kInternal, "", 0, 0, "encodeGlb needs a lobe for every vertex of every part");
}

}  // namespace

int chooseUvSet(const Sculpt& sculpt, const GltfSettings& settings) {
  const std::string file = sculpt.gltf ? sculpt.gltf->file.string() : "";
  const std::set<int> taken = takenUvSets(sculpt);
  const auto is_free = [&](int set) { return set >= 0 && set + 1 < kMaxUvSets && !taken.contains(set) && !taken.contains(set + 1); };
  if (settings.uv_set) {
    if (is_free(*settings.uv_set)) return *settings.uv_set;
    throw InputError(file, "UV sets " + std::to_string(*settings.uv_set) + " and " + std::to_string(*settings.uv_set + 1) +
                               " are taken or beyond 7; leave --uv-set out to use the lowest free pair");
  }
  if (sculpt.gltf && is_free(sculpt.gltf->earlier_set)) return sculpt.gltf->earlier_set;
  for (int set = 0; set + 1 < kMaxUvSets; ++set)
    if (is_free(set)) return set;
  throw InputError(file, "no two neighbouring UV sets below 8 are free; remove UV sets that nothing uses");
}

std::string encodeGlb(const Sculpt& sculpt, std::span<const std::vector<Lobe>> lobes_per_part, const AssetInfo& info,
                      const GltfSettings& settings, Warnings& warnings, std::span<const float> harmonics) {
  const std::vector<std::span<const Lobe>> lobes(lobes_per_part.begin(), lobes_per_part.end());
  return encodeGlb(sculpt, lobes, info, settings, warnings, harmonics);
}

std::string encodeGlb(const Sculpt& sculpt, std::span<const std::span<const Lobe>> lobes_per_part, const AssetInfo& info,
                      const GltfSettings& settings, Warnings& warnings, std::span<const float> harmonics) {
  const Baked baked{lobes_per_part, harmonics, harmonics.empty() ? 0 : harmonicCount(info.harmonic_order)};
  checkShapes(sculpt, baked);
  const std::string file = sculpt.gltf ? sculpt.gltf->file.string() : "";
  try {
    const int set = chooseUvSet(sculpt, settings);
    Output out;
    if (sculpt.gltf)
      extendDocument(sculpt, baked, set, settings, out, warnings);
    else
      buildDocument(sculpt, baked, set, settings, out, warnings);
    const AssetInfo resolved = writeAsset(info, set, out.seal, out.json);
    Json& buffers = arrayOf(out.json, "buffers");
    if (buffers.empty()) buffers.push_back(Json::object());
    buffers[0]["byteLength"] = out.size;
    std::string glb = joinGlb(file, out.json.dump(), out.pieces);
    if (!settings.pack) return glb;
    std::optional<size_t> kept_views;
    if (sculpt.gltf) kept_views = sculpt.gltf->json.value("bufferViews", Json::array()).size();
    return packGlb(file, glb, resolved, settings.pack_form, kept_views, warnings);
  } catch (const Json::exception& error) {
    throw InputError(file, std::string("a value of the glTF has the wrong type (") + error.what() + "); export the file again");
  }
}

}  // namespace cloudbake
