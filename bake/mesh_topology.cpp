// A closed oriented surface is one whose boundary is zero: every directed edge a→b is met by as many b→a. Then, and only
// then, the winding number of a point is the same along every ray (the discrete form of Stokes' theorem).
#include "bake/mesh_topology.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <unordered_map>

namespace cloudbake {

namespace {

struct PositionHash {
  size_t operator()(const Vec3& p) const {
    uint64_t hash = 0;
    for (const float f : {p.x, p.y, p.z}) hash = (hash ^ std::bit_cast<uint32_t>(f + 0.0F)) * 0x9E3779B97F4A7C15ULL;
    return hash ^ (hash >> 29);
  }
};

bool isDegenerate(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

}  // namespace

SurfaceMesh weldedByPosition(const SurfaceMesh& mesh) {
  SurfaceMesh welded;
  std::unordered_map<Vec3, uint32_t, PositionHash> index_of;
  std::vector<uint32_t> remap(mesh.positions.size());
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto [found, is_new] = index_of.try_emplace(mesh.positions[v], uint32_t(welded.positions.size()));
    if (is_new) welded.positions.push_back(mesh.positions[v]);
    remap[v] = found->second;
  }
  for (const Triangle& t : mesh.triangles) welded.triangles.push_back({remap[t[0]], remap[t[1]], remap[t[2]]});
  return welded;
}

MeshDefects findDefects(const SurfaceMesh& mesh) {
  MeshDefects defects;
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles)
    for (const uint32_t v : t) used[v] = true;
  defects.unreferenced_vertices = uint64_t(std::count(used.begin(), used.end(), false));

  // Each edge as low·2³²+high with its sense, sorted so that equal edges lie together.
  const SurfaceMesh welded = weldedByPosition(mesh);
  std::vector<std::pair<uint64_t, int>> edges;
  edges.reserve(3 * welded.triangles.size());
  for (const Triangle& t : welded.triangles) {
    if (isDegenerate(t)) {
      ++defects.degenerate_triangles;
      continue;
    }
    for (int i = 0; i < 3; ++i) {
      const uint32_t a = t[i], b = t[(i + 1) % 3];
      edges.emplace_back((uint64_t(std::min(a, b)) << 32) | std::max(a, b), a < b ? 1 : -1);
    }
  }
  std::sort(edges.begin(), edges.end());
  for (size_t first = 0; first < edges.size();) {
    size_t last = first;
    int balance = 0;
    for (; last < edges.size() && edges[last].first == edges[first].first; ++last) balance += edges[last].second;
    defects.unmatched_edges += uint64_t(std::abs(balance));
    defects.non_manifold_edges += last - first > 2;
    first = last;
  }
  return defects;
}

void reportDefects(const MeshDefects& defects, Warnings& warnings) {
  warnings.add(WarningKind::kOpenEdges, "an edge is open or wound against its neighbour: the mesh bounds no volume by itself",
               defects.unmatched_edges);
  warnings.add(WarningKind::kNonManifoldEdges, "an edge has more than two triangles", defects.non_manifold_edges);
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

Box boundingBox(const SurfaceMesh& mesh) {
  Box box;
  for (const Vec3& p : mesh.positions) box.add(p);
  return box;
}

}  // namespace cloudbake
