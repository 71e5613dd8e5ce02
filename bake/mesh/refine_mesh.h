// Splits edges of a mesh in their middles. No point of the surface moves, and all triangles at an edge are split alike.
#pragma once

#include <array>
#include <functional>
#include <optional>

#include "core/types.h"

namespace cloudbake {

/// All sides of triangles between the same two positions: both sides of a seam, or three and more where the mesh is not manifold.
struct SplittableEdge {
  std::array<Vec3, 2> ends;  ///< in lexicographic order
  Vec3 middle;               ///< the new vertex; of an edge that cannot be split, about halfway
  double area = 0;           ///< of its triangles, world units²
  double square_length{};    ///< world units²
  bool can_split = true;
};

/// The edges of a mesh, in lexicographic order of their ends, so that their order does not depend on that of vertices and triangles.
struct EdgeTable {
  static constexpr uint32_t kNone = UINT32_MAX;
  std::vector<SplittableEdge> edges;
  std::vector<std::array<uint32_t, 3>> of_triangle;  ///< #F: the edge from corner i to the next; kNone if both are at one position
};

/// Where the vertex between two vertices of a triangle would lie; nothing if there must be none.
using MiddleOf = std::function<std::optional<Vec3>(uint32_t a, uint32_t b)>;

/// An edge cannot be split if one of its sides has no middle, if the middles of its sides are not equal to the bit (the mesh would come
/// apart), or if the middle is one of its ends.
EdgeTable edgesOf(const SurfaceMesh& mesh, const MiddleOf& middle_of);

/// Also marks the longest edge of every triangle that has a marked edge, until nothing changes. Repeated splits then keep the angles of
/// triangles above half of what they were (M. Rivara, "Algorithms for refining triangular grids", IJNME 1984).
void markLongest(const EdgeTable& table, std::vector<bool>& marked);

/// The number of vertices that splitting the marked edges adds: one for each side of a seam.
size_t verticesToAdd(const SurfaceMesh& mesh, const EdgeTable& table, const std::vector<bool>& marked);

/// Splits the marked edges. New vertices are appended, with normals if the mesh has any, as directionBetween has them. Triangles keep their
/// order, with the parts of a split one in its place. Returns the two vertices, the lower one first, that each new vertex lies between.
std::vector<std::array<uint32_t, 2>> splitEdges(SurfaceMesh& mesh, const EdgeTable& table, const std::vector<bool>& marked);

}  // namespace cloudbake
