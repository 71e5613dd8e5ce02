// Constrained Delaunay triangulation (L. P. Chew, "Constrained Delaunay triangulations", Algorithmica 4, 1989) by CGAL's 2D package, with
// exact predicates. The polygon's sides are the constraints. The winding number of a face is found by a walk from the infinite face: it
// changes by one where the walk crosses a side.
#include "io/sculpt/delaunay_polygon.h"

#ifdef CLOUDBAKE_CGAL

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cstdint>
#include <unordered_map>

namespace cloudbake {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Winding = std::optional<int>;  // of a face; unset until the walk has met it
using Vertices = CGAL::Triangulation_vertex_base_with_info_2<size_t, Kernel>;
using Faces = CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<Winding, Kernel>>;
using Delaunay = CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<Vertices, Faces>,
                                                            CGAL::No_constraint_intersection_requiring_constructions_tag>;

// How often the polygon runs along an edge in its direction (lower place → higher place) minus how often it runs against it.
using Runs = std::unordered_map<uint64_t, int>;

uint64_t edgeKey(size_t a, size_t b) { return uint64_t(std::min(a, b)) << 32 | std::max(a, b); }

// Vertices of the triangulation at the places of the polygon. Points of equal position share a vertex, named after the first of them.
std::vector<Delaunay::Vertex_handle> insertPoints(Delaunay& triangulation, std::span<const std::array<double, 2>> points) {
  std::vector<std::pair<Kernel::Point_2, size_t>> sorted;
  for (size_t i = 0; i < points.size(); ++i) sorted.emplace_back(Kernel::Point_2(points[i][0], points[i][1]), i);
  std::sort(sorted.begin(), sorted.end());
  std::vector<size_t> first(points.size());
  std::vector<std::pair<Kernel::Point_2, size_t>> distinct;
  for (const auto& [point, place] : sorted) {
    if (distinct.empty() || distinct.back().first != point) distinct.emplace_back(point, place);
    first[place] = distinct.back().second;
  }
  triangulation.insert(distinct.begin(), distinct.end());
  std::vector<Delaunay::Vertex_handle> at(points.size());
  for (auto v = triangulation.finite_vertices_begin(); v != triangulation.finite_vertices_end(); ++v) at[v->info()] = v;
  for (size_t i = 0; i < points.size(); ++i) at[i] = at[first[i]];
  return at;
}

// Makes a side of the polygon a constraint, and adds its run. Vertices that lie between its ends split it. Both ways cost time in
// proportion to the edges at the vertex where the search begins, so it begins at the end that the polygon visits less often.
void addSide(Delaunay& triangulation, Delaunay::Vertex_handle from, Delaunay::Vertex_handle to, bool from_the_end) {
  if (from_the_end) std::swap(from, to);
  triangulation.insert_constraint(from, to);
}

void addRun(const Delaunay& triangulation, Delaunay::Vertex_handle from, Delaunay::Vertex_handle to, bool from_the_end, Runs& runs) {
  const int sign = from_the_end ? -1 : 1;
  if (from_the_end) std::swap(from, to);
  while (from != to) {
    Delaunay::Vertex_handle next = to;
    Delaunay::Face_handle face;
    int index = 0;
    triangulation.includes_edge(from, to, next, face, index);
    runs[edgeKey(from->info(), next->info())] += from->info() < next->info() ? sign : -sign;
    from = next;
  }
}

// Sets the winding number of every face.
void walkFaces(Delaunay& triangulation, const Runs& runs) {
  std::vector<Delaunay::Face_handle> stack{triangulation.infinite_face()};
  stack.back()->info() = 0;
  while (!stack.empty()) {
    const Delaunay::Face_handle face = stack.back();
    stack.pop_back();
    for (int i = 0; i < 3; ++i) {
      const Delaunay::Face_handle beyond = face->neighbor(i);
      if (beyond->info()) continue;
      // Seen from `face` the edge runs counter-clockwise from a to b, so a side from a to b has the face on its left.
      const Delaunay::Vertex_handle a = face->vertex(Delaunay::ccw(i)), b = face->vertex(Delaunay::cw(i));
      int left = 0;
      if (face->is_constrained(i))
        if (const auto run = runs.find(edgeKey(a->info(), b->info())); run != runs.end())
          left = a->info() < b->info() ? run->second : -run->second;
      beyond->info() = *face->info() - left;
      stack.push_back(beyond);
    }
  }
}

std::array<size_t, 3> cornersOf(Delaunay::Face_handle face) {
  std::array<size_t, 3> corners{face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()};
  if (*face->info() < 0) std::swap(corners[1], corners[2]);
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

}  // namespace

bool hasDelaunayPolygon() { return true; }

std::optional<std::vector<std::array<size_t, 3>>> delaunayPolygon(std::span<const std::array<double, 2>> points) {
  Delaunay triangulation;
  const std::vector<Delaunay::Vertex_handle> at = insertPoints(triangulation, points);
  if (triangulation.dimension() < 2) return std::nullopt;
  std::vector<uint32_t> visits(points.size(), 0);
  for (const auto& vertex : at) ++visits[vertex->info()];
  const auto for_each_side = [&](const auto& body) {
    for (size_t i = 0; i < points.size(); ++i)
      if (const auto from = at[i], to = at[(i + 1) % points.size()]; from != to) body(from, to, visits[from->info()] > visits[to->info()]);
  };
  Runs runs;
  try {
    for_each_side([&](auto from, auto to, bool from_the_end) { addSide(triangulation, from, to, from_the_end); });
    for_each_side([&](auto from, auto to, bool from_the_end) { addRun(triangulation, from, to, from_the_end, runs); });
  } catch (const Delaunay::Intersection_of_constraints_exception&) {
    return std::nullopt;
  }
  walkFaces(triangulation, runs);

  std::vector<std::array<size_t, 3>> triangles;
  for (auto face = triangulation.finite_faces_begin(); face != triangulation.finite_faces_end(); ++face) {
    if (std::abs(*face->info()) > 1) return std::nullopt;
    if (*face->info() != 0) triangles.push_back(cornersOf(face));
  }
  std::sort(triangles.begin(), triangles.end());
  if (triangles.empty()) return std::nullopt;
  return triangles;
}

}  // namespace cloudbake

#else

#include <stdexcept>

namespace cloudbake {

bool hasDelaunayPolygon() { return false; }

std::optional<std::vector<std::array<size_t, 3>>> delaunayPolygon(std::span<const std::array<double, 2>>) {
  throw std::logic_error("this binary was built without CGAL");
}

}  // namespace cloudbake

#endif
