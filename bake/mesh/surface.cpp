// Dual contouring by OpenVDB's volumeToMesh. Vertices are then moved onto φ = 0 by Newton steps x ← x − φ∇φ/|∇φ|².
#include "bake/mesh/surface.h"

#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <cmath>

#include "bake/mesh/mesh_topology.h"
#include "core/error.h"
#include "core/level_set_type.h"
#include "core/parallel.h"
#include "core/vertex_normals.h"

namespace cloudbake {

namespace {

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

}  // namespace cloudbake
