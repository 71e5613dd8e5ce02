// Cuts the polygons of sculpts into triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// Appends the triangles of a polygon with n ≥ 3 corners, with the polygon's winding. Corners are indices into `positions` and must be
/// valid. A convex polygon becomes a fan around its first corner, and any other polygon of up to kMostCornersByEars corners is cut by ear
/// clipping: n − 2 triangles. A polygon of more corners gets a constrained Delaunay triangulation, in a time of about n log n: corners at
/// the same position count once, so there may be fewer triangles, and none of them is flat. Without CGAL (CLOUDBAKE_CGAL) ear clipping goes
/// up to kMostCornersWithoutCgal corners, and InputError is thrown beyond. Returns false if the polygon intersects itself; its rest is then
/// a fan.
bool triangulatePolygon(std::span<const uint32_t> corners, std::span<const Vec3> positions, std::vector<Triangle>& triangles);

constexpr size_t kMostCornersByEars = 256, kMostCornersWithoutCgal = 4096;

}  // namespace cloudbake
