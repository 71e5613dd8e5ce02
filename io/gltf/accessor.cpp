// glTF 2.0, sections 3.6.2 (accessors, sparse ones, alignment) and 3.11 with KHR_mesh_quantization (normalised integers:
// f = c/255, c/65535, max(c/127, −1), max(c/32767, −1)).
#include "io/gltf/accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>

#include "core/error.h"
#include "core/parallel.h"
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

// A component as a double, which is exact for every type.
template <typename T>
double component(const unsigned char* data, bool normalized) {
  T value;
  std::memcpy(&value, data, sizeof value);
  if (sizeof value == 4 || !normalized) return double(value);
  return std::max(double(value) / double(std::numeric_limits<T>::max()), -1.0);
}

// Calls use(T()) for the T of a component type.
template <class Use>
void withComponentType(int type, const Use& use) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return use(int8_t());  // NOLINT(bugprone-branch-clone): they differ in T
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return use(uint8_t());
    case TINYGLTF_COMPONENT_TYPE_SHORT: return use(int16_t());
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return use(uint16_t());
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return use(uint32_t());
    default: return use(float());
  }
}

// Writes elements of `width` components.
template <typename Value>
void copyElements(const Elements& from, const tinygltf::Accessor& accessor, size_t width, size_t begin, size_t end, Value* values) {
  withComponentType(accessor.componentType, [&]<typename T>(T) {
    const unsigned char* element = from.data + begin * from.stride;
    if (std::is_same_v<T, Value> && from.stride == width * sizeof(T)) {
      std::memcpy(values, element, (end - begin) * from.stride);
      return;
    }
    for (size_t i = begin; i < end; ++i, element += from.stride)
      for (size_t c = 0; c < width; ++c) *values++ = Value(component<T>(element + c * sizeof(T), accessor.normalized));
  });
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

// Replaces the elements that a sparse accessor names.
template <typename Value>
void replaceElements(const GltfAccessors& accessors, const tinygltf::Accessor& accessor, size_t width, const std::string& owner,
                     Value* values) {
  const auto& sparse = accessor.sparse;
  const size_t size = componentBytes(accessors, accessor.componentType, owner), count = accessor.count;
  if (sparse.count < 0 || size_t(sparse.count) > count || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    fail(accessors, owner, "a sparse accessor replaces more elements than exist");
  const size_t index_size = componentBytes(accessors, sparse.indices.componentType, owner), changes = size_t(sparse.count);
  const Elements where = locate(accessors, sparse.indices.bufferView, size_t(sparse.indices.byteOffset), changes, index_size, owner);
  const Elements what = locate(accessors, sparse.values.bufferView, size_t(sparse.values.byteOffset), changes, size * width, owner);
  for (size_t i = 0; i < changes; ++i) {
    double at = 0;
    withComponentType(sparse.indices.componentType, [&]<typename T>(T) { at = component<T>(where.data + i * where.stride, false); });
    if (!(at >= 0) || at >= double(count)) fail(accessors, owner, "a sparse accessor replaces an element out of range");
    copyElements(what, accessor, width, i, i + 1, values + size_t(at) * width);
  }
}

// All components in storage order, as values or as targets that consist of several. Values beyond the last whole target are lost.
template <typename Value, typename Target = Value>
std::vector<Target> readComponents(const GltfAccessors& accessors, int index, int components, const std::string& owner) {
  constexpr size_t kElementsPerTask = 1 << 15;
  const tinygltf::Accessor& accessor = checkedAccessor(accessors, index, components, owner);
  const size_t size = componentBytes(accessors, accessor.componentType, owner), width = size_t(components), count = accessor.count;
  Elements elements;
  if (accessor.bufferView >= 0) elements = locate(accessors, accessor.bufferView, accessor.byteOffset, count, size * width, owner);
  std::vector<Target> targets(count * width * sizeof(Value) / sizeof(Target));
  Value* const values = reinterpret_cast<Value*>(targets.data());
  if (elements.data)
    parallelBlocks(count, kElementsPerTask,
                   [&](size_t begin, size_t end) { copyElements(elements, accessor, width, begin, end, values + begin * width); });
  if (accessor.sparse.isSparse) replaceElements(accessors, accessor, width, owner, values);
  return targets;
}

void checkIndices(const GltfAccessors& accessors, int index, int components, const std::string& owner) {
  const tinygltf::Accessor& checked = checkedAccessor(accessors, index, components, owner);
  if (checked.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && checked.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      checked.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    fail(accessors, owner, "its indices are not unsigned integers");
}

}  // namespace

std::vector<float> GltfAccessors::readFloats(int accessor, int components, const std::string& owner) const {
  return readComponents<float>(*this, accessor, components, owner);
}

std::vector<Vec3> GltfAccessors::readVectors(int accessor, const std::string& owner) const {
  return readComponents<float, Vec3>(*this, accessor, 3, owner);
}

std::vector<uint32_t> GltfAccessors::readIndices(int accessor, const std::string& owner, int components) const {
  checkIndices(*this, accessor, components, owner);
  return readComponents<uint32_t>(*this, accessor, components, owner);
}

std::vector<Triangle> GltfAccessors::readTriangles(int accessor, const std::string& owner) const {
  checkIndices(*this, accessor, 1, owner);
  return readComponents<uint32_t, Triangle>(*this, accessor, 1, owner);
}

}  // namespace cloudbake
