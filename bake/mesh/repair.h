// Functions that use CGAL. They make a closed surface around an open or non-manifold mesh, to build a volume from. Only on request they
// turn triangles the right way, fill holes, or make a new mesh of even triangles.
#pragma once

#include <optional>
#include <span>

#include "core/types.h"

namespace cloudbake {

/// A closed surface that faces outwards, and the size of the ball that could not pass through the mesh's holes.
struct Wrap {
  SurfaceMesh mesh;
  double alpha = 0;   ///< world units; holes narrower than this are closed
  double volume = 0;  ///< world units³
};

/// Whether this binary was built with CGAL (-DCLOUDBAKE_CGAL=ON). Without CGAL the functions below throw, except closedByFilling.
bool hasCgal();

/// The mesh with its triangles turned to agree and its holes filled: most likely the volume that an open sculpt represents. The first
/// triangles are the mesh's own, without those that have two equal corners or repeat an earlier one. Returns nothing if holes remain or if
/// this binary was built without CGAL. `filled_holes` receives the number of filled holes.
std::optional<SurfaceMesh> closedByFilling(const SurfaceMesh& mesh, uint64_t& filled_holes);

/// Wraps a triangle soup by an alpha wrap (GPL-3 code of CGAL, see NOTICE). α starts at half the box's diagonal and is halved down to
/// `detail` (world units; the finest useful size, e.g. four voxels), but it stays too large to enter the widest hole. If the volume drops
/// below 0.6 of the coarser wrap's and is about that of a shell around the triangles, balls of radius α have entered elsewhere and hollowed
/// the wrap out; then the coarser wrap is kept. Throws InputError without CGAL or if there is nothing to wrap.
Wrap wrapClosed(const SurfaceMesh& mesh, double detail);

/// The same surface in triangles whose edges are about `edge_length` (world units) long, welded, without normals. Border vertices stay, and
/// long border edges are split. New triangles may cut across creases by up to an edge. Throws InputError without CGAL, for edges of more
/// than two triangles, triangles with opposite winding, surfaces that touch in a point, and if the result would have too many or too few
/// triangles.
SurfaceMesh remeshed(const SurfaceMesh& mesh, double edge_length);

/// The repairs of a sculpt.
struct RepairSettings {
  bool orient = false;  ///< turn triangles to agree with their neighbours, and shells to face outwards
  bool fill = false;    ///< close holes with triangles between existing vertices
};

/// Makes only the requested repairs. Vertices and triangles keep their number and order; new triangles are appended.
/// orient: neighbours across edges of two triangles agree, and each shell faces outwards. A shell that faced inwards consistently and lies
/// inside another is a cavity and stays as it is. fill: a hole is a closed loop of open edges; its triangles join vertices of one part.
/// `part_of_vertex` (#V, or empty for one part) says which vertices a triangle may join. Turned triangles are marked in `turned` (#F).
/// Counts kHoleNotFilled. Throws InputError without CGAL.
RepairSummary repairMesh(SurfaceMesh& mesh, std::span<const uint32_t> part_of_vertex, const RepairSettings& settings,
                         std::vector<bool>& turned, Warnings& warnings);

}  // namespace cloudbake
