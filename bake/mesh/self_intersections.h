// Triangles that cut or touch each other away from what they share.
#pragma once

#include "bake/mesh/mesh_topology.h"

namespace cloudbake {

/// Pairs of triangles of a mesh, welded by position, that meet elsewhere than in their common corners and edges; `first` is the lowest
/// triangle. Equal triangles and those without area are no pairs (findDefects counts them). Exact decisions; n log n for everyday meshes.
/// Throws InputError where this binary was built without CGAL.
Defect findSelfIntersections(const SurfaceMesh& mesh);

}  // namespace cloudbake
