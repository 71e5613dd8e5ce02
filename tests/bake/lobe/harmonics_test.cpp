#include "bake/lobe/harmonics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bake/lobe/directions.h"
#include "core/harmonics.h"

namespace cloudbake {
namespace {

// P₀ … P₃ (Legendre).
double legendre(int band, double x) {
  return band == 0 ? 1 : band == 1 ? x : band == 2 ? (3 * x * x - 1) / 2 : (5 * x * x * x - 3 * x) / 2;
}

// The addition theorem: Σₘ Y(a) Y(b) = (2b + 1)/4π P(a·b) in every band. A wrong factor or sign of any harmonic breaks it.
TEST(Harmonics, AdditionTheorem) {
  const auto directions = fibonacciDirections(50);
  for (const Vec3& a : directions)
    for (const Vec3& b : directions) {
      const auto at_a = evaluateHarmonics(a), at_b = evaluateHarmonics(b);
      for (int band = 0; band <= kMaxHarmonicOrder; ++band) {
        double sum = 0;
        for (size_t i = size_t(band) * size_t(band); i < harmonicCount(band); ++i) sum += double(at_a[i]) * at_b[i];
        EXPECT_NEAR(sum, (2 * band + 1) / (4 * kPi) * legendre(band, dot(a, b)), 2e-6) << band;
      }
    }
}

TEST(Harmonics, Orthonormal) {
  const auto directions = fibonacciDirections(20000);
  for (size_t i = 0; i < kMaxHarmonics; ++i)
    for (size_t k = 0; k <= i; ++k) {
      double sum = 0;
      for (const Vec3& direction : directions) sum += double(evaluateHarmonics(direction)[i]) * evaluateHarmonics(direction)[k];
      EXPECT_NEAR(sum * 4 * kPi / double(directions.size()), i == k ? 1 : 0, 1e-3) << i << " " << k;
    }
}

// What lies in the span comes back, from few directions.
TEST(Harmonics, FitIsExactInItsSpan) {
  const std::vector<Vec3> directions = fibonacciDirections(40);
  for (int order = 1; order <= kMaxHarmonicOrder; ++order) {
    std::vector<float> wanted{1.4F};
    for (size_t i = 1; i < harmonicCount(order); ++i) wanted.push_back(0.03F * float(int(i % 5) - 2));
    std::vector<float> values;
    for (const Vec3& direction : directions) {
      double value = 0;
      for (size_t i = 0; i < wanted.size(); ++i) value += double(wanted[i]) * evaluateHarmonics(direction)[i];
      values.push_back(float(value));
    }
    const std::vector<float> found = fitHarmonics(directions, values, order);
    ASSERT_EQ(found.size(), wanted.size());
    for (size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 3e-6) << i;
  }
}

// A vertex of a ball of radius 1: ℓ = 2 max(0, c), c = cos of the angle to the inward normal. T in bands of P_b(c):
// a_b = (2b + 1)/2 ∫ T(c) P_b(c) dc; what is left is the error of the truncated series.
TEST(Harmonics, BallVertexAgainstItsLegendreSeries) {
  const double extinction = 3;
  const Vec3 inward = *normalized(Vec3{0.3F, -0.8F, 0.5F});
  const auto transmittance = [&](double c) { return std::exp(-extinction * 2 * std::max(0.0, c)); };
  const auto directions = fibonacciDirections(4096);
  std::vector<float> values;
  for (const Vec3& direction : directions) values.push_back(float(transmittance(dot(direction, inward))));
  double rms_before = 1;
  for (int order = 1; order <= kMaxHarmonicOrder; ++order) {
    std::array<double, 4> series{};
    constexpr int kSteps = 20000;
    for (int band = 0; band <= order; ++band)
      for (int i = 0; i < kSteps; ++i) {
        const double c = -1 + (i + 0.5) * 2 / kSteps;
        series[size_t(band)] += (2 * band + 1) / 2.0 * transmittance(c) * legendre(band, c) * 2 / kSteps;
      }
    const std::vector<float> found = fitHarmonics(directions, values, order);
    double squares = 0;
    for (const Vec3& direction : fibonacciDirections(500)) {
      const double c = dot(direction, inward);
      double expected = 0;
      for (int band = 0; band <= order; ++band) expected += series[size_t(band)] * legendre(band, c);
      EXPECT_NEAR(harmonicTransmittance(found, direction), std::clamp(expected, 0.0, 1.0), 2e-3);
      squares += std::pow(harmonicTransmittance(found, direction) - transmittance(c), 2);
    }
    const double rms = std::sqrt(squares / 500);
    EXPECT_LT(rms, rms_before) << "a higher order is nearer";
    rms_before = rms;
  }
}

TEST(Harmonics, TransmittanceStaysInRange) {
  const std::vector<float> strong{0, 5, -5, 5};
  for (const Vec3& direction : fibonacciDirections(100)) {
    const float t = harmonicTransmittance(strong, direction);
    EXPECT_TRUE(t >= 0 && t <= 1);
  }
}

}  // namespace
}  // namespace cloudbake
