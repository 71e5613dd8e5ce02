// Smooth normals of a triangle mesh.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// Angle-weighted unit normals, #V; weighted by area where these cancel, as at the tip of a flat fold. The normal is zero for a vertex
/// without a triangle of non-zero area, and where areas cancel too, as on two sides of a sheet.
std::vector<Vec3> vertexNormals(std::span<const Vec3> positions, std::span<const Triangle> triangles);

}  // namespace cloudbake
