// Ear clipping: G. H. Meisters, "Polygons have ears", American Mathematical Monthly 82, 1975. The polygon's plane is given by
// Newell's normal n = Σ pᵢ × pᵢ₊₁ (I. E. Sutherland et al., 1974), which is also defined for a slightly bent polygon.
#include "io/sculpt/triangulate.h"

#include <array>

#include "core/error.h"
#include "io/sculpt/delaunay_polygon.h"

namespace cloudbake {

namespace {

using Point = std::array<double, 2>;

// Twice the signed area of a triangle; positive if it is counter-clockwise.
double turn(const Point& a, const Point& b, const Point& c) { return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]); }

// Projects the corners along the largest component of the polygon's normal onto the other two axes, counter-clockwise.
std::vector<Point> flatten(std::span<const uint32_t> corners, std::span<const Vec3> positions) {
  std::array<double, 3> normal{};
  const Vec3 origin = positions[corners[0]];
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3 p = positions[corners[i]], q = positions[corners[(i + 1) % corners.size()]];
    const double px = double(p.x) - origin.x, py = double(p.y) - origin.y, pz = double(p.z) - origin.z;
    const double qx = double(q.x) - origin.x, qy = double(q.y) - origin.y, qz = double(q.z) - origin.z;
    normal[0] += py * qz - pz * qy;
    normal[1] += pz * qx - px * qz;
    normal[2] += px * qy - py * qx;
  }
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(normal[i]) > std::abs(normal[axis])) axis = i;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (normal[axis] < 0) std::swap(u, v);

  std::vector<Point> points;
  for (const uint32_t corner : corners) {
    const std::array<double, 3> p{positions[corner].x, positions[corner].y, positions[corner].z};
    points.push_back({p[u], p[v]});
  }
  return points;
}

bool isConvex(const std::vector<Point>& points) {
  const size_t n = points.size();
  for (size_t i = 0; i < n; ++i)
    if (turn(points[i], points[(i + 1) % n], points[(i + 2) % n]) < 0) return false;
  return true;
}

// An ear is a corner that turns left, with no other corner of the polygon inside its triangle.
bool isEar(const std::vector<Point>& points, const std::vector<uint32_t>& left, size_t at) {
  const size_t n = left.size(), before = left[(at + n - 1) % n], after = left[(at + 1) % n];
  const Point &a = points[before], &b = points[left[at]], &c = points[after];
  if (turn(a, b, c) <= 0) return false;
  for (const uint32_t other : left) {
    const Point& p = points[other];
    if (p == a || p == b || p == c) continue;
    if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
  }
  return true;
}

// Cuts ears off the corners `left` until three corners or no ear are left. An ear is handed to `emit` as three places in `left`.
template <class Emit>
void cutEars(const std::vector<Point>& points, std::vector<uint32_t>& left, const Emit& emit) {
  for (size_t at = 0, misses = 0; left.size() > 3 && misses < left.size();) {
    const size_t n = left.size();
    at %= n;
    if (!isEar(points, left, at)) {
      ++at, ++misses;
      continue;
    }
    emit((at + n - 1) % n, at, (at + 1) % n);
    left.erase(left.begin() + std::ptrdiff_t(at));
    misses = 0;
  }
}

// Whether every corner turns left and the polygon goes around once: its sides point upwards in one stretch and downwards in another.
bool isStrictlyConvex(const std::vector<Point>& points) {
  const size_t n = points.size();
  size_t changes = 0;
  const auto goes_up = [&](size_t i) {
    const Point &a = points[i % n], &b = points[(i + 1) % n];
    return a[1] < b[1] || (a[1] == b[1] && a[0] < b[0]);
  };
  for (size_t i = 0; i < n; ++i) {
    if (turn(points[i], points[(i + 1) % n], points[(i + 2) % n]) <= 0) return false;
    changes += goes_up(i) != goes_up(i + 1);
  }
  return changes == 2;
}

}  // namespace

bool triangulatePolygon(std::span<const uint32_t> corners, std::span<const Vec3> positions, std::vector<Triangle>& triangles) {
  std::vector<uint32_t> left(corners.size());
  for (size_t i = 0; i < left.size(); ++i) left[i] = uint32_t(i);
  const auto emit = [&](size_t a, size_t b, size_t c) { triangles.push_back({corners[left[a]], corners[left[b]], corners[left[c]]}); };

  bool simple = true;
  if (corners.size() > 3) {
    const std::vector<Point> points = flatten(corners, positions);
    const bool large = corners.size() > kMostCornersByEars;
    if (large && hasDelaunayPolygon() && !isStrictlyConvex(points)) {
      if (const auto inside = delaunayPolygon(points)) {
        for (const auto& t : *inside) triangles.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
        return true;
      }
      simple = false;
    } else if (!large || !isStrictlyConvex(points)) {
      if (corners.size() > kMostCornersWithoutCgal)
        throw InputError("", "a polygon has " + std::to_string(corners.size()) +
                                 " corners, and without CGAL (-DCLOUDBAKE_CGAL=OFF) at most " + std::to_string(kMostCornersWithoutCgal) +
                                 " can be cut: export the sculpt as triangles");
      const bool convex = isConvex(points);
      if (!convex) cutEars(points, left, emit);
      simple = convex || left.size() == 3;
    }
  }
  for (size_t i = 1; i + 1 < left.size(); ++i) emit(0, i, i + 1);
  return simple;
}

}  // namespace cloudbake
