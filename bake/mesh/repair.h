// What CGAL does: a closed surface around an open or non-manifold mesh, to build a volume from; and, on request only, triangles turned
// the right way, holes filled, or a new mesh of even triangles.
#pragma once

#include <optional>
#include <span>

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

/// The mesh with its triangles turned to agree and its holes filled, where that closes it: the volume that an open sculpt most likely
/// means. The first triangles are the mesh's own, without those of no area and those that repeat an earlier one. Nothing where holes are
/// left, or this binary was built without CGAL. `filled_holes` counts.
std::optional<SurfaceMesh> closedByFilling(const SurfaceMesh& mesh, uint64_t& filled_holes);

/// Wraps a triangle soup by an alpha wrap (GPL-3 code of CGAL, see NOTICE). α falls from half the box's diagonal by halves, to `detail`
/// (world units: the finest worth having, e.g. four voxels), but stays above what passes the widest hole. Where a volume drops under 0.6 of
/// the coarser wrap's and is no more than that of a shell around the triangles, balls of radius α have entered elsewhere and hollowed it
/// out: the coarser is kept. Throws InputError: no CGAL, or nothing to wrap.
Wrap wrapClosed(const SurfaceMesh& mesh, double detail);

/// The same surface in triangles whose edges are about `edge_length` (world units) long, welded, without normals. Border vertices stay, and
/// long border edges are cut; creases between faces may be cut across by up to an edge. Throws InputError: no CGAL, edges of more than two
/// triangles, triangles wound against each other, surfaces that touch in a point, too many or too few triangles to come.
SurfaceMesh remeshed(const SurfaceMesh& mesh, double edge_length);

/// What is to be changed of a sculpt.
struct RepairSettings {
  bool orient = false;  ///< turn triangles to agree with their neighbours, and shells outwards
  bool fill = false;    ///< close holes by triangles between the vertices that are there
};

/// Changes what is asked for and nothing else: vertices keep their number and order, triangles theirs; new ones come last.
/// orient: neighbours across edges of two triangles agree, and each shell is wound outwards; a shell that was wound inwards throughout
/// and lies inside another stays so: it is a cavity. fill: a hole is a closed loop of open edges; its triangles join vertices of one part.
/// `part_of_vertex` (#V, or empty for one part) says which vertices a triangle may join. Turned triangles are marked in `turned` (#F).
/// Counted: kHoleNotFilled. Throws InputError: no CGAL.
RepairSummary repairMesh(SurfaceMesh& mesh, std::span<const uint32_t> part_of_vertex, const RepairSettings& settings,
                         std::vector<bool>& turned, Warnings& warnings);

}  // namespace cloudbake
