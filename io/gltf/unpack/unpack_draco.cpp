// KHR_draco_mesh_compression (Khronos) and the bitstream of Draco 2.2 (google.github.io/draco/spec): a primitive names a buffer view of
// compressed bytes, and the number of Draco's attribute for each of its own.
#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "io/gltf/unpack/unpack.h"

namespace cloudbake {

namespace {

// Even, flat meshes take a few bits for many triangles; a header that declares more than this per byte was damaged.
constexpr uint64_t kMostPerByte = 4096;
// Bytes per vertex and per triangle that the decoder may take for connectivity, and copies of every attribute that it may hold.
constexpr uint64_t kBytesPerVertex = 200, kBytesPerTriangle = 200, kCopiesOfAttributes = 4;

// The numbers of vertices and triangles that the header declares. An edgebreaker's vertices are those before seams split them.
struct Declared {
  uint32_t vertices = 0, triangles = 0;
};

Declared readHeader(const Unpacking& unpacking, std::string_view bytes, const std::string& owner) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  char magic[5];
  uint8_t major = 0, minor = 0, type = 0, method = 0;
  uint16_t flags = 0;
  bool is_read = buffer.Decode(magic, 5) && std::string_view(magic, 5) == "DRACO" && buffer.Decode(&major) && buffer.Decode(&minor) &&
                 buffer.Decode(&type) && buffer.Decode(&method) && buffer.Decode(&flags);
  if (!is_read) unpacking.fail(owner + ": its Draco header is damaged");
  if (major != 2 || minor != 2)
    throw InputError(unpacking.file.string(), owner + " has Draco's bitstream " + std::to_string(major) + "." + std::to_string(minor) +
                                                  "; compress it again with a current encoder, or export without compression");
  if (type != draco::TRIANGULAR_MESH || method > 1) unpacking.fail(owner + " is not a mesh of Draco");
  buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(major, minor));
  constexpr uint16_t kHasMetadata = 0x8000;
  if ((flags & kHasMetadata) != 0) {
    draco::GeometryMetadata metadata;
    is_read = draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata);
  }
  Declared declared;
  uint8_t traversal = 0;
  if (method == draco::MESH_SEQUENTIAL_ENCODING)
    is_read = is_read && draco::DecodeVarint(&declared.triangles, &buffer) && draco::DecodeVarint(&declared.vertices, &buffer);
  else
    is_read = is_read && buffer.Decode(&traversal) && draco::DecodeVarint(&declared.vertices, &buffer) &&
              draco::DecodeVarint(&declared.triangles, &buffer);
  if (!is_read) unpacking.fail(owner + ": its Draco header is damaged");
  return declared;
}

// A mesh that refuses attributes beyond a number of bytes. Draco adds an attribute before it takes the memory for it.
class BoundedMesh : public draco::Mesh {
 public:
  BoundedMesh(Unpacking& unpacking, const std::string& owner) : unpacking_(unpacking), owner_(owner) {}
  void SetAttribute(int id, std::unique_ptr<draco::PointAttribute> attribute) override {
    unpacking_.reserve(kCopiesOfAttributes * num_points() * uint64_t(std::max<int64_t>(0, attribute->byte_stride())), owner_);
    draco::Mesh::SetAttribute(id, std::move(attribute));
  }

 private:
  Unpacking& unpacking_;
  const std::string& owner_;
};

std::unique_ptr<draco::Mesh> decodeMesh(Unpacking& unpacking, std::string_view bytes, const std::string& owner) {
  const Declared declared = readHeader(unpacking, bytes, owner);
  const uint64_t most = kMostPerByte * uint64_t(bytes.size());
  if (declared.vertices > most || declared.triangles > most)
    unpacking.fail(owner + " declares " + std::to_string(declared.vertices) + " vertices and " + std::to_string(declared.triangles) +
                   " triangles, too many for " + std::to_string(bytes.size()) + " compressed bytes");
  const uint64_t before = unpacking.decoded_bytes;
  unpacking.reserve(kBytesPerVertex * declared.vertices + kBytesPerTriangle * declared.triangles, owner);
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  auto mesh = std::make_unique<BoundedMesh>(unpacking, owner);
  draco::Decoder decoder;
  const draco::Status status = decoder.DecodeBufferToGeometry(&buffer, mesh.get());
  if (!status.ok()) unpacking.fail(owner + ": its Draco data is damaged (" + status.error_msg_string() + ")");
  unpacking.decoded_bytes = before;  // the mesh lives only until its attributes are copied
  return mesh;
}

// Writes an attribute with the component type of its accessor.
template <typename T>
std::string valuesOf(const draco::PointAttribute& attribute, uint32_t points, int width) {
  std::string bytes(size_t(points) * size_t(width) * sizeof(T), '\0');
  std::vector<T> value(size_t(std::max<int>(width, attribute.num_components())));
  for (uint32_t point = 0; point < points; ++point) {
    attribute.ConvertValue<T>(attribute.mapped_index(draco::PointIndex(point)), int8_t(width), value.data());
    std::memcpy(&bytes[size_t(point) * size_t(width) * sizeof(T)], value.data(), size_t(width) * sizeof(T));
  }
  return bytes;
}

// Calls `use` with a number of a component type of glTF; for another type, nothing.
template <class Use>
auto asComponent(uint64_t type, const Use& use) -> decltype(use(0.0F)) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return use(int8_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return use(uint8_t{});
    case TINYGLTF_COMPONENT_TYPE_SHORT: return use(int16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return use(uint16_t{});
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return use(uint32_t{});
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return use(float{});
    default: return decltype(use(0.0F))();
  }
}

std::string valuesAs(const draco::PointAttribute& attribute, uint32_t points, int width, uint64_t type) {
  return asComponent(type, [&](auto number) { return valuesOf<decltype(number)>(attribute, points, width); });
}

// The least and the greatest value of every component, which rounding may have changed.
template <typename T>
void setBounds(const std::string& bytes, size_t width, Json& accessor) {
  if (bytes.empty()) return;
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  Json low = Json::array(), high = Json::array();
  for (size_t c = 0; c < width; ++c) {
    T least = values[c], most = values[c];
    for (size_t i = c; i < values.size(); i += width) least = std::min(least, values[i]), most = std::max(most, values[i]);
    low.push_back(least), high.push_back(most);
  }
  accessor["min"] = std::move(low), accessor["max"] = std::move(high);
}

void updateBounds(const std::string& bytes, size_t width, uint64_t type, Json& accessor) {
  asComponent(type, [&](auto number) { setBounds<decltype(number)>(bytes, width, accessor); });
}

// glTF wants every element of a vertex attribute to begin at a multiple of four bytes.
std::string paddedElements(const std::string& bytes, size_t size, size_t stride) {
  if (size == stride) return bytes;
  std::string padded(bytes.size() / size * stride, '\0');
  for (size_t i = 0; i < bytes.size() / size; ++i) padded.replace(i * stride, size, bytes, i * size, size);
  return padded;
}

int widthOf(const std::string& type) {
  static const std::map<std::string, int> widths{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
  const auto found = widths.find(type);
  return found == widths.end() ? 0 : found->second;
}

// What is written into the document while its primitives are unpacked.
struct DracoUnpacking {
  Unpacking& all;
  std::set<uint64_t> filled;   // accessors that have their data
  std::set<uint64_t> sources;  // views of compressed bytes

  // Gives an accessor data of its own. An accessor that another primitive filled with other data is copied. Returns its number.
  uint64_t fill(uint64_t accessor, uint64_t count, std::string bytes, size_t stride, int target) {
    Json& accessors = all.json["accessors"];
    if (!filled.insert(accessor).second) {
      Json copy = accessors[accessor];
      accessors.push_back(std::move(copy));
      accessor = accessors.size() - 1;
      filled.insert(accessor);
    }
    Json view = {{"buffer", 0}, {"byteLength", bytes.size()}, {"target", target}};
    if (target == TINYGLTF_TARGET_ARRAY_BUFFER) view["byteStride"] = stride;
    all.json["bufferViews"].push_back(std::move(view));
    all.decoded_views.push_back(std::move(bytes));
    all.is_decoded.push_back(true);
    Json& own = accessors[accessor];
    own["bufferView"] = all.json["bufferViews"].size() - 1;
    own["count"] = count;
    own.erase("byteOffset");
    own.erase("sparse");
    return accessor;
  }

  const Json& accessorAt(uint64_t accessor, const std::string& owner) const {
    if (!all.json.contains("accessors") || !all.json["accessors"].is_array() || accessor >= all.json["accessors"].size() ||
        !all.json["accessors"][accessor].is_object())
      all.fail(owner + " uses an accessor that does not exist");
    return all.json["accessors"][accessor];
  }

  uint64_t unpackAttribute(const draco::Mesh& mesh, const Json& primitive, const std::string& name, uint64_t id, const std::string& owner) {
    const draco::PointAttribute* attribute = id <= UINT32_MAX ? mesh.GetAttributeByUniqueId(uint32_t(id)) : nullptr;
    if (!attribute) all.fail(owner + ": Draco's data has no attribute " + std::to_string(id) + " for " + name);
    if (!primitive.contains("attributes") || !primitive["attributes"].is_object() || !primitive["attributes"].contains(name))
      all.fail(owner + " has no attribute " + name);
    const uint64_t accessor = countAt(all, primitive["attributes"], name.c_str(), 0, owner);
    const Json& json = accessorAt(accessor, owner);
    const uint64_t type = countAt(all, json, "componentType", 0, owner);
    const int width = json.contains("type") && json["type"].is_string() ? widthOf(json["type"]) : 0;
    const size_t component = type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE     ? 1
                             : type == TINYGLTF_COMPONENT_TYPE_SHORT || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 2
                                                                                                                       : 4;
    const size_t size = size_t(width) * component, stride = (size + 3) / 4 * 4;
    all.reserve(uint64_t(mesh.num_points()) * stride, owner);
    const std::string bytes = width > 0 ? valuesAs(*attribute, mesh.num_points(), width, type) : "";
    if (bytes.empty() && mesh.num_points() > 0) all.fail(owner + ": the accessor of " + name + " has an unknown type");
    const bool has_bounds = json.contains("min") || json.contains("max") || name == "POSITION";
    const uint64_t filled_one =
        fill(accessor, mesh.num_points(), paddedElements(bytes, size, stride), stride, TINYGLTF_TARGET_ARRAY_BUFFER);
    if (has_bounds) updateBounds(bytes, size_t(width), type, all.json["accessors"][filled_one]);
    return filled_one;
  }

  void unpackPrimitive(Json& primitive, const std::string& owner) {
    const Json extension = primitive["extensions"][kDraco];
    if (!extension.is_object() || !extension.contains("bufferView") || !extension.contains("attributes") ||
        !extension["attributes"].is_object())
      all.fail(owner + ": " + kDraco + " lacks a buffer view or attributes");
    const uint64_t view = countAt(all, extension, "bufferView", 0, owner);
    const Json& views = all.json["bufferViews"];
    if (view >= views.size()) all.fail(owner + " uses a buffer view that does not exist");
    const std::string_view bytes =
        all.is_decoded[view] && !sources.contains(view)
            ? std::string_view(all.decoded_views[view])
            : all.bytesOf(countAt(all, views[view], "buffer", 0, owner), countAt(all, views[view], "byteOffset", 0, owner),
                          countAt(all, views[view], "byteLength", 0, owner), owner);
    const std::unique_ptr<draco::Mesh> mesh = decodeMesh(all, bytes, owner);
    for (const auto& [name, id] : extension["attributes"].items()) {
      if (!id.is_number_unsigned()) all.fail(owner + ": the number of Draco's attribute for " + name + " is not a whole number");
      primitive["attributes"][name] = unpackAttribute(*mesh, primitive, name, id.get<uint64_t>(), owner);
    }
    std::string indices;
    all.reserve(uint64_t(mesh->num_faces()) * 12, owner);
    for (uint32_t face = 0; face < mesh->num_faces(); ++face)
      for (const draco::PointIndex& point : mesh->face(draco::FaceIndex(face))) {
        const uint32_t index = point.value();
        indices.append(reinterpret_cast<const char*>(&index), 4);
      }
    if (!primitive.contains("indices")) {
      all.json["accessors"].push_back({{"componentType", TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT}, {"count", 0}, {"type", "SCALAR"}});
      primitive["indices"] = all.json["accessors"].size() - 1;
    }
    const uint64_t accessor = countAt(all, primitive, "indices", 0, owner);
    accessorAt(accessor, owner);
    const uint64_t filled_one =
        fill(accessor, uint64_t(mesh->num_faces()) * 3, std::move(indices), 4, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    all.json["accessors"][filled_one]["componentType"] = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    for (const char* bound : {"min", "max"}) all.json["accessors"][filled_one].erase(bound);
    primitive["indices"] = filled_one;
    primitive["mode"] = TINYGLTF_MODE_TRIANGLES;
    primitive["extensions"].erase(kDraco);
    if (primitive["extensions"].empty()) primitive.erase("extensions");
    sources.insert(view);
  }
};

}  // namespace

void unpackDraco(Unpacking& unpacking) {
  DracoUnpacking draco{unpacking, {}, {}};
  Json& meshes = unpacking.json["meshes"];
  for (size_t i = 0; i < meshes.size(); ++i) {
    if (!meshes[i].is_object() || !meshes[i].contains("primitives") || !meshes[i]["primitives"].is_array()) continue;
    for (size_t k = 0; k < meshes[i]["primitives"].size(); ++k) {
      Json& primitive = meshes[i]["primitives"][k];
      if (primitive.is_object() && primitive.contains("extensions") && primitive["extensions"].is_object() &&
          primitive["extensions"].contains(kDraco))
        draco.unpackPrimitive(primitive, "primitive " + std::to_string(k) + " of mesh " + std::to_string(i));
    }
  }
  // Nothing else uses the compressed bytes. Their views stay, as short as glTF allows, so that no view gets another number.
  for (const uint64_t view : draco.sources) {
    unpacking.decoded_views[view].assign(4, '\0');
    unpacking.is_decoded[view] = true;
  }
}

}  // namespace cloudbake
