// Measures how far a new surface lies from the one that it replaces.
#pragma once

#include <span>
#include <vector>

#include "core/figures.h"
#include "core/surface_points.h"
#include "core/types.h"

namespace cloudbake {

/// Exact distances of the new surface's vertices and triangle centres to the nearest triangle of the old surface, as fractions of the old
/// surface's longest side. The distances are one-way: a part of the old surface that the new one lacks is not noticed. The old surface must
/// have a triangle.
SurfaceError surfaceError(const SurfaceMesh& now, const SurfaceMesh& old);

/// The exactly nearest place on the mesh for each position. The mesh must have a triangle.
std::vector<SurfacePoint> nearestPoints(std::span<const Vec3> positions, const SurfaceMesh& mesh);

}  // namespace cloudbake
