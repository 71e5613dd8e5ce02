#include "io/gltf/sequence/sequence_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.h"
#include "core/lobe_packing.h"
#include "core/text/json.h"
#include "core/text/maker.h"
#include "io/file/write_file.h"
#include "io/gltf/accessor.h"
#include "io/gltf/asset_info.h"
#include "io/gltf/document.h"
#include "io/gltf/sculpt/load.h"
#include "io/gltf/sequence/key_texture.h"
#include "io/gltf/value_types.h"
#include "io/image/image.h"

namespace cloudbake {

namespace {

constexpr int kVersion = 1;
constexpr const char *kPictureName = "keys", *kCure = ": make it again with `cloudbake sequence`";

// --- Writing ---

struct Document {
  std::string bytes;
  Json views = Json::array(), accessors = Json::array();

  int addView(std::string_view part, int target) {
    Json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", part.size()}};
    if (target != 0) view["target"] = target;
    views.push_back(std::move(view));
    bytes += part;
    bytes.resize((bytes.size() + 3) / 4 * 4);
    return int(views.size()) - 1;
  }
  template <class T>
  int add(const std::vector<T>& values, int component, const char* type, int target, size_t per_element = 1) {
    const int view = addView({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)}, target);
    accessors.push_back({{"bufferView", view}, {"componentType", component}, {"count", values.size() / per_element}, {"type", type}});
    return int(accessors.size()) - 1;
  }
  int addPositions(const std::vector<Vec3>& positions) {
    const int accessor = add(positions, kFloat, "VEC3", kVertexTarget);
    Box box;
    for (const Vec3& p : positions) box.add(p);
    accessors.back()["min"] = numbersOf(box.low), accessors.back()["max"] = numbersOf(box.high);
    return accessor;
  }
  int addTimes(const std::vector<float>& seconds) {
    const int accessor = add(seconds, kFloat, "SCALAR", 0);
    accessors.back()["min"] = {shortest(seconds.front())}, accessors.back()["max"] = {shortest(seconds.back())};
    return accessor;
  }
};

// The numbers of two UV sets.
struct UvSets {
  std::vector<Vec2> first, second;
};

UvSets uvsOf(const SequenceKey& key) {
  UvSets sets;
  for (const Lobe& lobe : key.lobes) {
    sets.first.push_back({lobe.direction.x, lobe.direction.y});
    sets.second.push_back({lobe.direction.z, lobe.thickness});
  }
  return sets;
}

template <class T>
std::vector<T> differences(const std::vector<T>& values, const std::vector<T>& from) {
  std::vector<T> result = values;
  for (size_t i = 0; i < values.size(); ++i) {
    result[i].x -= from[i].x, result[i].y -= from[i].y;
    if constexpr (requires { result[i].z; }) result[i].z -= from[i].z;
  }
  return result;
}

Json meshOf(const SequenceSegment& segment, int number, SequenceForm form, Document& document) {
  const SequenceKey& base = segment.keys.front();
  const UvSets uvs = uvsOf(base);
  Json attributes = {{"POSITION", document.addPositions(base.positions)},
                     {"NORMAL", document.add(base.normals, kFloat, "VEC3", kVertexTarget)},
                     {"TEXCOORD_0", document.add(uvs.first, kFloat, "VEC2", kVertexTarget)},
                     {"TEXCOORD_1", document.add(uvs.second, kFloat, "VEC2", kVertexTarget)}};
  if (form == SequenceForm::kTexture) {
    std::vector<Vec2> texels;
    for (size_t v = 0; v < base.positions.size(); ++v) {
      const size_t row = v / kSequenceColumns;
      texels.push_back({float(v % kSequenceColumns), float(row)});
    }
    attributes["TEXCOORD_2"] = document.add(texels, kFloat, "VEC2", kVertexTarget);
  }
  std::vector<uint32_t> indices;
  for (const Triangle& t : segment.triangles) indices.insert(indices.end(), t.begin(), t.end());
  const bool is_wide = base.positions.size() > 65535;
  const int index = is_wide ? document.add(indices, kUnsignedInt, "SCALAR", kIndexTarget)
                            : document.add(std::vector<uint16_t>(indices.begin(), indices.end()), kUnsignedShort, "SCALAR", kIndexTarget);
  Json primitive = {{"attributes", attributes}, {"indices", index}, {"material", 0}};
  Json mesh = {{"name", fmt::format("segment {}", number + 1)}};
  if (form == SequenceForm::kMorph && segment.keys.size() > 1) {
    Json names = Json::array(), weights = Json::array();
    for (size_t k = 1; k < segment.keys.size(); ++k) {
      const SequenceKey& key = segment.keys[k];
      const UvSets own = uvsOf(key);
      primitive["targets"].push_back({{"POSITION", document.addPositions(differences(key.positions, base.positions))},
                                      {"NORMAL", document.add(differences(key.normals, base.normals), kFloat, "VEC3", kVertexTarget)},
                                      {"TEXCOORD_0", document.add(differences(own.first, uvs.first), kFloat, "VEC2", kVertexTarget)},
                                      {"TEXCOORD_1", document.add(differences(own.second, uvs.second), kFloat, "VEC2", kVertexTarget)}});
      names.push_back(fmt::format("frame {:g}", key.frame));
      weights.push_back(0);
    }
    mesh["weights"] = weights;
    mesh["extras"]["targetNames"] = names;
  }
  mesh["primitives"].push_back(std::move(primitive));
  return mesh;
}

// The channels that play the keys of a segment, and show its node as long as it is seen: from the middle of one fade to that of the next.
void animate(const CloudSequence& sequence, size_t number, SequenceForm form, Document& document, Json& animation) {
  const SequenceSegment& segment = sequence.segments[number];
  const auto addChannel = [&](const char* path, const char* interpolation, int input, int output) {
    animation["channels"].push_back({{"sampler", animation["samplers"].size()}, {"target", {{"node", number}, {"path", path}}}});
    animation["samplers"].push_back({{"input", input}, {"interpolation", interpolation}, {"output", output}});
  };
  const auto seconds = [&](double frame) { return float(frame / sequence.frames_per_second); };
  if (form == SequenceForm::kMorph && segment.keys.size() > 1) {
    const size_t targets = segment.keys.size() - 1;
    std::vector<float> times, weights(segment.keys.size() * targets);
    for (size_t k = 0; k < segment.keys.size(); ++k) {
      times.push_back(seconds(segment.keys[k].frame));
      if (k > 0) weights[k * targets + k - 1] = 1;
    }
    addChannel("weights", "LINEAR", document.addTimes(times), document.add(weights, kFloat, "SCALAR", 0));
  }
  if (sequence.segments.size() < 2) return;
  std::vector<float> times;
  std::vector<Vec3> scales;
  const auto set = [&](double frame, float scale) { times.push_back(seconds(frame)), scales.push_back({scale, scale, scale}); };
  const bool is_first = number == 0, is_last = number + 1 == sequence.segments.size();
  if (!is_first) {
    set(0, 0);
    set((segment.first() + sequence.segments[number - 1].last()) / 2, 1);
  } else {
    set(0, 1);
  }
  if (!is_last) set((sequence.segments[number + 1].first() + segment.last()) / 2, 0);
  addChannel("scale", "STEP", document.addTimes(times), document.add(scales, kFloat, "VEC3", 0));
}

Json infoOf(const CloudSequence& sequence, SequenceForm form, const std::vector<KeyTexturePlace>& places, const KeyTextureScale& scale) {
  AssetInfo info = sequence.info;
  info.layout = kSequenceLayout, info.version = kVersion, info.first_uv_set = 0;
  Json own = writeInfo(info);
  Json segments = Json::array();
  for (size_t s = 0; s < sequence.segments.size(); ++s) {
    Json frames = Json::array();
    for (const SequenceKey& key : sequence.segments[s].keys) frames.push_back(key.frame);
    Json segment = {{"mesh", s}, {"frames", std::move(frames)}};
    if (form == SequenceForm::kTexture) segment["first_row"] = places[s].first_row;
    segments.push_back(std::move(segment));
  }
  own["sequence"] = {{"keys", form == SequenceForm::kMorph ? "morph targets" : "picture"},
                     {"frames_per_second", sequence.frames_per_second},
                     {"loops", sequence.loops},
                     {"period", sequence.period},
                     {"segments", std::move(segments)}};
  if (form == SequenceForm::kTexture) {
    own["sequence"]["columns"] = kSequenceColumns;
    own["sequence"]["box"] = {numbersOf(scale.box.low), numbersOf(scale.box.high)};
    own["sequence"]["density_max"] = shortest(scale.densest);
  }
  return own;
}

// --- Reading ---

AssetInfo assetInfoOf(const std::filesystem::path& file, const Json& document) {
  Json plain = {{"asset", document.at("asset")}};
  Json& own = plain["asset"]["extras"]["cloudbake"];
  if (wholeNumber(own.at("version")) != kVersion)
    throw InputError(file.string(), std::string("is a sequence of another version of the layout") + kCure);
  own["layout"] = AssetInfo{}.layout, own["version"] = AssetInfo{}.version;
  AssetInfo info = requireInfo(file, plain);
  info.layout = kSequenceLayout, info.version = kVersion;
  return info;
}

// The key of a mesh: its base, or its base and one target.
class KeyReader {
 public:
  KeyReader(const std::filesystem::path& file, const tinygltf::Model& model, const tinygltf::Primitive& primitive)
      : file_(file), accessors_{file, model}, primitive_(primitive) {
    base_ = {0, vectors(primitive.attributes, "POSITION"), vectors(primitive.attributes, "NORMAL"), {}};
    uvs_ = floats(primitive.attributes, "TEXCOORD_0", "TEXCOORD_1");
    base_.lobes = lobesOf(uvs_);
  }

  const SequenceKey& base() const { return base_; }
  SequenceKey target(size_t number, double frame) const {
    if (number >= primitive_.targets.size()) throw InputError(file_.string(), std::string("a key has no morph target") + kCure);
    const auto& attributes = primitive_.targets[number];
    SequenceKey key{frame, vectors(attributes, "POSITION"), vectors(attributes, "NORMAL"), {}};
    std::vector<float> uvs = floats(attributes, "TEXCOORD_0", "TEXCOORD_1");
    for (size_t i = 0; i < uvs.size(); ++i) uvs[i] += uvs_[i];
    for (size_t v = 0; v < key.positions.size(); ++v) key.positions[v] += base_.positions[v], key.normals[v] += base_.normals[v];
    key.lobes = lobesOf(uvs);
    return key;
  }

 private:
  using Attributes = std::map<std::string, int>;
  int accessorOf(const Attributes& attributes, const char* name) const {
    const auto found = attributes.find(name);
    if (found == attributes.end()) throw InputError(file_.string(), fmt::format("a key of the sequence has no {}{}", name, kCure));
    return found->second;
  }
  template <class T>
  std::vector<T> counted(std::vector<T> values, size_t per_vertex) const {
    if (!base_.positions.empty() && values.size() != base_.positions.size() * per_vertex)
      throw InputError(file_.string(), std::string("the keys of a segment have different numbers of vertices") + kCure);
    return values;
  }
  std::vector<Vec3> vectors(const Attributes& attributes, const char* name) const {
    return counted(accessors_.readVectors(accessorOf(attributes, name), name), 1);
  }
  // Four per vertex.
  std::vector<float> floats(const Attributes& attributes, const char* first, const char* second) const {
    const std::vector<float> one = counted(accessors_.readFloats(accessorOf(attributes, first), 2, first), 2),
                             two = counted(accessors_.readFloats(accessorOf(attributes, second), 2, second), 2);
    std::vector<float> all;
    for (size_t v = 0; 2 * v < one.size(); ++v) all.insert(all.end(), {one[2 * v], one[2 * v + 1], two[2 * v], two[2 * v + 1]});
    return all;
  }
  static std::vector<Lobe> lobesOf(const std::vector<float>& uvs) {
    std::vector<Lobe> lobes;
    for (size_t i = 0; i < uvs.size(); i += 4) lobes.push_back(unpackLobe({{uvs[i], uvs[i + 1]}, {uvs[i + 2], uvs[i + 3]}}, {}));
    return lobes;
  }

  const std::filesystem::path& file_;
  GltfAccessors accessors_;
  const tinygltf::Primitive& primitive_;
  SequenceKey base_;
  std::vector<float> uvs_;
};

// What the metadata say of a picture of keys.
struct KeyPicture {
  Image image;
  KeyTextureScale scale;
};

SequenceSegment readSegment(const std::filesystem::path& file, const Json& own, const tinygltf::Model& model,
                            const std::optional<KeyPicture>& picture) {
  const auto refuse = [&](const char* what) { throw InputError(file.string(), std::string(what) + kCure); };
  const auto mesh = uint64_t(wholeNumber(own.at("mesh")));
  if (mesh >= model.meshes.size() || model.meshes[mesh].primitives.size() != 1) refuse("a segment has no mesh of one primitive");
  const tinygltf::Primitive& primitive = model.meshes[mesh].primitives.front();
  const KeyReader reader(file, model, primitive);
  SequenceSegment segment;
  segment.triangles = GltfAccessors{file, model}.readTriangles(primitive.indices, "a segment");
  const size_t vertices = reader.base().positions.size();
  for (const Triangle& t : segment.triangles)
    for (const uint32_t v : t)
      if (v >= vertices) refuse("a triangle has a corner beyond the vertices");
  const Json& frames = own.at("frames");
  if (!frames.is_array() || frames.empty()) refuse("a segment has no keys");
  KeyTexturePlace place;
  if (picture) {
    const int64_t row = wholeNumber(own.at("first_row"));
    place = {int(std::clamp<int64_t>(row, 0, kMostSequenceRows)), int(std::min<size_t>(frames.size(), kMostSequenceRows)), vertices};
    if (row < 0 || int64_t(place.first_row) + int64_t(4) * place.rowsPerBlock() * place.keys > picture->image.height)
      refuse("the picture of the keys is too small");
  }
  for (size_t k = 0; k < frames.size(); ++k) {
    const double frame = frames[k].get<double>();
    if (!std::isfinite(frame) || frame < 0 || (k > 0 && !(frame > segment.keys.back().frame)))
      refuse("the frames of a segment are not in order");
    SequenceKey key = picture  ? keyOfTexture(picture->image, place, int(k), picture->scale)
                      : k == 0 ? reader.base()
                               : reader.target(k - 1, frame);
    key.frame = frame;
    for (size_t v = 0; v < vertices; ++v)
      if (!isFinite(key.positions[v]) || !isFinite(key.lobes[v].direction) || !std::isfinite(key.lobes[v].thickness))
        refuse("a number of a key is not finite");
    for (Vec3& normal : key.normals) normal = normalized(normal).value_or(Vec3{0, 1, 0});
    segment.keys.push_back(std::move(key));
  }
  return segment;
}

}  // namespace

std::string encodeSequence(const CloudSequence& sequence, SequenceForm form) {
  Document document;
  Json json = {{"asset", {{"version", "2.0"}, {"generator", kMaker}}}, {"scene", 0}};
  std::vector<KeyTexturePlace> places;
  KeyTextureScale scale;
  if (form == SequenceForm::kTexture) {
    places = placesInTexture(sequence);
    scale = scaleOfTexture(sequence);
    if (rowsOfTexture(places) > kMostSequenceRows)
      throw InputError(
          "",
          fmt::format("the picture of the keys would have {} rows, but GPUs take at most {}: use fewer --vertices, or allow more --change",
                      rowsOfTexture(places), kMostSequenceRows));
  }
  json["asset"]["extras"]["cloudbake"] = infoOf(sequence, form, places, scale);
  Json nodes = Json::array(), roots = Json::array(), meshes = Json::array(), animation = {{"name", "sequence"}};
  for (const char* key : {"channels", "samplers"}) animation[key] = Json::array();
  for (size_t s = 0; s < sequence.segments.size(); ++s) {
    Json node = {{"name", fmt::format("segment {}", s + 1)}, {"mesh", s}};
    if (s > 0) node["scale"] = {0, 0, 0};  // until its time comes
    nodes.push_back(std::move(node));
    roots.push_back(s);
    meshes.push_back(meshOf(sequence.segments[s], int(s), form, document));
    animate(sequence, s, form, document, animation);
  }
  json["scenes"] = {{{"nodes", roots}}};
  json["nodes"] = nodes;
  json["meshes"] = meshes;
  Json material = {{"name", "cloud"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}};
  if (form == SequenceForm::kTexture) {
    constexpr int kClamp = 33071, kNearest = 9728;
    const int view = document.addView(encodePng(keyTexture(sequence, places, scale)), 0);
    json["images"] = {{{"name", kPictureName}, {"mimeType", "image/png"}, {"bufferView", view}}};
    json["samplers"] = {{{"magFilter", kNearest}, {"minFilter", kNearest}, {"wrapS", kClamp}, {"wrapT", kClamp}}};
    json["textures"] = {{{"sampler", 0}, {"source", 0}}};
    // A slot of linear values, of a material that ignores them.
    material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 0}};
    material["extensions"]["KHR_materials_unlit"] = Json::object();
    json["extensionsUsed"] = {"KHR_materials_unlit"};
  }
  json["materials"] = {material};
  if (!animation["channels"].empty()) json["animations"] = {animation};
  json["accessors"] = document.accessors;
  json["bufferViews"] = document.views;
  json["buffers"] = {{{"byteLength", document.bytes.size()}}};
  json["asset"]["extras"]["cloudbake"]["sequence"]["seal"] = sealOf(decodeSequence("", joinGlb("", json.dump(), document.bytes)));
  return joinGlb("", json.dump(), document.bytes);
}

std::string sealOf(const CloudSequence& sequence) {
  const AssetInfo& info = sequence.info;
  std::string bytes = fmt::format("{} {} {}", info.shape.exponent, info.shape.bias, info.extinction);
  const auto append = [&](const auto& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values.front()));
  };
  for (const SequenceSegment& segment : sequence.segments) {
    append(segment.triangles);
    for (const SequenceKey& key : segment.keys) {
      bytes += fmt::format(" {} ", key.frame);
      append(key.positions), append(key.normals), append(key.lobes);
    }
  }
  return hashBytes(bytes);
}

bool isSequence(std::string_view bytes) { return isGltfOfLayout(bytes, kSequenceLayout); }

CloudSequence decodeSequence(const std::filesystem::path& file, std::string_view bytes, uint64_t memory_limit) {
  const GlbChunks chunks = splitGlb(file, bytes);
  try {
    const auto parsed = parseJson(chunks.json);
    if (!parsed) throw InputError(file.string(), "its JSON is damaged");
    if (!isSequenceDocument(*parsed)) throw InputError(file.string(), "is not a sequence: make one with `cloudbake sequence`");
    checkValueTypes(file, *parsed);
    const Json& own = parsed->at("asset").at("extras").at("cloudbake").at("sequence");
    CloudSequence sequence;
    sequence.info = assetInfoOf(file, *parsed);
    sequence.frames_per_second = own.at("frames_per_second").get<double>();
    sequence.loops = own.at("loops").get<bool>();
    sequence.period = own.at("period").get<double>();
    sequence.seal = own.value("seal", "");
    if (!(sequence.frames_per_second > 0) || !std::isfinite(sequence.frames_per_second) || !(sequence.period >= 0) ||
        !std::isfinite(sequence.period))
      throw InputError(file.string(), std::string("frames_per_second or the period of the sequence is out of range") + kCure);
    std::optional<KeyPicture> picture;
    if (own.at("keys") == "picture") {
      const auto bytes_of_picture = imageIn(file, chunks, *parsed, kPictureName);
      if (!bytes_of_picture)
        throw InputError(file.string(),
                         "the sequence has no picture of its keys: a tool has removed it; use the file that `cloudbake sequence` wrote");
      picture = {decodePng(*bytes_of_picture, file.string(), memory_limit),
                 {{vectorOf(own.at("box").at(0)), vectorOf(own.at("box").at(1))}, own.at("density_max").get<float>()}};
      if (picture->image.width != kSequenceColumns || wholeNumber(own.at("columns")) != kSequenceColumns)
        throw InputError(file.string(), std::string("the picture of the keys has another width") + kCure);
    }
    const tinygltf::Model model = parseGeometry(file, *parsed, {{chunks.binary.begin(), chunks.binary.end()}});
    for (const Json& segment : own.at("segments")) sequence.segments.push_back(readSegment(file, segment, model, picture));
    if (sequence.segments.empty()) throw InputError(file.string(), std::string("the sequence has no segments") + kCure);
    for (size_t s = 1; s < sequence.segments.size(); ++s)
      if (!(sequence.segments[s].first() >= sequence.segments[s - 1].first()))
        throw InputError(file.string(), std::string("the segments are not in order") + kCure);
    return sequence;
  } catch (const Json::exception& error) {
    throw InputError(file.string(), std::string("the sequence's metadata are incomplete or damaged (") + error.what() + ")" + kCure);
  }
}

}  // namespace cloudbake
