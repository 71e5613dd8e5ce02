#include "bake/lobe/volume_target.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "bake/field/coverage.h"
#include "bake/field/level_set.h"
#include "bake/lobe/directions.h"
#include "bake/lobe/sweep.h"
#include "bake/lobe/volume_lattice.h"
#include "bake/lobe/volume_samples.h"
#include "bake/mesh/mesh_topology.h"
#include "tests/bake/lobe_helpers.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

// ℓ in a ball of radius 1 from a point in or on it.
double lengthInBall(Vec3 p, Vec3 direction) {
  const double b = dot(p, direction), c = double(dot(p, p)) - 1;
  return std::max(0.0, -b + std::sqrt(std::max(0.0, b * b - c)));
}

// R of a point of that ball, by a sum over many views and depths with exact lengths.
double ballRadiance(Vec3 p, Vec3 to_light, double extinction, const VolumeLight& light) {
  constexpr int kSteps = 200;
  double sum = 0, opacities = 0;
  for (const Vec3& view : fibonacciDirections(600)) {
    const double area = -dot(p, view), chord = lengthInBall(p, view), view_extinction = extinction * light.view_extinction,
                 step = chord / kSteps;
    if (area <= 0) continue;
    for (int i = 0; i < kSteps; ++i) {
      const double t = (i + 0.5) * step;
      const double length = lengthInBall(p + view * float(t), to_light);
      double scattered = 0, weight = 1, weights = 0, factor = 1, g = light.asymmetry;
      for (int octave = 0; octave <= light.octaves.count; ++octave) {
        const double square = 1 + g * g - 2 * g * dot(view, to_light);
        scattered += weight * (1 - g * g) / std::pow(square, 1.5) * std::exp(-factor * extinction * length);
        weights += weight;
        weight *= light.octaves.contribution, factor *= light.octaves.extinction, g *= light.octaves.eccentricity;
      }
      sum += area * view_extinction * step * std::exp(-view_extinction * t) * scattered / weights;
    }
    opacities += area * (1 - std::exp(-view_extinction * chord));
  }
  return sum / opacities;
}

struct BallErrors {
  double rms = 0, bias = 0;
};

// Over 12 points of the ball and some lights.
BallErrors ballErrors(const VolumeTargetSettings& settings, int voxels = 60) {
  const SurfaceMesh ball = ballMesh(1, 4);
  const CoverageField field = coverageOf(ball, voxels);
  std::vector<Vec3> points;
  for (const Vec3& p : fibonacciDirections(12)) points.push_back(p);
  const std::vector<Vec3> axes = sweepAxes(16);
  const VolumeTarget target = volumeTarget({points, points}, axes, field, settings);
  EXPECT_EQ(target.unseen, 0U);
  BallErrors errors;
  for (size_t p = 0; p < points.size(); ++p)
    for (size_t s = 0; s < settings.extinctions.size(); ++s)
      for (size_t j = 0; j < 2 * axes.size(); ++j) {
        const double truth = ballRadiance(points[p], j % 2 ? -axes[j / 2] : axes[j / 2], settings.extinctions[s], settings.light);
        const double error = target.radiance[(p * settings.extinctions.size() + s) * 2 * axes.size() + j] - truth;
        errors.rms += error * error, errors.bias += error;
      }
  const auto count = double(target.radiance.size());
  return {std::sqrt(errors.rms / count), errors.bias / count};
}

TEST(VolumeTarget, OfABallIsItsIntegral) {
  const BallErrors single = ballErrors({{1.75F, 3.5F, 7}, {}, 4}), thin = ballErrors({{0.2F}, {}, 4}),
                   soft = ballErrors({{3.5F}, {0.5F, {6}, 0}, 4}), forward = ballErrors({{3.5F}, {1, {2, 0.6F, 0.4F, 0.7F}, 0.5F}, 4});
  for (const BallErrors& errors : {single, thin, soft, forward}) {
    std::printf("[figures] ball: rms %.4f, bias %+.4f\n", errors.rms, errors.bias);
    EXPECT_LT(errors.rms, 0.03);
    EXPECT_LT(std::fabs(errors.bias), 0.015);
  }
}

TEST(VolumeTarget, ConvergesInViewsAndDepths) {
  const auto rms = [](int views, int depths) { return ballErrors({{3.5F}, {}, 4, views, depths}, 100).rms; };
  const double coarse = rms(8, 12), middle = rms(32, 12), fine = rms(128, 12);
  std::printf("[figures] rms with 8, 32 and 128 views: %.4f, %.4f, %.4f\n", coarse, middle, fine);
  EXPECT_LT(middle, 0.6 * coarse);
  EXPECT_LT(fine, middle) << "what is left is the field's";
  const double one = rms(128, 1), three = rms(128, 3);
  std::printf("[figures] with 1, 3 and 12 depths: %.4f, %.4f, %.4f\n", one, three, fine);
  EXPECT_LT(three, 0.6 * one);
  EXPECT_LE(fine, three);
}

// Without extinction everything is lit, and every light is the same.
TEST(VolumeTarget, OfAClearCloudIsWhite) {
  const SurfaceMesh ball = ballMesh(1, 2);
  for (const float radiance : volumeTarget({ball.positions, ball.normals}, sweepAxes(8), coverageOf(ball, 30), {{1e-5F}, {}, 4}).radiance)
    ASSERT_NEAR(radiance, 1, 1e-3);
}

// The inner side of a hollow ball: no view from outside reaches it, and its light is that of the shell around it.
TEST(VolumeTarget, CountsVerticesThatNoViewSees) {
  SurfaceMesh inner = ballMesh(0.5F, 2);
  reverse(inner);
  const SurfaceMesh hollow = merged(ballMesh(1, 3), inner);
  const size_t outer = hollow.positions.size() - inner.positions.size();
  const VolumeTarget target = volumeTarget({hollow.positions, hollow.normals}, sweepAxes(8), coverageOf(hollow, 50), {{3}, {}, 4});
  EXPECT_EQ(target.unseen, inner.positions.size());
  for (size_t i = outer * 8; i < target.radiance.size(); ++i) {
    EXPECT_GT(target.radiance[i], 0.01F);
    EXPECT_LT(target.radiance[i], 0.6F);
  }
}

TEST(VolumeTarget, OfAPointWithoutCloudIsItsOwnLight) {
  const CoverageField empty{GridFrame{{0, 0, 0}, 0.1}, {-5, -5, -5}, {10, 10, 10}, std::vector<float>(1000, 0.0F)};
  const std::vector<Vec3> point{{0, 0, 0}}, up{{0, 1, 0}};
  const VolumeTarget target = volumeTarget({point, up}, sweepAxes(4), empty, {{1, 2}, {}, 4});
  EXPECT_EQ(target.unseen, 1U);
  EXPECT_EQ(target.radiance, std::vector<float>(8, 1.0F));
  // Many of them, so that a lattice is used
  const std::vector<Vec3> points(50, point[0]), normals(50, up[0]);
  const VolumeTarget many = volumeTarget({points, normals}, sweepAxes(4), empty, {{1, 2}, {}, 4, 32, 6, true});
  EXPECT_EQ(many.unseen, 50U);
  EXPECT_EQ(many.radiance, std::vector<float>(400, 1.0F));
}

// A sheet of half a cell: views pass, and both of its sides are seen.
TEST(VolumeTarget, OfASheetThinnerThanACell) {
  const SurfaceMesh sheet = boxMesh({-1, -0.01F, -1}, {1, 0.01F, 1});
  const std::vector<Vec3> points{{0.1F, 0.01F, 0.2F}, {0.1F, -0.01F, 0.2F}}, normals{{0, 1, 0}, {0, -1, 0}};
  const VolumeTarget target = volumeTarget({points, normals}, sweepAxes(8), coverageOf(sheet, 50), {{3.5F}, {}, 4});
  EXPECT_EQ(target.unseen, 0U);
  for (const float radiance : target.radiance) {
    EXPECT_GT(radiance, 0.3F);
    EXPECT_LE(radiance, 1.0F);
  }
}

TEST(VolumeTarget, PointsWithoutNormalsAreSeenFromAllSides) {
  const SurfaceMesh ball = ballMesh(1, 2);
  const CoverageField field = coverageOf(ball, 40);
  const std::vector<Vec3> axes = sweepAxes(8);
  const VolumeTargetSettings settings{{3.5F}, {}, 4};
  const std::vector<float> with = volumeTarget({ball.positions, ball.normals}, axes, field, settings).radiance,
                           without = volumeTarget({ball.positions, {}}, axes, field, settings).radiance;
  EXPECT_EQ(without, volumeTarget({ball.positions, std::vector<Vec3>(ball.positions.size())}, axes, field, settings).radiance);
  double difference = 0;
  for (size_t i = 0; i < with.size(); ++i) difference = std::max(difference, double(std::fabs(with[i] - without[i])));
  EXPECT_GT(difference, 0.01);
  EXPECT_LT(difference, 0.2);
}

TEST(VolumeTarget, TheTableOfDepthsIsNearlyExact) {
  const DepthNodes nodes({{1.75F, 3.5F, 7}, {}, 4, 16, 2});
  std::vector<float> depths(2), weights(6), quick_depths(2), quick_weights(6);
  float depth_error = 0, weight_error = 0;
  for (float length = 0.001F; length < 2 * nodes.enough(); length *= 1.01F) {
    ASSERT_TRUE(nodes.divide(length, 1, depths, weights) && nodes.divideQuickly(length, 1, quick_depths, quick_weights));
    for (size_t i = 0; i < 2; ++i) depth_error = std::max(depth_error, std::fabs(quick_depths[i] - depths[i]) / depths[i]);
    for (size_t i = 0; i < 6; ++i) weight_error = std::max(weight_error, std::fabs(quick_weights[i] - weights[i]));
  }
  std::printf("[figures] table: depths within %.4f of themselves, weights within %.4f\n", double(depth_error), double(weight_error));
  EXPECT_LT(weight_error, 0.003F);
  EXPECT_LT(depth_error, 0.05F);
  EXPECT_FALSE(nodes.divideQuickly(0, 1, quick_depths, quick_weights));
}

// The lattice is used for many points only, and then R is nearly the same. The two balls shade each other.
TEST(VolumeTarget, ALatticeIsNearlyAsGood) {
  SurfaceMesh ball = ballMesh(0.4F, 4);
  for (Vec3& p : ball.positions) p = p + Vec3{0.9F, 0.5F, 0};
  const SurfaceMesh mesh = merged(ballMesh(1, 5), ball);
  const CoverageField field = coverageOf(mesh, 80);
  const std::vector<Vec3> axes = sweepAxes(30), view_axes = sweepAxes(16);
  for (const VolumeLight& light : {VolumeLight{}, VolumeLight{0.5F, {6}, 0}, VolumeLight{1, {2, 0.6F, 0.4F, 0.7F}, 0.5F}}) {
    VolumeTargetSettings settings{{1.5F, 3, 6}, light, 4, 16, 2};
    const VolumeTarget exact = volumeTarget({mesh.positions, mesh.normals}, axes, field, settings);
    settings.may_interpolate = true;
    ASSERT_TRUE(lengthLattice(field, view_axes, axes, settings, mesh.positions.size() * 16));
    EXPECT_FALSE(lengthLattice(field, view_axes, axes, settings, 16)) << "one point";
    const VolumeTarget near = volumeTarget({mesh.positions, mesh.normals}, axes, field, settings);
    EXPECT_EQ(near.unseen, exact.unseen);
    double squares = 0, sum = 0;
    for (size_t i = 0; i < exact.radiance.size(); ++i) {
      const double error = double(near.radiance[i]) - double(exact.radiance[i]);
      squares += error * error, sum += error;
    }
    const auto count = double(exact.radiance.size());
    std::printf("[figures] lattice: rms %.4f, bias %+.4f\n", std::sqrt(squares / count), sum / count);
    EXPECT_LT(std::sqrt(squares / count), 0.02);
    EXPECT_LT(std::fabs(sum / count), 0.01);
  }
}

class VolumeTargetOfBothKinds : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(, VolumeTargetOfBothKinds, testing::Bool(), [](const auto& one) { return one.param ? "lattice" : "exact"; });

TEST_P(VolumeTargetOfBothKinds, SameBytesForAnyThreadsOrderScaleAndPlace) {
  const SurfaceMesh torus = torusMesh(1, 0.4F, 47, 31);  // more than one block of points
  const CoverageField field = coverageOf(torus, 40);
  const std::vector<Vec3> axes = sweepAxes(8);
  const VolumeTargetSettings settings{{2, 3.5F}, {1, {3}, 0}, 4, 16, 4, GetParam()};
  const auto targetWith = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return volumeTarget({torus.positions, torus.normals}, axes, field, settings).radiance;
  };
  const std::vector<float> expected = targetWith(1);
  for (const size_t threads : {2U, 7U}) EXPECT_TRUE(targetWith(threads) == expected) << threads;

  const size_t count = torus.positions.size(), row = expected.size() / count;
  std::vector<Vec3> positions(torus.positions.rbegin(), torus.positions.rend()), normals(torus.normals.rbegin(), torus.normals.rend());
  const std::vector<float> reversed = volumeTarget({positions, normals}, axes, field, settings).radiance;
  for (size_t v = 0; v < count; ++v)
    ASSERT_TRUE(std::equal(expected.begin() + ptrdiff_t(v * row), expected.begin() + ptrdiff_t((v + 1) * row),
                           reversed.begin() + ptrdiff_t((count - 1 - v) * row)))
        << v;

  SurfaceMesh large = torus;
  for (Vec3& p : large.positions) p = p * 4;
  EXPECT_TRUE(
      volumeTarget({large.positions, large.normals}, axes, coverageOf(large, 40), {{0.5F, 0.875F}, {1, {3}, 0}, 16, 16, 4, GetParam()})
          .radiance == expected);
  SurfaceMesh moved = torus;
  for (Vec3& p : moved.positions) p = p + Vec3{64, -16, 8};
  const std::vector<float> elsewhere = volumeTarget({moved.positions, moved.normals}, axes, coverageOf(moved, 40), settings).radiance;
  double squares = 0;
  for (size_t i = 0; i < expected.size(); ++i) squares += std::pow(elsewhere[i] - expected[i], 2);
  EXPECT_LT(std::sqrt(squares / double(expected.size())), 1e-3);
}

TEST(ScatteredLight, IsTheSumOfItsOctaves) {
  const std::vector<float> lengths{0, 0.1F, 1, 20, -0.01F};
  for (const OctaveSettings& octaves : {OctaveSettings{}, OctaveSettings{6}, OctaveSettings{3, 0.7F, 0.3F}, OctaveSettings{2, 0, 1}}) {
    const std::vector<float> light = scatteredLight(lengths, 2, octaves);
    for (size_t n = 0; n < lengths.size(); ++n) {
      double sum = 0, weights = 0;
      for (int i = 0; i <= octaves.count; ++i) {
        const double weight = std::pow(octaves.contribution, i);
        sum += weight * std::exp(-std::pow(octaves.extinction, i) * 2 * std::max(0.0F, lengths[n])), weights += weight;
      }
      EXPECT_NEAR(light[n], sum / weights, 2e-6) << octaves.count << " " << lengths[n];
    }
  }
}

}  // namespace
}  // namespace cloudbake
