// The aurora: where it is, when it shines, and that it has no seam.
#include "preview/backdrop/aurora.h"

#include <gtest/gtest.h>

#include <cmath>

#include "preview/camera.h"

namespace cloudbake {
namespace {

constexpr float kNight = -0.5F;

// The sum over views at an elevation.
float lightAt(float elevation, const AuroraSettings& settings, float sun_height = kNight) {
  float sum = 0;
  for (int i = 0; i < 360; ++i) {
    const Vec3 light = auroraLight(directionFromAngles(float(i), elevation), sun_height, settings);
    EXPECT_TRUE(std::isfinite(light.x) && std::isfinite(light.y) && std::isfinite(light.z)) << i << " " << elevation;
    EXPECT_TRUE(light.x >= 0 && light.y >= 0 && light.z >= 0);
    sum += light.x + light.y + light.z;
  }
  return sum;
}

TEST(Aurora, IsBetweenItsElevations) {
  AuroraSettings settings;
  settings.bottom_degrees = 20, settings.top_degrees = 50;
  for (const float elevation : {-90.0F, -10.0F, 0.0F, 10.0F, 19.9F, 50.1F, 70.0F, 89.99F, 90.0F})
    EXPECT_EQ(lightAt(elevation, settings), 0) << elevation;
  EXPECT_GT(lightAt(30, settings), 1);
  settings.bottom_degrees = 0, settings.top_degrees = 90;
  for (const float elevation : {0.01F, 45.0F, 89.9F, 90.0F}) lightAt(elevation, settings);  // finite
  EXPECT_EQ(auroraLight({0, 1, 0}, kNight, settings), Vec3{});
}

TEST(Aurora, FadesAsTheSunRises) {
  const AuroraSettings settings;
  const float night = lightAt(25, settings), dusk = lightAt(25, settings, (settings.low_height + settings.high_height) / 2);
  EXPECT_NEAR(dusk, night / 2, 1e-3F * night);
  EXPECT_EQ(lightAt(25, settings, settings.high_height), 0);
  EXPECT_EQ(lightAt(25, settings, 1), 0);
}

TEST(Aurora, MovesWithTheTime) {
  AuroraSettings settings, later;
  later.time_seconds = 20;
  const auto change = [](const AuroraSettings& a, const AuroraSettings& b) {
    float sum = 0;
    for (int i = 0; i < 360; ++i) {
      const Vec3 view = directionFromAngles(float(i), 25);
      sum += length(auroraLight(view, kNight, a) - auroraLight(view, kNight, b));
    }
    return sum;
  };
  EXPECT_GT(change(settings, later), 1);
  AuroraSettings soon = settings;
  soon.time_seconds = 0.02F;
  EXPECT_LT(change(settings, soon), 0.02F * change(settings, later)) << "it jumps";
  settings.speed = later.speed = 0;
  EXPECT_EQ(change(settings, later), 0);
  later.seed = 1;
  EXPECT_GT(change(settings, later), 1);
}

// From one view to the next the light changes little: there is no seam, also where the azimuth starts again.
TEST(Aurora, HasNoSeam) {
  const AuroraSettings settings;
  float largest = 0, brightest = 0;
  for (const float elevation : {15.0F, 25.0F, 35.0F}) {
    Vec3 last = auroraLight(directionFromAngles(-180, elevation), kNight, settings);
    for (float azimuth = -179.98F; azimuth <= 180; azimuth += 0.02F) {
      const Vec3 light = auroraLight(directionFromAngles(azimuth, elevation), kNight, settings);
      largest = std::max(largest, length(light - last)), brightest = std::max(brightest, length(light));
      last = light;
    }
  }
  EXPECT_GT(brightest, 0.1F);
  EXPECT_LT(largest, 0.03F * brightest);
}

// The rays are along the vertical: a step in azimuth changes the light more than the same step in elevation.
TEST(Aurora, IsStretchedAlongTheVertical) {
  AuroraSettings settings;
  settings.bottom_degrees = 1, settings.top_degrees = 80;
  double aside = 0, upwards = 0;
  for (int i = 0; i < 3600; ++i) {
    const auto at = [&](float azimuth, float elevation) { return auroraLight(directionFromAngles(azimuth, elevation), kNight, settings); };
    const float azimuth = float(i) * 0.1F;
    const Vec3 here = at(azimuth, 40);
    aside += length(at(azimuth + 0.65F, 40) - here), upwards += length(at(azimuth, 40.5F) - here);  // half a degree each
  }
  EXPECT_GT(aside, 1.5 * upwards);
}

}  // namespace
}  // namespace cloudbake
