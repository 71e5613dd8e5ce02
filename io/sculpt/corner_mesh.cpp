#include "io/sculpt/corner_mesh.h"

#include <algorithm>
#include <map>

#include "io/sculpt/triangulate.h"

namespace cloudbake {

std::vector<PartFaces> facesOfParts(const CornerMesh& mesh) {
  std::vector<PartFaces> parts;
  std::map<std::pair<int, int>, size_t> known;
  size_t current = 0;
  for (size_t face = 0; face < mesh.faces.size(); ++face) {
    const auto [first, size, node, material] = mesh.faces[face];
    if (parts.empty() || parts[current].node != node || parts[current].material != material) {
      const auto [entry, added] = known.try_emplace({node, material}, parts.size());
      if (added) parts.push_back({node, material, {}});
      current = entry->second;
    }
    parts[current].faces.push_back(face);
  }
  return parts;
}

PartVertices splitCorners(const CornerMesh& mesh, const PartFaces& part, std::vector<uint32_t>& last_of) {
  PartVertices vertices;
  std::vector<uint32_t> before;  // of each distinct corner: the one before it of the same position
  const auto indexOf = [&](const Corner& corner) {
    uint32_t& last = last_of[size_t(corner[0])];
    for (uint32_t known = last; known != kNobody; known = before[known])
      if (vertices.distinct[known] == corner) return known;
    before.push_back(last);
    vertices.distinct.push_back(corner);
    return last = uint32_t(before.size() - 1);
  };
  for (const size_t face : part.faces)
    for (const Corner& corner : mesh.cornersOf(face)) vertices.corners.push_back(indexOf(corner));
  for (const Corner& corner : vertices.distinct) last_of[size_t(corner[0])] = kNobody;
  return vertices;
}

std::optional<PartVertices> keptVertices(const CornerMesh& mesh, const PartFaces& part, size_t positions, bool all) {
  constexpr Corner kUnused{-1, -1, -1};
  std::vector<Corner> corner_of(positions, kUnused);
  bool plain = true;
  for (const size_t face : part.faces)
    for (const Corner& corner : mesh.cornersOf(face)) {
      Corner& known = corner_of[size_t(corner[0])];
      if (known != kUnused && known != corner) return std::nullopt;
      known = corner;
      plain = plain && corner[1] < 0 && corner[2] < 0;
    }
  PartVertices vertices;
  std::vector<uint32_t> place(positions, kNobody);
  for (size_t i = 0; i < positions; ++i) {
    const bool used = corner_of[i] != kUnused;
    if (!used && !all) continue;
    if (!used && !plain) return std::nullopt;
    place[i] = uint32_t(vertices.distinct.size());
    vertices.distinct.push_back(used ? corner_of[i] : Corner{int(i), -1, -1});
  }
  for (const size_t face : part.faces)
    for (const Corner& corner : mesh.cornersOf(face)) vertices.corners.push_back(place[size_t(corner[0])]);
  return vertices;
}

void cutFaces(const std::filesystem::path& file, const CornerMesh& mesh, const PartFaces& faces, std::span<const uint32_t> corners,
              SculptPart& part, Warnings& warnings) {
  size_t first = 0;
  uint64_t crossed = 0;
  for (const size_t face : faces.faces) {
    const uint32_t size = mesh.faces[face].size;
    crossed += !triangulatePolygon(corners.subspan(first, size), part.positions, part.triangles);
    first += size;
  }
  warnings.add(WarningKind::kDegenerateTriangle, file.string() + ": polygons that intersect themselves were cut as a fan", crossed);
}

void countUnreferenced(const std::filesystem::path& file, const CornerMesh& mesh, size_t positions, Warnings& warnings) {
  std::vector<bool> used(positions);
  for (const Corner& corner : mesh.corners) used[size_t(corner[0])] = true;
  warnings.add(WarningKind::kUnreferencedVertex, file.string() + ": positions that no face uses were left out",
               uint64_t(std::count(used.begin(), used.end(), false)));
}

}  // namespace cloudbake
