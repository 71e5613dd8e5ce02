// Leaves vertices out of a triangle mesh: its edges collapse, and the topology stays.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// A surface whose edges may collapse. A point is a position and, if N > 3, what is blended across the triangles, in units of length.
template <size_t N>
struct CollapseInput {
  std::vector<std::array<float, N>> points;  ///< x, y, z first; no two have the same position
  std::vector<Triangle> triangles;           ///< over the points, each with three distinct corners
  std::vector<Triangle> corners;             ///< the same triangles over the vertices of a mesh; empty if these are the points
  size_t vertex_count = 0;                   ///< with corners: how many vertices the mesh has
  std::vector<bool> held;                    ///< points that stay; or empty
  std::vector<Triangle> kept;                ///< over the vertices, between points that are held: these stay, and are only counted
  /// No point goes whose surroundings would move by more, as a mean over its planes.
  float most_distance = std::numeric_limits<float>::infinity();
};

/// Why points are left. Every point is counted once, for the first reason that applies to it.
struct CollapseObstacles {
  size_t fixed = 0;     ///< held, on a border, or where the triangles form no single fan
  size_t topology = 0;  ///< every collapse would close a handle, or remove or join parts of the surface
  size_t shape = 0;     ///< a collapse would fold the surface, tear a seam or move it too far
};

struct CollapsedSurface {
  std::vector<Triangle> triangles;  ///< over the vertices of the mesh, those that are kept first; without corners, over the points
  size_t used = 0;                  ///< vertices (without corners: points) that they use
  CollapseObstacles obstacles;      ///< what is left of points, unless the count was met
};

/// Collapses edges, those first that change least, until at most `counts[i]` vertices are used; without corners, exactly so many. Counts
/// descend; every surface continues from the one before. Points do not move. Where a count cannot be met, as few are left as possible.
///
/// An edge collapses only if its ends have no common neighbours but those of its two triangles (the link condition). So what two triangles
/// share, two triangles share afterwards, and borders, handles and parts stay. No triangle loses its area or folds over onto a neighbour,
/// unless it was so before. The result is the same for any number of threads.
template <size_t N>
std::vector<CollapsedSurface> collapseEdges(CollapseInput<N> input, std::span<const size_t> counts);

extern template std::vector<CollapsedSurface> collapseEdges<3>(CollapseInput<3> input, std::span<const size_t> counts);
extern template std::vector<CollapsedSurface> collapseEdges<6>(CollapseInput<6> input, std::span<const size_t> counts);

}  // namespace cloudbake
