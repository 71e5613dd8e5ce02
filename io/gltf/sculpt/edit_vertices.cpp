// glTF 2.0, section 3.6.2: accessors, sparse ones, alignment and bounds.
#include "io/gltf/sculpt/edit_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/error.h"

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

// Bytes of an element; 0 for an unknown type.
size_t elementBytes(const Json& accessor) {
  return bytesOfComponent(int(wholeNumber(accessor.at("componentType")))) * componentsOf(accessor.at("type"));
}

// Elements at a constant stride in a buffer.
struct StridedRows {
  const unsigned char* first = nullptr;
  size_t stride = 0;
};

// `count` elements of `size` bytes each at an offset in a buffer view.
StridedRows rowsInView(const GltfDocument& document, const Json& place, size_t count, size_t size) {
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
  return {document.buffers[buffer].data() + start + offset, stride};
}

VertexRows copiedRows(const StridedRows& source, size_t count, size_t size) {
  VertexRows rows{std::string(count * size, '\0'), size};
  for (size_t i = 0; i < count; ++i) std::memcpy(&rows.bytes[i * size], source.first + i * source.stride, size);
  return rows;
}

// glTF wants the bounds of positions, in stored numbers.
void addBounds(Json& accessor, const std::string& bytes, size_t stride) {
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

}  // namespace

std::vector<uint32_t> distinctNumbers(std::vector<uint32_t> numbers) {
  if (numbers.empty()) return numbers;
  const uint32_t largest = *std::max_element(numbers.begin(), numbers.end());
  if (largest / 16 > numbers.size()) {  // few of many: sorting is faster
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
  }
  std::vector<bool> met(size_t(largest) + 1);
  for (const uint32_t number : numbers) met[number] = true;
  numbers.clear();
  for (size_t number = 0; number < met.size(); ++number)
    if (met[number]) numbers.push_back(uint32_t(number));
  return numbers;
}

VertexRows rowsOf(const GltfDocument& document, const Json& accessor, size_t expected) {
  const size_t size = elementBytes(accessor), count = wholeNumber(accessor.at("count"));
  if (count != expected || size == 0) damaged(document);
  VertexRows rows = accessor.contains("bufferView") ? copiedRows(rowsInView(document, accessor, count, size), count, size)
                                                    : VertexRows{std::string(count * size, '\0'), size};
  if (!accessor.contains("sparse")) return rows;
  const Json& sparse = accessor["sparse"];
  const size_t changes = wholeNumber(sparse.at("count")),
               width = bytesOfComponent(int(wholeNumber(sparse.at("indices").at("componentType"))));
  if (changes > count) damaged(document);
  const StridedRows where = rowsInView(document, sparse.at("indices"), changes, width),
                    what = rowsInView(document, sparse.at("values"), changes, size);
  for (size_t i = 0; i < changes; ++i) {
    uint32_t at = 0;
    std::memcpy(&at, where.first + i * where.stride, width);
    if (at >= count) damaged(document);
    std::memcpy(&rows.bytes[at * size], what.first + i * what.stride, size);
  }
  return rows;
}

VertexEditor::VertexEditor(GltfDocument document, const std::set<GltfPrimitive>& edited)
    : document_(std::move(document)), old_accessors_(document_.json.at("accessors")), in_use_(accessorsInUse(document_.json, edited)) {
  document_.free_views.clear();  // dropUnusedViews removes them
  document_.buffers.emplace_back();
  Json& views = document_.json["bufferViews"];  // made now, because a new key in an ordered_json moves its neighbours in memory
  if (!views.is_array()) views = Json::array();
}

void VertexEditor::keepVertices(int mesh, std::span<const int> primitives, const std::vector<uint32_t>& kept, size_t vertices) {
  Json& first = primitive({mesh, primitives.front()});
  const auto replaceAll = [&](Json& accessors) {
    for (auto& [name, accessor] : accessors.items())
      accessor = attribute(size_t(wholeNumber(accessor)), kept, vertices, name == "POSITION");
  };
  replaceAll(first["attributes"]);
  if (first.contains("targets"))
    for (Json& target : first["targets"]) replaceAll(target);
  const Json attributes = first["attributes"], targets = first.value("targets", Json());
  for (const int index : primitives.subspan(1)) {
    Json& other = primitive({mesh, index});
    other["attributes"] = attributes;
    if (other.contains("targets")) other["targets"] = targets;
  }
}

void VertexEditor::setIndices(GltfPrimitive place, std::span<const uint32_t> indices, size_t vertices) {
  const int old = int(wholeNumber(primitive(place), "indices", -1));
  const size_t width = vertices > 65535 ? 4 : 2;
  std::string bytes;
  bytes.reserve(indices.size() * width);
  for (const uint32_t index : indices) bytes.append(reinterpret_cast<const char*>(&index), width);  // little-endian
  Json accessor = {{"bufferView", addView(bytes, kIndexTarget, 0)},
                   {"componentType", width == 4 ? kUnsignedInt : kUnsignedShort},
                   {"count", indices.size()},
                   {"type", "SCALAR"}};
  primitive(place)["indices"] = put(old, std::move(accessor));
}

void VertexEditor::replace(GltfPrimitive place, const std::vector<uint32_t>& kept, std::span<const Triangle> triangles, size_t vertices) {
  keepVertices(place.first, std::array{place.second}, kept, vertices);
  std::vector<uint32_t> indices;
  for (const Triangle& t : triangles) indices.insert(indices.end(), t.begin(), t.end());
  if (indices.empty()) indices.resize(3);  // glTF has no accessors without elements: a triangle without area
  setIndices(place, indices, kept.size());
  primitive(place).erase("mode");  // triangles
}

GltfDocument VertexEditor::result() && {
  dropUnusedViews();
  return std::move(document_);
}

// Puts an accessor in the place of an old one that nothing uses any more, or at the end.
size_t VertexEditor::put(int old, Json accessor) {
  Json& accessors = document_.json["accessors"];
  if (old >= 0 && in_use_.insert(size_t(old)).second) {
    accessors.at(size_t(old)) = std::move(accessor);
    return size_t(old);
  }
  accessors.push_back(std::move(accessor));
  in_use_.insert(accessors.size() - 1);
  return accessors.size() - 1;
}

size_t VertexEditor::addView(const std::string& bytes, int target, size_t stride) {
  std::vector<unsigned char>& buffer = document_.buffers.back();
  buffer.resize((buffer.size() + 3) / 4 * 4);
  Json view = {{"buffer", document_.buffers.size() - 1}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
  if (stride > 0) view["byteStride"] = stride;
  view["target"] = target;
  buffer.insert(buffer.end(), bytes.begin(), bytes.end());
  Json& views = document_.json["bufferViews"];
  views.push_back(std::move(view));
  return views.size() - 1;
}

// The bytes of the rows that are kept, each padded to `stride`.
std::string VertexEditor::keptRows(size_t old, const std::vector<uint32_t>& kept, size_t vertices, size_t stride) {
  const Json& accessor = old_accessors_[old];
  const size_t size = elementBytes(accessor);
  if (size == 0 || size_t(wholeNumber(accessor.at("count"))) != vertices) damaged(document_);
  StridedRows rows;
  if (accessor.contains("sparse") || !accessor.contains("bufferView")) {
    auto known = sparse_.find(old);
    if (known == sparse_.end()) known = sparse_.emplace(old, rowsOf(document_, accessor, vertices)).first;
    rows = {reinterpret_cast<const unsigned char*>(known->second.bytes.data()), size};
  } else {
    rows = rowsInView(document_, accessor, vertices, size);
  }
  std::string bytes(kept.size() * stride, '\0');
  for (size_t i = 0; i < kept.size(); ++i) std::memcpy(&bytes[i * stride], rows.first + kept[i] * rows.stride, size);
  return bytes;
}

size_t VertexEditor::attribute(size_t old, const std::vector<uint32_t>& kept, size_t vertices, bool is_position) {
  const auto known = done_.find({old, kept});
  if (known != done_.end()) return known->second;
  if (old >= old_accessors_.size()) damaged(document_);
  Json accessor = old_accessors_[old];
  const size_t size = elementBytes(accessor), stride = (size + 3) / 4 * 4;
  const std::string bytes = keptRows(old, kept, vertices, stride);
  for (const char* key : {"sparse", "byteOffset", "min", "max"}) accessor.erase(key);
  accessor["bufferView"] = addView(bytes, kVertexTarget, stride == size ? 0 : stride);
  accessor["count"] = kept.size();
  if (is_position) addBounds(accessor, bytes, stride);
  return done_[{old, kept}] = put(int(old), std::move(accessor));
}

// Removes the views that nothing refers to any more, with their bytes, and puts the others into one buffer.
void VertexEditor::dropUnusedViews() {
  Json& json = document_.json;
  std::map<size_t, size_t> number_of;
  visitKey(json, "bufferView", [&](const Json& view) { number_of[view.get<size_t>()] = 0; });
  Json views = Json::array();
  std::vector<unsigned char> bytes;
  for (auto& [old, number] : number_of) {
    if (old >= json["bufferViews"].size()) damaged(document_);
    Json view = json["bufferViews"][old];
    const size_t buffer = wholeNumber(view.at("buffer")), start = wholeNumber(view, "byteOffset", 0),
                 length = wholeNumber(view.at("byteLength"));
    if (buffer >= document_.buffers.size() || start > document_.buffers[buffer].size() || length > document_.buffers[buffer].size() - start)
      damaged(document_);
    bytes.resize((bytes.size() + 3) / 4 * 4);
    view["buffer"] = 0, view["byteOffset"] = bytes.size();
    const auto first = document_.buffers[buffer].begin() + std::ptrdiff_t(start);
    bytes.insert(bytes.end(), first, first + std::ptrdiff_t(length));
    number = views.size();
    views.push_back(std::move(view));
  }
  visitKey(json, "bufferView", [&](Json& view) { view = number_of.at(view.get<size_t>()); });
  json["bufferViews"] = std::move(views);
  json["buffers"] = Json::array({{{"byteLength", bytes.size()}}});
  document_.buffers = {std::move(bytes)};
}

}  // namespace cloudbake
