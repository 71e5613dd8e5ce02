// Dual contouring by OpenVDB's volumeToMesh, vertices then moved onto φ = 0 by Newton steps x ← x − φ∇φ/|∇φ|². Decimation by
// quadric error (M. Garland, P. Heckbert, SIGGRAPH 1997) as OpenMesh implements it.
#include "bake/surface.h"

#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/parallel_for.h>

#include <cmath>

// g++ 12 takes OpenMesh's empty handles for uninitialised ones.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#pragma GCC diagnostic pop

#include "bake/mesh_topology.h"
#include "core/error.h"
#include "core/level_set_type.h"
#include "core/vertex_normals.h"

namespace cloudbake {

namespace {

using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<>;

float squaredDistance(Vec3 a, Vec3 b) { return dot(a - b, a - b); }

// Two triangles along the shorter diagonal: flatter, and free of slivers where a quad is bent.
void appendQuad(const openvdb::Vec4I& q, const std::vector<Vec3>& positions, std::vector<Triangle>& triangles) {
  if (squaredDistance(positions[q[0]], positions[q[2]]) <= squaredDistance(positions[q[1]], positions[q[3]])) {
    triangles.push_back({q[0], q[2], q[1]});
    triangles.push_back({q[0], q[3], q[2]});
  } else {
    triangles.push_back({q[0], q[3], q[1]});
    triangles.push_back({q[1], q[3], q[2]});
  }
}

// Moves index positions onto φ = 0; a step is at most half a voxel, so that no vertex leaves its cell's neighbourhood.
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

HalfEdgeMesh toHalfEdges(const SurfaceMesh& mesh, const Box& box, Warnings& warnings) {
  HalfEdgeMesh half_edges;
  const Vec3 center = box.center();
  const float size = box.longestSide() > 0 ? box.longestSide() : 1;
  const auto local = [&](uint32_t v) {
    const Vec3 p = (mesh.positions[v] - center) / size;
    return HalfEdgeMesh::Point(p.x, p.y, p.z);
  };
  for (uint32_t v = 0; v < mesh.positions.size(); ++v) half_edges.add_vertex(local(v));
  uint64_t refused = 0;
  omerr().disable();
  for (const Triangle& t : mesh.triangles) {
    using Handle = HalfEdgeMesh::VertexHandle;
    if (half_edges.add_face(Handle(int(t[0])), Handle(int(t[1])), Handle(int(t[2]))).is_valid()) continue;
    ++refused;
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    half_edges.add_face(half_edges.add_vertex(local(t[0])), half_edges.add_vertex(local(t[1])), half_edges.add_vertex(local(t[2])));
  }
  omerr().enable();
  warnings.add(WarningKind::kFacesRefused, "a face is non-manifold: kept with vertices of its own", refused);
  return half_edges;
}

SurfaceMesh fromHalfEdges(const HalfEdgeMesh& half_edges, const Box& box) {
  SurfaceMesh mesh;
  const Vec3 center = box.center();
  const float size = box.longestSide() > 0 ? box.longestSide() : 1;
  std::vector<uint32_t> remap(half_edges.n_vertices());
  for (const auto vertex : half_edges.vertices()) {
    if (half_edges.is_isolated(vertex)) continue;
    remap[size_t(vertex.idx())] = uint32_t(mesh.positions.size());
    const auto& p = half_edges.point(vertex);
    mesh.positions.push_back(Vec3{p[0], p[1], p[2]} * size + center);
  }
  for (const auto face : half_edges.faces()) {
    Triangle triangle{};
    size_t corner = 0;
    for (const auto vertex : half_edges.fv_range(face)) triangle[corner++] = remap[size_t(vertex.idx())];
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace

SurfaceMesh meshFromLevelSet(const LevelSet& level_set, const SurfaceSettings& settings, Warnings& warnings) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*level_set.grid->vdb, points, quads, 0.0);
  if (quads.empty()) throw InputError("", "the level set has no surface: more --voxels");

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
  if (mesh.positions.size() <= target_count) return;
  const Box box = boundingBox(mesh);
  HalfEdgeMesh half_edges = toHalfEdges(mesh, box, warnings);
  half_edges.request_vertex_status();
  half_edges.request_edge_status();
  half_edges.request_halfedge_status();
  half_edges.request_face_status();
  half_edges.request_face_normals();
  half_edges.update_face_normals();
  for (const auto vertex : half_edges.vertices())
    if (half_edges.is_boundary(vertex)) half_edges.status(vertex).set_locked(true);

  OpenMesh::Decimater::DecimaterT<HalfEdgeMesh> decimater(half_edges);
  OpenMesh::Decimater::ModQuadricT<HalfEdgeMesh>::Handle quadric;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();
  decimater.initialize();
  decimater.decimate_to(target_count);
  half_edges.garbage_collection();
  mesh = fromHalfEdges(half_edges, box);
}

}  // namespace cloudbake
