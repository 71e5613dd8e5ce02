// Gives primitives of a glTF document fewer vertices and other indices. Only for io/gltf/sculpt.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "io/gltf/document.h"

namespace cloudbake {

/// The distinct numbers, ascending.
std::vector<uint32_t> distinctNumbers(std::vector<uint32_t> numbers);

/// Elements that follow each other without gaps.
struct VertexRows {
  std::string bytes;
  size_t size = 0;  ///< of an element
};

/// All elements of an accessor. Throws InputError if they are not `expected` many, or lie outside their buffer.
VertexRows rowsOf(const GltfDocument& document, const Json& accessor, size_t expected);

/// A document while primitives of it are edited. Rows of vertices are copied byte by byte, so that every type and every unknown attribute
/// stays as it is. An accessor that nothing else uses is replaced in its place, so that no reference to it breaks. All functions throw
/// InputError if an attribute is damaged.
class VertexEditor {
 public:
  /// `edited` are the primitives that will be edited.
  VertexEditor(GltfDocument document, const std::set<GltfPrimitive>& edited);

  /// Leaves only the vertices `kept` (ascending) of `vertices` to some primitives of a mesh that have the same vertices. Their indices are
  /// not changed.
  void keepVertices(int mesh, std::span<const int> primitives, const std::vector<uint32_t>& kept, size_t vertices);
  void setIndices(GltfPrimitive place, std::span<const uint32_t> indices, size_t vertices);
  /// Leaves the vertices `kept` of `vertices` to a primitive, and gives it triangles of these.
  void replace(GltfPrimitive place, const std::vector<uint32_t>& kept, std::span<const Triangle> triangles, size_t vertices);

  /// The edited document, with one buffer that has only what is still used.
  GltfDocument result() &&;

 private:
  Json& primitive(GltfPrimitive place) { return primitiveOf(document_.json, place); }
  size_t put(int old, Json accessor);
  size_t addView(const std::string& bytes, int target, size_t stride);
  size_t attribute(size_t old, const std::vector<uint32_t>& kept, size_t vertices, bool is_position);
  std::string keptRows(size_t old, const std::vector<uint32_t>& kept, size_t vertices, size_t stride);
  void dropUnusedViews();

  GltfDocument document_;  // new bytes go to one new buffer, the last
  Json old_accessors_;
  std::set<size_t> in_use_;
  std::map<size_t, VertexRows> sparse_;                              // of old accessors
  std::map<std::pair<size_t, std::vector<uint32_t>>, size_t> done_;  // accessors by their old number and the vertices kept
};

}  // namespace cloudbake
