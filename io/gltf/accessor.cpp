// glTF 2.0, sections 3.6.2 (accessors, sparse ones, alignment) and 3.11 with KHR_mesh_quantization (normalised integers:
// f = c/255, c/65535, max(c/127, −1), max(c/32767, −1)).
#include "io/gltf/accessor.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "io/gltf/tinygltf.h"

namespace cloudbake {

namespace {

// Elements at a constant stride in a buffer.
struct Elements {
  const unsigned char* data = nullptr;  // null: all elements are zero
  size_t stride = 0;
};

[[noreturn]] void fail(const GltfAccessors& accessors, const std::string& owner, const std::string& what) {
  throw InputError(accessors.file.string(), owner + ": " + what + "; the file is damaged, export it again");
}

size_t componentBytes(const GltfAccessors& accessors, int type, const std::string& owner) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return 4;
    default: fail(accessors, owner, "an accessor has an unknown component type");
  }
}

// `count` elements of `bytes` bytes each inside a buffer view. No sum can overflow.
Elements locate(const GltfAccessors& accessors, int view_index, size_t offset, size_t count, size_t bytes, const std::string& owner) {
  const tinygltf::Model& model = accessors.model;
  if (view_index < 0 || size_t(view_index) >= model.bufferViews.size())
    fail(accessors, owner, "an accessor uses a buffer view that does not exist");
  const tinygltf::BufferView& view = model.bufferViews[size_t(view_index)];
  if (view.buffer < 0 || size_t(view.buffer) >= model.buffers.size())
    fail(accessors, owner, "a buffer view uses a buffer that does not exist");
  const std::vector<unsigned char>& buffer = model.buffers[size_t(view.buffer)].data;
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
    fail(accessors, owner, "a buffer view ends beyond its buffer of " + std::to_string(buffer.size()) + " bytes");
  const size_t stride = view.byteStride == 0 ? bytes : view.byteStride;
  if (stride < bytes || stride > 252) fail(accessors, owner, "a buffer view has an impossible stride");
  if (count == 0) return {};
  if (offset > view.byteLength || bytes > view.byteLength - offset || (count - 1) > (view.byteLength - offset - bytes) / stride)
    fail(accessors, owner,
         "an accessor of " + std::to_string(count) + " elements ends beyond its buffer view of " + std::to_string(view.byteLength) +
             " bytes");
  return {buffer.data() + view.byteOffset + offset, stride};
}

template <typename T>
T load(const unsigned char* data) {
  T value;
  std::memcpy(&value, data, sizeof value);
  return value;
}

double component(const unsigned char* data, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return normalized ? std::max(load<int8_t>(data) / 127.0, -1.0) : load<int8_t>(data);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return load<uint8_t>(data) / (normalized ? 255.0 : 1);
    case TINYGLTF_COMPONENT_TYPE_SHORT: return normalized ? std::max(load<int16_t>(data) / 32767.0, -1.0) : load<int16_t>(data);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return load<uint16_t>(data) / (normalized ? 65535.0 : 1);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return load<uint32_t>(data);
    default: return load<float>(data);
  }
}

// Returns the accessor after checking its number of components, type and count.
const tinygltf::Accessor& checkedAccessor(const GltfAccessors& accessors, int index, int components, const std::string& owner) {
  if (index < 0 || size_t(index) >= accessors.model.accessors.size()) fail(accessors, owner, "uses an accessor that does not exist");
  const tinygltf::Accessor& accessor = accessors.model.accessors[size_t(index)];
  if (tinygltf::GetNumComponentsInType(uint32_t(accessor.type)) != components)
    fail(accessors, owner, "an accessor has the wrong type (" + std::to_string(components) + " components are needed)");
  size_t total = 0;
  for (const tinygltf::Buffer& buffer : accessors.model.buffers) total += buffer.data.size();
  if (accessor.bufferView < 0 && accessor.count > total)
    fail(accessors, owner, "an accessor of " + std::to_string(accessor.count) + " zeros is implausibly large for this file");
  return accessor;
}

// The values in storage order as doubles, which are exact for every component type.
std::vector<double> readComponents(const GltfAccessors& accessors, int index, int components, const std::string& owner) {
  const tinygltf::Accessor& accessor = checkedAccessor(accessors, index, components, owner);
  const size_t size = componentBytes(accessors, accessor.componentType, owner), width = size_t(components), count = accessor.count;
  Elements elements;
  if (accessor.bufferView >= 0) elements = locate(accessors, accessor.bufferView, accessor.byteOffset, count, size * width, owner);
  std::vector<double> values(count * width);
  for (size_t i = 0; elements.data && i < count; ++i)
    for (size_t c = 0; c < width; ++c)
      values[i * width + c] = component(elements.data + i * elements.stride + c * size, accessor.componentType, accessor.normalized);
  if (!accessor.sparse.isSparse) return values;

  const auto& sparse = accessor.sparse;
  if (sparse.count < 0 || size_t(sparse.count) > count || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    fail(accessors, owner, "a sparse accessor replaces more elements than exist");
  const size_t index_size = componentBytes(accessors, sparse.indices.componentType, owner), changes = size_t(sparse.count);
  const Elements where = locate(accessors, sparse.indices.bufferView, size_t(sparse.indices.byteOffset), changes, index_size, owner);
  const Elements what = locate(accessors, sparse.values.bufferView, size_t(sparse.values.byteOffset), changes, size * width, owner);
  for (size_t i = 0; i < changes; ++i) {
    const double at = component(where.data + i * where.stride, sparse.indices.componentType, false);
    if (!(at >= 0) || at >= double(count)) fail(accessors, owner, "a sparse accessor replaces an element out of range");
    for (size_t c = 0; c < width; ++c)
      values[size_t(at) * width + c] = component(what.data + i * what.stride + c * size, accessor.componentType, accessor.normalized);
  }
  return values;
}

}  // namespace

std::vector<float> GltfAccessors::readFloats(int accessor, int components, const std::string& owner) const {
  const std::vector<double> values = readComponents(*this, accessor, components, owner);
  return {values.begin(), values.end()};
}

std::vector<uint32_t> GltfAccessors::readIndices(int accessor, const std::string& owner, int components) const {
  const tinygltf::Accessor& checked = checkedAccessor(*this, accessor, components, owner);
  if (checked.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && checked.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      checked.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    fail(*this, owner, "its indices are not unsigned integers");
  const std::vector<double> values = readComponents(*this, accessor, components, owner);
  return {values.begin(), values.end()};
}

}  // namespace cloudbake
