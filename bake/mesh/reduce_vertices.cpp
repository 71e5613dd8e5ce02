// Decimation by quadric error (M. Garland, P. Heckbert, SIGGRAPH 1997), as implemented in meshoptimizer: an edge collapses onto one of its
// ends, so the remaining vertices do not move.
#include <meshoptimizer.h>

#include <algorithm>
#include <iterator>
#include <limits>

#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/surface.h"

namespace cloudbake {

namespace {

constexpr int kPinchAttempts = 16;

void dropUnusedVertices(SurfaceMesh& mesh) {
  unsigned int* indices = mesh.triangles.front().data();
  const size_t count = 3 * mesh.triangles.size();
  std::vector<unsigned int> remap(mesh.positions.size());
  const size_t used = meshopt_optimizeVertexFetchRemap(remap.data(), indices, count, mesh.positions.size());
  meshopt_remapVertexBuffer(mesh.positions.data(), mesh.positions.data(), mesh.positions.size(), sizeof(Vec3), remap.data());
  meshopt_remapIndexBuffer(indices, indices, count, remap.data());
  mesh.positions.resize(used);
}

// Directed edges a→b, as a·2³²+b, that belong to more than one triangle, sorted. A manifold surface has none.
std::vector<uint64_t> repeatedEdges(size_t vertex_count, const std::vector<Triangle>& triangles) {
  std::vector<uint64_t> repeated;
  forEachEdge(vertex_count, triangles, Degenerate::kKept, [&](uint64_t low, std::span<EdgeSide> sides) {
    const uint64_t high = sides.front().high;
    const auto upwards = std::count_if(sides.begin(), sides.end(), [](const EdgeSide& side) { return side.sense > 0; });
    if (upwards > 1) repeated.push_back(low << 32 | high);
    if (ptrdiff_t(sides.size()) - upwards > 1) repeated.push_back(high << 32 | low);
  });
  std::sort(repeated.begin(), repeated.end());
  return repeated;
}

// Adds the neighbours of the held vertices to them.
void holdNeighbours(const std::vector<Triangle>& triangles, std::vector<bool>& held) {
  std::vector<uint32_t> neighbours;
  for (const Triangle& t : triangles)
    if (held[t[0]] || held[t[1]] || held[t[2]]) neighbours.insert(neighbours.end(), t.begin(), t.end());
  for (const uint32_t v : neighbours) held[v] = true;
}

// The triangles after the collapses. Triangles at held vertices stay unchanged. A collapse removes one vertex and two triangles.
std::vector<Triangle> collapsed(const SurfaceMesh& mesh, const std::vector<bool>& held, size_t target_count) {
  std::vector<Triangle> triangles = mesh.triangles;
  const auto stays = std::stable_partition(triangles.begin(), triangles.end(),
                                           [&](const Triangle& t) { return !held[t[0]] && !held[t[1]] && !held[t[2]]; });
  static_assert(sizeof(Triangle) == 3 * sizeof(unsigned int));
  unsigned int* indices = triangles.front().data();
  const size_t count = 3 * size_t(stays - triangles.begin()), over = 6 * (mesh.positions.size() - target_count);
  const size_t left =
      meshopt_simplify(indices, indices, count, &mesh.positions.front().x, mesh.positions.size(), sizeof(Vec3),
                       count - std::min(count, over), std::numeric_limits<float>::max(), meshopt_SimplifyLockBorder, nullptr);
  triangles.erase(triangles.begin() + ptrdiff_t(left / 3), stays);
  return triangles;
}

// The same, but without new repeated edges: the vertices of such edges and their neighbours are held, and all collapses are done again.
std::vector<Triangle> collapsedWithoutPinch(const SurfaceMesh& mesh, size_t target_count) {
  const std::vector<uint64_t> known = repeatedEdges(mesh.positions.size(), mesh.triangles);
  std::vector<bool> held(mesh.positions.size(), false);
  for (int attempt = 0; attempt < kPinchAttempts; ++attempt) {
    std::vector<Triangle> reduced = collapsed(mesh, held, target_count);
    const std::vector<uint64_t> repeated = repeatedEdges(mesh.positions.size(), reduced);
    std::vector<uint64_t> pinched;
    std::set_difference(repeated.begin(), repeated.end(), known.begin(), known.end(), std::back_inserter(pinched));
    if (pinched.empty()) return reduced;
    for (const uint64_t edge : pinched) held[edge >> 32] = held[uint32_t(edge)] = true;
    holdNeighbours(mesh.triangles, held);
  }
  return mesh.triangles;
}

}  // namespace

void reduceVertices(SurfaceMesh& mesh, size_t target_count, Warnings& warnings) {
  mesh.normals.clear();
  dropUnusedVertices(mesh);
  for (size_t before = SIZE_MAX; mesh.positions.size() > target_count && mesh.positions.size() < before;) {
    before = mesh.positions.size();
    mesh.triangles = collapsedWithoutPinch(mesh, std::max(target_count, before / 2));
    dropUnusedVertices(mesh);
  }
  if (mesh.positions.size() > target_count)
    warnings.add(WarningKind::kVertexBudget,
                 std::to_string(mesh.positions.size()) +
                     " vertices are left, because fewer would tear borders or change the topology: remesh the sculpt first");
}

}  // namespace cloudbake
