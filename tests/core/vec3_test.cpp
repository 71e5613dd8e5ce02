#include "core/affine.h"

#include <gtest/gtest.h>

using namespace cloudbake;

// A zero or non-finite vector has no direction: dividing by its norm would spread NaN.
TEST(Vec3, NormalizeOfZeroIsNothing) {
  EXPECT_FALSE(normalized({0, 0, 0}));
  EXPECT_FALSE(normalized({INFINITY, 0, 0}));
  EXPECT_FALSE(normalized({NAN, 0, 0}));
}

// Squares of 1e-30 and 1e30 leave float's range; the norm must not.
TEST(Vec3, NormalizeHasNoScale) {
  for (const float scale : {1e-38F, 1e-30F, 1.0F, 1e30F}) {
    const auto unit = normalized({3 * scale, 0, 4 * scale});
    ASSERT_TRUE(unit);
    EXPECT_FLOAT_EQ(unit->x, 0.6F);
    EXPECT_FLOAT_EQ(unit->z, 0.8F);
  }
}

// acos of a rounded cosine loses angles under 0.02 degrees, and is NaN past 1.
TEST(Vec3, SmallAnglesAreExact) {
  const float a = 1e-5F;
  EXPECT_NEAR(angleDegrees({1, 0, 0}, {std::cos(a), std::sin(a), 0}), a * 180 / kPi, 1e-9);
  EXPECT_EQ(angleDegrees({0, 1, 0}, {0, 1, 0}), 0);
  EXPECT_DOUBLE_EQ(angleDegrees({0, 0, 1}, {0, 0, -1}), 180);
}

TEST(Vec3, FrameIsRightHandedEverywhere) {
  for (const Vec3 v : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{-0.48F, 0.6F, -0.64F}}) {
    const Frame frame = frameAround(v);
    EXPECT_NEAR(length(frame.tangent), 1, 1e-6);
    EXPECT_NEAR(dot(frame.tangent, v), 0, 1e-6);
    EXPECT_NEAR(length(cross(frame.tangent, frame.bitangent) - v), 0, 1e-6);
  }
}

TEST(Vec3, InverseUndoesAMirroredNonUniformMap) {
  const Affine m{{{{-2, 0.5, 0}, {0, 3, 1}, {0.25, 0, 0.5}}}, {5, -7, 11}};
  const auto inverse = inverted(m);
  ASSERT_TRUE(inverse);
  const Vec3 p{1.5F, -2, 3}, back = transformPoint(*inverse, transformPoint(m, p));
  EXPECT_NEAR(length(back - p), 0, 1e-5);
  EXPECT_LT(determinant(m), 0);
  EXPECT_FALSE(inverted(Affine{{{{1, 0, 0}, {0, 0, 0}, {0, 0, 1}}}, {0, 0, 0}}));
}

TEST(Vec3, BoxOfNothingIsEmpty) {
  Box box;
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box.diagonal(), 0);
  box.add({1, 2, 3});
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.longestSide(), 0);
  box.add({4, 6, 3});
  EXPECT_EQ(box.diagonal(), 5);
}
