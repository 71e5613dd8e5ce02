// Meshes between our types and CGAL's. Only for bake/mesh/*.cpp that use CGAL.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <vector>

#include "bake/mesh/mesh_topology.h"
#include "core/types.h"

namespace cloudbake {

using CgalPoint = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using CgalMesh = CGAL::Surface_mesh<CgalPoint>;

/// A triangle soup in a frame of the shape: centre 0, longest side 1.
struct Soup {
  std::vector<CgalPoint> points;
  std::vector<std::vector<size_t>> faces;
  Vec3 center;
  double size;  ///< longest side, world units
};

/// The triangles that have an area: CGAL skips the others, and assumes that there is one.
inline Soup toSoup(const SurfaceMesh& mesh) {
  const Box box = boundingBox(mesh);
  Soup soup{{}, {}, box.center(), box.longestSide()};
  if (!(soup.size > 0)) return soup;
  for (const Vec3& p : mesh.positions)
    soup.points.emplace_back((double(p.x) - soup.center.x) / soup.size, (double(p.y) - soup.center.y) / soup.size,
                             (double(p.z) - soup.center.z) / soup.size);
  for (const Triangle& t : mesh.triangles)
    if (!CGAL::collinear(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]])) soup.faces.push_back({t[0], t[1], t[2]});
  return soup;
}

/// Back in the space of the shape.
inline SurfaceMesh fromCgal(const CgalMesh& from, const Soup& frame) {
  SurfaceMesh mesh;
  for (const auto vertex : from.vertices()) {
    const CgalPoint& p = from.point(vertex);
    mesh.positions.push_back({float(frame.center.x + frame.size * p.x()), float(frame.center.y + frame.size * p.y()),
                              float(frame.center.z + frame.size * p.z())});
  }
  for (const auto face : from.faces()) {
    Triangle triangle{};
    size_t corner = 0;
    for (const auto vertex : CGAL::vertices_around_face(from.halfedge(face), from)) triangle[corner++] = uint32_t(vertex);
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

/// The widest diagonal of a hole's box, world units; 0 without holes. In repair.cpp.
double widestHole(const SurfaceMesh& mesh);

}  // namespace cloudbake
