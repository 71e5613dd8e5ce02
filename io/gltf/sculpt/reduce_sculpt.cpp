// Writes the rows of vertices that remain as new accessors, byte by byte, so that every type and every unknown attribute stays as it is. An
// accessor that nothing else uses is replaced in its place, so that no reference to it breaks.
#include "io/gltf/sculpt/reduce_sculpt.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <unordered_map>

#include "core/error.h"
#include "core/text/numbers.h"
#include "io/gltf/document.h"

namespace cloudbake {

namespace {

[[noreturn]] void damaged(const GltfDocument& document) {
  throw InputError(document.file.string(),
                   "an attribute lies outside its buffer or has an unknown type; the file is damaged, export it again");
}

size_t bytesOfComponent(int type) { return type < 5122 ? 1 : type < 5125 ? 2 : 4; }
size_t componentsOf(const std::string& type) {
  static const std::map<std::string, size_t> kCounts{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                     {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
  const auto found = kCounts.find(type);
  return found == kCounts.end() ? 0 : found->second;
}

// Elements that follow each other without gaps.
struct Rows {
  std::string bytes;
  size_t size = 0;  // of an element
};

// `count` elements of `size` bytes each at an offset in a buffer view.
Rows rowsOfView(const GltfDocument& document, const Json& place, size_t count, size_t size) {
  const Json& views = document.json.at("bufferViews");
  const size_t index = wholeNumber(place.at("bufferView"));
  if (index >= views.size()) damaged(document);
  const Json& view = views[index];
  const size_t buffer = wholeNumber(view.at("buffer")), stride = wholeNumber(view, "byteStride", size),
               length = wholeNumber(view.at("byteLength")), start = wholeNumber(view, "byteOffset", 0),
               offset = wholeNumber(place, "byteOffset", 0);
  if (buffer >= document.buffers.size() || start > document.buffers[buffer].size() || length > document.buffers[buffer].size() - start ||
      stride < size || stride > 252 || offset > length ||
      (count > 0 && (size > length - offset || (count - 1) > (length - offset - size) / stride)))
    damaged(document);
  Rows rows{std::string(count * size, '\0'), size};
  for (size_t i = 0; i < count; ++i) std::memcpy(&rows.bytes[i * size], &document.buffers[buffer][start + offset + i * stride], size);
  return rows;
}

Rows rowsOf(const GltfDocument& document, const Json& accessor, size_t expected) {
  const size_t size = bytesOfComponent(int(wholeNumber(accessor.at("componentType")))) * componentsOf(accessor.at("type")),
               count = wholeNumber(accessor.at("count"));
  if (count != expected || size == 0) damaged(document);
  Rows rows = accessor.contains("bufferView") ? rowsOfView(document, accessor, count, size) : Rows{std::string(count * size, '\0'), size};
  if (!accessor.contains("sparse")) return rows;
  const Json& sparse = accessor["sparse"];
  const size_t changes = wholeNumber(sparse.at("count")),
               width = bytesOfComponent(int(wholeNumber(sparse.at("indices").at("componentType"))));
  if (changes > count) damaged(document);
  const Rows where = rowsOfView(document, sparse.at("indices"), changes, width),
             what = rowsOfView(document, sparse.at("values"), changes, size);
  for (size_t i = 0; i < changes; ++i) {
    uint32_t at = 0;
    std::memcpy(&at, &where.bytes[i * width], width);
    if (at >= count) damaged(document);
    std::memcpy(&rows.bytes[at * size], &what.bytes[i * size], size);
  }
  return rows;
}

// Calls visit(value) for every value of this key in the tree.
template <class Visit>
void visitKey(Json& json, const char* key, const Visit& visit) {
  if (!json.is_structured()) return;
  for (auto item = json.begin(); item != json.end(); ++item)
    if (json.is_object() && item.key() == key && item->is_number_unsigned())
      visit(*item);
    else
      visitKey(*item, key, visit);
}

// The document while parts of it are replaced. New bytes go to one new buffer, the last.
class Reducer {
 public:
  Reducer(const GltfDocument& source, const std::set<size_t>& reduced)
      : source_(source), result_(source), meshes_(separateMeshes(source, result_.json)) {
    for (size_t i = 0; i < meshes_.size(); ++i) result_.places[i].mesh = meshes_[i];
    result_.free_views.clear();  // dropUnusedViews removes them
    result_.buffers.emplace_back();
    in_use_ = otherUses(reduced);
  }

  void replace(size_t part, const std::vector<uint32_t>& kept, const std::vector<Triangle>& triangles, size_t vertices) {
    const GltfPlace& place = result_.places[part];
    Json& primitive = result_.json["meshes"][size_t(place.mesh)]["primitives"][size_t(place.primitive)];
    for (auto& [name, accessor] : primitive["attributes"].items())
      accessor = attribute(wholeNumber(accessor), kept, vertices, name == "POSITION");
    const int old_indices = primitive.contains("indices") ? int(wholeNumber(primitive["indices"])) : -1;
    primitive["indices"] = indices(old_indices, triangles, kept.size());
    primitive.erase("mode");  // triangles
  }

  std::shared_ptr<const GltfDocument> result() {
    dropUnusedViews();
    return std::make_shared<GltfDocument>(std::move(result_));
  }

 private:
  // What stays as it is keeps its accessors.
  std::set<size_t> otherUses(const std::set<size_t>& reduced) const {
    std::set<std::pair<int, int>> replaced;
    for (const size_t part : reduced) replaced.emplace(result_.places[part].mesh, result_.places[part].primitive);
    return accessorsInUse(result_.json, replaced);
  }

  // Puts an accessor in the place of an old one that nothing uses any more, or at the end.
  size_t put(int old, Json accessor) {
    Json& accessors = result_.json["accessors"];
    if (old >= 0 && in_use_.insert(size_t(old)).second) {
      accessors[size_t(old)] = std::move(accessor);
      return size_t(old);
    }
    accessors.push_back(std::move(accessor));
    in_use_.insert(accessors.size() - 1);
    return accessors.size() - 1;
  }

  size_t addView(const std::string& bytes, int target, size_t stride) {
    std::vector<unsigned char>& buffer = result_.buffers.back();
    buffer.resize((buffer.size() + 3) / 4 * 4);
    Json view = {{"buffer", result_.buffers.size() - 1}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
    if (stride > 0) view["byteStride"] = stride;
    view["target"] = target;
    buffer.insert(buffer.end(), bytes.begin(), bytes.end());
    Json& views = result_.json["bufferViews"];
    if (!views.is_array()) views = Json::array();
    views.push_back(std::move(view));
    return views.size() - 1;
  }

  size_t attribute(size_t old, const std::vector<uint32_t>& kept, size_t vertices, bool is_position) {
    const auto known = done_.find({old, kept});
    if (known != done_.end()) return known->second;
    if (old >= source_.json.at("accessors").size()) damaged(source_);
    Json accessor = source_.json["accessors"][old];
    const Rows rows = rowsOf(source_, accessor, vertices);
    const size_t stride = (rows.size + 3) / 4 * 4;
    std::string bytes(kept.size() * stride, '\0');
    for (size_t i = 0; i < kept.size(); ++i) std::memcpy(&bytes[i * stride], &rows.bytes[kept[i] * rows.size], rows.size);
    for (const char* key : {"sparse", "byteOffset", "min", "max"}) accessor.erase(key);
    accessor["bufferView"] = addView(bytes, kVertexTarget, stride == rows.size ? 0 : stride);
    accessor["count"] = kept.size();
    if (is_position) addBounds(accessor, bytes, stride);
    return done_[{old, kept}] = put(int(old), std::move(accessor));
  }

  // glTF wants the bounds of positions, in stored numbers.
  static void addBounds(Json& accessor, const std::string& bytes, size_t stride) {
    const int type = int(wholeNumber(accessor["componentType"]));
    const auto stored = [&](size_t at) -> double {
      const auto as = [&](auto value) {
        std::memcpy(&value, &bytes[at], sizeof value);
        return double(value);
      };
      return type == 5120   ? as(int8_t())
             : type == 5121 ? as(uint8_t())
             : type == 5122 ? as(int16_t())
             : type == 5123 ? as(uint16_t())
                            : as(float());
    };
    for (size_t axis = 0; axis < 3; ++axis) {
      double low = INFINITY, high = -INFINITY;
      for (size_t at = axis * bytesOfComponent(type); at < bytes.size(); at += stride)
        low = std::min(low, stored(at)), high = std::max(high, stored(at));
      const auto number = [&](double value) { return type == kFloat ? Json(float(value)) : Json(int(value)); };
      accessor["min"].push_back(number(low)), accessor["max"].push_back(number(high));
    }
  }

  size_t indices(int old, const std::vector<Triangle>& triangles, size_t vertices) {
    std::string bytes;
    const size_t width = vertices > 65535 ? 4 : 2;
    for (const Triangle& t : triangles)
      for (const uint32_t v : t) bytes.append(reinterpret_cast<const char*>(&v), width);  // little-endian
    Json accessor = {{"bufferView", addView(bytes, kIndexTarget, 0)},
                     {"componentType", width == 4 ? kUnsignedInt : kUnsignedShort},
                     {"count", 3 * triangles.size()},
                     {"type", "SCALAR"}};
    return put(old, std::move(accessor));
  }

  // Removes the views that nothing refers to any more, with their bytes, and puts the others into one buffer.
  void dropUnusedViews() {
    Json& json = result_.json;
    std::map<size_t, size_t> number_of;
    visitKey(json, "bufferView", [&](const Json& view) { number_of[view.get<size_t>()] = 0; });
    Json views = Json::array();
    std::vector<unsigned char> bytes;
    for (auto& [old, number] : number_of) {
      if (old >= json["bufferViews"].size()) damaged(source_);
      Json view = json["bufferViews"][old];
      const size_t buffer = wholeNumber(view.at("buffer")), start = wholeNumber(view, "byteOffset", 0),
                   length = wholeNumber(view.at("byteLength"));
      if (buffer >= result_.buffers.size() || start > result_.buffers[buffer].size() || length > result_.buffers[buffer].size() - start)
        damaged(source_);
      bytes.resize((bytes.size() + 3) / 4 * 4);
      view["buffer"] = 0, view["byteOffset"] = bytes.size();
      const auto first = result_.buffers[buffer].begin() + std::ptrdiff_t(start);
      bytes.insert(bytes.end(), first, first + std::ptrdiff_t(length));
      number = views.size();
      views.push_back(std::move(view));
    }
    visitKey(json, "bufferView", [&](Json& view) { view = number_of.at(view.get<size_t>()); });
    json["bufferViews"] = std::move(views);
    json["buffers"] = Json::array({{{"byteLength", bytes.size()}}});
    result_.buffers = {std::move(bytes)};
  }

  const GltfDocument& source_;
  GltfDocument result_;
  std::vector<int> meshes_;
  std::set<size_t> in_use_;
  std::map<std::pair<size_t, std::vector<uint32_t>>, size_t> done_;  // accessors by their old number and the vertices kept
};

template <class Value>
void keepRows(std::vector<Value>& values, const std::vector<uint32_t>& kept) {
  if (values.empty()) return;
  std::vector<Value> rows;
  for (const uint32_t v : kept) rows.push_back(values[v]);
  values = std::move(rows);
}

template <class Value>
void addRows(const std::vector<Value>& values, std::vector<std::string>& rows) {
  for (size_t v = 0; v < values.size(); ++v) rows[v].append(reinterpret_cast<const char*>(&values[v]), sizeof(Value));
}

// The values of all attributes of each vertex, as bytes.
std::vector<std::string> attributeBytes(const Sculpt& sculpt, size_t index) {
  const SculptPart& part = sculpt.parts[index];
  std::vector<std::string> rows(part.positions.size());
  addRows(part.positions, rows), addRows(part.normals, rows), addRows(part.uvs, rows), addRows(part.colors, rows);
  for (const std::vector<Vec2>& uvs : part.more_uvs) addRows(uvs, rows);
  if (!sculpt.gltf) return rows;
  const GltfPlace& place = sculpt.gltf->places[index];
  const Json& json = sculpt.gltf->json;
  for (const Json& accessor : json.at("meshes").at(size_t(place.mesh)).at("primitives").at(size_t(place.primitive)).at("attributes")) {
    const Rows values = rowsOf(*sculpt.gltf, json.at("accessors").at(size_t(wholeNumber(accessor))), rows.size());
    for (size_t v = 0; v < rows.size(); ++v) rows[v].append(values.bytes, v * values.size, values.size);
  }
  return rows;
}

}  // namespace

std::vector<uint32_t> firstAlike(const Sculpt& sculpt) {
  std::vector<uint32_t> first;
  for (size_t i = 0; i < sculpt.parts.size(); ++i) {
    const auto start = uint32_t(first.size()), count = uint32_t(sculpt.parts[i].positions.size());
    if (isDeformed(sculpt, i)) {
      for (uint32_t v = 0; v < count; ++v) first.push_back(start + v);
      continue;
    }
    std::unordered_map<std::string, uint32_t> known;
    std::vector<std::string> rows = attributeBytes(sculpt, i);
    for (uint32_t v = 0; v < count; ++v) first.push_back(known.try_emplace(std::move(rows[v]), start + v).first->second);
  }
  return first;
}

bool isDeformed(const Sculpt& sculpt, size_t part) {
  if (!sculpt.parts[part].vertex_to_scene.empty()) return true;
  if (!sculpt.gltf) return false;
  const GltfPlace& place = sculpt.gltf->places[part];
  const Json& primitive = sculpt.gltf->json.at("meshes").at(size_t(place.mesh)).at("primitives").at(size_t(place.primitive));
  return primitive.contains("targets") && !primitive["targets"].empty();
}

std::vector<uint32_t> usedVertices(std::span<const Triangle> triangles, size_t vertex_count) {
  std::vector<bool> used(vertex_count);
  for (const Triangle& t : triangles)
    for (const uint32_t v : t) used[v] = true;
  std::vector<uint32_t> vertices;
  for (uint32_t v = 0; v < vertex_count; ++v)
    if (used[v]) vertices.push_back(v);
  return vertices;
}

Sculpt withTriangles(const Sculpt& sculpt, std::span<const std::vector<Triangle>> triangles_per_part) {
  Sculpt result = sculpt;
  std::set<size_t> reduced;
  for (size_t i = 0; i < result.parts.size(); ++i)
    if (!triangles_per_part[i].empty()) reduced.insert(i);
  try {
    std::optional<Reducer> document;
    if (sculpt.gltf) document.emplace(*sculpt.gltf, reduced);
    for (const size_t i : reduced) {
      SculptPart& part = result.parts[i];
      const size_t vertices = part.positions.size();
      const std::vector<uint32_t> kept = usedVertices(triangles_per_part[i], vertices);
      std::vector<uint32_t> number_of(vertices);
      for (uint32_t k = 0; k < kept.size(); ++k) number_of[kept[k]] = k;
      part.triangles = triangles_per_part[i];
      for (Triangle& t : part.triangles)
        for (uint32_t& v : t) v = number_of[v];
      keepRows(part.positions, kept), keepRows(part.normals, kept), keepRows(part.uvs, kept), keepRows(part.colors, kept);
      for (std::vector<Vec2>& uvs : part.more_uvs) keepRows(uvs, kept);
      keepRows(part.vertex_to_scene, kept);
      if (document) document->replace(i, kept, part.triangles, vertices);
    }
    if (document) result.gltf = document->result();
  } catch (const Json::exception& error) {
    throw InputError(sculpt.gltf->file.string(),
                     std::string("a value of the glTF has the wrong type (") + error.what() + "); export the file again");
  }
  return result;
}

}  // namespace cloudbake
