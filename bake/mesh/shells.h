// Connected pieces of a mesh, and tests of which piece lies inside which.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// Triangles that are connected by shared vertices.
struct Shell {
  std::vector<uint32_t> triangles;  ///< indices, ascending
  Box box;
  double volume = 0;  ///< signed, world units³; for an open shell, the volume with a fan over its border
};

/// The shells of a mesh welded by position (weldedByPosition), in order of their first triangles.
std::vector<Shell> shellsOf(const SurfaceMesh& welded);

/// The winding number of a shell at a point: a whole number if the shell is closed, a fraction if it is open.
double windingNumber(const SurfaceMesh& welded, const Shell& shell, Vec3 point);

/// For every shell, whether its first corner lies inside another one, whichever way that is wound. A shell of fewer than four triangles
/// encloses nothing.
std::vector<bool> innerShells(const SurfaceMesh& welded, const std::vector<Shell>& shells);

}  // namespace cloudbake
