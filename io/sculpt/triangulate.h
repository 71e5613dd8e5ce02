// Cuts the polygons of sculpts into triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// Appends the n−2 triangles of a polygon with n ≥ 3 corners, with the polygon's winding. A convex polygon becomes a fan
/// around its first corner; any other polygon is cut by ear clipping. Corners are indices into `positions` and must be valid.
/// Returns false if no ear was left (the polygon intersects itself); the rest is then a fan.
bool triangulatePolygon(std::span<const uint32_t> corners, std::span<const Vec3> positions, std::vector<Triangle>& triangles);

}  // namespace cloudbake
