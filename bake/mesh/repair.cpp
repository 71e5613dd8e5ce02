// Alpha wrapping: C. Portaneri, M. Rouxel-Labbé, M. Hemmer, D. Cohen-Steiner, P. Alliez, "Alpha Wrapping with an Offset",
// ACM TOG 41(4), 2022, as implemented in CGAL: balls of radius α carve a Delaunay tetrahedralisation from outside, and the part that they
// cannot reach is the solid. The surface lies `offset` outside the input.
// Remeshing: M. Botsch, L. Kobbelt, "A Remeshing Approach to Multiresolution Modeling", SGP 2004, as implemented in CGAL: long edges are
// split, short ones collapsed, valences equalised by flips, and vertices moved in their tangent plane and projected back to the input.
// Orienting: A. Guéziec, G. Taubin, F. Lazarus, B. Horn, "Cutting and Stitching: Converting Sets of Polygons to Manifold Surfaces", IEEE
// TVCG 7(2), 2001. Filling: P. Liepa, "Filling Holes in Meshes", SGP 2003 (the first step: the triangulation of least dihedral angles
// and area). Both as implemented in CGAL.
#include "bake/mesh/repair.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "core/error.h"

#ifdef CLOUDBAKE_CGAL
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/repair.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <unordered_map>

#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/shells.h"
#endif

namespace cloudbake {

#ifdef CLOUDBAKE_CGAL

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using CgalMesh = CGAL::Surface_mesh<Point>;

constexpr double kOffsetOfAlpha = 1.0 / 30;  // CGAL's user manual: small compared with α, but large enough to bound the mesh's size
constexpr double kHollowVolumeRatio = 0.6, kHollowShells = 2;
constexpr double kAlphaOfHole = 0.6;  // × the hole's diagonal: a ball with a radius of a little more than half the diagonal does not pass
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
  // CGAL skips triangles without area and assumes that at least one other exists.
  for (const Triangle& t : mesh.triangles)
    if (!CGAL::collinear(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]])) soup.faces.push_back({t[0], t[1], t[2]});
  return soup;
}

// CGAL's wrap searches the last corners of all triangles in a tree (compute_reference_point in its splitting_helper.h), by recursion as
// deep as the most triangles that share one: a fan of 30,000 overflows the stack. There the corners take turns to be the last, and
// triangles that are there twice are left out. `soup` is welded by position.
void spreadLastCorners(Soup& soup) {
  constexpr size_t kDeepest = 1000;
  std::vector<size_t> used(soup.points.size(), 0);
  for (const auto& face : soup.faces) ++used[face[2]];
  if (used.empty() || *std::max_element(used.begin(), used.end()) <= kDeepest) return;

  std::set<std::array<size_t, 3>> met;
  std::erase_if(soup.faces, [&](const std::vector<size_t>& face) {
    std::array<size_t, 3> corners{face[0], face[1], face[2]};
    std::sort(corners.begin(), corners.end());
    return !met.insert(corners).second;
  });
  std::fill(used.begin(), used.end(), 0);
  for (auto& face : soup.faces) {
    const auto last = std::min_element(face.begin(), face.end(), [&](size_t a, size_t b) { return used[a] < used[b]; });
    ++used[*last];
    std::rotate(face.begin(), last + 1, face.end());
  }
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

// --- Orienting ---

// The triangles of a soup, turned so that neighbours agree. Vertices where surfaces only touch are duplicated.
SurfaceMesh coherent(const SurfaceMesh& welded, std::vector<bool>& turned) {
  std::vector<Point> points;
  for (const Vec3& p : welded.positions) points.emplace_back(p.x, p.y, p.z);
  std::vector<std::vector<size_t>> faces;
  for (const Triangle& t : welded.triangles) faces.push_back({t[0], t[1], t[2]});
  pmp::orient_polygon_soup(points, faces);
  SurfaceMesh mesh;
  for (const Point& p : points) mesh.positions.push_back({float(p.x()), float(p.y()), float(p.z())});
  for (size_t f = 0; f < faces.size(); ++f) {
    mesh.triangles.push_back({uint32_t(faces[f][0]), uint32_t(faces[f][1]), uint32_t(faces[f][2])});
    turned[f] = mesh.positions[faces[f][0]] != welded.positions[welded.triangles[f][0]];
  }
  return mesh;
}

// What the rounding of its coordinates may add to the volume of a flat sheet in this box.
double volumeOfRounding(const Box& box) {
  const auto lengthOf = [](Vec3 v) { return std::hypot(double(v.x), double(v.y), double(v.z)); };
  return 1e-6 * std::pow(lengthOf(box.high - box.low), 2) * std::max(lengthOf(box.low), lengthOf(box.high));
}

// Which triangles to turn. Triangles with two coincident corners have no orientation and stay.
std::vector<bool> trianglesToTurn(const SurfaceMesh& mesh) {
  const SurfaceMesh welded = weldedByPosition(mesh);
  SurfaceMesh proper{welded.positions, {}, {}};
  std::vector<uint32_t> index;
  for (uint32_t f = 0; f < welded.triangles.size(); ++f)
    if (hasDistinctCorners(welded.triangles[f])) proper.triangles.push_back(welded.triangles[f]), index.push_back(f);
  std::vector<bool> turned(proper.triangles.size());
  const SurfaceMesh agreed = coherent(proper, turned);
  const std::vector<Shell> shells = shellsOf(agreed);
  std::vector<bool> result(mesh.triangles.size());
  const std::vector<bool> inner = innerShells(agreed, shells);
  for (size_t i = 0; i < shells.size(); ++i) {
    const Shell& shell = shells[i];
    const size_t turned_here = size_t(std::count_if(shell.triangles.begin(), shell.triangles.end(), [&](uint32_t f) { return turned[f]; }));
    const bool was_coherent = turned_here == 0 || turned_here == shell.triangles.size();
    const double volume_before = turned_here == 0 ? shell.volume : -shell.volume;
    const bool is_cavity = was_coherent && volume_before < 0 && inner[i];
    // A flat sheet has no volume in either orientation, so the majority decides.
    const bool is_flat = std::fabs(shell.volume) <= volumeOfRounding(shell.box);
    const bool flip = is_cavity ? turned_here > 0 : is_flat ? 2 * turned_here > shell.triangles.size() : shell.volume < 0;
    for (const uint32_t f : shell.triangles) result[index[f]] = turned[f] != flip;
  }
  return result;
}

// Removes triangles that add nothing to a surface: those with two coincident corners or with the corners of an earlier triangle.
std::vector<Triangle> withoutRepeats(const SurfaceMesh& mesh) {
  const SurfaceMesh welded = weldedByPosition(mesh);
  std::set<Triangle> met;
  std::vector<Triangle> triangles;
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    Triangle corners = welded.triangles[f];
    std::sort(corners.begin(), corners.end());
    if (hasDistinctCorners(corners) && met.insert(corners).second) triangles.push_back(mesh.triangles[f]);
  }
  return triangles;
}

// --- Filling ---

// An open side of a triangle, in the reverse direction, as a triangle on its other side would have it.
struct BorderSide {
  uint32_t from, to;  // welded vertices
  uint32_t corner;    // the original mesh's vertex at `from`
  uint32_t third;     // the triangle's third welded vertex
  bool is_used = false;
};

// In the order of their triangles.
std::vector<BorderSide> borderSides(const SurfaceMesh& mesh, const SurfaceMesh& welded) {
  std::vector<EdgeSide> open;
  forEachEdge(welded.positions.size(), welded.triangles, Degenerate::kLeftOut, [&](uint32_t, std::span<EdgeSide> sides) {
    if (sides.size() == 1) open.push_back(sides.front());
  });
  std::sort(open.begin(), open.end(),
            [](const EdgeSide& a, const EdgeSide& b) { return std::pair(a.triangle, a.corner) < std::pair(b.triangle, b.corner); });
  std::vector<BorderSide> border;
  for (const EdgeSide& side : open) {
    const Triangle& t = welded.triangles[side.triangle];
    const size_t next = (side.corner + 1U) % 3;
    border.push_back({t[next], t[side.corner], mesh.triangles[side.triangle][next], t[(side.corner + 2U) % 3]});
  }
  return border;
}

using Loop = std::vector<const BorderSide*>;

// Closed loops that visit no vertex twice: a walk that returns to a vertex is cut there. Sides that form no loop are counted in `stray`.
std::vector<Loop> loopsOf(std::vector<BorderSide>& border, uint64_t* stray) {
  std::unordered_map<uint32_t, std::vector<BorderSide*>> leaving;
  for (BorderSide& side : border) leaving[side.from].push_back(&side);
  const auto next = [&](uint32_t vertex) -> BorderSide* {
    for (BorderSide* side : leaving[vertex])
      if (!side->is_used) return side;
    return nullptr;
  };
  std::vector<Loop> loops;
  for (BorderSide& start : border) {
    Loop walk;
    std::unordered_map<uint32_t, size_t> place_of;
    for (BorderSide* side = start.is_used ? nullptr : &start; side; side = next(side->to)) {
      side->is_used = true;
      place_of[side->from] = walk.size();
      walk.push_back(side);
      const auto back = place_of.find(side->to);
      if (back == place_of.end()) continue;
      const auto first = walk.begin() + ptrdiff_t(back->second);
      loops.emplace_back(first, walk.end());
      for (auto cut = first; cut != walk.end(); ++cut) place_of.erase((*cut)->from);
      walk.erase(first, walk.end());
    }
    *stray += walk.size();
  }
  return loops;
}

// The largest diagonal of a hole's bounding box, world units.
double widestHole(const SurfaceMesh& mesh) {
  const SurfaceMesh welded = weldedByPosition(mesh);
  std::vector<BorderSide> border = borderSides(mesh, welded);
  uint64_t stray = 0;
  double widest = 0;
  for (const Loop& loop : loopsOf(border, &stray)) {
    Box box;
    for (const BorderSide* side : loop) box.add(welded.positions[side->from]);
    widest = std::max(widest, double(box.diagonal()));
  }
  return widest;
}

using LoopTriangle = std::array<int, 3>;

// Triangles between some `places` of a loop, as indices into the loop; empty if none were found. By default all triangulations are
// searched. CGAL's quicker search among the triangles of a Delaunay tetrahedralisation breaks ties by the addresses of its vertices, and a
// flat hole has many ties.
std::vector<LoopTriangle> triangulated(const std::vector<Point>& points, const std::vector<Point>& across, const std::vector<int>& places,
                                       bool delaunay = false) {
  std::vector<Point> chosen, beyond;
  for (const int place : places) chosen.push_back(points[size_t(place)]);
  if (places.size() == points.size()) beyond = across;
  std::vector<CGAL::Triple<int, int, int>> found;
  pmp::triangulate_hole_polyline(chosen, beyond, std::back_inserter(found),
                                 CGAL::parameters::use_delaunay_triangulation(delaunay).do_not_use_cubic_algorithm(delaunay));
  std::vector<LoopTriangle> triangles;
  for (const auto& t : found) triangles.push_back({places[size_t(t.first)], places[size_t(t.second)], places[size_t(t.third)]});
  return triangles;
}

// The search time grows with the third power of the number of places. So a long loop is first triangulated over every k-th place, and then
// each chain between two of these is triangulated separately.
std::vector<LoopTriangle> trianglesOver(const std::vector<Point>& points, const std::vector<Point>& across,
                                        const std::vector<int>& places) {
  constexpr size_t kMostPlaces = 150;
  if (places.size() <= kMostPlaces) return triangulated(points, across, places);
  const size_t step = (places.size() + kMostPlaces - 1) / kMostPlaces;
  std::vector<int> coarse;
  for (size_t i = 0; i < places.size(); i += step) coarse.push_back(places[i]);
  std::vector<LoopTriangle> triangles = triangulated(points, across, coarse);
  if (triangles.empty()) return {};
  for (size_t i = 0; i < places.size(); i += step) {
    std::vector<int> chain;
    for (size_t k = i; k <= std::min(i + step, places.size()); ++k) chain.push_back(places[k % places.size()]);
    if (chain.size() < 3) continue;
    const std::vector<LoopTriangle> fine = trianglesOver(points, across, chain);
    if (fine.empty()) return {};
    triangles.insert(triangles.end(), fine.begin(), fine.end());
  }
  return triangles;
}

std::vector<LoopTriangle> trianglesOver(const Loop& loop, const SurfaceMesh& welded) {
  const auto point = [&](uint32_t v) { return Point(welded.positions[v].x, welded.positions[v].y, welded.positions[v].z); };
  std::vector<Point> points, across;
  for (const BorderSide* side : loop) points.push_back(point(side->from)), across.push_back(point(side->third));
  std::vector<int> places(points.size());
  std::iota(places.begin(), places.end(), 0);
  const std::vector<LoopTriangle> triangles = trianglesOver(points, across, places);
  return triangles.empty() ? triangulated(points, across, places, true) : triangles;  // collinear chains have no triangulation of their own
}

void fillHoles(SurfaceMesh& mesh, std::span<const uint32_t> part_of_vertex, RepairSummary& summary, Warnings& warnings) {
  const SurfaceMesh welded = weldedByPosition(mesh);
  std::vector<BorderSide> border = borderSides(mesh, welded);
  uint64_t stray = 0;
  const std::vector<Loop> loops = loopsOf(border, &stray);
  warnings.add(WarningKind::kHoleNotFilled, "open edges form no loop, because their triangles have opposite winding: add orient", stray);
  for (const Loop& loop : loops) {
    const auto part = [&](const BorderSide* side) { return part_of_vertex.empty() ? 0 : part_of_vertex[side->corner]; };
    if (std::any_of(loop.begin(), loop.end(), [&](const BorderSide* side) { return part(side) != part(loop.front()); })) {
      warnings.add(WarningKind::kHoleNotFilled, "a hole lies between two parts of the sculpt: join the parts to have it filled");
      continue;
    }
    const auto triangles = loop.size() < 3 ? std::vector<LoopTriangle>() : trianglesOver(loop, welded);
    if (triangles.empty()) {
      warnings.add(WarningKind::kHoleNotFilled, "a hole of " + std::to_string(loop.size()) + " edges has no triangulation");
      continue;
    }
    for (const auto& t : triangles) {
      const auto corner = [&](int at) { return loop[size_t(at)]->corner; };
      mesh.triangles.push_back({corner(t[0]), corner(t[1]), corner(t[2])});
    }
    ++summary.filled_holes;
    summary.added_triangles += triangles.size();
  }
}

}  // namespace

bool hasCgal() { return true; }

RepairSummary repairMesh(SurfaceMesh& mesh, std::span<const uint32_t> part_of_vertex, const RepairSettings& settings,
                         std::vector<bool>& turned, Warnings& warnings) {
  RepairSummary summary;
  turned.assign(mesh.triangles.size(), false);
  if (settings.orient) turned = trianglesToTurn(mesh);
  for (size_t f = 0; f < turned.size(); ++f)
    if (turned[f]) std::swap(mesh.triangles[f][1], mesh.triangles[f][2]), ++summary.turned_triangles;
  if (settings.fill) fillHoles(mesh, part_of_vertex, summary, warnings);
  return summary;
}

std::optional<SurfaceMesh> closedByFilling(const SurfaceMesh& mesh, uint64_t& filled_holes) {
  SurfaceMesh closed{mesh.positions, {}, withoutRepeats(mesh)};
  std::vector<bool> turned;
  Warnings left;
  // A shell that faces inwards would be taken from the volume of the others, even if its own triangles agree.
  const std::vector<Shell> shells = shellsOf(weldedByPosition(closed));
  const bool faces_inwards = std::any_of(shells.begin(), shells.end(), [](const Shell& shell) { return shell.volume < 0; });
  const bool orient = faces_inwards || findDefects(closed).turned_edges.count > 0;
  filled_holes = repairMesh(closed, {}, {orient, true}, turned, left).filled_holes;
  if (findDefects(closed).unmatched_edges > 0) return std::nullopt;
  return closed;
}

Wrap wrapClosed(const SurfaceMesh& mesh, double detail) {
  Soup soup = toSoup(weldedByPosition(mesh));
  spreadLastCorners(soup);
  if (soup.faces.empty() || !(soup.size > 0))
    throw InputError("", "no triangle has an area, so there is nothing to close: repair the mesh");
  const double finest = std::max(detail, kAlphaOfHole * widestHole(mesh)), area = surfaceArea(mesh);
  Wrap best;
  for (double alpha = boundingBox(mesh).diagonal() / 2; best.mesh.triangles.empty() || alpha >= finest; alpha /= 2) {
    Wrap wrap{wrapOnce(soup, alpha), alpha, 0};
    wrap.volume = signedVolume(wrap.mesh);
    const double shell = 2 * alpha * kOffsetOfAlpha * area;
    if (!best.mesh.triangles.empty() && wrap.volume < kHollowVolumeRatio * best.volume && wrap.volume < kHollowShells * shell) break;
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
  requireUsefulCount(surfaceArea(welded) / (std::sqrt(3.0) / 4 * edge_length * edge_length));

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

std::optional<SurfaceMesh> closedByFilling(const SurfaceMesh&, uint64_t&) { return std::nullopt; }

RepairSummary repairMesh(SurfaceMesh&, std::span<const uint32_t>, const RepairSettings&, std::vector<bool>&, Warnings&) {
  throw InputError("", "--repair needs CGAL, but this binary was built without it (-DCLOUDBAKE_CGAL=OFF)");
}

Wrap wrapClosed(const SurfaceMesh&, double) {
  throw InputError("", "the mesh is open, but this binary was built without CGAL (-DCLOUDBAKE_CGAL=OFF): close the holes");
}

SurfaceMesh remeshed(const SurfaceMesh&, double) {
  throw InputError("", "--remesh needs CGAL, but this binary was built without it (-DCLOUDBAKE_CGAL=OFF)");
}

#endif

}  // namespace cloudbake
