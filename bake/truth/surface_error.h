// Measures how far a new surface lies from the one that it replaces.
#pragma once

#include "core/figures.h"
#include "core/types.h"

namespace cloudbake {

/// Exact distances of the new surface's vertices and triangle centres to the nearest triangle of the old surface, as fractions of the old
/// surface's longest side. The distances are one-way: a part of the old surface that the new one lacks is not noticed. The old surface must
/// have a triangle.
SurfaceError surfaceError(const SurfaceMesh& now, const SurfaceMesh& old);

}  // namespace cloudbake
