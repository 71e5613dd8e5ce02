// The rasteriser against rays through the same places, which Embree finds.
#include "preview/mesh_clouds/raster.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/shapes.h"

namespace cloudbake {
namespace {

Affine movedBy(double x, double y, double z) {
  Affine m;
  m.offset = {x, y, z};
  return m;
}

struct Difference {
  int pixels = 0;          // that differ by more than rounding
  float largest_part = 0;  // of opacity
};

// A sample on an edge may be seen by one and not by the other: a 16th of a pixel.
Difference differenceToRays(std::span<const Instance> instances, const Camera& camera) {
  const LightSettings light = lightForSun(70, 20);
  const DepthRange range = defaultDepthRange(instances);
  const Image4 drawn = rasterChannels(placeMeshes(instances, light), camera, range);
  const Image4 rays = renderChannels(instances, camera, light, {.divisor = 1, .samples_per_side = 4, .depth_range = range});
  Difference difference;
  int covered = 0;
  for (size_t i = 0; i < drawn.pixels.size(); ++i) {
    const Rgba &a = drawn.pixels[i], &b = rays.pixels[i];
    covered += b[2] > 0;
    const bool same = std::abs(a[0] - b[0]) < 2e-3F && std::abs(a[1] - b[1]) < 2e-3F && a[2] == b[2] && std::abs(a[3] - b[3]) < 2e-3F;
    difference.pixels += !same;
    difference.largest_part = std::max(difference.largest_part, std::abs(a[2] - b[2]));
  }
  EXPECT_GT(covered, 100);
  return difference;
}

TEST(Raster, SeesWhatRaysSee) {
  const BakedMesh ball = bakedBall(1, {}, 4), small = bakedBall(0.4F, {}, 3);
  const Instance instances[] = {{&ball, {}}, {&small, movedBy(0.8, 0.3, 0.9)}, {&small, movedBy(-0.9, 0.2, -0.4)}};
  for (const Camera& camera : {Camera{{0, 0, 5}, {0, 0, 0}, 35, 161, 97}, Camera{{3, -2, 1}, {0.2F, 0, 0}, 60, 70, 130}}) {
    const Difference difference = differenceToRays(instances, camera);
    EXPECT_LE(difference.pixels, 5);
    EXPECT_LE(difference.largest_part, 1.5F / 16);
  }
}

// From within a ball, triangles lie before, beside and behind the camera, and some of them cross its plane.
TEST(Raster, TrianglesMayReachBehindTheCamera) {
  const BakedMesh ball = bakedBall(1, {}, 1);  // 80 large triangles
  const Instance instances[] = {{&ball, {}}};
  for (const Vec3 target : {Vec3{1, 0.2F, 0}, Vec3{0, -1, 0.3F}, Vec3{-0.5F, 0.5F, -0.7F}}) {
    const Camera camera{{0.1F, 0.2F, 0.05F}, target, 100, 90, 60};
    EXPECT_LE(differenceToRays(instances, camera).pixels, 3);
    const Image4 drawn = rasterChannels(placeMeshes(instances, lightForSun(0, 30)), camera, {0, 2});
    for (const Rgba& p : drawn.pixels) EXPECT_EQ(p[2], 1) << "the ball is closed around the camera";
  }
}

// No sample falls between triangles, however they lie: the disc of a ball has no hole, from any side.
TEST(Raster, ClosedSurfaceHasNoHoles) {
  const BakedMesh ball = bakedBall(1, {}, 5);
  const Instance instances[] = {{&ball, {}}};
  const LitMesh lit = placeMeshes(instances, lightForSun(0, 30));
  for (int i = 0; i < 6; ++i) {
    const Vec3 towards = directionFromAngles(float(i * 61), float(i * 29 - 80));
    const Camera camera{towards * 4, {}, 35, 100, 100};
    const Image4 drawn = rasterChannels(lit, camera, {2, 6});
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 100; ++x) {
        const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
        const Vec3 nearest = ray.origin - ray.direction * dot(ray.origin, ray.direction);
        if (length(nearest) > 0.95F && length(nearest) < 1.05F) continue;
        ASSERT_EQ(drawn.at(x, y)[2], length(nearest) < 1 ? 1 : 0) << i << ": " << x << ' ' << y;
      }
  }
}

// Two squares that face the camera, one a quarter into a pixel: their coverage is their area.
TEST(Raster, CoverageIsTheAreaThatIsCovered) {
  const auto square = [](float left, float right, float z) {
    BakedMesh mesh;
    mesh.surface.positions = {{left, -9, z}, {right, -9, z}, {right, 9, z}, {left, 9, z}};
    mesh.surface.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.lobes.assign(4, {{0, 1, 0}, 1});
    mesh.info.extinction = 1;
    return mesh;
  };
  // Eight pixels of the width 1 at the distance 4.
  const Camera camera{{0, 0, 4}, {0, 0, 0}, float(2 * std::atan(1.0) * 180 / kPi), 8, 8};
  const BakedMesh back = square(-3, 1.25F, 0), front = square(-2.625F, -0.875F, 0.5F);
  const Instance instances[] = {{&back, {}}, {&front, {}}};
  const Image4 drawn = rasterChannels(placeMeshes(instances, lightForSun(0, 30)), camera, {0, 8});
  for (int y = 0; y < 8; ++y) {
    EXPECT_EQ(drawn.at(0, y), kNoCloud);
    EXPECT_EQ(drawn.at(4, y)[2], 1);
    EXPECT_EQ(drawn.at(5, y)[2], 0.25F);
    EXPECT_EQ(drawn.at(6, y), kNoCloud);
    EXPECT_NEAR(drawn.at(1, y)[3], 3.5 / 8, 1e-6) << "the front square hides the back one";
    EXPECT_NEAR(drawn.at(4, y)[3], 4.0 / 8, 1e-6);
  }
}

TEST(Raster, NothingInViewIsNoCloud) {
  const BakedMesh ball = bakedBall(1, {}, 2);
  const Instance behind[] = {{&ball, movedBy(0, 0, 20)}}, aside[] = {{&ball, movedBy(30, 0, 0)}};
  const Camera camera{{0, 0, 5}, {0, 0, 0}, 35, 20, 20};
  for (const std::span<const Instance> instances : {std::span<const Instance>(behind), std::span<const Instance>(aside), {}})
    for (const Rgba& p : rasterChannels(placeMeshes(instances, lightForSun(0, 30)), camera, {0, 10}).pixels) EXPECT_EQ(p, kNoCloud);
}

TEST(Raster, SameBytesForAnyNumberOfThreads) {
  const BakedMesh ball = bakedBall(1, {}, 4);
  const Instance instances[] = {{&ball, {}}, {&ball, movedBy(0.5, 0.2, 0.3)}};
  const auto draw = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return rasterChannels(placeMeshes(instances, lightForSun(70, 20)), {{0, 0, 5}, {0, 0, 0}, 35, 150, 100}, {3, 7});
  };
  const Image4 one = draw(1);
  EXPECT_EQ(std::memcmp(one.pixels.data(), draw(5).pixels.data(), one.pixels.size() * sizeof(Rgba)), 0);
}

}  // namespace
}  // namespace cloudbake
