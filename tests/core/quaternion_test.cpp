#include "core/quaternion.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/portable_math.h"

namespace cloudbake {
namespace {

Quaternion about(std::array<double, 3> axis, double degrees) {
  const auto [sin, cos] = sinCosDegrees(degrees / 2);
  return {axis[0] * sin, axis[1] * sin, axis[2] * sin, cos};
}

void expectNear(const Quaternion& a, const Quaternion& b, double sign = 1) {
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(a[i], sign * b[i], 1e-12) << i;
}

TEST(Quaternion, TurnsPoints) {
  const Vec3 turned = transformVector(rotationBy(about({0, 0, 1}, 90)), {1, 0, 0});
  EXPECT_NEAR(turned.x, 0, 1e-7);
  EXPECT_NEAR(turned.y, 1, 1e-7);
}

TEST(Quaternion, SlerpTurnsAtAnEvenSpeed) {
  const std::array<double, 3> axis{1.0 / 3, 2.0 / 3, -2.0 / 3};
  for (const double whole : {1e-9, 0.001, 30.0, 120.0, 179.0})
    for (const double t : {0.0, 0.1, 1.0 / 3, 0.5, 0.9, 1.0})
      expectNear(slerp(about(axis, 20), about(axis, 20 + whole), t), about(axis, 20 + t * whole));
}

TEST(Quaternion, SlerpTakesTheShorterWay) {
  Quaternion other = about({0, 1, 0}, 60);
  for (double& x : other) x = -x;
  expectNear(slerp(about({0, 1, 0}, 0), other, 0.25), about({0, 1, 0}, 15));
  expectNear(slerp(about({0, 1, 0}, 0), about({0, 1, 0}, 300), 0.5), about({0, 1, 0}, -30));
}

TEST(Quaternion, ZeroHasNoDirection) {
  EXPECT_FALSE(normalized(Quaternion{0, 0, 0, 0}));
  EXPECT_FALSE(normalized(Quaternion{0, NAN, 0, 1}));
  expectNear(*normalized(Quaternion{0, 3, 0, -4}), {0, 0.6, 0, -0.8});
}

}  // namespace
}  // namespace cloudbake
