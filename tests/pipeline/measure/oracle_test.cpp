// The truth that bakes are measured against, itself held to the ball.
#include "pipeline/measure/oracle.h"

#include <cmath>

#include "bake/lobe/sweep.h"
#include "core/lobe_lighting.h"
#include "core/ray_scene.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

const Cloud& fineBall() {
  static const Cloud cloud = cloudOf(ballMesh(1, 4));
  return cloud;
}

TEST(Oracle, KnowsTheBall) {
  const Oracle oracle = askOracle(fineBall(), {}, 20, {1.5F, {}, 4});
  ASSERT_EQ(oracle.vertices, evenlySpread(fineBall().surface.positions.size(), 20));
  EXPECT_TRUE(contains(oracle.name, RayScene::kName));
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  EXPECT_EQ(oracle.axes, sweepAxes(512));
  ASSERT_EQ(oracle.lengths.size(), 20U * 512);
  double squares = 0;
  for (size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(oracle.positions[i], fineBall().surface.positions[oracle.vertices[i]]);
    const Lobe exact = ballLobe(oracle.positions[i], {}, 1);
    EXPECT_LT(angleDegrees(oracle.truth.lobes[i].direction, exact.direction), 0.5);
    EXPECT_NEAR(oracle.truth.lobes[i].thickness, 2, 0.02);
    EXPECT_NEAR(oracle.truth.concentration[i], 0.75, 0.01) << "m / sum of squares over a half sphere: 3/4";
    for (size_t j = 0; j < directions.size(); ++j)
      squares += std::pow(oracle.lengths[i * 512 + j] - std::max(0.0F, -2 * dot(oracle.positions[i], directions[j])), 2);
  }
  EXPECT_LT(std::sqrt(squares / double(oracle.lengths.size())), 0.02) << "the mesh lies a little within the ball";
}

TEST(Oracle, RaysAreNoLongerThanTheBakes) {
  const Oracle oracle = askOracle(fineBall(), {}, 5, {1, {}, 0.5});
  for (const float length : oracle.lengths) ASSERT_LE(length, 0.5F + 1e-5F);
  for (const Lobe& lobe : oracle.truth.lobes) EXPECT_NEAR(lobe.thickness, 0.5F, 1e-4F);
}

TEST(Oracle, LightsMayBeGiven) {
  const std::vector<Vec3> axes{{0, 1, 0}, {1, 0, 0}};
  const Oracle oracle = askOracle(fineBall(), {}, 3, {1, {}, 4, axes});
  EXPECT_EQ(oracle.axes, axes);
  EXPECT_EQ(oracle.lengths.size(), 3U * 4);
}

// Positions beyond those that triangles use cost next to nothing, so that the limits show.
TEST(Oracle, HowManyVerticesUnlessTold) {
  Cloud closed = cloudOf(boxMesh({0, 0, 0}, {1, 1, 1}));
  for (int i = 0; i < 2500; ++i) closed.surface.positions.push_back({3, float(i), 0});
  EXPECT_EQ(askOracle(closed, {}, {}, {1, {}, 0.001, {{0, 1, 0}}}).vertices.size(), 2000U);
  Cloud open = closed;
  open.surface.triangles.pop_back();
  open.closed = false;
  Warnings warnings;
  open.level_set = levelSetOf(cloudOf(ballMesh(1, 1)), settingsFor({"voxels=8"}).field, Lattice::kSurface, warnings);
  EXPECT_EQ(askOracle(open, {}, {}, {1, {}, 0.001, {{0, 1, 0}}}).vertices.size(), 200U) << "a march is slow";
}

// Of a volume: another light, at the vertices that are seen.
TEST(Oracle, JudgesByAVolume) {
  Cloud cloud = fineBall();
  cloud.surface.positions[0] = {0, 0, 0};  // a vertex in the middle, where no view comes
  const Oracle oracle = askOracle(cloud, {}, 20, {3.5F, VolumeLight{}, 4}), other = askOracle(fineBall(), {}, 20, {3.5F, {}, 4});
  EXPECT_TRUE(contains(oracle.name, "march"));
  ASSERT_EQ(oracle.vertices.size(), 19U);
  EXPECT_EQ(oracle.vertices.front(), other.vertices[1]);
  EXPECT_EQ(oracle.positions.size(), 19U);
  EXPECT_EQ(oracle.truth.lobes.size(), 19U);
  EXPECT_EQ(oracle.truth.concentration.size(), 19U);
  EXPECT_EQ(oracle.axes, sweepAxes(64));
  EXPECT_EQ(oracle.lengths.size(), 19U * 64);
  ASSERT_EQ(oracle.light.size(), 19U * 64);
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  for (size_t i = 0; i < 19; ++i)
    for (size_t j = 0; j < 64; ++j)
      if (const float cosine = dot(oracle.positions[i], directions[j]); std::fabs(cosine) > 0.8F) {
        ASSERT_EQ(oracle.light[i * 64 + j] > 0.45F, cosine > 0) << cosine;
        ASSERT_LT(oracle.light[i * 64 + j], 0.75F);
      }
}

// Figures are of the vertices that were asked for, out of the lobes of all.
TEST(Oracle, FiguresOfLobesThatAreOffByAKnownAmount) {
  const Oracle oracle = askOracle(fineBall(), {}, 20, {3.5F, {}, 4});
  std::vector<Lobe> lobes(fineBall().surface.positions.size(), Lobe{{0, 1, 0}, 100});
  for (size_t i = 0; i < oracle.vertices.size(); ++i) lobes[oracle.vertices[i]] = oracle.truth.lobes[i];
  const LobeShape shape{3, -0.006F};
  const BakeFigures exact = figuresAgainst(oracle, lobes, false, shape, 3.5F);
  EXPECT_EQ(exact.vertices, 20U);
  EXPECT_EQ(exact.truth, oracle.name);
  EXPECT_NEAR(exact.lobe.angle_rms_degrees, 0, 1e-3);
  EXPECT_NEAR(exact.lobe.density_rms, 0, 1e-6);
  double squares = 0;
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  for (size_t i = 0; i < 20; ++i)
    for (size_t j = 0; j < directions.size(); ++j)
      squares +=
          std::pow(lobeTransmittance(oracle.truth.lobes[i], directions[j], shape, 3.5F) - std::exp(-3.5 * oracle.lengths[i * 512 + j]), 2);
  EXPECT_NEAR(exact.transmittance.rms, std::sqrt(squares / (20 * 512)), 1e-5);

  for (const size_t v : oracle.vertices) lobes[v].thickness *= 1.1F;
  const BakeFigures thicker = figuresAgainst(oracle, lobes, true, shape, 3.5F);
  EXPECT_TRUE(thicker.is_fit && !exact.is_fit);
  EXPECT_NEAR(thicker.lobe.density_bias, 0.1, 1e-4);
  EXPECT_NEAR(thicker.lobe.density_rms, 0.1, 1e-3);
}

// The same lobe everywhere is the same between the vertices; its error there is known on a ball.
TEST(Oracle, JudgesTheSurfaceBetweenTheVertices) {
  const Oracle oracle = askOracle(fineBall(), {}, 300, {.extinction = 3.5F, .ray_length = 4, .over_surface = true});
  ASSERT_EQ(oracle.surface.points.size(), 300U);
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  ASSERT_EQ(oracle.surface.light.size(), 300U * directions.size());
  const std::vector<Lobe> lobes(fineBall().surface.positions.size(), Lobe{{0, 1, 0}, 1});
  const BakeFigures figures = figuresAgainst(oracle, lobes, false, {3, 0}, 3.5F);
  double squares = 0;
  for (const SurfacePoint& point : oracle.surface.points)
    for (const Vec3 direction : directions) {
      const double chord = std::max(0.0F, -2 * dot(valueAt(point, fineBall().surface.positions), direction));
      squares += std::pow(lobeTransmittance(lobes[0], direction, {3, 0}, 3.5F) - std::exp(-3.5 * chord), 2);
    }
  const double exact = std::sqrt(squares / double(oracle.surface.light.size()));
  EXPECT_EQ(figures.surface.points, 300U);
  EXPECT_NEAR(figures.surface.per_pixel.rms, exact, 0.01);
  EXPECT_NEAR(figures.surface.per_vertex.rms, figures.surface.per_pixel.rms, 1e-6);
}

TEST(Oracle, LeavesOutPlacesThatNoViewSees) {
  const SurfaceMesh outer = ballMesh(1, 2), inner = ballMesh(0.5F, 2);
  const Oracle asked = askOracle(cloudOf(merged(outer, inner)), {}, 100,
                                 {.extinction = 3.5F, .volume = VolumeLight{}, .ray_length = 4, .over_surface = true});
  const SurfaceOracle& oracle = asked.surface;
  EXPECT_NEAR(double(oracle.points.size()), 80, 2) << "a fifth of the area is inside";
  EXPECT_EQ(oracle.light.size(), oracle.points.size() * 64);
  for (const SurfacePoint& point : oracle.points) EXPECT_LT(point.corners[0], outer.positions.size());
}

}  // namespace
}  // namespace cloudbake
