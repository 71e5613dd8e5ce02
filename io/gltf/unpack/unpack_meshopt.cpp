// EXT_meshopt_compression (Khronos; KHR_meshopt_compression has the same layout): a buffer view names the place of its compressed bytes,
// the number and size of its elements, a codec (mode) and a filter that undoes a rounding of its elements.
#include <meshoptimizer.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/gltf/unpack/unpack.h"

namespace cloudbake {

namespace {

// A byte of the vertex codec holds two bits for each of 16 values at least, and one of the index codecs an index or a triangle.
constexpr uint64_t kMostVertexBytesPerByte = 64, kMostIndexBytesPerByte = 12;

struct View {
  std::string owner;
  std::string_view compressed;
  uint64_t count = 0, stride = 0;
  std::string mode, filter;
};

std::string textAt(const Unpacking& unpacking, const Json& object, const char* key, const char* fallback, const std::string& owner) {
  if (!object.contains(key)) return fallback;
  if (!object[key].is_string()) unpacking.fail(owner + ": " + key + " is not a text");
  return object[key];
}

View readView(const Unpacking& unpacking, const Json& json, size_t index, const std::string& extension) {
  View view;
  view.owner = "buffer view " + std::to_string(index);
  const Json& own = json["extensions"][extension];
  if (!own.is_object()) unpacking.fail(view.owner + ": " + extension + " is not an object");
  const auto number = [&](const char* key) { return countAt(unpacking, own, key, 0, view.owner); };
  view.compressed = unpacking.bytesOf(number("buffer"), number("byteOffset"), number("byteLength"), view.owner);
  view.count = number("count");
  view.stride = number("byteStride");
  view.mode = textAt(unpacking, own, "mode", "", view.owner);
  view.filter = textAt(unpacking, own, "filter", "NONE", view.owner);
  return view;
}

// The limits of the specification, which the library takes for granted, and sizes that the compressed bytes cannot have.
void checkView(const Unpacking& unpacking, const View& view) {
  const bool of_vertices = view.mode == "ATTRIBUTES", of_triangles = view.mode == "TRIANGLES";
  if (!of_vertices && !of_triangles && view.mode != "INDICES") unpacking.fail(view.owner + ": there is no mode '" + view.mode + "'");
  if (of_vertices ? view.stride == 0 || view.stride % 4 != 0 || view.stride > 256 : view.stride != 2 && view.stride != 4)
    unpacking.fail(view.owner + " has elements of " + std::to_string(view.stride) + " bytes");
  if (of_triangles && view.count % 3 != 0) unpacking.fail(view.owner + " has " + std::to_string(view.count) + " indices of triangles");
  const bool fits = view.filter == "NONE" || (view.filter == "OCTAHEDRAL" && (view.stride == 4 || view.stride == 8)) ||
                    (view.filter == "QUATERNION" && view.stride == 8) || view.filter == "EXPONENTIAL";
  if (!fits || (view.filter != "NONE" && !of_vertices))
    throw InputError(unpacking.file.string(),
                     view.owner + ": the filter '" + view.filter + "' is unknown or does not fit; export without compression");
  const uint64_t most = (of_vertices ? kMostVertexBytesPerByte : kMostIndexBytesPerByte) * uint64_t(view.compressed.size());
  if (view.count > most / view.stride)
    unpacking.fail(view.owner + " declares " + std::to_string(view.count) + " elements of " + std::to_string(view.stride) +
                   " bytes, but its " + std::to_string(view.compressed.size()) + " compressed bytes cannot hold more than " +
                   std::to_string(most) + " bytes");
  constexpr unsigned char kVertexHeader = 0xA0;
  if (of_vertices && !view.compressed.empty() && (uint8_t(view.compressed[0]) & 0xF0) == kVertexHeader && (view.compressed[0] & 0x0F) != 0)
    throw InputError(unpacking.file.string(),
                     view.owner + " uses version " + std::to_string(view.compressed[0] & 0x0F) +
                         " of the vertex codec, which this meshoptimizer cannot decode; export with EXT_meshopt_compression");
}

std::string decoded(const Unpacking& unpacking, const View& view) {
  std::string plain(view.count * view.stride, '\0');
  const auto* bytes = reinterpret_cast<const unsigned char*>(view.compressed.data());
  const size_t size = view.compressed.size();
  const int error = view.count == 0             ? 0
                    : view.mode == "ATTRIBUTES" ? meshopt_decodeVertexBuffer(plain.data(), view.count, view.stride, bytes, size)
                    : view.mode == "TRIANGLES"  ? meshopt_decodeIndexBuffer(plain.data(), view.count, view.stride, bytes, size)
                                                : meshopt_decodeIndexSequence(plain.data(), view.count, view.stride, bytes, size);
  if (error != 0) unpacking.fail(view.owner + ": its compressed bytes are damaged (meshoptimizer's error " + std::to_string(error) + ")");
  if (view.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(plain.data(), view.count, view.stride);
  if (view.filter == "QUATERNION") meshopt_decodeFilterQuat(plain.data(), view.count, view.stride);
  if (view.filter == "EXPONENTIAL") meshopt_decodeFilterExp(plain.data(), view.count, view.stride);
  return plain;
}

}  // namespace

void unpackMeshopt(Unpacking& unpacking, const std::string& extension) {
  Json& views = unpacking.json["bufferViews"];
  for (size_t i = 0; i < views.size(); ++i) {
    if (!views[i].is_object() || !views[i].contains("extensions") || !views[i]["extensions"].is_object() ||
        !views[i]["extensions"].contains(extension))
      continue;
    const View view = readView(unpacking, views[i], i, extension);
    checkView(unpacking, view);
    unpacking.reserve(view.count * view.stride, view.owner);
    unpacking.decoded_views[i] = decoded(unpacking, view);
    unpacking.is_decoded[i] = true;
  }
}

}  // namespace cloudbake
