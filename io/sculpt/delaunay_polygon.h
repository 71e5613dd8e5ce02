// Cuts large polygons of the plane into triangles. Only for io/sculpt/triangulate.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace cloudbake {

/// Whether delaunayPolygon is built in (CLOUDBAKE_CGAL). Without it, delaunayPolygon must not be called.
bool hasDelaunayPolygon();

/// The triangles of a polygon's inside (winding number ≠ 0) as places in `points`; those of a part that is wound clockwise are clockwise
/// too. Of several points at one position the first one is used. Nothing if the polygon intersects itself, winds around a part of the plane
/// more than once, or has no inside. The same points give the same triangles in the same order.
std::optional<std::vector<std::array<size_t, 3>>> delaunayPolygon(std::span<const std::array<double, 2>> points);

}  // namespace cloudbake
