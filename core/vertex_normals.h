// Smooth normals of a triangle mesh.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// Angle-weighted unit normals, #V. The normal is zero for a vertex without a triangle of non-zero area.
std::vector<Vec3> vertexNormals(std::span<const Vec3> positions, std::span<const Triangle> triangles);

}  // namespace cloudbake
