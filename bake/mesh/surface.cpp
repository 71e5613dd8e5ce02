// Dual contouring by OpenVDB's volumeToMesh: a vertex per cell and sheet of the surface in it, at the mean of where the surface crosses the
// cell's edges. Its triangles share every edge with one other, also in ambiguous cells. Vertices are then moved onto φ = 0 by Newton steps
// x ← x − φ∇φ/|∇φ|², except where that would fold the surface.
#include "bake/mesh/surface.h"

#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "bake/mesh/mesh_topology.h"
#include "core/error.h"
#include "core/level_set_type.h"
#include "core/parallel.h"
#include "core/vertex_normals.h"

namespace cloudbake {

namespace {

constexpr float kLeastDistance_voxels = 0.1F;
constexpr double kLeastFold = -0.8;     // cosine between the normals of neighbours
constexpr double kLeastQuality = 0.02;  // twice a triangle's area per squared longest side
constexpr int kMostCorrections = 10;

// The field in which the surface is found: a vertex must not lie nearly on the lattice, because the triangles of many cells around a point
// of the lattice would have no area then. Where vertices belong is asked of the field itself.
openvdb::FloatGrid::Ptr keptFromLattice(const openvdb::FloatGrid& grid) {
  openvdb::FloatGrid::Ptr result = grid.deepCopy();
  std::vector<openvdb::FloatTree::LeafNodeType*> leaves;
  result->tree().getNodes(leaves);
  parallelFor(leaves.size(), [&](size_t l) {
    for (auto value = leaves[l]->beginValueAll(); value; ++value)
      value.setValue(std::copysign(std::clamp(std::fabs(*value), kLeastDistance_voxels, 1.0F), *value < 0 ? -1.0F : 1.0F));
  });
  return result;
}

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
  parallelBlocks(positions.size(), 1, [&](size_t begin, size_t end) {
    auto accessor = grid.getConstAccessor();
    const auto phi = [&](Vec3 p) { return openvdb::tools::BoxSampler::sample(accessor, openvdb::Vec3d(p.x, p.y, p.z)); };
    for (size_t v = begin; v < end; ++v)
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

using Vec3d = std::array<double, 3>;
double dotOf(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// The normal of a triangle, of unit length; zero if it is nearly a line.
Vec3d normalOf(const std::vector<Vec3>& positions, const Triangle& t) {
  const auto between = [&](size_t i, size_t j) {
    const Vec3 p = positions[t[i]], q = positions[t[j]];
    return Vec3d{double(q.x) - p.x, double(q.y) - p.y, double(q.z) - p.z};
  };
  const Vec3d a = between(0, 1), b = between(1, 2), c = between(2, 0);
  Vec3d n{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  const double twice_area = std::sqrt(dotOf(n, n));
  if (!(twice_area > kLeastQuality * std::max({dotOf(a, a), dotOf(b, b), dotOf(c, c)}))) return {};
  for (double& x : n) x /= twice_area;
  return n;
}

// Whether two neighbours at the vertex face each other, or one is nearly a line.
bool isFolded(uint32_t v, const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles, const VertexTriangles& star) {
  const auto faces = star.at(v);
  const auto normal = [&](uint32_t f) { return normalOf(positions, triangles[f]); };
  const auto corner = [&](uint32_t f) { return triangles[f][0] == v ? 0U : triangles[f][1] == v ? 1U : 2U; };
  return std::any_of(faces.begin(), faces.end(), [&](uint32_t f) {
    const Vec3d n = normal(f);
    if (dotOf(n, n) == 0) return true;
    const uint32_t next = triangles[f][(corner(f) + 1) % 3];
    return std::any_of(faces.begin(), faces.end(),
                       [&](uint32_t g) { return triangles[g][(corner(g) + 2) % 3] == next && dotOf(n, normal(g)) < kLeastFold; });
  });
}

// Takes vertices back to where they were, `from`, where they were moved past their neighbours, as it happens in crevices that are finer
// than the lattice.
void takeBackFolds(std::vector<Vec3>& positions, const std::vector<Vec3>& from, const std::vector<Triangle>& triangles) {
  const VertexTriangles star = trianglesAtVertices(positions.size(), triangles);
  std::vector<uint32_t> doubtful(positions.size());
  std::iota(doubtful.begin(), doubtful.end(), 0U);
  std::vector<uint8_t> folded(positions.size(), 0);
  const auto withNeighbours = [&](const std::vector<uint32_t>& vertices) {
    std::vector<uint32_t> result;
    for (const uint32_t v : vertices)
      for (const uint32_t f : star.at(v)) result.insert(result.end(), triangles[f].begin(), triangles[f].end());
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  };
  for (int correction = 0; correction < kMostCorrections && !doubtful.empty(); ++correction) {
    parallelBlocks(doubtful.size(), 256, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) folded[doubtful[i]] = isFolded(doubtful[i], positions, triangles, star);
    });
    std::erase_if(doubtful, [&](uint32_t v) { return !folded[v]; });
    doubtful = withNeighbours(doubtful);
    for (const uint32_t v : doubtful) positions[v] = correction == 0 ? 0.5F * (from[v] + positions[v]) : from[v];
    doubtful = withNeighbours(doubtful);
  }
}

}  // namespace

SurfaceMesh meshFromLevelSet(const LevelSet& level_set, const SurfaceSettings& settings, Warnings& warnings) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*keptFromLattice(*level_set.grid->vdb), points, quads, 0.0);
  if (quads.empty()) throw InputError("", "the level set has no surface: use more --voxels");

  SurfaceMesh mesh;
  for (const auto& p : points) mesh.positions.push_back({p.x(), p.y(), p.z()});
  const std::vector<Vec3> in_cells = mesh.positions;
  projectOntoSurface(mesh.positions, *level_set.grid->vdb);
  for (const auto& q : quads) appendQuad(q, mesh.positions, mesh.triangles);
  if (signedVolume(mesh) < 0)
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  takeBackFolds(mesh.positions, in_cells, mesh.triangles);

  if (settings.vertices) reduceVertices(mesh, *settings.vertices, warnings);
  mesh.normals = vertexNormals(mesh.positions, mesh.triangles);
  for (Vec3& p : mesh.positions) p = level_set.frame.toWorld(p);
  return mesh;
}

}  // namespace cloudbake
