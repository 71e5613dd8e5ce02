// Limits of keys, for every type of a value.
#include "core/keys.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace cloudbake {
namespace {

struct Lamp {
  float power = 0.5F;
  double height = 2;
  int bulbs = 3;
  uint32_t seed = 0;
  bool is_on = true;
  Vec2 drift{0, 0};
  Vec3 color{1, 1, 1};
  uint64_t maker = 1;
  std::optional<float> warmth;
  std::optional<Vec3> shade;
};

const Keys<Lamp>& lampKeys() {
  using S = Lamp;
  static const Keys<S> keys{
      {"power", &S::power, 1e-6, 0.99, "its power"}, {"height", &S::height, 0, 10, "its height"},
      {"bulbs", &S::bulbs, 1, 8, "its bulbs"},       {"seed", &S::seed, 0, kMostSeed, "other lamps"},
      {"on", &S::is_on, 0, 1, "it shines"},          {"drift", &S::drift, -1, 1, "its drift"},
      {"color", &S::color, 0, 4, "its colour"},      {"maker", &S::maker, 1, 1e7, "its maker"},
      {"warmth", &S::warmth, 1, 9, "its warmth"},    {"shade", &S::shade, 0, 1, "colour of its shade"},
  };
  return keys;
}

// The name of the key that is out of its range, if any.
std::string refused(const auto& change) {
  Lamp lamp;
  change(lamp);
  try {
    requireInRange(lampKeys(), lamp);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Keys, AreInTheirRange) {
  EXPECT_EQ(refused([](Lamp&) {}), "");
  EXPECT_EQ(refused([](Lamp& l) { l.power = 0.99F, l.height = 10, l.bulbs = 8, l.drift = {-1, 1}, l.color = {0, 4, 0}; }), "");
  EXPECT_EQ(refused([](Lamp& l) { l.power = 1e-6F, l.height = 0, l.bulbs = 1, l.is_on = false, l.seed = 2147483647; }), "");
  EXPECT_EQ(refused([](Lamp& l) { l.power = 0.991F; }), "power is out of its range");
  EXPECT_EQ(refused([](Lamp& l) { l.power = NAN; }), "power is out of its range");
  EXPECT_EQ(refused([](Lamp& l) { l.height = std::numeric_limits<double>::infinity(); }), "height is out of its range");
  EXPECT_EQ(refused([](Lamp& l) { l.bulbs = 0; }), "bulbs is out of its range");
  EXPECT_EQ(refused([](Lamp& l) { l.seed = 2147483648U; }), "seed is out of its range");
  EXPECT_EQ(refused([](Lamp& l) { l.drift.y = 1.5F; }), "drift is out of its range");
  EXPECT_EQ(refused([](Lamp& l) { l.color.z = -0.1F; }), "color is out of its range");
  EXPECT_EQ(refused([](Lamp& l) { l.color.x = NAN; }), "color is out of its range");
  EXPECT_EQ(refused([](Lamp& l) { l.maker = 10000001; }), "maker is out of its range");
  EXPECT_EQ(refused([](Lamp& l) { l.warmth = 9.0F, l.shade = Vec3{0, 1, 0}; }), "");
  EXPECT_EQ(refused([](Lamp& l) { l.warmth = 0.0F; }), "warmth is out of its range");
  EXPECT_EQ(refused([](Lamp& l) { l.shade = Vec3{0, 1.5F, 0}; }), "shade is out of its range");
}

}  // namespace
}  // namespace cloudbake
