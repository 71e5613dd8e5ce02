// First find overlapping boxes (A. Zomorodian, H. Edelsbrunner, "Fast Software for Box Intersections", IJCGA 12, 2002, as implemented in
// CGAL). The test then depends on what the two triangles share. Nothing: do they intersect? A corner: does the opposite side of one meet
// the other triangle? A side: are they coplanar and folded onto each other?
#include "bake/mesh/self_intersections.h"

#include "core/error.h"

#ifdef CLOUDBAKE_CGAL
#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>
#endif

namespace cloudbake {

#ifdef CLOUDBAKE_CGAL

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using TriangleBox = CGAL::Box_intersection_d::Box_with_info_d<double, 3, uint32_t>;

bool meetElsewhere(const std::vector<Point>& points, const Triangle& a, const Triangle& b) {
  int shared = 0;
  size_t at_a[3], at_b[3];
  for (size_t i = 0; i < 3; ++i)
    for (size_t k = 0; k < 3; ++k)
      if (a[i] == b[k]) at_a[shared] = i, at_b[shared] = k, ++shared;
  const auto triangle = [&](const Triangle& t) { return Kernel::Triangle_3(points[t[0]], points[t[1]], points[t[2]]); };
  const auto sideAcross = [&](const Triangle& t, size_t corner) {
    return Kernel::Segment_3(points[t[(corner + 1) % 3]], points[t[(corner + 2) % 3]]);
  };
  switch (shared) {
    case 0: return CGAL::do_intersect(triangle(a), triangle(b));
    case 1: return CGAL::do_intersect(sideAcross(a, at_a[0]), triangle(b)) || CGAL::do_intersect(sideAcross(b, at_b[0]), triangle(a));
    case 2: {
      const Point &p = points[a[at_a[0]]], &q = points[a[at_a[1]]];
      const Point &c = points[a[3 - at_a[0] - at_a[1]]], &d = points[b[3 - at_b[0] - at_b[1]]];
      return CGAL::coplanar(p, q, c, d) && CGAL::coplanar_orientation(p, q, c, d) == CGAL::POSITIVE;
    }
    default: return false;
  }
}

}  // namespace

Defect findSelfIntersections(const SurfaceMesh& mesh) {
  const SurfaceMesh welded = weldedByPosition(mesh);
  std::vector<Point> points;
  for (const Vec3& p : welded.positions) points.emplace_back(p.x, p.y, p.z);
  std::vector<TriangleBox> boxes;
  for (uint32_t f = 0; f < welded.triangles.size(); ++f) {
    const Triangle& t = welded.triangles[f];
    if (!CGAL::collinear(points[t[0]], points[t[1]], points[t[2]]))
      boxes.emplace_back(points[t[0]].bbox() + points[t[1]].bbox() + points[t[2]].bbox(), f);
  }
  Defect pairs;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const TriangleBox& a, const TriangleBox& b) {
    if (meetElsewhere(points, welded.triangles[a.info()], welded.triangles[b.info()])) pairs.meet(std::min(a.info(), b.info()));
  });
  return pairs;
}

#else

Defect findSelfIntersections(const SurfaceMesh&) {
  throw InputError("", "--inspect needs CGAL, but this binary was built without it (-DCLOUDBAKE_CGAL=OFF)");
}

#endif

}  // namespace cloudbake
