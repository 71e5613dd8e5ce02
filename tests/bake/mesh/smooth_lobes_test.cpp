#include "bake/mesh/smooth_lobes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <random>

#include "bake/lobe/directions.h"
#include "core/lobe_lighting.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

using Bits = std::array<uint32_t, 4>;

std::vector<Bits> bitsOf(const std::vector<Lobe>& lobes) {
  std::vector<Bits> bits;
  for (const Lobe& lobe : lobes) bits.push_back(std::bit_cast<Bits>(lobe));
  return bits;
}

std::vector<Lobe> smoothed(std::vector<Lobe> lobes, const SurfaceMesh& mesh, int passes) {
  smoothLobes(lobes, mesh, passes);
  return lobes;
}

std::vector<Lobe> ballLobes(const SurfaceMesh& ball) {
  std::vector<Lobe> lobes;
  for (const Vec3& p : ball.positions) lobes.push_back(ballLobe(p, {}, 1));
  return lobes;
}

// Each direction moved by normal noise of `sigma` per component, each density by as much of itself.
std::vector<Lobe> noisy(std::vector<Lobe> lobes, float sigma) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal(0, sigma);
  for (Lobe& lobe : lobes) {
    lobe.direction = *normalized(lobe.direction + Vec3{normal(random), normal(random), normal(random)});
    lobe.thickness *= 1 + normal(random);
  }
  return lobes;
}

struct Spread {
  double direction_degrees = 0, thickness = 0;  // rms
};
Spread spreadOf(const std::vector<Lobe>& lobes, const std::vector<Lobe>& truth) {
  Spread sum;
  for (size_t v = 0; v < lobes.size(); ++v) {
    const double angle = angleDegrees(lobes[v].direction, truth[v].direction), density = lobes[v].thickness - truth[v].thickness;
    sum.direction_degrees += angle * angle;
    sum.thickness += density * density;
  }
  return {std::sqrt(sum.direction_degrees / double(lobes.size())), std::sqrt(sum.thickness / double(lobes.size()))};
}

// One triangle: every vertex is the others' neighbour.
SurfaceMesh oneTriangle() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 1, 2}}}; }

// Random places of vertices and triangles, and random first corners.
struct Shuffled {
  SurfaceMesh mesh;
  std::vector<Lobe> lobes;
  std::vector<uint32_t> from;  // where a vertex was
};
Shuffled shuffled(const SurfaceMesh& mesh, const std::vector<Lobe>& lobes, unsigned seed) {
  std::mt19937 random(seed);
  Shuffled result;
  result.from.resize(lobes.size());
  std::iota(result.from.begin(), result.from.end(), 0U);
  std::shuffle(result.from.begin(), result.from.end(), random);
  std::vector<uint32_t> to(lobes.size());
  for (uint32_t v = 0; v < result.from.size(); ++v) {
    to[result.from[v]] = v;
    result.mesh.positions.push_back(mesh.positions[result.from[v]]);
    result.lobes.push_back(lobes[result.from[v]]);
  }
  for (Triangle t : mesh.triangles) {
    std::rotate(t.begin(), t.begin() + random() % 3, t.end());
    result.mesh.triangles.push_back({to[t[0]], to[t[1]], to[t[2]]});
  }
  std::shuffle(result.mesh.triangles.begin(), result.mesh.triangles.end(), random);
  return result;
}

// Every triangle with corners of its own, as at a UV seam along every edge.
SurfaceMesh splitEverywhere(const SurfaceMesh& mesh, std::vector<uint32_t>& from) {
  SurfaceMesh split;
  for (const Triangle& t : mesh.triangles) {
    const auto first = uint32_t(split.positions.size());
    for (const uint32_t v : t) split.positions.push_back(mesh.positions[v]), from.push_back(v);
    split.triangles.push_back({first, first + 1, first + 2});
  }
  return split;
}

}  // namespace

// Also at a vertex with so many neighbours that sums of products would round.
TEST(SmoothLobes, ConstantFieldKeepsItsBits) {
  SurfaceMesh fan;
  fan.positions = {{0, 0, 0}};
  for (uint32_t k = 0; k < 101; ++k) {
    fan.positions.push_back({std::cos(0.06F * float(k)), std::sin(0.06F * float(k)), 0});
    if (k > 0) fan.triangles.push_back({0, k, k + 1});
  }
  for (const SurfaceMesh& mesh : {fan, ballMesh(1, 2)})
    for (const Vec3 direction : {Vec3{0.3F, -0.7F, 0.2F}, Vec3{1, 1e-3F, -0.0F}, Vec3{-0.111F, 0.59F, 7}})
      for (const int passes : {1, 10}) {
        const std::vector<Lobe> lobes(mesh.positions.size(), Lobe{*normalized(direction), 1.2345678F});
        EXPECT_EQ(bitsOf(smoothed(lobes, mesh, passes)), bitsOf(lobes));
      }
}

TEST(SmoothLobes, NoPassesChangeNothing) {
  std::vector<uint32_t> from;
  const SurfaceMesh split = splitEverywhere(ballMesh(1, 2), from);
  const std::vector<Lobe> lobes = noisy(ballLobes(split), 0.2F);
  EXPECT_EQ(bitsOf(smoothed(lobes, split, 0)), bitsOf(lobes));
}

// On a ball d = 2R is constant, and rings are nearly regular: o turns by less than a fifteenth of an edge's angle in one pass, three tenths
// in ten.
TEST(SmoothLobes, BallHardlyChanges) {
  for (int level = 2; level <= 5; ++level)
    for (const auto& [passes, edges] : {std::pair(1, 1.0 / 15), std::pair(10, 0.3)}) {
      const SurfaceMesh ball = ballMesh(1, level);
      const std::vector<Lobe> lobes = ballLobes(ball), result = smoothed(lobes, ball, passes);
      const double edge_degrees = 63.43 / double(1 << level);
      double worst = 0;
      for (size_t v = 0; v < lobes.size(); ++v) {
        worst = std::max(worst, angleDegrees(result[v].direction, lobes[v].direction));
        EXPECT_EQ(result[v].thickness, 2.0F);
      }
      EXPECT_LT(worst, edges * edge_degrees) << level << " " << passes;
    }
}

// λ = 1/2 leaves 1/4 + 1/4 · 1/6 of the variance of independent noise where a vertex has six neighbours.
TEST(SmoothLobes, OnePassReducesNoiseAsDerived) {
  const SurfaceMesh ball = ballMesh(1, 5);
  const std::vector<Lobe> truth = ballLobes(ball), lobes = noisy(truth, 0.02F);
  const Spread before = spreadOf(lobes, truth), after = spreadOf(smoothed(lobes, ball, 1), truth);
  const double expected = std::sqrt(0.25 + 0.25 / 6);
  EXPECT_NEAR(after.direction_degrees / before.direction_degrees, expected, 0.01);
  EXPECT_NEAR(after.thickness / before.thickness, expected, 0.01);
}

TEST(SmoothLobes, NoiseFallsWithEveryPass) {
  const SurfaceMesh ball = ballMesh(1, 4);
  const std::vector<Lobe> truth = ballLobes(ball), lobes = noisy(truth, 0.1F);
  Spread last = spreadOf(lobes, truth);
  for (int passes = 1; passes <= 20; ++passes) {
    const Spread now = spreadOf(smoothed(lobes, ball, passes), truth);
    EXPECT_LT(now.direction_degrees, last.direction_degrees) << passes;
    EXPECT_LT(now.thickness, last.thickness) << passes;
    last = now;
  }
}

// The sphere's integrals of s and of l s, of the result and of ½ s₀ + ¼ s₁ + ¼ s₂: the same total, and first moments that point one way.
TEST(SmoothLobes, MeansTheThicknessFunctions) {
  const std::vector<Lobe> lobes{{{1, 0, 0}, 1}, {{0, 1, 0}, 4}, {*normalized({0, 0.3F, 1}), 0.2F}};
  const Lobe result = smoothed(lobes, oneTriangle(), 1)[0];
  double total = 0, total_of_result = 0;
  Vec3 moment;
  for (const Vec3& l : fibonacciDirections(100'000)) {
    const auto s = [&](const Lobe& lobe) { return lobeThickness(lobe, l, {3, 0}); };
    const float mean = 0.5F * s(lobes[0]) + 0.25F * s(lobes[1]) + 0.25F * s(lobes[2]);
    total += mean, total_of_result += s(result);
    moment += l * mean;
  }
  EXPECT_NEAR(total_of_result / total, 1, 1e-5);
  EXPECT_LT(angleDegrees(result.direction, *normalized(moment)), 0.01);
}

// No density leaves the range of its ring, however odd the triangles.
TEST(SmoothLobes, DensitiesStayInRange) {
  const SurfaceMesh torus = torusMesh(1, 0.1F, 400, 5);
  std::vector<Lobe> lobes(torus.positions.size(), Lobe{{0, 1, 0}, 0});
  for (size_t v = 0; v < lobes.size(); v += 3) lobes[v].thickness = 1e-3F;
  for (const Lobe& lobe : smoothed(lobes, torus, 30)) {
    EXPECT_GE(lobe.thickness, 0);
    EXPECT_LE(lobe.thickness, 1e-3F);
    EXPECT_EQ(lobe.direction, (Vec3{0, 1, 0}));
  }
}

// A seam along every edge, one side of it with lobes of its own: copies end with one lobe.
TEST(SmoothLobes, SeamsStaySeamless) {
  const SurfaceMesh ball = ballMesh(1, 3);
  std::vector<uint32_t> from;
  const SurfaceMesh split = splitEverywhere(ball, from);
  const std::vector<Lobe> lobes = noisy(ballLobes(ball), 0.1F), other = noisy(ballLobes(ball), 0.3F);
  std::vector<Lobe> same, mixed;
  for (size_t v = 0; v < from.size(); ++v) {
    same.push_back(lobes[from[v]]);
    mixed.push_back(v % 2 ? lobes[from[v]] : other[from[v]]);
  }
  const auto whole = bitsOf(smoothed(lobes, ball, 3)), of_same = bitsOf(smoothed(same, split, 3)),
             of_mixed = bitsOf(smoothed(mixed, split, 3));
  std::vector<std::optional<Bits>> met(ball.positions.size());
  for (size_t v = 0; v < from.size(); ++v) {
    EXPECT_EQ(of_same[v], whole[from[v]]);
    EXPECT_EQ(of_mixed[v], met[from[v]].value_or(of_mixed[v]));
    met[from[v]] = of_mixed[v];
  }
}

// Two positions that differ by the sign of a zero are one, which has the mean of both lobes.
TEST(SmoothLobes, SignedZerosAreOnePlace) {
  const SurfaceMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0F, 0, -0.0F}, {1, 0, 0}, {0, 0, 1}}, {}, {{0, 1, 2}, {3, 5, 4}}};
  std::vector<Lobe> lobes(6, Lobe{{0, 0, 1}, 0});
  const float densities[] = {1, 2, 3, 7, 2, 5};
  for (size_t v = 0; v < 6; ++v) lobes[v].thickness = densities[v];
  const std::vector<Lobe> result = smoothed(lobes, mesh, 1);
  EXPECT_EQ(bitsOf(result)[0], bitsOf(result)[3]);
  EXPECT_FLOAT_EQ(result[0].thickness, 0.5F * (1 + 7) / 2 + 0.5F * (2 + 3 + 5) / 3);
}

// Seam copies that differ are there too, also where all have no thickness and one direction must be chosen.
TEST(SmoothLobes, OrderDoesNotMatter) {
  const SurfaceMesh ball = ballMesh(1, 3);
  std::vector<uint32_t> from;
  const SurfaceMesh split = merged(splitEverywhere(ball, from), ball);
  std::vector<Lobe> lobes;
  for (const uint32_t v : from) lobes.push_back(ballLobe(ball.positions[v], {}, 1));
  for (const Vec3& p : ball.positions) lobes.push_back(ballLobe(p, {}, 1));
  lobes = noisy(lobes, 0.2F);
  for (size_t v = 0; v < lobes.size(); ++v)
    if (split.positions[v].y > 0) lobes[v].thickness = 0;
  const auto expected = bitsOf(smoothed(lobes, split, 4));
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Shuffled other = shuffled(split, lobes, seed);
    const auto result = bitsOf(smoothed(other.lobes, other.mesh, 4));
    for (size_t v = 0; v < result.size(); ++v) ASSERT_EQ(result[v], expected[other.from[v]]) << seed;
  }
}

TEST(SmoothLobes, ThreadsDoNotMatter) {
  const SurfaceMesh ball = ballMesh(1, 5);
  const std::vector<Lobe> lobes = noisy(ballLobes(ball), 0.1F);
  std::vector<Bits> expected;
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const auto result = bitsOf(smoothed(lobes, ball, 5));
    if (expected.empty()) expected = result;
    EXPECT_EQ(result, expected) << threads;
  }
}

// A third face on an edge and a face twice make no neighbour count more; a triangle without area joins its two places.
TEST(SmoothLobes, EachNeighbourCountsOnce) {
  SurfaceMesh mesh{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {2, 2, 2}}, {}, {{0, 1, 2}, {0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {0, 0, 5}}};
  std::vector<Lobe> lobes(6, Lobe{{0, 0, 1}, 0});
  lobes[1].thickness = 1;
  EXPECT_FLOAT_EQ(smoothed(lobes, mesh, 1)[0].thickness, 0.5F / 5);
}

// A border's vertex has the neighbours that it has; one that no triangle uses keeps its bits, and so does a triangle's that is one point.
TEST(SmoothLobes, OpenMeshAndLonelyVertices) {
  SurfaceMesh mesh{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {5, 5, 5}, {6, 6, 6}}, {}, {{0, 1, 2}, {0, 2, 3}, {5, 5, 5}}};
  const Lobe lonely{*normalized({0.1F, 0.7F, 0.3F}), 9.87654F};
  const std::vector<Lobe> lobes{{{0, 0, 1}, 1}, {{0, 0, 1}, 2}, {{0, 0, 1}, 3}, {{0, 0, 1}, 4}, lonely, lonely};
  const std::vector<Lobe> result = smoothed(lobes, mesh, 1);
  EXPECT_FLOAT_EQ(result[0].thickness, 0.5F + 0.5F * 3);
  EXPECT_FLOAT_EQ(result[1].thickness, 1 + 0.5F * 2);
  EXPECT_FLOAT_EQ(result[3].thickness, 2 + 0.5F * 2);
  EXPECT_EQ(bitsOf(result)[4], bitsOf(lobes)[4]);
  EXPECT_EQ(bitsOf(result)[5], bitsOf(lobes)[4]);
}

// What cancels keeps its direction, exact or but for rounding, at any size; the density is the mean all the same.
TEST(SmoothLobes, OpposingDirectionsKeepTheOldOne) {
  for (const float size : {1e-12F, 1.0F, 1e12F}) {
    const Vec3 o = *normalized({0.6F, -0.3F, 0.2F});
    const std::vector<Lobe> result = smoothed({{o, 3 * size}, {-o, 2 * size}, {-o, 4 * size}}, oneTriangle(), 1);
    EXPECT_EQ(result[0].direction, o);
    EXPECT_FLOAT_EQ(result[0].thickness, 3 * size);
    EXPECT_LT(angleDegrees(result[2].direction, -o), 1e-4);
  }
  const Vec3 a = *normalized({0.6F, -0.3F, 0.2F}), side = frameAround(a).tangent * std::sqrt(0.75F);
  EXPECT_EQ(smoothed({{a, 1}, {-0.5F * a + side, 2}, {-0.5F * a - side * 1.0000001F, 2}}, oneTriangle(), 1)[0].direction, a);
}

// A vertex without thickness takes its neighbours' direction and adds none to theirs.
TEST(SmoothLobes, DirectionsCountByDensity) {
  const std::vector<Lobe> result = smoothed({{{1, 0, 0}, 0}, {{0, 1, 0}, 1}, {{0, 1, 0}, 1}}, oneTriangle(), 1);
  for (const Lobe& lobe : result) EXPECT_EQ(lobe.direction, (Vec3{0, 1, 0}));
}
