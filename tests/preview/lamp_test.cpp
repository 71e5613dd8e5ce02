// Lamps and lightning.
#include "preview/lamp.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cloudbake {
namespace {

const Lobe kNoCloud{{0, 1, 0}, 0};

TEST(Lamp, FallsOffWithTheSquareOfTheDistance) {
  EXPECT_FLOAT_EQ(lampFalloff(3, 0, 0.1F), 1.0F / 9);
  EXPECT_FLOAT_EQ(lampFalloff(0.01F, 0, 0.5F), 4) << "within the radius it gets no brighter";
  EXPECT_TRUE(std::isfinite(lampFalloff(0, 0, 0)));
  // The range ends it without a step.
  EXPECT_EQ(lampFalloff(5, 5, 0.1F), 0);
  EXPECT_EQ(lampFalloff(7, 5, 0.1F), 0);
  EXPECT_LT(lampFalloff(4.99F, 5, 0.1F), 1e-3F);
  EXPECT_NEAR(lampFalloff(0.5F, 5, 0.1F), 4, 0.01F) << "near the lamp it changes nothing";
}

TEST(Lamp, ShinesInItsCone) {
  const Vec2 cone{std::cos(0.2F), std::cos(0.5F)};
  const auto at = [&](float angle) { return lampCone({std::sin(angle), std::cos(angle), 0}, {0, -1, 0}, cone); };
  EXPECT_EQ(at(0), 1);
  EXPECT_EQ(at(0.19F), 1);
  EXPECT_GT(at(0.3F), at(0.4F));
  EXPECT_EQ(at(0.51F), 0);
  EXPECT_EQ(at(3), 0);
  EXPECT_EQ(lampCone({0, 1, 0}, {0, 1, 0}, {-1, -1}), 1) << "a point light shines to all sides";
}

TEST(Lamp, CountsNoMoreCloudThanLiesBeforeIt) {
  const Lamp lamp{{0, 2, 0}, {1, 2, 3}, 0, 0.1F};
  const Lobe thick{{0, 1, 0}, 10};
  const auto lit = [&](const Lobe& lobe, Vec3 place) { return lampLight(lamp, lobe, place, {0, 1, 0}, 1, {3, 0}, 0.5F).y; };
  EXPECT_FLOAT_EQ(lit(kNoCloud, {0, 0, 0}), 2.0F / 4);
  EXPECT_FLOAT_EQ(lit(thick, {0, 0, 0}), 2.0F / 4 * std::exp(-0.5F * 2));
  EXPECT_FLOAT_EQ(lit(thick, {0, -30, 0}), 2.0F / (32 * 32) * std::exp(-0.5F * 10));
  EXPECT_FLOAT_EQ(lit(thick, {0, 2, 0}), 2.0F / 0.01F) << "at the lamp nothing is before it";
}

TEST(Lightning, FollowsSeedAndTime) {
  LightningSettings settings;
  settings.place = {1, 2, 3}, settings.spread = {4, 0, 0.5F}, settings.every_seconds = 6;
  const std::vector<Flash> flashes = flashesOf(settings);
  ASSERT_EQ(flashes.size(), size_t(kFlashes));
  for (const Flash& flash : flashes) {
    EXPECT_LE(std::abs(flash.place.x - 1), 4);
    EXPECT_EQ(flash.place.y, 2);
    ASSERT_FALSE(flash.strokes.empty());
    EXPECT_EQ(flash.strokes[0].y, 1);
    float before = -1;
    for (const Vec2 stroke : flash.strokes) {
      EXPECT_GE(stroke.x - before, 0.03F);
      before = stroke.x;
    }
    EXPECT_LT(flashBrightness(flash, settings.every_seconds, settings.decay_seconds), kDarkFlash) << "it ends in its stretch";
  }
  EXPECT_NE(flashes[0].place, flashes[1].place);
  EXPECT_EQ(flashesOf(settings)[5].strokes, flashes[5].strokes);
  LightningSettings other = settings;
  other.seed = 1;
  EXPECT_NE(flashesOf(other)[0].place, flashes[0].place);
  // The third flash, and the same one after all others.
  const double start = 2 * 6 + double(flashes[2].strokes[0].x);
  for (const double seconds : {start + 0.001, start + 0.001 + kFlashes * 6}) {
    const std::vector<Lamp> lamps = lampsAt({}, {&settings, 1}, seconds);
    ASSERT_EQ(lamps.size(), 1U);
    EXPECT_EQ(lamps[0].place, flashes[2].place);
    EXPECT_NEAR(lamps[0].color.z, std::exp(-0.001F / 0.05F), 1e-3F);
  }
  EXPECT_TRUE(lampsAt({}, {&settings, 1}, start - 0.001).empty()) << "before it, it is dark";
}

// The counts that the source gives.
TEST(Lightning, HasAsManyStrokesAsFlashesHave) {
  double strokes = 0, single = 0, seconds = 0, intervals = 0, later = 0;
  constexpr uint32_t kSeeds = 200;
  LightningSettings settings;
  for (settings.seed = 0; settings.seed < kSeeds; ++settings.seed)
    for (const Flash& flash : flashesOf(settings)) {
      strokes += double(flash.strokes.size());
      single += flash.strokes.size() == 1;
      for (size_t i = 1; i < flash.strokes.size(); ++i)
        seconds += double(flash.strokes[i].x - flash.strokes[i - 1].x), later += double(flash.strokes[i].y), ++intervals;
    }
  EXPECT_NEAR(strokes / (kSeeds * kFlashes), 3.3, 0.3);
  EXPECT_NEAR(single / (kSeeds * kFlashes), 0.305, 0.03);
  EXPECT_NEAR(seconds / intervals, 0.062, 0.002);
  EXPECT_NEAR(later / intervals, 0.52, 0.02);
}

TEST(Lightning, MayBeASingleFlash) {
  LightningSettings settings;
  settings.at = 7.5F;
  EXPECT_EQ(flashesOf(settings).size(), 1U);
  EXPECT_TRUE(lampsAt({}, {&settings, 1}, 7.4).empty());
  EXPECT_EQ(lampsAt({}, {&settings, 1}, 7.51).size(), 1U);
  EXPECT_TRUE(lampsAt({}, {&settings, 1}, 60).empty());
}

}  // namespace
}  // namespace cloudbake
