#include "io/sculpt/triangulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/random.h"
#include "io/sculpt/delaunay_polygon.h"

namespace cloudbake {
namespace {

using Polygon = std::vector<Vec3>;

struct Cut {
  bool simple = false;
  std::vector<Triangle> triangles;
};

Cut cut(const Polygon& polygon) {
  std::vector<uint32_t> corners(polygon.size());
  for (size_t i = 0; i < corners.size(); ++i) corners[i] = uint32_t(i);
  Cut result;
  result.simple = triangulatePolygon(corners, polygon, result.triangles);
  return result;
}

double areaOf(const Vec3& a, const Vec3& b, const Vec3& c) {
  return ((double(b.x) - a.x) * (double(c.y) - a.y) - (double(c.x) - a.x) * (double(b.y) - a.y)) / 2;
}

// Shoelace formula.
double areaOf(const Polygon& polygon) {
  double area = 0;
  for (size_t i = 1; i + 1 < polygon.size(); ++i) area += areaOf(polygon[0], polygon[i], polygon[i + 1]);
  return area;
}

// The triangles are wound like the polygon, none is flat, and their areas sum to the polygon's. `placed` is the polygon in another plane.
void expectExactCut(const Polygon& polygon, const std::string& name, const Polygon& placed) {
  const Cut result = cut(placed);
  const double whole = areaOf(polygon);
  double sum = 0;
  size_t wrong = 0;
  for (const Triangle& t : result.triangles) {
    ASSERT_TRUE(t[0] < polygon.size() && t[1] < polygon.size() && t[2] < polygon.size()) << name;
    const double area = areaOf(polygon[t[0]], polygon[t[1]], polygon[t[2]]);
    sum += area;
    wrong += area * whole <= 0;
  }
  EXPECT_TRUE(result.simple) << name;
  EXPECT_EQ(wrong, 0U) << name << ": flat or turned triangles of " << result.triangles.size();
  EXPECT_NEAR(sum, whole, 1e-9 * std::abs(whole)) << name;
  EXPECT_LE(result.triangles.size(), polygon.size() - 2) << name;
}

void expectExactCut(const Polygon& polygon, const std::string& name) { expectExactCut(polygon, name, polygon); }

// Straight sides between whole-numbered corners, each cut into `steps`: exactly collinear.
Polygon straightSides(const std::vector<std::array<int, 2>>& corners, int steps) {
  Polygon polygon;
  for (size_t s = 0; s < corners.size(); ++s) {
    const auto &a = corners[s], &b = corners[(s + 1) % corners.size()];
    for (int i = 0; i < steps; ++i)
      polygon.push_back({float(a[0] * steps + (b[0] - a[0]) * i), float(a[1] * steps + (b[1] - a[1]) * i), 0});
  }
  return polygon;
}

Polygon comb(int teeth) {
  Polygon polygon;
  for (int i = 0; i < teeth; ++i)
    for (const auto& [x, y] : {std::pair(0, 0), {1, 0}, {1, 10}, {2, 10}}) polygon.push_back({float(4 * i + x), float(y), 0});
  for (const float x : {float(4 * teeth), 0.0F}) polygon.push_back({x, -1, 0});
  return polygon;
}

Polygon spiral(int corners) {
  Polygon polygon;
  const auto add = [&](int i, double start) {
    const double angle = i * 0.01, radius = start + angle * 0.2;
    polygon.push_back({float(radius * std::cos(angle)), float(radius * std::sin(angle)), 0});
  };
  for (int i = 0; i < corners / 2; ++i) add(i, 1);
  for (int i = corners / 2; i-- > 0;) add(i, 1.5);
  return polygon;
}

// How many basic blocks the triangulation of large polygons has run (see tests/CMakeLists.txt).
thread_local uint64_t blocks = 0;

// Ten times the corners take about twelve times the work: their number grows, and its logarithm.
template <class Make>
void expectInProportion(int corners, const Make& make) {
  const auto blocksFor = [&](int count) {
    blocks = 0;
    expectExactCut(make(count), std::to_string(count) + " corners");
    return double(blocks);
  };
  const double few = blocksFor(corners), many = blocksFor(10 * corners);
  EXPECT_GT(few, corners);
  EXPECT_LT(many / few, 20) << few << ", then " << many;
}

}  // namespace

// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the compiler calls it by this name
extern "C" void __sanitizer_cov_trace_pc() { ++blocks; }

TEST(Triangulate, CutsLargePolygonsExactly) {
  if (!hasDelaunayPolygon()) GTEST_SKIP() << "built without CGAL";
  for (const int corners : {300, 10'000, 100'000}) {
    const std::string size = std::to_string(corners);
    expectExactCut(straightSides({{0, 0}, {1, 0}, {0, 1}}, corners / 3), "triangle of collinear corners " + size);
    expectExactCut(straightSides({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, corners / 6), "L " + size);
    expectExactCut(comb(corners / 4), "comb " + size);
    expectExactCut(spiral(corners), "spiral " + size);
  }
}

// Stars whose corners lie at random distances, combs and spirals: from every first corner, in both directions and in four planes.
TEST(Triangulate, CutsSmallConcavePolygonsExactly) {
  std::vector<Polygon> polygons{comb(2), comb(5), spiral(30), straightSides({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 1)};
  for (int corners = 5; corners <= 24; ++corners) {
    Polygon& star = polygons.emplace_back();
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners, radius = 0.2 + uniformDouble(hashDraw(4, uint32_t(corners), uint32_t(i)));
      star.push_back({float(radius * std::cos(angle)), float(radius * std::sin(angle)), 0});
    }
  }
  for (Polygon polygon : polygons)
    for (size_t first = 0; first < polygon.size(); ++first) {
      const std::string name = std::to_string(polygon.size()) + " corners, first " + std::to_string(first);
      expectExactCut(polygon, name);
      std::reverse(polygon.begin(), polygon.end());
      const auto placed = [&](auto place) {
        Polygon other;
        for (const Vec3 p : polygon) other.push_back(place(p.x, p.y));
        return other;
      };
      expectExactCut(polygon, name + ", reversed");
      expectExactCut(polygon, name + ", in yz", placed([](float x, float y) { return Vec3{0, x, y}; }));
      expectExactCut(polygon, name + ", in zx", placed([](float x, float y) { return Vec3{y, 0, x}; }));
      expectExactCut(polygon, name + ", leaning", placed([](float x, float y) { return Vec3{x, y, 2 * x - 3 * y}; }));
      std::reverse(polygon.begin(), polygon.end());
      std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
    }
}

// The second power of the number of corners, or a stack as deep, would show here.
TEST(Triangulate, WorksInProportionToTheCorners) {
  if (!hasDelaunayPolygon()) GTEST_SKIP() << "built without CGAL";
  expectInProportion(40'000, [](int corners) { return straightSides({{0, 0}, {1, 0}, {0, 1}}, corners / 3); });
}

// Every corner of a triangle many times, one after the other.
TEST(Triangulate, CountsRepeatedCornersOnce) {
  if (!hasDelaunayPolygon()) GTEST_SKIP() << "built without CGAL";
  Polygon polygon;
  for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}) polygon.insert(polygon.end(), 10'000, p);
  const Cut result = cut(polygon);
  EXPECT_TRUE(result.simple);
  EXPECT_EQ(result.triangles, (std::vector<Triangle>{{0, 10'000, 20'000}}));
}

// A corner that the polygon visits again and again: petals around a centre.
TEST(Triangulate, VisitsACornerOften) {
  if (!hasDelaunayPolygon()) GTEST_SKIP() << "built without CGAL";
  const auto petals = [](int corners) {
    Polygon polygon;
    for (int i = 0; i < corners / 3; ++i) {
      const double a = 6 * std::numbers::pi * i / corners, b = 6 * std::numbers::pi * (i + 0.5) / corners;
      polygon.push_back({0, 0, 0});
      for (const double angle : {a, b}) polygon.push_back({float(1000 * std::cos(angle)), float(1000 * std::sin(angle)), 0});
    }
    return polygon;
  };
  EXPECT_EQ(cut(petals(9'000)).triangles.size(), 3'000U);
  expectInProportion(3'000, petals);
}

// A bridge to a hole is passed twice, once in each direction: the hole stays open.
TEST(Triangulate, LeavesTheHoleOfABridgedPolygonOpen) {
  if (!hasDelaunayPolygon()) GTEST_SKIP() << "built without CGAL";
  Polygon polygon = straightSides({{0, 0}, {9, 0}, {9, 9}, {0, 9}}, 100);
  const Polygon hole = straightSides({{3, 3}, {3, 6}, {6, 6}, {6, 3}}, 100);
  polygon.push_back(polygon.front());
  polygon.insert(polygon.end(), hole.begin(), hole.end());
  polygon.push_back(hole.front());
  expectExactCut(polygon, "bridged");
  EXPECT_NEAR(areaOf(polygon), 72 * 100 * 100, 1e-6);
}

// A polygon that crosses itself, runs twice around, or is a line: a fan, which says so.
TEST(Triangulate, MakesAFanWherePolygonsCrossThemselves) {
  if (!hasDelaunayPolygon()) GTEST_SKIP() << "built without CGAL";
  Polygon star, twice, line;
  for (int i = 0; i < 1001; ++i) {
    const double angle = 2 * std::numbers::pi * 2 * i / 1001;
    star.push_back({float(std::cos(angle)), float(std::sin(angle)), 0});
    line.push_back({float(i), 0, 0});
  }
  const Polygon once = straightSides({{0, 0}, {1, 0}, {0, 1}}, 200);
  for (int i = 0; i < 2; ++i) twice.insert(twice.end(), once.begin(), once.end());
  for (const Polygon& polygon : {star, twice, line}) {
    const Cut result = cut(polygon);
    EXPECT_FALSE(result.simple);
    EXPECT_EQ(result.triangles.size(), polygon.size() - 2);
  }
}

TEST(Triangulate, GivesTheSameTrianglesEachTime) { EXPECT_EQ(cut(comb(2'000)).triangles, cut(comb(2'000)).triangles); }

// Without CGAL, time bounds what is cut.
TEST(Triangulate, RefusesWhatTakesTooLongWithoutCgal) {
  if (hasDelaunayPolygon()) GTEST_SKIP() << "built with CGAL";
  expectExactCut(comb(200), "comb");
  try {
    cut(comb(2'000));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.message.find("8002 corners"), std::string::npos) << error.message;
  }
}

}  // namespace cloudbake
