// What CGAL does: a closed surface around an open or non-manifold mesh, to build a volume from; and new, even triangles on request.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// A closed, outward surface and the size of the ball that could not pass through the mesh's holes.
struct Wrap {
  SurfaceMesh mesh;
  double alpha = 0;   ///< world units: holes narrower than this are closed
  double volume = 0;  ///< world units³
};

/// Whether this binary was built with CGAL (-DCLOUDBAKE_CGAL=ON), without which the functions below throw.
bool hasCgal();

/// Wraps a triangle soup by an alpha wrap (GPL-3 code of CGAL, see NOTICE). α falls from half the box's diagonal by halves while the volume
/// holds; where it drops under 0.6 of the coarser wrap's, balls of radius α have entered through a hole and hollowed it out, so the coarser
/// is kept. `detail` (world units) is the finest α worth having, e.g. four voxels. Throws InputError: no CGAL, or nothing to wrap.
Wrap wrapClosed(const SurfaceMesh& mesh, double detail);

/// The same surface in triangles whose edges are about `edge_length` (world units) long, welded, without normals. Border vertices stay, and
/// long border edges are cut; creases between faces may be cut across by up to an edge. Throws InputError: no CGAL, edges of more than two
/// triangles, triangles wound against each other, surfaces that touch in a point, too many or too few triangles to come.
SurfaceMesh remeshed(const SurfaceMesh& mesh, double edge_length);

}  // namespace cloudbake
