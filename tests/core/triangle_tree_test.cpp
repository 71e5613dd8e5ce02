// Against the arithmetic of one triangle after the other, on meshes that are hard for a tree, and on lines through every corner and edge.
#include "core/triangle_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/parallel.h"
#include "core/random.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

class Draws {
 public:
  explicit Draws(uint32_t seed) : seed_(seed) {}
  float one() { return uniformFloat(hashDraw(seed_, next_++, 0)); }
  Vec3 point() { return {one() - 0.5F, one() - 0.5F, one() - 0.5F}; }
  Vec3 direction() {
    for (;;)
      if (const auto unit = normalized(point())) return *unit;
  }

 private:
  uint32_t seed_, next_ = 0;
};

std::vector<RayHit> hitsOf(const TriangleTree& tree, const Ray& ray) {
  std::vector<RayHit> hits;
  tree.forHits(ray, [&](const RayHit& hit) { hits.push_back(hit); });
  std::sort(hits.begin(), hits.end(), [](const RayHit& a, const RayHit& b) { return a.triangle < b.triangle; });
  return hits;
}

// Where a ray meets a triangle (Möller and Trumbore 1997), in double. `doubt` is true if it passes very near an edge, or begins very near
// the plane.
std::optional<RayHit> plainHit(const SurfaceMesh& mesh, uint32_t index, const Ray& ray, bool& doubt) {
  struct Wide {
    double x, y, z;
  };
  const auto minus = [](Vec3 a, Vec3 b) { return Wide{double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z}; };
  const auto triple = [](Wide u, Wide v, Wide w) {
    return u.x * (v.y * w.z - v.z * w.y) + u.y * (v.z * w.x - v.x * w.z) + u.z * (v.x * w.y - v.y * w.x);
  };
  const auto& [ia, ib, ic] = mesh.triangles[index];
  const Vec3 a = mesh.positions[ia];
  const Wide e = minus(mesh.positions[ib], a), f = minus(mesh.positions[ic], a), s = minus(ray.origin, a), d = minus(ray.direction, {});
  const double determinant = triple(e, f, d);  // that of n·ω
  const double u = triple(s, f, d) / determinant, v = triple(e, s, d) / determinant, t = -triple(e, f, s) / determinant;
  if (!std::isfinite(t)) return std::nullopt;
  const double least = std::min({u, v, 1 - u - v});
  doubt = doubt || std::abs(least) < 1e-4 + 1e-6 / std::abs(determinant) || (least > 0 && std::abs(t) < 1e-4);
  if (least < 0 || t < 0) return std::nullopt;
  return RayHit{float(t), determinant > 0 ? 1 : -1, index};
}

TEST(TriangleTree, MeetsWhatEveryTriangleAloneMeets) {
  Draws draws(1);
  SurfaceMesh soup;
  for (uint32_t i = 0; i < 600; ++i) {
    const Vec3 at = draws.point();
    const float size = i % 50 == 0 ? 1.0F : 0.2F;
    for (int corner = 0; corner < 3; ++corner) soup.positions.push_back(at + size * draws.point());
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const TriangleTree tree(soup.positions, soup.triangles);
  size_t compared = 0, met = 0;
  for (int i = 0; i < 3000; ++i) {
    const Ray ray{draws.point() * (i % 3 == 0 ? 20.0F : 1.0F), draws.direction()};
    bool doubt = false;
    std::vector<RayHit> expected;
    for (uint32_t triangle = 0; triangle < soup.triangles.size(); ++triangle)
      if (const auto hit = plainHit(soup, triangle, ray, doubt)) expected.push_back(*hit);
    if (doubt) continue;
    const std::vector<RayHit> hits = hitsOf(tree, ray);
    ++compared, met += hits.size();
    ASSERT_EQ(hits.size(), expected.size()) << i;
    for (size_t k = 0; k < hits.size(); ++k) {
      EXPECT_EQ(hits[k].triangle, expected[k].triangle);
      EXPECT_EQ(hits[k].sign, expected[k].sign);
      EXPECT_NEAR(hits[k].t, expected[k].t, 1e-4F);
    }
  }
  EXPECT_GT(compared, 500U);
  EXPECT_GT(met, 1000U);
}

TEST(TriangleTree, RaysTogetherMeetWhatEachMeetsAlone) {
  const SurfaceMesh mesh = merged(ballMesh(0.5F, 3), torusMesh(0.5F, 0.2F, 40, 20));
  const TriangleTree tree(mesh.positions, mesh.triangles);
  Draws draws(2);
  for (size_t count = 0; count <= kRaysTogether; ++count) {
    const Vec3 origin = draws.point();
    std::vector<Vec3> directions;
    for (size_t i = 0; i < count; ++i) directions.push_back(draws.direction());
    if (count > 3) directions[1] = {NAN, 0, 0}, directions[2] = {};
    std::vector<std::vector<RayHit>> together(count);
    tree.addHits(origin, directions, together);
    for (size_t i = 0; i < count; ++i) {
      const std::vector<RayHit> alone = hitsOf(tree, {origin, directions[i]});
      std::sort(together[i].begin(), together[i].end(), [](const RayHit& a, const RayHit& b) { return a.triangle < b.triangle; });
      ASSERT_EQ(together[i].size(), alone.size()) << i;
      EXPECT_FALSE(count > 3 && (i == 1 || i == 2) && !alone.empty());
      for (size_t k = 0; k < alone.size(); ++k)
        EXPECT_TRUE(together[i][k].triangle == alone[k].triangle && together[i][k].t == alone[k].t && together[i][k].sign == alone[k].sign);
    }
  }
  std::vector<std::vector<RayHit>> hits(kRaysTogether + 1);
  EXPECT_THROW(tree.addHits({}, std::vector<Vec3>(kRaysTogether + 1, {1, 0, 0}), hits), std::invalid_argument);
}

// Signs of the crossings of a line, from its beginning on.
std::vector<int> signsAlong(const TriangleTree& tree, const Ray& ray) {
  std::vector<RayHit> hits = hitsOf(tree, ray);
  std::sort(hits.begin(), hits.end(), [](const RayHit& a, const RayHit& b) { return a.t < b.t; });
  std::vector<int> signs;
  for (const RayHit& hit : hits) signs.push_back(hit.sign);
  return signs;
}

std::vector<Vec3> cornersAndEdges(const SurfaceMesh& mesh) {
  std::vector<Vec3> places = mesh.positions;
  for (const auto& [a, b, c] : mesh.triangles)
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      places.push_back(0.5F * (mesh.positions[from] + mesh.positions[to]));
      places.push_back(mesh.positions[from] + 0.3F * (mesh.positions[to] - mesh.positions[from]));
    }
  return places;
}

// From inside a ball each line leaves once, from outside it enters and leaves or passes by: whatever corner or edge it goes through.
TEST(TriangleTree, NoRaySlipsThroughACornerOrAnEdge) {
  const SurfaceMesh ball = ballMesh(0.5F, 3);
  const TriangleTree tree(ball.positions, ball.triangles);
  Draws draws(3);
  std::vector<Vec3> origins{{}, {0.1F, 0, 0}, {2, 0, 0}, {0, -3, 0}, {100, 30, -20}};
  for (int i = 0; i < 4; ++i) origins.push_back(0.4F * draws.point()), origins.push_back(3.0F * draws.direction());
  size_t through = 0;
  for (const Vec3& origin : origins)
    for (const Vec3& place : cornersAndEdges(ball)) {
      const std::vector<int> signs = signsAlong(tree, {origin, *normalized(place - origin)});
      if (length(origin) < 0.45F) {
        ASSERT_EQ(signs, std::vector<int>{1});
      } else {
        ASSERT_TRUE(signs.empty() || (signs.size() == 2 && signs[0] + signs[1] == 0));
        through += !signs.empty();
      }
    }
  EXPECT_GT(through, 10000U);
}

// Along the axes every edge function of a cube of cubes is exactly 0 somewhere, and boxes are flat.
TEST(TriangleTree, AxialRaysThroughBoxes) {
  SurfaceMesh boxes;
  for (int i = 0; i < 27; ++i) {
    const int row = i / 3 % 3, layer = i / 9;
    const Vec3 low{float(i % 3), float(row), float(layer)};
    boxes = i == 0 ? boxMesh(low, low + Vec3{1, 1, 1}) : merged(boxes, boxMesh(low, low + Vec3{1, 1, 1}));
  }
  const TriangleTree tree(boxes.positions, boxes.triangles);
  for (int axis = 0; axis < 3; ++axis)
    for (const float sense : {-1.0F, 1.0F})
      for (int i = -1; i <= 7; ++i)
        for (int j = -1; j <= 7; ++j) {
          const float along = sense > 0 ? -1.0F : 4.0F, u = 0.5F * float(i), v = 0.5F * float(j);
          const Vec3 origin = axis == 0 ? Vec3{along, u, v} : axis == 1 ? Vec3{v, along, u} : Vec3{u, v, along};
          const Vec3 direction = axis == 0 ? Vec3{sense, 0, 0} : axis == 1 ? Vec3{0, sense, 0} : Vec3{0, 0, sense};
          const std::vector<int> signs = signsAlong(tree, {origin, direction});
          const bool inside = i > 0 && i < 6 && j > 0 && j < 6, outside = i < 0 || i > 6 || j < 0 || j > 6;
          EXPECT_EQ(std::accumulate(signs.begin(), signs.end(), 0), 0);
          // On the rim it depends on where the line is moved.
          EXPECT_TRUE((!inside && signs.empty()) || (!outside && signs.size() == 6)) << axis << " " << i << " " << j;
        }
}

// A wall of squares with flat boxes that end where the rays go, seen from near and far: each ray meets one triangle.
TEST(TriangleTree, NoRaySlipsBetweenBoxes) {
  constexpr int kSquares = 40;
  Draws draws(4);
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto turned = [axis](Vec3 v) { return axis == 0 ? v : axis == 1 ? Vec3{v.z, v.x, v.y} : Vec3{v.y, v.z, v.x}; };
    SurfaceMesh wall;
    for (int i = 0; i <= kSquares; ++i)
      for (int j = 0; j <= kSquares; ++j) wall.positions.push_back(turned({0.0137F * float(i) - 0.3F, 0.0171F * float(j) - 0.3F, 0.123F}));
    for (uint32_t i = 0; i < kSquares; ++i)
      for (uint32_t j = 0; j < kSquares; ++j) {
        const uint32_t low = i * (kSquares + 1) + j, high = low + kSquares + 1;
        wall.triangles.insert(wall.triangles.end(), {{low, high, high + 1}, {low, high + 1, low + 1}});
      }
    const TriangleTree tree(wall.positions, wall.triangles);
    for (int i = 0; i < 20000; ++i) {
      const auto inner = [&] { return 1 + uint32_t(draws.one() * float(kSquares - 1)); };
      const uint32_t at = inner() * (kSquares + 1) + inner();
      const Vec3 corner = wall.positions[at], next = wall.positions[i % 2 == 0 ? at - 1 : at - kSquares - 1];
      const Vec3 place = i % 3 == 0 ? corner : corner + draws.one() * (next - corner);
      Vec3 away = draws.point();
      if (i % 5 == 0) away = turned({0, 0, 1});
      if (i % 5 == 1) away = turned({draws.point().x, 0, 1});
      const Vec3 origin = place + (i % 2 == 0 ? 1.0F : 30.0F) * away;
      ASSERT_EQ(hitsOf(tree, {origin, *normalized(place - origin)}).size(), 1U) << axis << " " << i;
    }
  }
}

TEST(TriangleTree, NoneAndOne) {
  const TriangleTree none({}, {});
  EXPECT_TRUE(hitsOf(none, {{}, {1, 0, 0}}).empty());
  std::vector<std::vector<RayHit>> hits_of_none(1);
  none.addHits({}, std::vector<Vec3>{{1, 0, 0}}, hits_of_none);
  EXPECT_TRUE(hits_of_none[0].empty());
  none.forTrianglesNear({}, [](uint32_t, float radius) { return ADD_FAILURE(), radius; });

  const std::vector<Vec3> corners{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const std::vector<Triangle> triangle{{0, 1, 2}};
  const TriangleTree one(corners, triangle);
  const std::vector<RayHit> hits = hitsOf(one, {{0.25F, 0.25F, -1}, {0, 0, 0.5F}});
  ASSERT_EQ(hits.size(), 1U);
  EXPECT_EQ(hits[0].t, 4);  // in lengths of the direction
  EXPECT_EQ(hits[0].sign, 1);
  EXPECT_EQ(hitsOf(one, {{0.25F, 0.25F, 3}, {0, 0, -1}})[0].sign, -1);
  EXPECT_EQ(hitsOf(one, {{0.25F, 0.25F, 1}, {0, 0, -1}}).size(), 1U);  // begins on it
  EXPECT_TRUE(hitsOf(one, {{0.25F, 0.25F, 3}, {0, 0, 1}}).empty());
  EXPECT_TRUE(hitsOf(one, {{0.75F, 0.75F, -1}, {0, 0, 1}}).empty());
  EXPECT_TRUE(hitsOf(one, {{-1, 0.25F, 1}, {1, 0, 0}}).empty());  // in its plane
}

// Where nothing can be split by place, and where it can only be split unevenly.
TEST(TriangleTree, DegenerateMeshes) {
  constexpr uint32_t kMany = 20000;
  SurfaceMesh stack;
  for (uint32_t i = 0; i < kMany; ++i) {
    stack.positions.insert(stack.positions.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    stack.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const TriangleTree stacked(stack.positions, stack.triangles);
  EXPECT_EQ(hitsOf(stacked, {{0.2F, 0.2F, -1}, {0, 0, 1}}).size(), kMany);
  EXPECT_LE(stacked.depth(), 9U);

  SurfaceMesh flat;  // points, lines and slivers on a line
  for (uint32_t i = 0; i < kMany; ++i) {
    const Vec3 at{float(i) / kMany, 0, 0};
    flat.positions.insert(flat.positions.end(), {at, at, i % 2 == 0 ? at : at + Vec3{0, 1, 0}});
    flat.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const TriangleTree flattened(flat.positions, flat.triangles);
  for (const Vec3& direction : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) EXPECT_TRUE(hitsOf(flattened, {{}, direction}).empty());
  size_t looked_at = 0;
  uint32_t nearest = 0;
  flattened.forTrianglesNear({0.5F, -0.1F, 0}, [&](uint32_t triangle, float radius) {
    const float distance = length(flat.positions[3 * triangle] - Vec3{0.5F, -0.1F, 0});
    if (distance < radius) nearest = triangle;
    ++looked_at;
    return std::min(distance, radius);
  });
  EXPECT_EQ(nearest, kMany / 2);
  EXPECT_LT(looked_at, 100U);

  SurfaceMesh halving;  // each cut along an axis takes off a few at one end
  for (uint32_t i = 0; i < kMany; ++i) {
    const float size = std::ldexp(1.0F, -int(i % 120)), side = std::ldexp(1.0F, -int(i / 120 % 120));
    halving.positions.insert(halving.positions.end(), {{size, side, 0}, {size, side, size}, {size, 2 * side, 0}});
    halving.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_LE(TriangleTree(halving.positions, halving.triangles).depth(), TriangleTree::kMostDepth);
}

TEST(TriangleTree, WhatIsNotFiniteIsNeverMet) {
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 0}, {INFINITY, 1, 0}, {0, 1e19F, 0}, {0, 0, 1}};
  const std::vector<Triangle> triangles{{0, 1, 3}, {0, 1, 4}, {0, 1, 5}, {0, 1, 2}};
  const TriangleTree tree(corners, triangles);
  const std::vector<RayHit> hits = hitsOf(tree, {{0.2F, 0.2F, -1}, {0, 0, 1}});
  ASSERT_EQ(hits.size(), 1U);
  EXPECT_EQ(hits[0].triangle, 3U);
  std::set<uint32_t> near;
  tree.forTrianglesNear({}, [&](uint32_t triangle, float radius) { return near.insert(triangle), radius; });
  EXPECT_EQ(near, std::set<uint32_t>{3});
  for (const Ray& ray : {Ray{{NAN, 0, 0}, {0, 0, 1}}, Ray{{INFINITY, 0, 0}, {-1, 0, 0}}, Ray{{0.2F, 0.2F, -1}, {0, 0, NAN}}, Ray{{}, {}}})
    EXPECT_TRUE(hitsOf(tree, ray).empty());
}

// With the nearest corner as the distance, which is one of a triangle's box.
TEST(TriangleTree, FindsTheNearest) {
  const SurfaceMesh mesh = torusMesh(0.4F, 0.1F, 80, 40);
  const TriangleTree tree(mesh.positions, mesh.triangles);
  Draws draws(5);
  size_t looked_at = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 point = i < 10 ? mesh.positions[size_t(i)] : (i % 2 == 0 ? 1.0F : 5.0F) * draws.point();
    float expected = INFINITY, found = INFINITY;
    for (const Vec3& p : mesh.positions) expected = std::min(expected, length(p - point));
    tree.forTrianglesNear(point, [&](uint32_t triangle, float radius) {
      EXPECT_EQ(radius, found);
      for (const uint32_t v : mesh.triangles[triangle]) found = std::min(found, length(mesh.positions[v] - point));
      ++looked_at;
      return found;
    });
    EXPECT_EQ(found, expected);

    // All triangles of the ball, also those that only touch it.
    std::set<uint32_t> touched;
    tree.forTrianglesNear(point, [&](uint32_t triangle, float) { return touched.insert(triangle), expected; });
    for (uint32_t triangle = 0; triangle < mesh.triangles.size(); ++triangle)
      for (const uint32_t v : mesh.triangles[triangle])
        ASSERT_TRUE(touched.contains(triangle) || length(mesh.positions[v] - point) > expected);
  }
  EXPECT_LT(looked_at, 200 * mesh.triangles.size() / 20);
}

// Several tasks, whose nodes are joined.
TEST(TriangleTree, IsTheSameWithAnyNumberOfThreads) {
  const SurfaceMesh mesh = ballMesh(0.5F, 5);
  const auto hitsInOrder = [&](int threads) {
    const ThreadLimit limit(threads);
    const TriangleTree tree(mesh.positions, mesh.triangles);
    Draws draws(6);
    std::vector<uint32_t> order;
    for (int i = 0; i < 200; ++i)
      tree.forHits({draws.point(), draws.direction()}, [&](const RayHit& hit) { order.push_back(hit.triangle); });
    return order;
  };
  const std::vector<uint32_t> order = hitsInOrder(1);
  EXPECT_GT(order.size(), 100U);
  EXPECT_EQ(hitsInOrder(2), order);
  EXPECT_EQ(hitsInOrder(5), order);
}

}  // namespace
}  // namespace cloudbake
