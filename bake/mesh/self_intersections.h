// Finds triangles that intersect or touch each other outside their shared corners and edges.
#pragma once

#include "bake/mesh/mesh_topology.h"

namespace cloudbake {

/// Counts pairs of triangles of a mesh, welded by position, that meet outside their common corners and edges. `first` is the lowest
/// triangle. Equal triangles and triangles without area do not count (findDefects counts them). Decisions are exact; the time is n log n
/// for usual meshes. Throws InputError if this binary was built without CGAL.
Defect findSelfIntersections(const SurfaceMesh& mesh);

}  // namespace cloudbake
