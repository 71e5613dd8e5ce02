// Alpha wrapping: C. Portaneri, M. Rouxel-Labbé, M. Hemmer, D. Cohen-Steiner, P. Alliez, "Alpha Wrapping with an Offset",
// ACM TOG 41(4), 2022, as CGAL implements it: a Delaunay tetrahedralisation is carved from outside by balls of radius α; what
// they cannot reach is the solid. The surface lies `offset` outside of the input.
#include "bake/repair.h"

#include "core/error.h"

#ifdef CLOUDBAKE_CGAL
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include "bake/mesh_topology.h"
#endif

namespace cloudbake {

#ifdef CLOUDBAKE_CGAL

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using CgalMesh = CGAL::Surface_mesh<Point>;

constexpr double kOffsetOfAlpha = 1.0 / 30;  // CGAL's user manual: small against α, large enough to bound the mesh's size
constexpr double kHollowVolumeRatio = 0.6;

struct Soup {
  std::vector<Point> points;  // in a frame of the shape: centre 0, longest side 1
  std::vector<std::vector<size_t>> faces;
  Vec3 center;
  double size;
};

Soup toSoup(const SurfaceMesh& mesh) {
  const Box box = boundingBox(mesh);
  Soup soup{{}, {}, box.center(), box.longestSide()};
  for (const Vec3& p : mesh.positions)
    soup.points.emplace_back((double(p.x) - soup.center.x) / soup.size, (double(p.y) - soup.center.y) / soup.size,
                             (double(p.z) - soup.center.z) / soup.size);
  // CGAL leaves out triangles without area, and takes for granted that one is left.
  for (const Triangle& t : mesh.triangles)
    if (!CGAL::collinear(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]])) soup.faces.push_back({t[0], t[1], t[2]});
  return soup;
}

SurfaceMesh wrapOnce(const Soup& soup, double alpha) {
  CgalMesh wrapped;
  CGAL::alpha_wrap_3(soup.points, soup.faces, alpha / soup.size, alpha / soup.size * kOffsetOfAlpha, wrapped);
  SurfaceMesh mesh;
  for (const auto vertex : wrapped.vertices()) {
    const Point& p = wrapped.point(vertex);
    mesh.positions.push_back(
        {float(soup.center.x + soup.size * p.x()), float(soup.center.y + soup.size * p.y()), float(soup.center.z + soup.size * p.z())});
  }
  for (const auto face : wrapped.faces()) {
    Triangle triangle{};
    size_t corner = 0;
    for (const auto vertex : CGAL::vertices_around_face(wrapped.halfedge(face), wrapped)) triangle[corner++] = uint32_t(vertex);
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace

bool canWrap() { return true; }

Wrap wrapClosed(const SurfaceMesh& mesh, double detail) {
  const Soup soup = toSoup(mesh);
  if (soup.faces.empty() || !(soup.size > 0)) throw InputError("", "no triangle has an area: nothing to close, repair the mesh");
  Wrap best;
  for (double alpha = boundingBox(mesh).diagonal() / 2; best.mesh.triangles.empty() || alpha >= detail; alpha /= 2) {
    Wrap wrap{wrapOnce(soup, alpha), alpha, 0};
    wrap.volume = signedVolume(wrap.mesh);
    if (!best.mesh.triangles.empty() && wrap.volume < kHollowVolumeRatio * best.volume) break;
    best = std::move(wrap);
  }
  return best;
}

#else

bool canWrap() { return false; }

Wrap wrapClosed(const SurfaceMesh&, double) {
  throw InputError("", "the mesh is open, and this binary was built without CGAL (-DCLOUDBAKE_CGAL=OFF): close the holes");
}

#endif

}  // namespace cloudbake
