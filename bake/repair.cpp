// Alpha wrapping: C. Portaneri, M. Rouxel-Labbé, M. Hemmer, D. Cohen-Steiner, P. Alliez, "Alpha Wrapping with an Offset",
// ACM TOG 41(4), 2022, as CGAL implements it: a Delaunay tetrahedralisation is carved from outside by balls of radius α; what
// they cannot reach is the solid. The surface lies `offset` outside of the input.
// Remeshing: M. Botsch, L. Kobbelt, "A Remeshing Approach to Multiresolution Modeling", SGP 2004, as CGAL implements it: long edges are
// split, short ones collapsed, valences evened by flips, vertices moved in their tangent plane and projected back to the input.
#include "bake/repair.h"

#include <cmath>
#include <cstdio>
#include <string>

#include "core/error.h"

#ifdef CLOUDBAKE_CGAL
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/repair.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include "bake/mesh_topology.h"
#endif

namespace cloudbake {

#ifdef CLOUDBAKE_CGAL

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using CgalMesh = CGAL::Surface_mesh<Point>;

constexpr double kOffsetOfAlpha = 1.0 / 30;  // CGAL's user manual: small against α, large enough to bound the mesh's size
constexpr double kHollowVolumeRatio = 0.6;
constexpr unsigned kRemeshIterations = 5;
constexpr double kMostTriangles = 2e7, kFewestTriangles = 20;

struct Soup {
  std::vector<Point> points;  // in a frame of the shape: centre 0, longest side 1
  std::vector<std::vector<size_t>> faces;
  Vec3 center;
  double size;
};

Soup toSoup(const SurfaceMesh& mesh) {
  const Box box = boundingBox(mesh);
  Soup soup{{}, {}, box.center(), box.longestSide()};
  if (!(soup.size > 0)) return soup;
  for (const Vec3& p : mesh.positions)
    soup.points.emplace_back((double(p.x) - soup.center.x) / soup.size, (double(p.y) - soup.center.y) / soup.size,
                             (double(p.z) - soup.center.z) / soup.size);
  // CGAL leaves out triangles without area, and takes for granted that one is left.
  for (const Triangle& t : mesh.triangles)
    if (!CGAL::collinear(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]])) soup.faces.push_back({t[0], t[1], t[2]});
  return soup;
}

SurfaceMesh fromCgal(const CgalMesh& from, const Soup& frame) {
  SurfaceMesh mesh;
  for (const auto vertex : from.vertices()) {
    const Point& p = from.point(vertex);
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

SurfaceMesh wrapOnce(const Soup& soup, double alpha) {
  CgalMesh wrapped;
  CGAL::alpha_wrap_3(soup.points, soup.faces, alpha / soup.size, alpha / soup.size * kOffsetOfAlpha, wrapped);
  return fromCgal(wrapped, soup);
}

double areaOf(const CgalMesh& mesh) {
  double area = 0;
  for (const auto face : mesh.faces()) area += CGAL::to_double(pmp::face_area(face, mesh));
  return area;
}

void requireUsefulCount(double triangles) {
  if (triangles >= kFewestTriangles && triangles <= kMostTriangles) return;
  char text[160];
  std::snprintf(text, sizeof text, "--remesh would make about %.3g triangles: take a %s edge (from %.0f to %.0e are made)", triangles,
                triangles > kMostTriangles ? "longer" : "shorter", kFewestTriangles, kMostTriangles);
  throw InputError("", text);
}

void requireManifold(const SurfaceMesh& mesh, const Soup& soup) {
  if (pmp::is_polygon_soup_a_polygon_mesh(soup.faces)) return;
  const uint64_t edges = findDefects(mesh).non_manifold_edges;
  throw InputError("", (edges > 0 ? "--remesh: " + std::to_string(edges) + " edges have more than two triangles"
                                  : std::string("--remesh: triangles are wound against each other, or surfaces touch in a point")) +
                           ": take --vertices N, which thins out any mesh, or wrap the sculpt in one skin (a voxel remesh) first");
}

}  // namespace

bool hasCgal() { return true; }

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

SurfaceMesh remeshed(const SurfaceMesh& mesh, double edge_length) {
  const SurfaceMesh welded = weldedByPosition(mesh);
  const Soup soup = toSoup(welded);
  if (soup.faces.empty() || !(soup.size > 0)) throw InputError("", "--remesh: no triangle has an extent");
  requireManifold(welded, soup);
  CgalMesh result;
  pmp::polygon_soup_to_polygon_mesh(soup.points, soup.faces, result);
  pmp::remove_isolated_vertices(result);
  const double edge = edge_length / soup.size;
  requireUsefulCount(areaOf(result) / (std::sqrt(3.0) / 4 * edge * edge));

  std::vector<CgalMesh::Edge_index> border;
  for (const auto e : result.edges())
    if (result.is_border(e)) border.push_back(e);
  pmp::split_long_edges(border, edge, result);
  pmp::isotropic_remeshing(result.faces(), edge, result,
                           CGAL::parameters::number_of_iterations(kRemeshIterations).protect_constraints(true));
  result.collect_garbage();
  return fromCgal(result, soup);
}

#else

bool hasCgal() { return false; }

Wrap wrapClosed(const SurfaceMesh&, double) {
  throw InputError("", "the mesh is open, and this binary was built without CGAL (-DCLOUDBAKE_CGAL=OFF): close the holes");
}

SurfaceMesh remeshed(const SurfaceMesh&, double) {
  throw InputError("", "--remesh needs CGAL, and this binary was built without it (-DCLOUDBAKE_CGAL=OFF)");
}

#endif

}  // namespace cloudbake
