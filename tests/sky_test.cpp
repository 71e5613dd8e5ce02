// The sky: finite and defined everywhere, brightest in the sun.
#include "preview/sky.h"

#include <gtest/gtest.h>

#include "preview/camera.h"

namespace cloudbake {
namespace {

float brightness(Vec3 color) { return 0.2126F * color.x + 0.7152F * color.y + 0.0722F * color.z; }

SkySettings skyForSun(float azimuth, float elevation) {
  SkySettings sky;
  sky.to_sun = directionFromAngles(azimuth, elevation);
  sky.colors = skyColorsForSun(sky.to_sun.y);
  return sky;
}

TEST(Sky, IsFiniteAndNotNegativeEverywhere) {
  for (const float sun : {-90.0F, -12.0F, 0.0F, 5.0F, 40.0F, 90.0F}) {
    const SkySettings sky = skyForSun(30, sun);
    for (float azimuth = 0; azimuth < 360; azimuth += 15)
      for (float elevation = -90; elevation <= 90; elevation += 5) {
        const Vec3 color = skyColor(directionFromAngles(azimuth, elevation), sky);
        ASSERT_TRUE(isFinite(color));
        ASSERT_GE(std::min({color.x, color.y, color.z}), 0);
      }
  }
}

TEST(Sky, SunIsBrighterThanElsewhereAndThereIsOnlyOne) {
  const SkySettings sky = skyForSun(30, 40);
  const float sun = brightness(skyColor(sky.to_sun, sky));
  int outside = 0;
  for (float azimuth = 0; azimuth < 360; azimuth += 5)
    for (float elevation = -90; elevation <= 90; elevation += 5) {
      const Vec3 view = directionFromAngles(azimuth, elevation);
      if (angleDegrees(view, sky.to_sun) < 4) continue;
      EXPECT_LT(brightness(skyColor(view, sky)) * 2, sun);
      ++outside;
    }
  EXPECT_GT(outside, 2000);
}

// The rim of the disc: saturate(cos(x)^a·b) falls under 1 where cos(x)^a = 1/b.
TEST(Sky, DiscHasTheRadiusThatItsConstantsGive) {
  SkySettings sky = skyForSun(0, 40);
  const double radius = std::acos(std::pow(1.0 / sky.disc_gain, 1.0 / sky.disc_exponent)) * 180 / kPi;
  EXPECT_NEAR(radius, 3, 0.1);
  const auto at = [&](double degrees) { return brightness(skyColor(directionFromAngles(0, 40 + float(degrees)), sky)); };
  const float inside = at(0.9 * radius);
  EXPECT_NEAR(inside, at(0), 0.03 * at(0));
  EXPECT_LT(at(2 * radius), 0.3 * inside);
}

TEST(Sky, HorizonIsALineAndGroundLiesBelow) {
  const SkySettings sky = skyForSun(180, 60);
  EXPECT_EQ(skyColor({0, 0, 1}, sky), sky.colors.horizon);
  EXPECT_EQ(skyColor({0, -1, 0}, sky), sky.colors.ground);
  EXPECT_LT(skyColor({0, 1, 0}, sky).x, sky.colors.horizon.x);
  // Continuous across the line.
  const Vec3 above = skyColor(directionFromAngles(0, 0.001F), sky), below = skyColor(directionFromAngles(0, -0.001F), sky);
  EXPECT_LT(length(above - below), 0.01F);
}

TEST(Sky, HorizonSinksForAViewerHighAbove) {
  SkySettings sky = skyForSun(180, 60);
  sky.viewer_height = 1;  // one radius up: the horizon is 60 degrees below level
  EXPECT_LT(length(skyColor(directionFromAngles(0, -60), sky) - sky.colors.horizon), 0.02F);
  EXPECT_EQ(skyColor({0, -1, 0}, sky).x < sky.colors.horizon.x, true);
}

TEST(Sky, HoursAreMixedWithoutJumps) {
  Vec3 last = skyColorsForSun(-1).sun_color;
  for (float height = -1; height <= 1; height += 0.001F) {
    const Vec3 color = skyColorsForSun(height).sun_color;
    EXPECT_LT(length(color - last), 0.02F) << height;
    last = color;
  }
  EXPECT_GT(brightness(skyColorsForSun(1).sun_color), 5 * brightness(skyColorsForSun(-1).sun_color));
}

}  // namespace
}  // namespace cloudbake
