// Counts defects of a mesh, to decide whether it bounds a volume.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "core/types.h"

namespace cloudbake {

/// The same triangles over distinct positions, compared exactly (−0 = 0). Without this, meshes with vertices split at seams look open.
SurfaceMesh weldedByPosition(const SurfaceMesh& mesh);

/// Whether a triangle of a welded mesh has three different corners.
inline bool hasDistinctCorners(const Triangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; }

/// A side of a triangle, from its corner `corner` to the next one.
struct EdgeSide {
  uint32_t high;      ///< the end with the higher index
  uint32_t triangle;  ///< its index
  uint16_t corner;
  int16_t sense;  ///< +1: from the lower end to the higher one; −1: back
};

/// The treatment of triangles without three distinct corners.
enum class Degenerate { kLeftOut, kKept };

/// Calls body(low, sides) for every edge between vertices below `vertex_count`, in order of its lower and then its higher end. `sides` are
/// all that lie on it: one at a border, three and more where the triangles are not manifold. `body` may reorder them. A side between equal
/// corners is no edge.
void forEachEdge(size_t vertex_count, const std::vector<Triangle>& triangles, Degenerate degenerate,
                 const std::function<void(uint32_t low, std::span<EdgeSide> sides)>& body);

/// The triangles at each vertex, in their order.
struct VertexTriangles {
  std::vector<uint32_t> first;      ///< #V+1 offsets into triangles
  std::vector<uint32_t> triangles;  ///< indices, those of one vertex after the other
  std::span<const uint32_t> at(uint32_t vertex) const {
    return std::span(triangles).subspan(first[vertex], first[vertex + 1] - first[vertex]);
  }
};
VertexTriangles trianglesAtVertices(size_t vertex_count, std::span<const Triangle> triangles);

/// The number of occurrences of a defect, and the place of the first one.
struct Defect {
  uint64_t count = 0;
  uint32_t first = 0;  ///< index of a triangle (for unreferenced vertices, of a vertex)
  void meet(uint32_t where) {
    if (count++ == 0 || where < first) first = where;
  }
  void add(const Defect& other) {
    if (other.count > 0 && (count == 0 || other.first < first)) first = other.first;
    count += other.count;
  }
};

/// Angle-weighted normals of the surface welded by position, per vertex of the mesh. They agree on both sides of a seam or hard edge.
std::vector<Vec3> smoothNormals(const SurfaceMesh& mesh);

/// The defects of a mesh, counted after welding by position.
struct MeshDefects {
  uint64_t unmatched_edges = 0;  ///< Σ |n(a→b) − n(b→a)|; 0 if and only if the winding number is well defined everywhere
  Defect open_edges;             ///< edges of one triangle
  Defect turned_edges;           ///< edges of two triangles with opposite winding
  Defect non_manifold_edges;     ///< edges of more than two triangles
  Defect degenerate_triangles;   ///< two corners coincide, or all three are collinear
  Defect duplicate_triangles;    ///< the same three corners as an earlier triangle, whatever the winding
  Defect unreferenced_vertices;  ///< counted before welding
};
MeshDefects findDefects(const SurfaceMesh& mesh);

/// Adds the defects to the warnings, each with its first place. `place` names the place from the index of a triangle or a vertex.
using PlaceName = std::function<std::string(uint32_t index, bool is_vertex)>;
void reportDefects(const MeshDefects& defects, const PlaceName& place, Warnings& warnings);

/// Volume by the divergence theorem, Σ p0·(p1×p2)/6 about the box's centre, in world units³. Positive if triangles face outwards.
double signedVolume(const SurfaceMesh& mesh);

/// World units².
double surfaceArea(const SurfaceMesh& mesh);

/// World units; 0 without triangles.
double meanEdgeLength(const SurfaceMesh& mesh);

Box boundingBox(const SurfaceMesh& mesh);

}  // namespace cloudbake
