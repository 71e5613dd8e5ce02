// Renders of bodies whose lobes and chords are known in closed form.
#include "preview/mesh_clouds/render.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <span>
#include <stdexcept>

#include "core/lobe_lighting.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

Box boxOf(const BakedMesh& mesh) {
  Box box;
  for (const Vec3& p : mesh.surface.positions) box.add(p);
  return box;
}

// Everything black but the sun, a white sky, one ray per pixel: a pixel of the cloud is R (or G), the sky is 1.
LightSettings plainLight(Vec3 to_sun) {
  LightSettings light;
  light.sky.to_sun = to_sun;
  light.sky.colors = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {0, 0, 0}, {0, 0, 0}, {1, 1, 1}};
  light.sky.disc.gain = light.sky.glow = 0;
  light.half_lambert = 1;
  light.view_extinction = 0;
  light.samples_per_side = 1;
  return light;
}

// Distances along a ray where it enters and leaves a ball at the origin; empty where it passes by.
std::optional<std::pair<double, double>> chordOf(const Ray& ray, double radius) {
  const double middle = -dot(ray.origin, ray.direction), miss = double(dot(ray.origin, ray.origin)) - middle * middle;
  if (miss >= radius * radius) return std::nullopt;
  const double half = std::sqrt(radius * radius - miss);
  return std::pair{middle - half, middle + half};
}

Vec3 pointAt(const Ray& ray, double t) { return ray.origin + ray.direction * float(t); }

// T_lobe of a ball as the formula states it, by hand.
double ballTransmittance(Vec3 point, double radius, Vec3 to_light, double extinction, double bias) {
  const double cosine = -double(dot(point, to_light)) / radius;
  return std::exp(-extinction * std::max(0.0, std::pow(std::max(0.0, cosine / 2 + 0.5), 3) * 2 * radius + bias));
}

TEST(Render, BallShowsTheLobeFormula) {
  const float radius = 2;
  const BakedMesh ball = bakedBall(radius);
  const Vec3 to_sun = directionFromAngles(70, 20);
  const Camera camera = frameCamera(boxOf(ball), 0, 0, 30, 61, 41);
  LightSettings light = plainLight(to_sun);
  const Image sun = renderLobe(ball, camera, light);
  light.sky.colors.sun_color = {};
  light.sky.colors.ambient_sky = {1, 1, 1};
  const Image sky = renderLobe(ball, camera, light);

  int inside = 0;
  double brightest = 0, darkest = 1;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
      const auto chord = chordOf(ray, radius * 0.998);  // clear of the icosphere's rim
      if (!chord) continue;
      const Vec3 point = pointAt(ray, chord->first);
      const double expected = ballTransmittance(point, radius, to_sun, ball.info.extinction, ball.info.shape.bias);
      EXPECT_NEAR(sun.at(x, y).x, expected, 0.01);
      EXPECT_NEAR(sky.at(x, y).x, ballTransmittance(point, radius, {0, 1, 0}, ball.info.extinction, ball.info.shape.bias), 0.01);
      brightest = std::max(brightest, double(sun.at(x, y).x));
      darkest = std::min(darkest, double(sun.at(x, y).x));
      ++inside;
    }
  EXPECT_GT(inside, 600);
  EXPECT_GT(brightest, 0.99);
  EXPECT_LT(darkest, 0.1);
  EXPECT_GT(sun.at(40, 20).x, 1.5F * sun.at(20, 20).x);
}

TEST(Render, HalfLambertMultipliesTheSun) {
  const BakedMesh ball = bakedBall(1);
  const Camera camera = frameCamera(boxOf(ball), 0, 0, 30, 31, 31);
  LightSettings light = plainLight({1, 0, 0});
  const Image without = renderLobe(ball, camera, light);
  light.half_lambert = 0.4F;
  const Image with = renderLobe(ball, camera, light);
  for (const int x : {7, 12, 15, 20, 24}) {
    const Ray ray = cameraRay(camera, float(x) + 0.5F, 15.5F);
    const Vec3 normal = pointAt(ray, chordOf(ray, 1)->first);
    EXPECT_NEAR(with.at(x, 15).x / without.at(x, 15).x, 0.4 + 0.6 * (normal.x / 2 + 0.5), 0.01);
  }
}

TEST(Render, NormalsAreMadeWhereTheyAreMissing) {
  BakedMesh ball = bakedBall(1);
  const Camera camera = frameCamera(boxOf(ball), 0, 0, 30, 31, 31);
  LightSettings light = plainLight({1, 0, 0});
  light.half_lambert = 0;
  const Image given = renderLobe(ball, camera, light);
  ball.surface.normals.clear();
  const Image made = renderLobe(ball, camera, light);
  for (size_t i = 0; i < given.pixels.size(); ++i) EXPECT_NEAR(given.pixels[i].x, made.pixels[i].x, 0.01);
}

// A black ball before a white sky shows exp(−σ_v·chord), and a lit one the integral of its colour along the chord.
TEST(Render, SoftBallIsTheIntegralAlongTheChord) {
  const BakedMesh ball = bakedBall(1);
  const Camera camera = frameCamera(boxOf(ball), 0, 0, 30, 41, 41);
  const Vec3 to_sun = directionFromAngles(150, 10);
  LightSettings light = plainLight(to_sun);
  light.view_extinction = 0.6F;
  const double sigma = 0.6 * ball.info.extinction;
  const Image lit = renderLobe(ball, camera, light);
  light.sky.colors.sun_color = {};
  const Image black = renderLobe(ball, camera, light);

  int inside = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
      const auto chord = chordOf(ray, 0.95);  // at the rim a chord follows the facets
      if (!chord) continue;
      const auto whole = chordOf(ray, 1);
      const double length = whole->second - whole->first;
      EXPECT_NEAR(black.at(x, y).x, std::exp(-sigma * length), 0.01);

      const double near = ballTransmittance(pointAt(ray, whole->first), 1, to_sun, ball.info.extinction, ball.info.shape.bias);
      const double far = ballTransmittance(pointAt(ray, whole->second), 1, to_sun, ball.info.extinction, ball.info.shape.bias);
      double expected = std::exp(-sigma * length);
      for (int i = 0; i < 1000; ++i) {
        const double part = (i + 0.5) / 1000;
        expected += sigma * length / 1000 * std::exp(-sigma * length * part) * (near + (far - near) * part);
      }
      EXPECT_NEAR(lit.at(x, y).x, expected, 0.01);
      ++inside;
    }
  EXPECT_GT(inside, 350);
}

BakedMesh withLobes(SurfaceMesh surface) {
  BakedMesh mesh;
  mesh.lobes.assign(surface.positions.size(), Lobe{{0, -1, 0}, 0});
  mesh.surface = std::move(surface);
  mesh.info.extinction = 1;
  return mesh;
}

// Black, so that the pixel is what comes through.
float throughCenter(const BakedMesh& mesh, float azimuth, float elevation) {
  LightSettings light = plainLight({0, 1, 0});
  light.sky.colors.sun_color = {};
  light.view_extinction = 1;
  const Image image = renderLobe(mesh, frameCamera(boxOf(mesh), azimuth, elevation, 30, 15, 15), light);
  return image.at(7, 7).x;
}

TEST(Render, GapsAndShellsFollowTheWindingNumber) {
  // Two cuts through a torus, with air between.
  EXPECT_NEAR(throughCenter(withLobes(torusMesh(1, 0.25F, 96, 48)), 0, 0), std::exp(-1.0), 0.005);
  // The centre ray runs along an edge's middle on both sides of a box: met twice, counted once.
  EXPECT_NEAR(throughCenter(withLobes(boxMesh({-1, -1, -1}, {1, 1, 1})), 0, 0), std::exp(-2.0), 1e-5);
  EXPECT_NEAR(throughCenter(withLobes(boxMesh({-1, -1, -1}, {1, 1, 1})), 90, 0), std::exp(-2.0), 1e-5);
  // Through two corners and along the diagonal edges of a box.
  EXPECT_NEAR(throughCenter(withLobes(boxMesh({-1, -1, -1}, {1, 1, 1})), 45, 0), std::exp(-2 * std::sqrt(2.0)), 1e-4);
  // Overlapping shells count once, a reversed inner shell is a cavity, an inverted mesh is as solid as any.
  SurfaceMesh outer = boxMesh({-1, -1, -1}, {1, 1, 1}), inner = boxMesh({-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F});
  EXPECT_NEAR(throughCenter(withLobes(merged(outer, inner)), 0, 0), std::exp(-2.0), 1e-5);
  reverse(inner);
  EXPECT_NEAR(throughCenter(withLobes(merged(outer, inner)), 0, 0), std::exp(-1.0), 1e-5);
  reverse(outer);
  EXPECT_NEAR(throughCenter(withLobes(outer), 0, 0), std::exp(-2.0), 1e-5);
}

TEST(Render, OpenMeshIsAnOpaqueSurface) {
  BakedMesh sheet = withLobes({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {}, {{0, 1, 2}, {0, 2, 3}}});
  EXPECT_EQ(throughCenter(sheet, 0, 0), 0);
  EXPECT_EQ(throughCenter(sheet, 180, 0), 0);
}

TEST(Render, BackgroundIsTheSky) {
  const BakedMesh ball = bakedBall(1);
  const Camera camera = frameCamera(boxOf(ball), 30, 10, 40, 48, 32);
  LightSettings light = lightForSun(210, 12);
  light.samples_per_side = 1;
  const Image image = renderLobe(ball, camera, light), empty = renderLobe({}, camera, light);
  int background = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Ray ray = cameraRay(camera, float(x) + 0.5F, float(y) + 0.5F);
      const Vec3 sky = skyColor(ray.direction, light.sky);
      EXPECT_LT(length(empty.at(x, y) - sky), 1e-4F);
      if (chordOf(ray, 1)) continue;
      EXPECT_LT(length(image.at(x, y) - sky), 1e-4F);
      ++background;
    }
  EXPECT_GT(background, 500);
}

// One picture of the ball at any size and place; bit-exact for powers of two.
Image pictureOfBall(float radius, Vec3 center) {
  const BakedMesh ball = bakedBall(radius, center, 4);
  return renderLobe(ball, frameCamera(boxOf(ball), 30, 10, 35, 40, 30), lightForSun(80, 25));
}

double largestColorDifference(const Image& a, const Image& b) {
  double largest = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) largest = std::max(largest, double(length(a.pixels[i] - b.pixels[i])));
  return largest;
}

TEST(Render, SizeAndPlaceDoNotMatter) {
  const Image one = pictureOfBall(1, {});
  for (const float radius : {0x1p-20F, 0x1p+20F, 0x1p-60F}) EXPECT_EQ(pictureOfBall(radius, {}).pixels, one.pixels) << radius;
  for (const float radius : {1e-6F, 1e6F}) EXPECT_LT(largestColorDifference(pictureOfBall(radius, {}), one), 1e-3) << radius;
  EXPECT_LT(largestColorDifference(pictureOfBall(1, {1000, -500, 250}), one), 0.02);
}

TEST(Render, ExtinctionComesFromSettingsThenAssetThenSize) {
  BakedMesh ball = bakedBall(1, {}, 3);
  const Camera camera = frameCamera(boxOf(ball), 0, 0, 35, 20, 20);
  LightSettings light = lightForSun(60, 30);
  light.samples_per_side = 2;
  const Image recorded = renderLobe(ball, camera, light);  // 7 / longest side
  ball.info.extinction = 0;
  EXPECT_LT(largestColorDifference(renderLobe(ball, camera, light), recorded), 1e-4);
  ball.info.extinction = 100;
  light.extinction = 3.5F;
  EXPECT_LT(largestColorDifference(renderLobe(ball, camera, light), recorded), 1e-4);
  light.extinction = 35.0F;
  EXPECT_GT(largestColorDifference(renderLobe(ball, camera, light), recorded), 0.1);
}

TEST(Render, ShadesFromElsewhereTakeTheLobesPlace) {
  BakedMesh ball = bakedBall(2, {3, 1, -2}, 4);
  const Camera camera = frameCamera(boxOf(ball), 30, 10, 35, 40, 30);
  const LightSettings light = lightForSun(80, 25);
  const Image lobes = renderLobe(ball, camera, light);
  const Instance instance{&ball, {}};
  const std::vector<Shade> shades = lightMeshes({&instance, 1}, light).shades;
  ball.lobes.clear();
  EXPECT_EQ(renderShaded(ball, shades, camera, light).pixels, lobes.pixels);
  EXPECT_THROW(renderShaded(ball, std::span(shades).first(3), camera, light), std::invalid_argument);
}

// Through two balls, one behind the other, the nearer of which is red and the other green: as opaque as both, and all of it red.
TEST(Render, TheFirstSurfaceAloneShowsItsLight) {
  const SurfaceMesh front = ballMesh(1, 4, {0, 0, 2}), back = ballMesh(1, 4, {0, 0, -2});
  BakedMesh both;
  both.surface = merged(front, back);
  both.info.extinction = 0.5F;
  std::vector<Shade> shades(front.positions.size(), Shade{1, 0});
  shades.resize(both.surface.positions.size(), Shade{0, 1});
  const Camera camera = frameCamera(boxOf(both), 0, 0, 30, 31, 31);
  LightSettings light = plainLight({0, 1, 0});
  light.sky.colors.sun_color = {1, 0, 0}, light.sky.colors.ambient_sky = {0, 1, 0}, light.sky.colors.ambient_ground = {};
  light.view_extinction = 1;
  const Vec3 mixed = renderShaded(both, shades, camera, light).at(15, 15);
  light.first_surface = true;
  const Vec3 whole = renderShaded(both, shades, camera, light).at(15, 15);
  const float sky = std::exp(-2.0F), green = std::exp(-1.0F) * (1 - std::exp(-1.0F));
  const Vec3 behind = skyColor({0, 0, -1}, light.sky) * sky;
  EXPECT_NEAR(mixed.x - behind.x, 1 - std::exp(-1.0F), 0.01);
  EXPECT_NEAR(mixed.y - behind.y, green, 0.01);
  EXPECT_NEAR(whole.x - behind.x, 1 - sky, 0.01);
  EXPECT_NEAR(whole.y - behind.y, 0, 0.01);
}

TEST(Render, SameBytesForAnyNumberOfThreads) {
  const auto render = [](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return pictureOfBall(1, {});
  };
  const Image one = render(1), two = render(2);
  EXPECT_EQ(std::memcmp(one.pixels.data(), two.pixels.data(), one.pixels.size() * sizeof(Vec3)), 0);
}

// From noon on until the sun is far below the horizon, the lower half of a ball is never the brighter one.
TEST(Render, NothingIsLitFromBelow) {
  const BakedMesh ball = bakedBall(1);
  const Camera camera = frameCamera(boxOf(ball), 0, 0, 30, 32, 32);
  for (const float azimuth : {0.0F, 120.0F})
    for (float elevation = -20; elevation <= 60; elevation += elevation < 0 ? 1 : 10) {
      LightSettings light = lightForSun(azimuth, elevation);
      const Vec3 sun_color = light.sky.colors.sun_color;
      light.sky.colors = {};
      light.sky.colors.sun_color = sun_color;
      light.sky.disc.gain = light.sky.glow = 0;
      const Image image = renderLobe(ball, camera, light);
      for (int y = 4; y < 16; ++y) {
        float above = 0, below = 0;  // of rows as far from the middle
        for (int x = 10; x < 22; ++x) above += image.at(x, y).y, below += image.at(x, 31 - y).y;
        EXPECT_GE(above, below * 0.999F) << "sun at " << elevation << ", row " << y;
      }
    }
}

TEST(Render, EdgesAreAntialiased) {
  const BakedMesh ball = bakedBall(1);
  const Camera camera = frameCamera(boxOf(ball), 0, 0, 30, 41, 41);
  LightSettings light = plainLight({0, 0, 1});
  light.sky.colors.sun_color = {};
  light.samples_per_side = 4;
  const Image image = renderLobe(ball, camera, light);
  double covered = 0, expected = 0;
  bool partly = false;
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 41; ++x) {
      covered += 1 - image.at(x, y).x;
      partly = partly || (image.at(x, y).x > 0.2F && image.at(x, y).x < 0.8F);
      for (int row = 0; row < 20; ++row)
        for (int column = 0; column < 20; ++column) {
          const Ray ray = cameraRay(camera, float(x) + (float(column) + 0.5F) / 20, float(y) + (float(row) + 0.5F) / 20);
          expected += chordOf(ray, 1) ? 1.0 / 400 : 0;
        }
    }
  EXPECT_TRUE(partly);
  EXPECT_NEAR(covered / expected, 1, 0.005);
}

TEST(Render, RefusesAMeshWithoutLobes) {
  BakedMesh ball = bakedBall(1, {}, 1);
  ball.lobes.clear();
  EXPECT_THROW(renderLobe(ball, Camera{}, LightSettings{}), std::invalid_argument);
}

TEST(Render, ToneMapRisesFromBlackToWhite) {
  Image ramp = blankImage(2000, 1);
  for (int i = 0; i < 2000; ++i) ramp.at(i, 0) = Vec3{1, 1, 1} * (float(i) * 0.01F);
  const Image mapped = toneMap(ramp, 1);
  EXPECT_EQ(mapped.at(0, 0), (Vec3{}));
  for (int i = 1; i < 2000; ++i) {
    EXPECT_GE(mapped.at(i, 0).x, mapped.at(i - 1, 0).x);
    EXPECT_LE(mapped.at(i, 0).x, 1);
  }
  EXPECT_NEAR(mapped.at(1999, 0).x, 1, 1e-6);
  // The published curve at 0.18 and 1, then the sRGB transfer function, by hand: 0.2663 → 0.5530, 0.8038 → 0.9085.
  EXPECT_NEAR(mapped.at(18, 0).x, 0.553, 0.002);
  EXPECT_NEAR(mapped.at(100, 0).x, 0.908, 0.002);
  EXPECT_EQ(toneMap(ramp, 2).at(50, 0), mapped.at(100, 0));
  Image bright = blankImage(1, 1);
  bright.at(0, 0) = {1e30F, INFINITY, 20};
  EXPECT_LT(length(toneMap(bright, 1).at(0, 0) - Vec3{1, 1, 1}), 1e-6F);
}

// Rounded to 8 bits, every block of 8 × 8 pixels keeps the mean of a value between two steps to 1/64 step; whole steps stay whole.
TEST(Dither, KeepsTheMeanBetweenSteps) {
  for (int part = 0; part <= 64; ++part) {
    Image flat = blankImage(16, 8);
    for (Vec3& p : flat.pixels) p = Vec3{1, 1, 1} * ((100 + float(part) / 64) / 255);
    double sum = 0;
    const Image picture = dithered(flat);
    for (const Vec3& p : picture.pixels) {
      const double step = std::round(255 * double(p.y));
      ASSERT_TRUE(step == 100 || step == 101) << step;
      ASSERT_EQ(p.x, p.z);
      sum += step;
    }
    EXPECT_NEAR(sum / double(picture.pixels.size()), 100 + part / 64.0, 1.01 / 64);
  }
  EXPECT_EQ(dithered(blankImage(0, 0)).pixels.size(), 0U);
}

// Of an opaque cloud: each pixel inside its outline is the white picture's times the colour.
TEST(Render, OwnColorsMultiplyTheCloud) {
  BakedMesh ball = bakedBall(1, {}, 4);
  const Camera camera{{0, 0, 5}, {0, 0, 0}, 35, 80, 60};
  LightSettings light = lightForSun(100, 25);
  light.samples_per_side = 1, light.view_extinction = 0;
  const Image plain = renderLobe(ball, camera, light);
  ball.colors.assign(ball.lobes.size(), {1, 1, 1});
  const Image white = renderLobe(ball, camera, light);
  for (size_t i = 0; i < plain.pixels.size(); ++i) ASSERT_LE(length(white.pixels[i] - plain.pixels[i]), 1e-5F);
  ball.colors.assign(ball.lobes.size(), {0.9F, 0.3F, 0.1F});
  const Image red = renderLobe(ball, camera, light);
  const Vec3 before = plain.at(40, 30), after = red.at(40, 30);
  EXPECT_LE(length(after - Vec3{before.x * 0.9F, before.y * 0.3F, before.z * 0.1F}), 1e-5F);
  EXPECT_EQ(red.at(0, 0), plain.at(0, 0));
  light.own_colors = false;
  EXPECT_EQ(renderLobe(ball, camera, light).pixels, plain.pixels);
}

}  // namespace
}  // namespace cloudbake
