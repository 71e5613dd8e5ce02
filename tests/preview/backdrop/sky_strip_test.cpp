// A painted strip of colours as the ramp of the sky.
#include "preview/backdrop/sky_strip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace cloudbake {
namespace {

// Each pixel has its own colour.
Image someStrip(int width, int height) {
  Image picture = blankImage(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) picture.at(x, y) = {float(x), float(y), 0.5F};
  return picture;
}

float heightOf(double degrees) { return float(std::sin(degrees * kPi / 180)); }

TEST(SkyStrip, RowsAreHoursAndColumnsAreColors) {
  const SkyRamp ramp = rampOfStrip(someStrip(4, 4), {});
  ASSERT_EQ(ramp.hours.size(), 4U);
  const double elevations[]{-18, 18, 54, 90};
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(ramp.hours[i].sun_height, heightOf(elevations[i]), 1e-6);
    const SkyColors& colors = ramp.hours[i].colors;
    const float row = 3 - float(i);  // the lowest sun is at the bottom
    EXPECT_EQ(colors.zenith, (Vec3{0, row, 0.5F}));
    EXPECT_EQ(colors.low_sky, (Vec3{1, row, 0.5F}));
    EXPECT_EQ(colors.horizon, (Vec3{2, row, 0.5F}));
    EXPECT_EQ(colors.ground, (Vec3{3, row, 0.5F}));
    EXPECT_EQ(colors.sun_color, skyColorsForSun(ramp.hours[i].sun_height).sun_color) << "a colour without a column is built in";
  }
  EXPECT_TRUE(ramp.own_ground);
  EXPECT_FALSE(ramp.own_ambient_sky || ramp.own_ambient_ground);
}

TEST(SkyStrip, TakesTheMiddleOfWideColumns) {
  const SkyRamp ramp = rampOfStrip(someStrip(70, 2), {.low_degrees = -5, .high_degrees = 5, .columns = 7, .gain = 2});
  const SkyColors& night = ramp.hours.front().colors;
  EXPECT_EQ(night.zenith, (Vec3{10, 2, 1})) << "pixel 5, times the gain";
  EXPECT_EQ(night.sun_color, (Vec3{90, 2, 1}));
  EXPECT_EQ(night.ambient_sky, (Vec3{110, 2, 1}));
  EXPECT_EQ(night.ambient_ground, (Vec3{130, 2, 1}));
  EXPECT_TRUE(ramp.own_ambient_sky && ramp.own_ambient_ground);
  EXPECT_NEAR(ramp.hours.back().sun_height, heightOf(5), 1e-6);
}

TEST(SkyStrip, IsReadBetweenItsRowsIfItIsTall) {
  const SkyRamp ramp = rampOfStrip(someStrip(4, 127), {});
  ASSERT_EQ(ramp.hours.size(), size_t(kMostStripHours));
  EXPECT_EQ(ramp.hours.front().colors.zenith.y, 126);
  EXPECT_EQ(ramp.hours.back().colors.zenith.y, 0);
  EXPECT_NEAR(ramp.hours[1].colors.zenith.y, 124, 1e-3);
  const SkyRamp uneven = rampOfStrip(someStrip(4, 100), {});
  EXPECT_NEAR(uneven.hours[1].colors.zenith.y, 99 - 99.0 / 63, 1e-3) << "mixed from two rows";
  for (size_t i = 1; i < uneven.hours.size(); ++i) EXPECT_GT(uneven.hours[i].sun_height, uneven.hours[i - 1].sun_height);
}

TEST(SkyStrip, OfOneRowIsTheSameAtEveryHour) {
  const SkyRamp ramp = rampOfStrip(someStrip(4, 1), {});
  for (const float height : {-1.0F, 0.0F, 1.0F}) EXPECT_EQ(skyColorsForSun(height, ramp).zenith, (Vec3{0, 0, 0.5F}));
}

TEST(SkyStrip, RefusesWhatIsTooSmall) {
  EXPECT_THROW(rampOfStrip(someStrip(3, 4), {}), std::invalid_argument);
  EXPECT_THROW(rampOfStrip(someStrip(4, 4), {.low_degrees = 5, .high_degrees = 5}), std::invalid_argument);
  EXPECT_THROW(rampOfStrip(someStrip(4, 4), {.columns = 8}), std::invalid_argument);
}

}  // namespace
}  // namespace cloudbake
