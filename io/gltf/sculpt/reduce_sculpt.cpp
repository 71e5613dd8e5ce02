#include "io/gltf/sculpt/reduce_sculpt.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <unordered_map>

#include "core/error.h"
#include "io/gltf/sculpt/edit_vertices.h"

namespace cloudbake {

namespace {

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
  const Json& json = sculpt.gltf->json;
  for (const Json& accessor : primitiveOf(json, sculpt.gltf->places[index].first()).at("attributes")) {
    const VertexRows values = rowsOf(*sculpt.gltf, json.at("accessors").at(size_t(wholeNumber(accessor))), rows.size());
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
  const Json& primitive = primitiveOf(sculpt.gltf->json, sculpt.gltf->places[part].first());
  return primitive.contains("targets") && !primitive["targets"].empty();
}

Sculpt withTriangles(const Sculpt& sculpt, std::span<const std::vector<Triangle>> triangles_per_part) {
  Sculpt result = sculpt;
  GltfDocument document = sculpt.gltf ? *sculpt.gltf : GltfDocument{};
  try {
    std::vector<GltfPrimitive> primitives;
    std::set<GltfPrimitive> edited;
    if (sculpt.gltf) {
      const std::vector<int> meshes = separateMeshes(*sculpt.gltf, document.json);
      for (size_t i = 0; i < meshes.size(); ++i) {
        GltfPlace& place = document.places[i];
        place.mesh = meshes[i];
        primitives.push_back(place.first());
        if (triangles_per_part[i].empty()) continue;
        if (place.stretches.size() > 1) throw Error(ExitCode::kInternal, "", 0, 0, "withTriangles needs a part per primitive");
        place.stretches.front().triangles = triangles_per_part[i].size();
        edited.insert(place.first());
      }
    }
    std::optional<VertexEditor> editor;
    if (sculpt.gltf) editor.emplace(std::move(document), edited);
    for (size_t i = 0; i < result.parts.size(); ++i) {
      if (triangles_per_part[i].empty()) continue;
      const size_t vertices = sculpt.parts[i].positions.size();
      const std::vector<uint32_t> kept = usedVertices(triangles_per_part[i]);
      result.parts[i] = partOf(sculpt.parts[i], kept, triangles_per_part[i]);
      if (editor) editor->replace(primitives[i], kept, result.parts[i].triangles, vertices);
    }
    if (editor) result.gltf = std::make_shared<GltfDocument>(std::move(*editor).result());
  } catch (const Json::exception& error) {
    throw InputError(sculpt.gltf->file.string(),
                     std::string("a value of the glTF has the wrong type (") + error.what() + "); export the file again");
  }
  return result;
}

}  // namespace cloudbake
