// Places between vertices: spread by area, and the lobes that engines blend there.
#include "core/surface_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/lobe_lighting.h"
#include "core/lobe_packing.h"

namespace cloudbake {
namespace {

// Two triangles of areas 3 and 1, and one without an area between them.
SurfaceMesh unequal() {
  SurfaceMesh mesh;
  mesh.positions = {{0, 0, 0}, {6, 0, 0}, {0, 1, 0}, {0, 0, 5}, {2, 0, 5}, {0, 1, 5}};
  mesh.triangles = {{0, 1, 2}, {0, 0, 1}, {3, 4, 5}};
  return mesh;
}

TEST(SurfacePoints, AreSpreadByArea) {
  const std::vector<SurfacePoint> points = spreadOverSurface(unequal(), 1000);
  ASSERT_EQ(points.size(), 1000U);
  size_t on_first = 0;
  Vec3 mean;
  for (const SurfacePoint& point : points) {
    EXPECT_NE(point.corners[1], 0U) << "the flat triangle has no area";
    float sum = 0;
    for (const float weight : point.weights) {
      EXPECT_GE(weight, 0);
      sum += weight;
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    if (point.corners[0] != 0) continue;
    ++on_first;
    mean += valueAt(point, unequal().positions);
  }
  EXPECT_EQ(on_first, 750U);
  EXPECT_LT(length(mean / 750 - Vec3{2, 1.0F / 3, 0}), 0.01F) << "the mean is the centre";
}

TEST(SurfacePoints, AreNoneWithoutAnArea) {
  SurfaceMesh mesh = unequal();
  mesh.triangles = {{0, 0, 1}};
  EXPECT_TRUE(spreadOverSurface(mesh, 10).empty());
  EXPECT_TRUE(spreadOverSurface({}, 10).empty());
}

// Squares of these sizes are 0 or infinite in float.
TEST(SurfacePoints, SizesDoNotMatter) {
  const std::vector<SurfacePoint> points = spreadOverSurface(unequal(), 100);
  for (const int exponent : {-120, -70, 70, 120}) {
    SurfaceMesh mesh = unequal();
    for (Vec3& p : mesh.positions) p = p * std::ldexp(1.0F, exponent);
    const std::vector<SurfacePoint> scaled = spreadOverSurface(mesh, 100);
    ASSERT_EQ(scaled.size(), points.size()) << exponent;
    for (size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(scaled[i].corners, points[i].corners) << exponent;
      EXPECT_EQ(scaled[i].weights, points[i].weights) << exponent;
    }
  }
}

TEST(SurfacePoints, BlendTheFloats) {
  const Lobe lobes[] = {{{0, 0, 1}, 2}, {{1, 0, 0}, 4}, {{0, 1, 0}, 7}};
  const SurfacePoint corner{{2, 1, 0}, {1, 0, 0}}, middle{{0, 1, 2}, {0.5F, 0.5F, 0}};
  EXPECT_EQ(blendedLobe(corner, lobes).direction, lobes[2].direction);
  EXPECT_EQ(blendedLobe(corner, lobes).thickness, 7);
  // The blended direction is (1/2, 0, 1/2), of length √½; decoding multiplies the thickness 3 by it.
  const Lobe blended = blendedLobe(middle, lobes);
  EXPECT_LT(length(blended.direction - Vec3{std::sqrt(0.5F), 0, std::sqrt(0.5F)}), 1e-6F);
  EXPECT_FLOAT_EQ(blended.thickness, 3 * std::sqrt(0.5F));
  const LobeShape shape{3, 0.1F};
  const Vec3 up{0, 1, 0};
  EXPECT_FLOAT_EQ(blendedTransmittance(middle, lobes, up, shape, 0.5F),
                  (lobeTransmittance(lobes[0], up, shape, 0.5F) + lobeTransmittance(lobes[1], up, shape, 0.5F)) / 2);
  EXPECT_FLOAT_EQ(blendedTransmittance(corner, lobes, up, shape, 0.5F), lobeTransmittance(lobes[2], up, shape, 0.5F));
}

TEST(SurfacePoints, HaveUnitNormals) {
  const Vec3 normals[] = {{0, 0, 1}, {0, 1, 0}, {0, 0, -1}};
  EXPECT_LT(length(normalAt({{0, 1, 2}, {0.5F, 0.5F, 0}}, normals) - Vec3{0, std::sqrt(0.5F), std::sqrt(0.5F)}), 1e-6F);
  EXPECT_EQ(normalAt({{0, 1, 2}, {0.5F, 0, 0.5F}}, normals), Vec3{}) << "they cancel out";
}

}  // namespace
}  // namespace cloudbake
