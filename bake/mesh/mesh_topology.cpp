// A closed oriented surface is one whose boundary is zero: there are as many directed edges a→b as b→a. Then, and only then, the winding
// number of a point is the same along every ray (the discrete form of Stokes' theorem).
#include "bake/mesh/mesh_topology.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <tuple>

#include "core/distinct_positions.h"
#include "core/vertex_normals.h"

namespace cloudbake {

namespace {

// (b−a)×(c−a) = 0 in doubles, which represent the differences of floats exactly and their products nearly exactly.
bool isOnLine(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ux = double(b.x) - a.x, uy = double(b.y) - a.y, uz = double(b.z) - a.z;
  const double vx = double(c.x) - a.x, vy = double(c.y) - a.y, vz = double(c.z) - a.z;
  return uy * vz == uz * vy && uz * vx == ux * vz && ux * vy == uy * vx;
}

// Counts duplicate triangles. They share all their sides, so they are counted only at the side of their two lowest corners. All `sides`
// have the same ends.
void findDuplicates(std::span<const EdgeSide> sides, const SurfaceMesh& mesh, Defect& duplicates) {
  if (sides.size() < 2) return;
  std::vector<std::pair<uint32_t, uint32_t>> opposite;  // corner, triangle
  for (const EdgeSide& side : sides) {
    const uint32_t corner = mesh.triangles[side.triangle][(side.corner + 2) % 3];
    if (corner > side.high) opposite.emplace_back(corner, side.triangle);
  }
  std::sort(opposite.begin(), opposite.end());
  for (size_t i = 1; i < opposite.size(); ++i)
    if (opposite[i].first == opposite[i - 1].first) duplicates.meet(opposite[i].second);
}

// The mesh over distinct positions, and the new index of each original vertex.
SurfaceMesh welded(const SurfaceMesh& mesh, std::vector<uint32_t>& remap) {
  DistinctPositions distinct(mesh.positions.size());
  remap.clear();
  for (const Vec3& p : mesh.positions) remap.push_back(distinct.add(p));
  SurfaceMesh result;
  result.positions = std::move(distinct.positions);
  for (const Triangle& t : mesh.triangles) result.triangles.push_back({remap[t[0]], remap[t[1]], remap[t[2]]});
  return result;
}

}  // namespace

SurfaceMesh weldedByPosition(const SurfaceMesh& mesh) {
  std::vector<uint32_t> remap;
  return welded(mesh, remap);
}

std::vector<Vec3> smoothNormals(const SurfaceMesh& mesh) {
  std::vector<uint32_t> remap;
  const SurfaceMesh one = welded(mesh, remap);
  const std::vector<Vec3> normals = vertexNormals(one.positions, one.triangles);
  std::vector<Vec3> result;
  for (const uint32_t v : remap) result.push_back(normals[v]);
  return result;
}

void forEachEdge(size_t vertex_count, const std::vector<Triangle>& triangles, Degenerate degenerate,
                 const std::function<void(uint32_t, std::span<EdgeSide>)>& body) {
  const auto for_each_side = [&](const auto& visit) {
    for (uint32_t f = 0; f < triangles.size(); ++f) {
      const Triangle& t = triangles[f];
      if (degenerate == Degenerate::kLeftOut && !hasDistinctCorners(t)) continue;
      for (uint16_t i = 0; i < 3; ++i) {
        const uint32_t a = t[i], b = t[(i + 1) % 3];
        if (a != b) visit(std::min(a, b), EdgeSide{std::max(a, b), f, i, int16_t(a < b ? 1 : -1)});
      }
    }
  };
  // A counting sort: the sides of vertex v are sides[first[v]] to sides[first[v + 1]]. The sum makes first[v + 1] the place of the first
  // side of v; it moves on with every side that is placed, and ends as the place of the first side of v + 1.
  std::vector<uint32_t> first(vertex_count + 2, 0);
  for_each_side([&](uint32_t low, const EdgeSide&) { ++first[low + 2]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<EdgeSide> sides(first.back());
  for_each_side([&](uint32_t low, const EdgeSide& side) { sides[first[low + 1]++] = side; });
  for (uint32_t v = 0; v < vertex_count; ++v) {
    const auto last = sides.begin() + first[v + 1];
    std::sort(sides.begin() + first[v], last, [](const EdgeSide& a, const EdgeSide& b) {
      return std::tie(a.high, a.triangle, a.corner) < std::tie(b.high, b.triangle, b.corner);
    });
    for (auto begin = sides.begin() + first[v], end = begin; begin != last; begin = end) {
      end = std::find_if(begin, last, [&](const EdgeSide& side) { return side.high != begin->high; });
      body(v, {&*begin, size_t(end - begin)});
    }
  }
}

VertexTriangles trianglesAtVertices(size_t vertex_count, std::span<const Triangle> triangles) {
  // A counting sort as above.
  VertexTriangles result{std::vector<uint32_t>(vertex_count + 2, 0), std::vector<uint32_t>(3 * triangles.size())};
  for (const Triangle& t : triangles)
    for (const uint32_t v : t) ++result.first[v + 2];
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  for (uint32_t f = 0; f < triangles.size(); ++f)
    for (const uint32_t v : triangles[f]) result.triangles[result.first[v + 1]++] = f;
  result.first.pop_back();
  return result;
}

MeshDefects findDefects(const SurfaceMesh& mesh) {
  MeshDefects defects;
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles)
    for (const uint32_t v : t) used[v] = true;
  for (size_t v = 0; v < used.size(); ++v)
    if (!used[v]) defects.unreferenced_vertices.meet(uint32_t(v));

  const SurfaceMesh one = weldedByPosition(mesh);
  for (uint32_t f = 0; f < one.triangles.size(); ++f) {
    const Triangle& t = one.triangles[f];
    if (!hasDistinctCorners(t) || isOnLine(one.positions[t[0]], one.positions[t[1]], one.positions[t[2]]))
      defects.degenerate_triangles.meet(f);
  }
  forEachEdge(one.positions.size(), one.triangles, Degenerate::kLeftOut, [&](uint32_t, std::span<EdgeSide> sides) {
    int balance = 0;
    uint32_t triangle = UINT32_MAX;
    for (const EdgeSide& side : sides) balance += side.sense, triangle = std::min(triangle, side.triangle);
    defects.unmatched_edges += uint64_t(std::abs(balance));
    if (sides.size() == 1) defects.open_edges.meet(triangle);
    if (sides.size() == 2 && balance != 0) defects.turned_edges.meet(triangle);
    if (sides.size() > 2) defects.non_manifold_edges.meet(triangle);
    findDuplicates(sides, one, defects.duplicate_triangles);
  });
  return defects;
}

void reportDefects(const MeshDefects& defects, const PlaceName& place, Warnings& warnings) {
  const auto tell = [&](WarningKind kind, const char* what, const Defect& defect, bool is_vertex = false) {
    if (defect.count > 0) warnings.add(kind, what + (", first at " + place(defect.first, is_vertex)), defect.count);
  };
  tell(WarningKind::kOpenEdges, "an edge is open: the mesh does not bound a volume", defects.open_edges);
  tell(WarningKind::kTurnedTriangles, "neighbouring triangles have opposite winding", defects.turned_edges);
  tell(WarningKind::kNonManifoldEdges, "an edge has more than two triangles", defects.non_manifold_edges);
  tell(WarningKind::kDegenerateTriangle, "a triangle has no area", defects.degenerate_triangles);
  tell(WarningKind::kDuplicateTriangle, "a triangle appears twice", defects.duplicate_triangles);
  tell(WarningKind::kUnreferencedVertex, "a vertex belongs to no triangle", defects.unreferenced_vertices, true);
}

double signedVolume(const SurfaceMesh& mesh) {
  const Vec3 c = boundingBox(mesh).center();
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    double p[3][3];
    for (int i = 0; i < 3; ++i) {
      const Vec3 q = mesh.positions[t[i]];
      p[i][0] = double(q.x) - c.x, p[i][1] = double(q.y) - c.y, p[i][2] = double(q.z) - c.z;
    }
    sum += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) + p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
           p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
  }
  return sum / 6;
}

double surfaceArea(const SurfaceMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const double ux = double(b.x) - a.x, uy = double(b.y) - a.y, uz = double(b.z) - a.z;
    const double vx = double(c.x) - a.x, vy = double(c.y) - a.y, vz = double(c.z) - a.z;
    const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    sum += 0.5 * std::sqrt(nx * nx + ny * ny + nz * nz);
  }
  return sum;
}

double meanEdgeLength(const SurfaceMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) sum += length(mesh.positions[t[i]] - mesh.positions[t[(i + 1) % 3]]);
  return sum / (3 * std::max<double>(1, double(mesh.triangles.size())));
}

Box boundingBox(const SurfaceMesh& mesh) {
  Box box;
  for (const Vec3& p : mesh.positions) box.add(p);
  return box;
}

}  // namespace cloudbake
