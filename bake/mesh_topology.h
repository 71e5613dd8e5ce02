// Counts that tell whether a mesh bounds a volume.
#pragma once

#include "core/types.h"

namespace cloudbake {

/// Same triangles over exactly distinct positions (−0 = 0): formats that split vertices at seams look open without this.
SurfaceMesh weldedByPosition(const SurfaceMesh& mesh);

/// What is odd about a mesh, counted after welding by position.
struct MeshDefects {
  uint64_t unmatched_edges = 0;        ///< Σ |n(a→b) − n(b→a)|: 0 if and only if the winding number is well defined everywhere
  uint64_t non_manifold_edges = 0;     ///< edges with more than two triangles
  uint64_t degenerate_triangles = 0;   ///< two corners at one place
  uint64_t unreferenced_vertices = 0;  ///< counted before welding
};
MeshDefects findDefects(const SurfaceMesh& mesh);

/// Counts open and non-manifold edges as warnings (the readers of io/ count the other two).
void reportDefects(const MeshDefects& defects, Warnings& warnings);

/// Volume by the divergence theorem, Σ p0·(p1×p2)/6 about the box's centre; positive where triangles face outwards.
double signedVolume(const SurfaceMesh& mesh);

Box boundingBox(const SurfaceMesh& mesh);

}  // namespace cloudbake
