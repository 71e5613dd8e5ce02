// Orienting: A. Guéziec, G. Taubin, F. Lazarus, B. Horn, "Cutting and Stitching: Converting Sets of Polygons to Manifold Surfaces", IEEE
// TVCG 7(2), 2001. Filling: P. Liepa, "Filling Holes in Meshes", SGP 2003 (the first step: the triangulation of least dihedral angles
// and area). Both as implemented in CGAL.
#include "bake/mesh/repair.h"

#include <cmath>
#include <string>

#include "core/error.h"

#ifdef CLOUDBAKE_CGAL
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <unordered_map>

#include "bake/mesh/cgal_mesh.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/shells.h"
#include "core/portable_math.h"
#endif

namespace cloudbake {

#ifdef CLOUDBAKE_CGAL

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

// --- Orienting ---

// The triangles of a soup, turned so that neighbours agree. Vertices where surfaces only touch are duplicated.
SurfaceMesh coherent(const SurfaceMesh& welded, std::vector<bool>& turned) {
  std::vector<CgalPoint> points;
  for (const Vec3& p : welded.positions) points.emplace_back(p.x, p.y, p.z);
  std::vector<std::vector<size_t>> faces;
  for (const Triangle& t : welded.triangles) faces.push_back({t[0], t[1], t[2]});
  pmp::orient_polygon_soup(points, faces);
  SurfaceMesh mesh;
  for (const CgalPoint& p : points) mesh.positions.push_back({float(p.x()), float(p.y()), float(p.z())});
  for (size_t f = 0; f < faces.size(); ++f) {
    mesh.triangles.push_back({uint32_t(faces[f][0]), uint32_t(faces[f][1]), uint32_t(faces[f][2])});
    turned[f] = mesh.positions[faces[f][0]] != welded.positions[welded.triangles[f][0]];
  }
  return mesh;
}

// What the rounding of its coordinates may add to the volume of a flat sheet in this box.
double volumeOfRounding(const Box& box) {
  const auto square = [](Vec3 v) { return double(v.x) * v.x + double(v.y) * v.y + double(v.z) * v.z; };
  return 1e-6 * square(box.high - box.low) * std::sqrt(std::max(square(box.low), square(box.high)));
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

}  // namespace

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

namespace {

using LoopTriangle = std::array<int, 3>;

// CGAL's kernel with an angle between two triangles that has the same bits with every C library. A triangulation is chosen by these angles,
// and flat or regular holes have many that are equal but for rounding.
class HoleKernel
    : public CGAL::Filtered_kernel_adaptor<CGAL::Type_equality_wrapper<CGAL::Simple_cartesian<double>::Base<HoleKernel>::Type, HoleKernel>,
                                           true> {
 public:
  /// The angle of abc and abd along ab in degrees, from −180 to 180.
  struct Compute_approximate_dihedral_angle_3 {  // NOLINT(readability-identifier-naming): CGAL's name
    double operator()(const Point_3& a, const Point_3& b, const Point_3& c, const Point_3& d) const {
      const Vector_3 ab = b - a, ac = c - a, across = CGAL::cross_product(ab, d - a);
      return atan2Degrees(std::sqrt(ab.squared_length()) * (ac * across), CGAL::cross_product(ab, ac) * across);
    }
  };
  Compute_approximate_dihedral_angle_3 compute_approximate_dihedral_angle_3_object() const { return {}; }  // NOLINT: CGAL's name
};
using HolePoint = HoleKernel::Point_3;

// Triangles between some `places` of a loop, as indices into the loop; empty if none were found. By default all triangulations are
// searched. CGAL's quicker search among the triangles of a Delaunay tetrahedralisation breaks ties by the addresses of its vertices, and a
// flat hole has many ties.
std::vector<LoopTriangle> triangulated(const std::vector<HolePoint>& points, const std::vector<HolePoint>& across,
                                       const std::vector<int>& places, bool delaunay = false) {
  std::vector<HolePoint> chosen, beyond;
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
std::vector<LoopTriangle> trianglesOver(const std::vector<HolePoint>& points, const std::vector<HolePoint>& across,
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
  const auto point = [&](uint32_t v) { return HolePoint(welded.positions[v].x, welded.positions[v].y, welded.positions[v].z); };
  std::vector<HolePoint> points, across;
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

#else

bool hasCgal() { return false; }

std::optional<SurfaceMesh> closedByFilling(const SurfaceMesh&, uint64_t&) { return std::nullopt; }

RepairSummary repairMesh(SurfaceMesh&, std::span<const uint32_t>, const RepairSettings&, std::vector<bool>&, Warnings&) {
  throw InputError("", "--repair needs CGAL, but this binary was built without it (-DCLOUDBAKE_CGAL=OFF)");
}

#endif

}  // namespace cloudbake
