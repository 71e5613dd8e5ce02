#include "core/lobe_lighting.h"

#include <gtest/gtest.h>

using namespace cloudbake;

// Published constants (k = 3, b = −0.01): towards the bulk s = d + b, at a right angle s = d/8 + b, away 0.
TEST(LobeLighting, HasThePublishedValues) {
  const Lobe lobe{{0, 0, 1}, 2};
  const LobeShape shape{3, -0.01F};
  EXPECT_FLOAT_EQ(lobeThickness(lobe, {0, 0, 1}, shape), 1.99F);
  EXPECT_FLOAT_EQ(lobeThickness(lobe, {1, 0, 0}, shape), 0.24F);
  EXPECT_EQ(lobeThickness(lobe, {0, 0, -1}, shape), 0);
  EXPECT_FLOAT_EQ(lobeTransmittance(lobe, {0, 0, 1}, shape, 0.5F), std::exp(-0.995F));
}

// l·o/2 + 1/2 falls under 0 by rounding at l = −o; pow of that with a broken exponent would be NaN.
TEST(LobeLighting, IsFiniteAtTheOppositeDirection) {
  const Lobe lobe{{0.57735034F, 0.57735034F, 0.57735034F}, 3};
  for (const float exponent : {0.5F, 2.5F, 3.0F, 7.3F}) {
    const float transmittance = lobeTransmittance(lobe, -1.0000002F * lobe.direction, {exponent, -0.01F}, 2);
    EXPECT_EQ(transmittance, 1) << exponent;
  }
}

// A negative bias must not light a vertex above 1.
TEST(LobeLighting, TransmittanceNeverExceedsOne) {
  for (float cosine = -1; cosine <= 1; cosine += 0.125F) {
    const Vec3 light{std::sqrt(1 - cosine * cosine), 0, cosine};
    const float t = lobeTransmittance({{0, 0, 1}, 0.001F}, light, {3, -0.5F}, 10);
    EXPECT_GE(t, 0);
    EXPECT_LE(t, 1);
  }
}

TEST(LobeLighting, IntegerExponentsAgreeWithPow) {
  for (const float k : {0.0F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 16.0F})
    for (float x = 0; x <= 1; x += 0.0625F) EXPECT_NEAR(lobePower(x, k), std::pow(double(x), double(k)), 1e-6) << x << "^" << k;
}
