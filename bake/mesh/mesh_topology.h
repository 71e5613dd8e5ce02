// Counts that tell whether a mesh bounds a volume.
#pragma once

#include <functional>
#include <string>

#include "core/types.h"

namespace cloudbake {

/// Same triangles over exactly distinct positions (−0 = 0): formats that split vertices at seams look open without this.
SurfaceMesh weldedByPosition(const SurfaceMesh& mesh);

/// Whether a triangle of a welded mesh has three corners at three places.
inline bool hasDistinctCorners(const Triangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; }

/// How often something is met, and where first.
struct Defect {
  uint64_t count = 0;
  uint32_t first = 0;  ///< index of a triangle (of a vertex for unreferenced ones)
  void meet(uint32_t where) {
    if (count++ == 0 || where < first) first = where;
  }
};

/// Angle-weighted normals of the surface welded by position, per vertex of the mesh: the same on both sides of a seam or hard edge.
std::vector<Vec3> smoothNormals(const SurfaceMesh& mesh);

/// What is odd about a mesh, counted after welding by position.
struct MeshDefects {
  uint64_t unmatched_edges = 0;  ///< Σ |n(a→b) − n(b→a)|: 0 if and only if the winding number is well defined everywhere
  Defect open_edges;             ///< edges of one triangle
  Defect turned_edges;           ///< edges of two triangles that are wound against each other
  Defect non_manifold_edges;     ///< edges of more than two triangles
  Defect degenerate_triangles;   ///< two corners at one place, or all three on a line
  Defect duplicate_triangles;    ///< the same three corners as an earlier triangle, whatever the winding
  Defect unreferenced_vertices;  ///< counted before welding
};
MeshDefects findDefects(const SurfaceMesh& mesh);

/// Counts them as warnings, each with its first place, which `place` names: by a triangle's index, or a vertex's.
using PlaceName = std::function<std::string(uint32_t index, bool is_vertex)>;
void reportDefects(const MeshDefects& defects, const PlaceName& place, Warnings& warnings);

/// Volume by the divergence theorem, Σ p0·(p1×p2)/6 about the box's centre; positive where triangles face outwards.
double signedVolume(const SurfaceMesh& mesh);

/// World units².
double surfaceArea(const SurfaceMesh& mesh);

/// World units; 0 without triangles.
double meanEdgeLength(const SurfaceMesh& mesh);

Box boundingBox(const SurfaceMesh& mesh);

}  // namespace cloudbake
