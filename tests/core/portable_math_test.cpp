// Errors against the C library's functions of long doubles, whose 64 bits leave 11 beyond those of a double.
#include "core/portable_math.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "core/exp_log.h"
#include "core/random.h"
#include "core/vec3.h"

using namespace cloudbake;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kLeast = std::numeric_limits<double>::denorm_min();
constexpr long double kTrueDegrees = 180 / 3.14159265358979323846264338327950288L;
constexpr uint32_t kDraws = 200'000;

/// The i-th draw of a stream in [low, high).
double drawn(uint64_t stream, uint32_t i, double low, double high) {
  return low + (high - low) * double(hashDraw(stream, i, 0) >> 11U) * 0x1p-53;
}
/// One with any exponent between two, and any sign.
double drawnOfAnySize(uint64_t stream, uint32_t i, int low, int high) {
  const double size = std::ldexp(drawn(stream, i, 1, 2), int(drawn(stream + 1, i, low, high)));
  return i % 2 == 0 ? size : -size;
}

/// Keeps the largest error in units in the last place.
class Largest {
 public:
  void add(double found, long double truth, double argument, double units = 1) {
    const auto rounded = double(truth);
    if (std::isinf(rounded) || std::isnan(rounded) || found == rounded) {
      EXPECT_TRUE(found == rounded || (std::isnan(found) && std::isnan(rounded))) << found << " for " << rounded << " at " << argument;
      return;
    }
    const int exponent = std::max(std::ilogb(rounded), std::numeric_limits<double>::min_exponent - 1);
    const auto error = double(std::fabs(found - truth)) / std::ldexp(1.0, exponent - 52) / units;
    if (error > error_) error_ = error, at_ = argument;
  }
  void expectAtMost(double bound, const char* name) const {
    std::printf("[figures] %s: %.2f ulp at %.17g\n", name, error_, at_);
    EXPECT_LE(error_, bound) << name << " at " << at_;
  }

 private:
  double error_ = 0, at_ = 0;
};

}  // namespace

TEST(PortableMath, ExpAndLog) {
  Largest exp, log;
  for (uint32_t i = 0; i < kDraws; ++i) {
    for (const double x : {drawn(1, i, -746, 710), drawn(2, i, -1, 1), drawnOfAnySize(3, i, -70, 12)})
      exp.add(portableExp(x), std::exp(static_cast<long double>(x)), x);
    for (const double x : {std::fabs(drawnOfAnySize(5, i, -1074, 1023)), drawn(7, i, 0.5, 2), 1 + drawnOfAnySize(8, i, -52, -2)})
      log.add(portableLog(x), std::log(static_cast<long double>(x)), x);
  }
  exp.expectAtMost(1.1, "exp");
  log.expectAtMost(1, "log");
}

TEST(PortableMath, Trigonometry) {
  Largest sine, cosine, tangent, angle, degrees, arcsine, arccosine;
  for (uint32_t i = 0; i < kDraws; ++i) {
    for (const double x :
         {drawn(1, i, -400, 400), drawnOfAnySize(2, i, -60, 1023), 90 * std::floor(drawn(4, i, -9, 9)) + drawn(5, i, -1e-6, 1e-6)}) {
      int quadrant = 0;
      const long double r = std::remquo(std::fmod(static_cast<long double>(x), 360.0L), 90.0L, &quadrant) / kTrueDegrees;
      const bool is_odd = (quadrant & 1) != 0;
      const long double s = is_odd ? std::cos(r) : std::sin(r), c = is_odd ? -std::sin(r) : std::cos(r),
                        sign = (quadrant & 2) != 0 ? -1 : 1;
      const SinCos found = sinCosDegrees(x);
      sine.add(found.sin, sign * s, x);
      cosine.add(found.cos, sign * c, x);
      if (c != 0) tangent.add(tanDegrees(x), s / c, x);
    }
    const double y = drawnOfAnySize(6, i, -20, 20), x = drawnOfAnySize(8, i / 2, -20, 20);
    const long double truth = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    angle.add(portableAtan2(y, x), truth, y / x);
    degrees.add(atan2Degrees(y, x), truth * kTrueDegrees, y / x);
    for (const double ratio : {drawn(10, i, -1, 1), 1 + std::ldexp(-drawn(11, i, 0, 1), -int(i % 50)), drawnOfAnySize(12, i, -60, -1)}) {
      arcsine.add(asinDegrees(ratio), std::asin(static_cast<long double>(ratio)) * kTrueDegrees, ratio);
      arccosine.add(acosDegrees(ratio), std::acos(static_cast<long double>(ratio)) * kTrueDegrees, ratio);
    }
  }
  sine.expectAtMost(3, "sin");
  cosine.expectAtMost(3, "cos");
  tangent.expectAtMost(6, "tan");
  angle.expectAtMost(7, "atan2");
  degrees.expectAtMost(7, "atan2 in degrees");
  arcsine.expectAtMost(7, "asin in degrees");
  arccosine.expectAtMost(7, "acos in degrees");
}

TEST(PortableMath, Powers) {
  Largest power, whole;
  for (uint32_t i = 0; i < kDraws; ++i) {
    const double x = std::fabs(drawnOfAnySize(1, i, -100, 100)), y = drawn(3, i, -7, 7);
    const long double exponent = y * std::log(static_cast<long double>(x));
    power.add(portablePow(x, y), std::pow(static_cast<long double>(x), static_cast<long double>(y)), x, 1 + std::fabs(double(exponent)));
    const int n = int(drawn(4, i, 1, 1024));
    const double base = drawn(5, i, std::exp2(-1000.0 / n), std::exp2(1000.0 / n));
    for (const int one : {n, -n})
      whole.add(portablePow(base, one), std::pow(static_cast<long double>(base), static_cast<long double>(one)), base, n);
  }
  power.expectAtMost(2, "pow, of 1 + |y ln x|");
  whole.expectAtMost(1, "pow, whole y, of |y|");
}

// The nearest float, within the given share of a unit.
TEST(PortableMath, Floats) {
  const auto errorOf = [](float found, double truth) {
    const int exponent = std::max(std::ilogb(float(truth)), std::numeric_limits<float>::min_exponent - 1);
    return float(truth) == found ? 0 : std::fabs(double(found) - truth) / std::ldexp(1.0, exponent - 23);
  };
  double worst = 0;
  for (uint32_t bits = 1; bits < 0x7F800000U; bits += 2503) {
    const auto x = std::bit_cast<float>(bits);
    if (x < 88) worst = std::max({worst, errorOf(portableExp(x), std::exp(double(x))), errorOf(portableExp(-x), std::exp(-double(x)))});
    worst =
        std::max({worst, errorOf(portableLog(x), std::log(double(x))), errorOf(portablePow(x, 0.41F), std::pow(double(x), double(0.41F)))});
  }
  EXPECT_LE(worst, 0.51);
}

TEST(PortableMath, ExtremesAreThoseOfIeee) {
  EXPECT_EQ(portableExp(0.0), 1);
  EXPECT_EQ(portableExp(-kInfinity), 0);
  EXPECT_EQ(portableExp(kInfinity), kInfinity);
  EXPECT_EQ(portableExp(1e300), kInfinity);
  EXPECT_EQ(portableExp(-1e300), 0);
  EXPECT_EQ(portableExp(100.0F), std::numeric_limits<float>::infinity());
  EXPECT_EQ(portableExp(-745.0), kLeast);
  EXPECT_TRUE(std::isnan(portableExp(kNan)));
  EXPECT_EQ(portableLog(1.0), 0);
  EXPECT_EQ(portableLog(0.0), -kInfinity);
  EXPECT_EQ(portableLog(kInfinity), kInfinity);
  EXPECT_EQ(portableLog(kLeast), std::log(kLeast));
  EXPECT_TRUE(std::isnan(portableLog(-1.0)));
  EXPECT_TRUE(std::isnan(portableLog(kNan)));
  EXPECT_TRUE(std::isnan(sinCosDegrees(kInfinity).sin) && std::isnan(sinCosDegrees(-kInfinity).cos));
  EXPECT_TRUE(std::isnan(sinCosDegrees(kNan).sin) && std::isnan(tanDegrees(kNan)));
  EXPECT_EQ(sinCosDegrees(0x1p1000).cos, sinCosDegrees(std::fmod(0x1p1000, 360)).cos);
  EXPECT_EQ(sinCosDegrees(kLeast).cos, 1);
  EXPECT_EQ(tanDegrees(90), kInfinity);
  EXPECT_EQ(tanDegrees(45), 1);
  EXPECT_EQ(atan2Degrees(0, -1), 180);
  EXPECT_EQ(atan2Degrees(0, 0), 0);
  EXPECT_EQ(atan2Degrees(-3, 0), -90);
  EXPECT_EQ(atan2Degrees(1, kInfinity), 0);
  EXPECT_EQ(atan2Degrees(1, -kInfinity), 180);
  EXPECT_EQ(portableAtan2(kInfinity, -1), kPi / 2);
  EXPECT_TRUE(std::isnan(portableAtan2(kNan, 1)) && std::isnan(portableAtan2(0, kNan)));
  EXPECT_EQ(asinDegrees(-1), -90);
  EXPECT_EQ(acosDegrees(-1), 180);
  EXPECT_TRUE(std::isnan(asinDegrees(1.0001)) && std::isnan(acosDegrees(-1.0001)));
  EXPECT_TRUE(std::isnan(portablePow(-1.0, 0.3)));
  EXPECT_EQ(portablePow(-2.0, 3.0), -8);
  EXPECT_EQ(portablePow(10.0, -2.0), 0.01);
  EXPECT_NEAR(portablePow(10.0, -320.0), 1e-320, 1e-323);
  EXPECT_EQ(portablePow(0.0, 0.0), 1);
  EXPECT_EQ(portablePow(0.0, 2.3), 0);
  EXPECT_EQ(portablePow(0.0, -2.3), kInfinity);
  EXPECT_EQ(portablePow(kInfinity, 2.3), kInfinity);
  EXPECT_EQ(portablePow(2.0, kInfinity), kInfinity);
  EXPECT_EQ(portablePow(2.0, -kInfinity), 0);
  EXPECT_TRUE(std::isnan(portablePow(kNan, 0.3)) && std::isnan(portablePow(2.0, kNan)));
}

TEST(PortableMath, IsExactAtRightAngles) {
  for (int q = -8; q <= 8; ++q) {
    const SinCos a = sinCosDegrees(90.0 * q);
    EXPECT_EQ(a.sin, double((q & 1) == 0 ? 0 : ((q & 3) == 1 ? 1 : -1)));
    EXPECT_EQ(a.cos, double((q & 1) == 1 ? 0 : ((q & 3) == 0 ? 1 : -1)));
    EXPECT_FALSE(std::signbit(a.sin) && a.sin == 0) << q;
    EXPECT_FALSE(std::signbit(a.cos) && a.cos == 0) << q;
  }
}

// All bits, over numbers of every kind, as GCC and Clang give them at every level of optimisation. Another compiler or processor must give
// the same. NaN counts as NaN, whatever its bits.
TEST(PortableMath, BitsAreTheseEverywhere) {
  uint64_t hash = 0xCBF29CE484222325ULL;  // FNV-1a
  const auto add = [&](double x) {
    const uint64_t bits = std::isnan(x) ? 0 : std::bit_cast<uint64_t>(x);
    for (unsigned shift = 0; shift < 64; shift += 8) hash = (hash ^ (bits >> shift & 0xFFU)) * 0x100000001B3ULL;
  };
  for (uint32_t i = 0; i < kDraws; ++i) {
    const auto any = std::bit_cast<double>(hashDraw(1, i, 0)), other = std::bit_cast<double>(hashDraw(2, i, 0));
    const double usual = drawn(3, i, -700, 700), unit = drawn(4, i, -1, 1), positive = drawn(5, i, 0, 9);
    for (const double x : {any, usual, unit}) {
      const SinCos angle = sinCosDegrees(x);
      add(angle.sin), add(angle.cos), add(tanDegrees(x)), add(portableExp(x)), add(portableLog(x)), add(double(portableExp(float(unit))));
    }
    add(portableAtan2(any, other)), add(portableAtan2(usual, unit)), add(atan2Degrees(unit, usual)), add(asinDegrees(unit));
    add(acosDegrees(unit)), add(portablePow(positive, unit)), add(portablePow(any, other)), add(portablePow(usual, double(i % 40) - 20));
    add(double(expMinus(float(10 * positive)))), add(double(minusLog(float(positive + 1e-9))));
  }
  EXPECT_EQ(hash, 0xF38A9C16AEADBD27ULL) << std::hex << hash;
}
