// Stars: as many as asked for, spread evenly, as bright as stars are, in a sky that turns.
#include "preview/backdrop/stars.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "preview/camera.h"

namespace cloudbake {
namespace {

constexpr float kNight = -0.5F;

float strongest(Vec3 color) { return std::max({color.x, color.y, color.z}); }

// The stars of a part of the sky, found by looking everywhere: local maxima on a fine grid of directions.
struct Found {
  Vec3 direction;
  float light;
};
std::vector<Found> starsBetween(float low, float high, float azimuth_low, float azimuth_high, const StarSettings& settings) {
  constexpr float kStep = 0.04F;  // degrees
  std::vector<Found> found;
  for (float elevation = low; elevation < high; elevation += kStep)
    for (float azimuth = azimuth_low; azimuth < azimuth_high; azimuth += kStep / std::cos(elevation * float(kPi / 180))) {
      const Vec3 view = directionFromAngles(azimuth, elevation);
      const float light = strongest(starLight(view, kNight, settings));
      if (!(light > 0.2F * 0.02F * settings.brightness)) continue;
      const auto same = std::find_if(found.begin(), found.end(), [&](const Found& one) { return dot(one.direction, view) > 0.99999F; });
      if (same == found.end())
        found.push_back({view, light});
      else if (light > same->light)
        *same = {view, light};
    }
  return found;
}

TEST(Stars, AreAsManyAsAskedForAndSpreadEvenly) {
  StarSettings settings;
  settings.count = 20000;
  settings.tint = 0;
  // Two patches of equal solid angle, one about the middle of a face of the cube, one about an edge: 0.0379 of the sphere each.
  const auto patch = [&](float azimuth) { return starsBetween(30, 60, azimuth, azimuth + 74.6F, settings); };
  const double share = (std::sin(60 * kPi / 180) - std::sin(30 * kPi / 180)) / 2 * 74.6 / 360, expected = share * settings.count;
  for (const float azimuth : {-37.0F, 8.0F, 100.0F})
    EXPECT_NEAR(double(patch(azimuth).size()), expected, 4 * std::sqrt(expected)) << azimuth;
}

// N(> F) falls as F^(−3/2): of those brighter than a flux, a share of 2^(−3/2) is twice as bright.
TEST(Stars, AreFaintMoreOftenThanBright) {
  StarSettings settings;
  settings.count = 30000;
  settings.tint = 0;
  const std::vector<Found> stars = starsBetween(20, 60, 0, 100, settings);
  const auto brighter = [&](float flux) {
    return double(std::count_if(stars.begin(), stars.end(), [&](const Found& one) { return one.light > flux * settings.brightness; }));
  };
  EXPECT_GT(stars.size(), 1500U);
  EXPECT_NEAR(brighter(0.08F) / brighter(0.04F), std::pow(2, -1.5), 0.06);
  EXPECT_EQ(brighter(1.001F), 0);
}

TEST(Stars, FallToHalfAtHalfTheirSize) {
  StarSettings settings;
  settings.count = 300;
  settings.tint = 0;
  settings.size_degrees = 0.5F;
  std::vector<Found> stars = starsBetween(20, 70, 0, 90, settings);
  ASSERT_GT(stars.size(), 5U);
  for (Found& star : stars) {
    // The exact centre, by going uphill.
    for (float step = 1e-3F; step > 1e-6F; step /= 2)
      for (int tries = 0; tries < 8; ++tries)
        for (const Vec3 aside : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
          const Vec3 other = *normalized(star.direction + aside * step);
          const float light = strongest(starLight(other, kNight, settings));
          if (light > star.light) star = {other, light};
        }
    const Vec3 aside = *normalized(cross(star.direction, Vec3{0, 1, 0}));
    const Vec3 half = *normalized(star.direction + aside * float(std::tan(0.25 * kPi / 180)));
    EXPECT_NEAR(strongest(starLight(half, kNight, settings)) / star.light, 0.5, 0.02);
  }
}

TEST(Stars, FadeByDayAndSet) {
  const StarSettings settings;
  const Vec3 star = starsBetween(40, 60, 0, 40, settings).front().direction;
  const float night = strongest(starLight(star, -0.2F, settings));
  EXPECT_GT(night, 0);
  EXPECT_EQ(strongest(starLight(star, -1, settings)), night);
  const float dusk = strongest(starLight(star, -0.12F, settings));
  EXPECT_TRUE(dusk > 0 && dusk < night) << dusk;
  EXPECT_EQ(starLight(star, -0.05F, settings), Vec3{});
  EXPECT_EQ(starLight(star, 0.5F, settings), Vec3{});
  for (float azimuth = 0; azimuth < 360; azimuth += 0.05F) EXPECT_EQ(starLight(directionFromAngles(azimuth, -1), kNight, settings), Vec3{});
}

TEST(Stars, TurnAboutTheirPoleAndChangeWithTheSeed) {
  StarSettings settings, turned, other;
  turned.turn_degrees = 30;
  other.seed = 1;
  const float c = std::cos(float(30 * kPi / 180)), s = std::sin(float(30 * kPi / 180));
  const Vec3 axis = settings.pole;
  int compared = 0, differ = 0;
  for (const Found& star : starsBetween(30, 60, 0, 60, settings)) {
    const Vec3 v = star.direction, moved = v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
    differ += strongest(starLight(v, kNight, other)) < 0.5F * star.light;
    if (moved.y < 0.3F) continue;
    EXPECT_NEAR(strongest(starLight(moved, kNight, turned)), star.light, 0.02F * star.light);
    ++compared;
  }
  EXPECT_GT(compared, 50);
  EXPECT_GT(differ, 50);
}

}  // namespace
}  // namespace cloudbake
