// Remeshing: M. Botsch, L. Kobbelt, "A Remeshing Approach to Multiresolution Modeling", SGP 2004, as implemented in CGAL: long edges are
// split, short ones collapsed, valences equalised by flips, and vertices moved in their tangent plane and projected back to the input.
#include "bake/mesh/repair.h"

#include "core/error.h"
#include "core/parallel.h"

#ifdef CLOUDBAKE_CGAL
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/repair.h>
#include <fmt/format.h>

#include <cmath>

#include "bake/mesh/cgal_mesh.h"
#include "bake/mesh/mesh_topology.h"
#endif

namespace cloudbake {

#ifdef CLOUDBAKE_CGAL

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

constexpr unsigned kRemeshIterations = 5;
constexpr double kMostTriangles = 2e7, kFewestTriangles = 20;

// Constrains nothing. CGAL asks it at every split, and for every vertex that it moves, so that is where a long remesh can be stopped.
template <class Key>
struct NoConstraint {
  using key_type = Key;
  using value_type = bool;
  using reference = bool;
  using category = boost::read_write_property_map_tag;
  friend bool get(NoConstraint, Key) {
    throwIfLoopsStop();
    return false;
  }
  friend void put(NoConstraint, Key, bool) {}
};

void requireUsefulCount(double triangles) {
  if (triangles >= kFewestTriangles && triangles <= kMostTriangles) return;
  throw InputError("", fmt::format("--remesh would make about {:.3g} triangles: use a {} edge (from {:.0f} to {:.0e} are allowed)",
                                   triangles, triangles > kMostTriangles ? "longer" : "shorter", kFewestTriangles, kMostTriangles));
}

void requireManifold(const SurfaceMesh& mesh, const Soup& soup) {
  if (pmp::is_polygon_soup_a_polygon_mesh(soup.faces)) return;
  const uint64_t edges = findDefects(mesh).non_manifold_edges.count;
  throw InputError("", (edges > 0 ? "--remesh: " + std::to_string(edges) + " edges have more than two triangles"
                                  : std::string("--remesh: neighbouring triangles have opposite winding, or surfaces touch in a point")) +
                           ": use --vertices N, which reduces any mesh, or first make the sculpt one closed skin (a voxel remesh)");
}

}  // namespace

SurfaceMesh remeshed(const SurfaceMesh& mesh, double edge_length) {
  const SurfaceMesh welded = weldedByPosition(mesh);
  const Soup soup = toSoup(welded);
  if (soup.faces.empty() || !(soup.size > 0)) throw InputError("", "--remesh: no triangle has an extent");
  requireManifold(welded, soup);
  CgalMesh result;
  pmp::polygon_soup_to_polygon_mesh(soup.points, soup.faces, result);
  pmp::remove_isolated_vertices(result);
  const double edge = edge_length / soup.size;
  requireUsefulCount(surfaceArea(welded) / (std::sqrt(3.0) / 4 * edge_length * edge_length));

  std::vector<CgalMesh::Edge_index> border;
  for (const auto e : result.edges())
    if (result.is_border(e)) border.push_back(e);
  pmp::split_long_edges(border, edge, result);
  pmp::isotropic_remeshing(result.faces(), edge, result,
                           CGAL::parameters::number_of_iterations(kRemeshIterations)
                               .protect_constraints(true)
                               .edge_is_constrained_map(NoConstraint<CgalMesh::Edge_index>())
                               .vertex_is_constrained_map(NoConstraint<CgalMesh::Vertex_index>()));
  result.collect_garbage();
  return fromCgal(result, soup);
}

#else

SurfaceMesh remeshed(const SurfaceMesh&, double) {
  throw InputError("", "--remesh needs CGAL, but this binary was built without it (-DCLOUDBAKE_CGAL=OFF)");
}

#endif

}  // namespace cloudbake
