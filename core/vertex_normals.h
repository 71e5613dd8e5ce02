// Smooth normals of a triangle mesh.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace cloudbake {

/// Angle-weighted unit normals, #V; zero where a vertex has no triangle with an area.
std::vector<Vec3> vertexNormals(std::span<const Vec3> positions, std::span<const Triangle> triangles);

}  // namespace cloudbake
