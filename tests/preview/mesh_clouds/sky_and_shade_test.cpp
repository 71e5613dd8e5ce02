// The default sky in pictures as they are shown: how blue, how bright towards the horizon, and what shade and base of a cloud take from it.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "preview/mesh_clouds/mesh_clouds.h"
#include "preview/mesh_clouds/render.h"
#include "preview/shading_math.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

float luminance(Vec3 color) { return dot(color, {0.2126F, 0.7152F, 0.0722F}); }

// By channel.
Vec3 medianOf(std::vector<Vec3> colors) {
  const auto middle = [&](float Vec3::*channel) {
    const auto at = colors.begin() + std::ptrdiff_t(colors.size() / 2);
    std::nth_element(colors.begin(), at, colors.end(), [&](const Vec3& a, const Vec3& b) { return a.*channel < b.*channel; });
    return 255 * (*at.*channel);
  };
  return {middle(&Vec3::x), middle(&Vec3::y), middle(&Vec3::z)};
}

// The 8-bit median of the sky at a height of the view, far from a sun at this height.
Vec3 skyAt(float elevation, float sun_elevation) {
  const LightSettings light = lightFor({}, 0, sun_elevation);
  const Camera camera{{0, 0, 0}, directionFromAngles(180, elevation), 1, 24, 3};
  return medianOf(toneMap(drawSky(camera, light.sky)).pixels);
}

TEST(SkyAndShade, SkyIsADeepBlueThatBrightensToTheHorizon) {
  for (const float sun : {28.0F, 48.0F, 70.0F, 90.0F}) {
    const Vec3 high = skyAt(30, sun), middle = skyAt(12, sun), low = skyAt(5, sun), horizon = skyAt(0, sun);
    const auto expect = [&](Vec3 found, Vec3 target, float tolerance) {
      for (float Vec3::*channel : {&Vec3::x, &Vec3::y, &Vec3::z}) EXPECT_NEAR(found.*channel, target.*channel, tolerance) << sun;
    };
    expect(high, {61, 95, 190}, 16);
    expect(middle, {95, 130, 225}, 20);
    expect(low, {150, 185, 240}, 24);
    EXPECT_GE(std::min({horizon.x, horizon.y, horizon.z}), 235) << sun;
    EXPECT_LT(std::max({horizon.x, horizon.y, horizon.z}), 254) << sun;
    EXPECT_GT(high.z, 2.4F * high.x) << sun;
    EXPECT_LT(luminance(high), luminance(middle));
    EXPECT_LT(luminance(middle), luminance(low));
    EXPECT_LT(luminance(low), luminance(horizon));
  }
}

// Haze and ground are bluish under any sun by day, not a grey or brown band.
TEST(SkyAndShade, NoGreyBandBelowTheHorizon) {
  for (const float sun : {28.0F, 48.0F, 90.0F})
    for (const float elevation : {-2.0F, -5.0F, -8.0F, -15.0F, -30.0F}) {
      const Vec3 below = skyAt(elevation, sun);
      EXPECT_GT(below.y, below.x) << elevation << " " << sun;
      EXPECT_GT(below.z, below.y) << elevation << " " << sun;
      EXPECT_GT(luminance(below), 135) << elevation << " " << sun;
    }
}

// The colours that a cloud has where it is in the shade of the sun (R = 0): above, and at its base (G = 0).
TEST(SkyAndShade, ShadeIsBlueAndTheBaseIsNotDark) {
  for (const float sun : {-5.0F, 8.0F, 28.0F, 60.0F, 90.0F}) {
    const SkyColors colors = lightFor({}, 0, sun).sky.colors;
    Image image = blankImage(2, 1);
    image.at(0, 0) = cloudColor({0, 0.5F}, colors), image.at(1, 0) = cloudColor({0, 0}, colors);
    image = toneMap(std::move(image));
    const Vec3 shade = image.at(0, 0), base = image.at(1, 0);
    EXPECT_GT(shade.z, 1.5F * shade.x) << sun;
    EXPECT_GT(luminance(base), 0.5F * luminance(shade)) << sun;
  }
}

// A thick ball between the viewer and a sun that is above it: shade in its middle, light at its upper rim that is not clipped.
TEST(SkyAndShade, BallAgainstTheSun) {
  const BakedMesh ball = bakedBall(1, {}, 5);
  const Instance instances[] = {{&ball, {}}};
  const Camera camera{{0, -0.5F, 6}, {0, 0, 0}, 30, 120, 120};
  const Image picture = toneMap(renderMeshClouds(instances, camera, lightFor({}, 175, 35)));
  std::vector<Vec3> middle;
  for (int y = 50; y < 70; ++y)
    for (int x = 50; x < 70; ++x) middle.push_back(picture.at(x, y));
  const Vec3 shade = medianOf(middle);
  EXPECT_GT(shade.z, 1.3F * shade.x);
  EXPECT_GT(luminance(shade), 100);
  float brightest = 0;
  for (int y = 0; y < 60; ++y) brightest = std::max(brightest, luminance(picture.at(60, y)));
  EXPECT_LT(255 * brightest, 253);
}

}  // namespace
}  // namespace cloudbake
