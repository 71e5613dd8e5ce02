#include "io/gltf/sculpt/part_per_primitive.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "core/error.h"
#include "io/gltf/sculpt/edit_vertices.h"

namespace cloudbake {

namespace {

template <class Value>
std::vector<Value> pickedRows(const std::vector<Value>& values, const std::vector<uint32_t>& kept) {
  std::vector<Value> rows;
  if (values.empty()) return rows;
  rows.reserve(kept.size());
  for (const uint32_t v : kept) rows.push_back(values[v]);
  return rows;
}

// Makes the parts of the primitives that share one, and edits the document.
void splitPart(const SculptPart& part, const GltfPlace& place, size_t index, VertexEditor& editor, Sculpt& result,
               std::vector<GltfPlace>& places, std::vector<PartSource>& sources) {
  size_t first = 0;
  for (const GltfStretch& stretch : place.stretches) {
    const auto triangles = std::span(part.triangles).subspan(first, stretch.triangles);
    first += stretch.triangles;
    std::vector<uint32_t> kept = usedVertices(triangles);
    if (kept.empty()) kept = {0};  // glTF has no accessors without elements
    result.parts.push_back(partOf(part, kept, triangles));
    places.push_back({place.node, place.mesh, {stretch}});
    editor.replace(places.back().first(), kept, result.parts.back().triangles, part.positions.size());
    sources.push_back({index, std::move(kept)});
  }
}

Sculpt split(const Sculpt& sculpt, const std::vector<bool>& is_split, std::vector<PartSource>& sources) {
  GltfDocument document = *sculpt.gltf;
  const std::vector<int> meshes = separateMeshes(*sculpt.gltf, document.json);
  std::vector<GltfPlace> old_places = document.places, places;
  std::set<GltfPrimitive> edited;
  for (size_t i = 0; i < meshes.size(); ++i) {
    old_places[i].mesh = meshes[i];
    for (const GltfStretch& stretch : old_places[i].stretches)
      if (is_split[i]) edited.emplace(meshes[i], stretch.primitive);
  }
  VertexEditor editor(std::move(document), edited);
  Sculpt result{{}, nullptr, sculpt.frame_note};
  for (size_t i = 0; i < sculpt.parts.size(); ++i) {
    if (is_split[i]) {
      splitPart(sculpt.parts[i], old_places[i], i, editor, result, places, sources);
      continue;
    }
    result.parts.push_back(sculpt.parts[i]);
    places.push_back(old_places[i]);
    std::vector<uint32_t> all(sculpt.parts[i].positions.size());
    std::iota(all.begin(), all.end(), 0U);
    sources.push_back({i, std::move(all)});
  }
  GltfDocument edited_document = std::move(editor).result();
  edited_document.places = std::move(places);
  result.gltf = std::make_shared<GltfDocument>(std::move(edited_document));
  return result;
}

}  // namespace

std::vector<uint32_t> usedVertices(std::span<const Triangle> triangles) {
  std::vector<uint32_t> corners;
  corners.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) corners.insert(corners.end(), t.begin(), t.end());
  return distinctNumbers(std::move(corners));
}

SculptPart partOf(const SculptPart& part, const std::vector<uint32_t>& kept, std::span<const Triangle> triangles) {
  SculptPart own;
  own.name = part.name, own.to_scene = part.to_scene, own.object = part.object, own.repaired = part.repaired;
  own.node = part.node, own.material = part.material, own.fixed = part.fixed;
  own.positions = pickedRows(part.positions, kept);
  own.normals = pickedRows(part.normals, kept);
  own.uvs = pickedRows(part.uvs, kept);
  own.colors = pickedRows(part.colors, kept);
  for (const std::vector<Vec2>& uvs : part.more_uvs) own.more_uvs.push_back(pickedRows(uvs, kept));
  own.vertex_to_scene = pickedRows(part.vertex_to_scene, kept);
  own.triangles.assign(triangles.begin(), triangles.end());
  for (Triangle& t : own.triangles)
    for (uint32_t& v : t) v = uint32_t(std::lower_bound(kept.begin(), kept.end(), v) - kept.begin());
  return own;
}

std::optional<Sculpt> withPartPerPrimitive(const Sculpt& sculpt, const std::function<bool(size_t)>& is_split,
                                           std::vector<PartSource>* sources) {
  std::vector<bool> are_split(sculpt.parts.size());
  for (size_t i = 0; sculpt.gltf && i < are_split.size(); ++i) are_split[i] = sculpt.gltf->places[i].stretches.size() > 1 && is_split(i);
  if (std::find(are_split.begin(), are_split.end(), true) == are_split.end()) return std::nullopt;
  try {
    std::vector<PartSource> own_sources;
    Sculpt result = split(sculpt, are_split, own_sources);
    if (sources) *sources = std::move(own_sources);
    return result;
  } catch (const Json::exception& error) {
    throw InputError(sculpt.gltf->file.string(),
                     std::string("a value of the glTF has the wrong type (") + error.what() + "); export the file again");
  }
}

}  // namespace cloudbake
