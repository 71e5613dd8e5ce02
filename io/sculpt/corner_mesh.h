// Faces whose corners have indices of their own into positions, UVs and other attributes, as in OBJ and PLY, and the vertices that the
// parts of a sculpt make of them. Only for io/sculpt/*.cpp.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "core/sculpt.h"

namespace cloudbake {

/// Indices of a corner: into the positions, into the UVs, and into one more attribute of the format; −1 if it has none.
using Corner = std::array<int, 3>;

/// A face with at least three corners.
struct CornerFace {
  size_t first = 0;   ///< its corners are CornerMesh::corners[first …]
  uint32_t size = 0;  ///< their number
  int node = 0;
  int material = -1;
};

struct CornerMesh {
  std::vector<Corner> corners{};  ///< of all faces, one face after the other
  std::vector<CornerFace> faces{};

  std::span<const Corner> cornersOf(size_t face) const { return std::span(corners).subspan(faces[face].first, faces[face].size); }
};

/// The faces of one node and one material.
struct PartFaces {
  int node, material;
  std::vector<size_t> faces;
};

/// The parts in order of first use.
std::vector<PartFaces> facesOfParts(const CornerMesh& mesh);

/// The vertices of a part: distinct corners of the file, and the corners of the part's faces as places in them.
struct PartVertices {
  std::vector<Corner> distinct;
  std::vector<uint32_t> corners;
};

inline constexpr uint32_t kNobody = UINT32_MAX;

/// One vertex per distinct corner, in order of first use. `last_of` is kNobody for every position before and after.
PartVertices splitCorners(const CornerMesh& mesh, const PartFaces& part, std::vector<uint32_t>& last_of);

/// The file's own vertices in their order: those that the part uses, or `all` of the `positions`. Nothing if a position has two different
/// corners, or if a kept one has no corner while others have more than a position.
std::optional<PartVertices> keptVertices(const CornerMesh& mesh, const PartFaces& part, size_t positions, bool all);

/// Cuts the faces of a part into triangles of `corners`, which are places in part.positions. Counts polygons that intersect themselves.
void cutFaces(const std::filesystem::path& file, const CornerMesh& mesh, const PartFaces& faces, std::span<const uint32_t> corners,
              SculptPart& part, Warnings& warnings);

/// Counts the positions that no corner uses.
void countUnreferenced(const std::filesystem::path& file, const CornerMesh& mesh, size_t positions, Warnings& warnings);

}  // namespace cloudbake
