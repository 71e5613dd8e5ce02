// Dual contouring by OpenVDB's volumeToMesh. Vertices are then moved onto φ = 0 by Newton steps x ← x − φ∇φ/|∇φ|². Decimation by
// quadric error (M. Garland, P. Heckbert, SIGGRAPH 1997), as implemented in meshoptimizer: an edge collapses onto one of its ends,
// so the remaining vertices do not move.
#include "bake/mesh/surface.h"

#include <meshoptimizer.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "bake/mesh/mesh_topology.h"
#include "core/error.h"
#include "core/level_set_type.h"
#include "core/vertex_normals.h"

namespace cloudbake {

namespace {

constexpr int kPinchAttempts = 16;

float squaredDistance(Vec3 a, Vec3 b) { return dot(a - b, a - b); }

// Splits a quad along its shorter diagonal, which is flatter and avoids slivers if the quad is bent.
void appendQuad(const openvdb::Vec4I& q, const std::vector<Vec3>& positions, std::vector<Triangle>& triangles) {
  if (squaredDistance(positions[q[0]], positions[q[2]]) <= squaredDistance(positions[q[1]], positions[q[3]])) {
    triangles.push_back({q[0], q[2], q[1]});
    triangles.push_back({q[0], q[3], q[2]});
  } else {
    triangles.push_back({q[0], q[3], q[1]});
    triangles.push_back({q[1], q[3], q[2]});
  }
}

// Moves index positions onto φ = 0. A step is at most half a voxel, so that no vertex leaves the neighbourhood of its cell.
void projectOntoSurface(std::vector<Vec3>& positions, const openvdb::FloatGrid& grid) {
  tbb::parallel_for(tbb::blocked_range<size_t>(0, positions.size()), [&](const tbb::blocked_range<size_t>& range) {
    auto accessor = grid.getConstAccessor();
    const auto phi = [&](Vec3 p) { return openvdb::tools::BoxSampler::sample(accessor, openvdb::Vec3d(p.x, p.y, p.z)); };
    for (size_t v = range.begin(); v < range.end(); ++v)
      for (int iteration = 0; iteration < 3; ++iteration) {
        const Vec3 p = positions[v];
        const float h = 0.25F;
        const Vec3 gradient{(phi(p + Vec3{h, 0, 0}) - phi(p - Vec3{h, 0, 0})) / (2 * h),
                            (phi(p + Vec3{0, h, 0}) - phi(p - Vec3{0, h, 0})) / (2 * h),
                            (phi(p + Vec3{0, 0, h}) - phi(p - Vec3{0, 0, h})) / (2 * h)};
        const float squared = dot(gradient, gradient);
        if (!(squared > 0.01F)) break;
        const Vec3 step = gradient * (-phi(p) / squared);
        const float norm = length(step);
        positions[v] = p + (norm > 0.5F ? step * (0.5F / norm) : step);
      }
  });
}

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
std::vector<uint64_t> repeatedEdges(const std::vector<Triangle>& triangles) {
  std::vector<uint64_t> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (size_t k = 0; k < 3; ++k) edges.push_back(uint64_t(t[k]) << 32 | t[(k + 1) % 3]);
  std::sort(edges.begin(), edges.end());
  std::vector<uint64_t> repeated;
  for (size_t e = 1; e < edges.size(); ++e)
    if (edges[e] == edges[e - 1] && (repeated.empty() || repeated.back() != edges[e])) repeated.push_back(edges[e]);
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
  const std::vector<uint64_t> known = repeatedEdges(mesh.triangles);
  std::vector<bool> held(mesh.positions.size(), false);
  for (int attempt = 0; attempt < kPinchAttempts; ++attempt) {
    std::vector<Triangle> reduced = collapsed(mesh, held, target_count);
    const std::vector<uint64_t> repeated = repeatedEdges(reduced);
    std::vector<uint64_t> pinched;
    std::set_difference(repeated.begin(), repeated.end(), known.begin(), known.end(), std::back_inserter(pinched));
    if (pinched.empty()) return reduced;
    for (const uint64_t edge : pinched) held[edge >> 32] = held[uint32_t(edge)] = true;
    holdNeighbours(mesh.triangles, held);
  }
  return mesh.triangles;
}

}  // namespace

SurfaceMesh meshFromLevelSet(const LevelSet& level_set, const SurfaceSettings& settings, Warnings& warnings) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*level_set.grid->vdb, points, quads, 0.0);
  if (quads.empty()) throw InputError("", "the level set has no surface: use more --voxels");

  SurfaceMesh mesh;
  for (const auto& p : points) mesh.positions.push_back({p.x(), p.y(), p.z()});
  projectOntoSurface(mesh.positions, *level_set.grid->vdb);
  for (const auto& q : quads) appendQuad(q, mesh.positions, mesh.triangles);
  if (signedVolume(mesh) < 0)
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);

  if (settings.vertices) reduceVertices(mesh, *settings.vertices, warnings);
  mesh.normals = vertexNormals(mesh.positions, mesh.triangles);
  for (Vec3& p : mesh.positions) p = level_set.frame.toWorld(p);
  return mesh;
}

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
