// Placed meshes: a transform of the instance does what the same transform of the cloud would do.
#include "preview/mesh_clouds/lit_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <stdexcept>

#include "core/harmonics.h"
#include "core/lobe_lighting.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

Affine scaling(double x, double y, double z) {
  Affine m;
  m.linear = {{{x, 0, 0}, {0, y, 0}, {0, 0, z}}};
  return m;
}

// A quarter turn about z: x → y.
const Affine kTurn{{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}}, {5, -3, 2}};

LitMesh lightOne(const BakedMesh& mesh, const Affine& to_world, const LightSettings& light) {
  const Instance instance{&mesh, to_world};
  return lightMeshes({&instance, 1}, light);
}

void expectSameShades(const LitMesh& a, const LitMesh& b, float tolerance) {
  ASSERT_EQ(a.shades.size(), b.shades.size());
  ASSERT_FALSE(a.shades.empty());
  for (size_t i = 0; i < a.shades.size(); ++i) {
    ASSERT_NEAR(a.shades[i].sun, b.shades[i].sun, tolerance) << i;
    ASSERT_NEAR(a.shades[i].sky, b.shades[i].sky, tolerance) << i;
  }
}

TEST(LitMesh, LightHasTheColorsOfItsHour) {
  for (const float elevation : {-30.0F, 0.0F, 7.0F, 60.0F}) {
    const SkySettings sky = lightForSun(40, elevation).sky;
    const float height = std::sin(elevation * kPi / 180);
    EXPECT_NEAR(sky.to_sun.y, height, 1e-6);
    EXPECT_LT(length(sky.colors.sun_color - skyColorsForSun(height).sun_color), 1e-4F) << elevation;
    EXPECT_LT(length(sky.colors.zenith - skyColorsForSun(height).zenith), 1e-4F) << elevation;
  }
}

TEST(LitMesh, LobesMoveAsTheThicknessThatTheyAre) {
  const Lobe lobe{{1, 0, 0}, 2};
  const Lobe turned = transformedLobe(lobe, kTurn);
  EXPECT_NEAR(length(turned.direction - Vec3{0, 1, 0}), 0, 1e-6);
  EXPECT_FLOAT_EQ(turned.thickness, 2);
  const Lobe stretched = transformedLobe({*normalized({1, 1, 0}), 2}, scaling(3, 1, 1));
  EXPECT_NEAR(length(stretched.direction - *normalized({3, 1, 0})), 0, 1e-6);
  EXPECT_NEAR(stretched.thickness, 2 * std::sqrt(5.0), 1e-5);
  EXPECT_NEAR(transformedLobe(lobe, scaling(-1, 1, 1)).direction.x, -1, 1e-6);
  // A vertex without cloud keeps its direction.
  EXPECT_NEAR(length(transformedLobe({{1, 0, 0}, 0}, kTurn).direction - Vec3{0, 1, 0}), 0, 1e-6);
}

// T = (1 + y)/2, as two coefficients: Y₀ is constant, Y₁ is y.
std::vector<float> halfUp() { return {0.5F / 0.28209479F, 0.5F / 0.48860251F, 0, 0}; }

TEST(LitMesh, HarmonicsAreOfTheMeshsOwnAxesAndLengths) {
  const auto placed = [](Vec3 to_light, const Affine& to_world, float extinction) {
    return placedTransmittance(halfUp(), *normalized(to_light), *inverted(to_world), 2, extinction);
  };
  EXPECT_NEAR(placed({0, 1, 0}, {}, 2), 1, 1e-6);
  EXPECT_NEAR(placed({1, 0, 0}, {}, 2), 0.5, 1e-6);
  // Turned, what was along y is along −x.
  EXPECT_NEAR(placed({-1, 0, 0}, kTurn, 2), 1, 1e-6);
  EXPECT_NEAR(placed({0, 1, 0}, kTurn, 2), 0.5, 1e-6);
  // Larger clouds of the same fog are thicker; of as much less fog they look the same. Twice the σ squares T.
  EXPECT_NEAR(placed({1, 0, 0}, scaling(3, 3, 3), 2), 0.125, 1e-6);
  EXPECT_NEAR(placed({1, 0, 0}, scaling(3, 3, 3), 2 / 3.0F), 0.5, 1e-5);
  EXPECT_NEAR(placed({1, 0, 0}, {}, 4), 0.25, 1e-6);
  EXPECT_NEAR(placed({1, 0, 0}, {}, 1), std::sqrt(0.5), 1e-6);
  // Stretched along x alone, only chords along x are longer; along the diagonal (1, 1) came from (1/3, 1), whose y is 3/√10.
  EXPECT_NEAR(placed({1, 0, 0}, scaling(3, 1, 1), 2), 0.125, 1e-6);
  EXPECT_NEAR(placed({0, 0, 1}, scaling(3, 1, 1), 2), 0.5, 1e-6);
  const double back = std::sqrt(10.0) / 3 / std::sqrt(2.0), own = 0.5 + 0.5 * 3 / std::sqrt(10.0);
  EXPECT_NEAR(placed({1, 1, 0}, scaling(3, 1, 1), 2), std::pow(own, 1 / back), 1e-6);
}

// The sky's term of faces that look down is darker by the factor of the sun's term.
TEST(LitMesh, HalfLambertOfTheSky) {
  const BakedMesh ball = bakedBall(1, {}, 2);
  LightSettings light = lightForSun(90, 30);
  const LitMesh plain = lightOne(ball, {}, light);
  light.half_lambert_sky = 0.5F;
  const LitMesh darker = lightOne(ball, {}, light);
  for (size_t v = 0; v < ball.lobes.size(); ++v) {
    const float up = normalized(ball.surface.positions[v]).value().y;
    EXPECT_NEAR(darker.shades[v].sky, plain.shades[v].sky * (0.5F + 0.5F * (0.5F + 0.5F * up)), 0.02F);
    EXPECT_EQ(darker.shades[v].sun, plain.shades[v].sun);
  }
}

TEST(LitMesh, HarmonicsGoBeforeLobesUnlessTold) {
  BakedMesh ball = bakedBall(1, {}, 2);
  ball.info.harmonic_order = 1;
  for (size_t v = 0; v < ball.lobes.size(); ++v)
    for (const float c : halfUp()) ball.harmonics.push_back(c);
  LightSettings light = lightForSun(90, 30);
  light.half_lambert = 1;
  for (const Shade& shade : lightOne(ball, {}, light).shades) {
    ASSERT_NEAR(shade.sun, 0.75, 1e-6);
    ASSERT_NEAR(shade.sky, 1, 1e-6);
  }
  light.lobes_only = true;
  BakedMesh bare = ball;
  bare.harmonics.clear();
  expectSameShades(lightOne(ball, {}, light), lightOne(bare, {}, light), 0);
  light.lobes_only = false;
  ball.harmonics.pop_back();
  EXPECT_THROW(lightOne(ball, {}, light), std::invalid_argument);
}

// A ball that is turned is lit as a ball that was baked there: the place tells the light, not the vertex.
TEST(LitMesh, TurnedAndMirroredBallsAreLitByPlace) {
  const BakedMesh ball = bakedBall();
  LightSettings light = lightForSun(70, 20);
  for (const Affine& to_world : {kTurn, scaling(-1, 1, 1), compose(kTurn, scaling(-2, 2, 2))}) {
    const LitMesh lit = lightOne(ball, to_world, light);
    const float radius = unitScale(to_world);
    const Vec3 center = transformPoint(to_world, {});
    for (size_t i = 0; i < lit.positions.size(); i += 7) {
      const Vec3 world = lit.positions[i] * lit.size + lit.center, normal = *normalized(world - center);
      const float expected = lobeTransmittance(ballLobe(world, center, radius), light.sky.to_sun, {3, -0.006F * radius}, 3.5F / radius) *
                             (0.5F + 0.5F * (dot(normal, light.sky.to_sun) / 2 + 0.5F));
      ASSERT_NEAR(lit.shades[i].sun, expected, 1e-3);
    }
  }
}

TEST(LitMesh, MadeNormalsOfAMirroredMeshPointOutwards) {
  BakedMesh ball = bakedBall();
  const LightSettings light = lightForSun(70, 20);
  const LitMesh given = lightOne(ball, scaling(-1, 1, 1), light);
  ball.surface.normals.clear();
  expectSameShades(lightOne(ball, scaling(-1, 1, 1), light), given, 0.01F);
}

// Normals of a stretched ball are those of the ellipsoid.
TEST(LitMesh, NormalsStayAtRightAnglesUnderAStretch) {
  BakedMesh ball = bakedBall();
  for (Lobe& lobe : ball.lobes) lobe.thickness = 0;
  ball.info.shape.bias = 0;
  LightSettings light = lightForSun(0, 90);
  light.half_lambert = 0;
  const LitMesh lit = lightOne(ball, scaling(1, 4, 1), light);
  for (size_t i = 0; i < lit.shades.size(); i += 5) {
    const Vec3 p = ball.surface.positions[i], normal = *normalized({p.x, p.y / 4, p.z});
    EXPECT_NEAR(lit.shades[i].sun, normal.y / 2 + 0.5F, 1e-4);
  }
}

// An engine that lights a placed mesh by the formula gets what lightMeshes has.
TEST(LitMesh, PlacedMeshesAreLitLikeTheFrame) {
  const BakedMesh ball = bakedBall(1);
  const Affine to_world = compose(kTurn, scaling(-2, 2, 2));
  const Instance instance{&ball, to_world};
  const LightSettings light = lightForSun(70, 20);
  const PlacedMesh placed = placedMesh(instance, {});
  const LitMesh lit = placeMeshes({&instance, 1}, light);
  ASSERT_EQ(placed.lobes.size(), lit.shades.size());
  EXPECT_EQ(placed.triangles, lit.triangles);
  for (size_t v = 0; v < lit.shades.size(); ++v) {
    EXPECT_LT(length(lit.toFrame(placed.positions[v]) - lit.positions[v]), 1e-5F);
    const float facing = dot(placed.normals[v], light.sky.to_sun) * 0.5F + 0.5F;
    const float sun = lobeTransmittance(placed.lobes[v], light.sky.to_sun, placed.shape, placed.extinction);
    EXPECT_NEAR(sun * (light.half_lambert + (1 - light.half_lambert) * facing), lit.shades[v].sun, 1e-5F);
  }
}

// An instance keeps its look at any size, unless one σ is given for the whole scene.
TEST(LitMesh, RecordedExtinctionScalesAgainstTheInstance) {
  const BakedMesh ball = bakedBall();
  LightSettings light = lightForSun(70, 20);
  const LitMesh one = lightOne(ball, {}, light);
  for (const double scale : {0x1p-10, 0.1, 3.0, 1e6, 1e-15}) {
    const Instance instance{&ball, scaling(scale, scale, scale)};
    EXPECT_NEAR(worldExtinction(instance, light) * scale, 3.5, 1e-5);
    expectSameShades(lightOne(ball, instance.to_world, light), one, 1e-5F);
  }
  light.extinction = 1.5F;
  EXPECT_EQ(worldExtinction({&ball, scaling(2, 2, 2)}, light), 1.5F);
  const LitMesh small = lightOne(ball, {}, light), large = lightOne(ball, scaling(3, 3, 3), light);
  double darker = 0;
  for (size_t i = 0; i < small.shades.size(); ++i) darker += double(small.shades[i].sky) - large.shades[i].sky;
  EXPECT_GT(darker / double(small.shades.size()), 0.1);
}

TEST(LitMesh, UnitScaleIsTheMeanOverDirections) {
  EXPECT_EQ(unitScale({}), 1);
  EXPECT_FLOAT_EQ(unitScale(scaling(2, 4, 1)), 2);
  EXPECT_FLOAT_EQ(unitScale(scaling(-3, 3, 3)), 3);
  EXPECT_FLOAT_EQ(unitScale(scaling(-3, -3, -3)), 3);
  EXPECT_FLOAT_EQ(unitScale(scaling(1e-20, 1e-20, 1e-20)), 1e-20F);
}

TEST(LitMesh, FrameHoldsAllInstances) {
  const BakedMesh ball = bakedBall();
  Affine far;
  far.offset = {10, 0, 0};
  const Instance instances[] = {{&ball, {}}, {&ball, far}};
  LitMesh lit = lightMeshes(instances, lightForSun(0, 30));
  prepareForRays(lit);
  EXPECT_NEAR(lit.size, 12, 0.01);
  EXPECT_NEAR(lit.center.x, 5, 0.01);
  EXPECT_EQ(lit.triangles.size(), 2 * ball.surface.triangles.size());

  // Through both: four crossings, in and out in turn, at the places of two balls.
  std::vector<Crossing> crossings;
  const Ray ray{lit.toFrame({-5, 0.013F, 0.017F}), {1, 0, 0}};
  findCrossings(lit, ray, crossings);
  ASSERT_EQ(crossings.size(), 4U);
  const double expected[] = {4, 6, 14, 16};
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(crossings[i].t * lit.size, expected[i], 0.02);
    EXPECT_EQ(crossings[i].sign, i % 2 ? -1 : 1);
  }
  const auto nearest = nearestCrossing(lit, ray);
  ASSERT_TRUE(nearest);
  EXPECT_EQ(nearest->t, crossings[0].t);
  EXPECT_EQ(nearest->triangle, crossings[0].triangle);
  EXPECT_FALSE(nearestCrossing(lit, {lit.toFrame({-5, 3, 0}), {1, 0, 0}}));
  EXPECT_FALSE(nearestCrossing(lightMeshes({}, lightForSun(0, 30)), ray));
}

TEST(LitMesh, RefusesWhatCannotBeLit) {
  BakedMesh ball = bakedBall();
  EXPECT_THROW(lightOne(ball, scaling(1, 0, 1), lightForSun(0, 30)), std::invalid_argument);
  ball.lobes.pop_back();
  EXPECT_THROW(lightOne(ball, {}, lightForSun(0, 30)), std::invalid_argument);
}

TEST(LitMesh, ShadesFromElsewhereStandInTheSameFrame) {
  const BakedMesh ball = bakedBall(2, {5, 1, -3});
  const LightSettings light = lightForSun(40, 30);
  const LitMesh lit = lightOne(ball, {}, light), shaded = shadedMesh(ball, lit.shades);
  EXPECT_EQ(shaded.positions, lit.positions);
  EXPECT_EQ(shaded.triangles, lit.triangles);
  EXPECT_EQ(shaded.center, lit.center);
  EXPECT_EQ(shaded.size, lit.size);
  expectSameShades(shaded, lit, 0);
  EXPECT_THROW(shadedMesh(ball, {}), std::invalid_argument);
}

TEST(LitMesh, TransmittanceOfLengths) {
  const std::vector<float> to_sun{0, 1, 2}, to_sky{0.5F, 0, 4};
  const std::vector<Shade> shades = transmittanceShades(to_sun, to_sky, 0.7F);
  ASSERT_EQ(shades.size(), 3U);
  for (size_t v = 0; v < 3; ++v) {
    EXPECT_NEAR(shades[v].sun, std::exp(-0.7 * to_sun[v]), 1e-6);
    EXPECT_NEAR(shades[v].sky, std::exp(-0.7 * to_sky[v]), 1e-6);
  }
  EXPECT_THROW(transmittanceShades(to_sun, std::span(to_sky).first(2), 0.7F), std::invalid_argument);
}

TEST(LitMesh, LambertIsTheCosineOfTheNormal) {
  SurfaceMesh ball = ballMesh(2, 3, {1, 0, 0});
  const Vec3 to_sun = *normalized({1, 1, 0});
  const std::vector<Shade> given = lambertShades(ball, to_sun);
  ASSERT_EQ(given.size(), ball.positions.size());
  for (size_t v = 0; v < given.size(); ++v) {
    EXPECT_NEAR(given[v].sun, std::max(0.0, (double(ball.normals[v].x) + ball.normals[v].y) / std::sqrt(2.0)), 1e-6);
    EXPECT_NEAR(given[v].sky, 0.5 + 0.5 * ball.normals[v].y, 1e-6);
  }
  // Made where they are missing.
  ball.normals.clear();
  const std::vector<Shade> made = lambertShades(ball, to_sun);
  ASSERT_EQ(made.size(), given.size());
  for (size_t v = 0; v < given.size(); ++v) EXPECT_NEAR(made[v].sun, given[v].sun, 0.02);
}

// Linear in the place, so that the colour of a crossing says where it is.
TEST(LitMesh, ColorsAreInterpolatedAtCrossings) {
  BakedMesh ball = bakedBall(1, {}, 3);
  for (const Vec3& p : ball.surface.positions) ball.colors.push_back(Vec3{0.5F, 0.5F, 0.5F} + p * 0.4F);
  const Instance instances[] = {{&ball, {}}};
  LightSettings light = lightForSun(100, 25);
  LitMesh lit = lightMeshes(instances, light);
  prepareForRays(lit);
  const Ray ray{{0.1F, 0.2F, 3}, {0, 0, -1}};
  const auto crossing = nearestCrossing(lit, ray);
  ASSERT_TRUE(crossing);
  const Vec3 place = (ray.origin + ray.direction * crossing->t) * lit.size + lit.center;
  EXPECT_LE(length(crossing->color - (Vec3{0.5F, 0.5F, 0.5F} + place * 0.4F)), 1e-5F);
  light.own_colors = false;
  EXPECT_TRUE(lightMeshes(instances, light).colors.empty());
  ball.colors.pop_back();
  EXPECT_THROW(placeMeshes(instances, light), std::invalid_argument);
}

}  // namespace
}  // namespace cloudbake
