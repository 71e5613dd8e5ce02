// The tone curve at many values against its formulas, on every target of Highway that this CPU can run.
#include "preview/mesh_clouds/tone_kernels.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/forced_target.h"

namespace cloudbake {
namespace {

// The formulas in double, with the exponent as float has it.
double encodedTone(double value, double exposure) {
  const double x = std::min(std::max(0.0, value * exposure), 1e6);
  const double film = std::min(1.0, x * (double(2.51F) * x + double(0.03F)) / (x * (double(2.43F) * x + double(0.59F)) + double(0.14F)));
  return film <= 0.0031308 ? 12.92 * film : 1.055 * std::pow(film, double(1 / 2.4F)) - 0.055;
}

TEST(ToneKernels, FollowTheFormulasOnEveryTarget) {
  std::vector<float> values;
  for (int i = 0; i < 4003; ++i) values.push_back(std::exp2(float(i) / 200 - 14));  // 2⁻¹⁴ … 2⁶; no vector ends with the last
  std::vector<float> first;
  for (const int64_t target : runnableTargets()) {
    const ForcedTarget forced(target);
    std::vector<float> found = values;
    encodeTones(found.data(), found.size(), 0.75F);
    for (size_t i = 0; i < values.size(); ++i) ASSERT_NEAR(found[i], encodedTone(values[i], 0.75), 2e-7) << values[i] << ' ' << target;
    if (first.empty()) first = found;
    for (size_t i = 0; i < values.size(); ++i) ASSERT_EQ(std::bit_cast<uint32_t>(found[i]), std::bit_cast<uint32_t>(first[i])) << target;
  }
}

// The power is that of the library, rounded to a float, at nearly all values.
TEST(ToneKernels, PowersAreRoundedFromMoreDigits) {
  std::vector<float> values, found;
  for (int i = 0; i < 4000; ++i) values.push_back(0.005F + float(i) / 1500);
  found = values;
  encodeTones(found.data(), found.size(), 1);
  int equal = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    const float x = values[i], film = std::min(1.0F, x * (2.51F * x + 0.03F) / (x * (2.43F * x + 0.59F) + 0.14F));
    equal += film > 0.0031308F && found[i] == 1.055F * float(std::pow(double(film), double(1 / 2.4F))) - 0.055F;
  }
  EXPECT_GT(equal, 3950);
}

TEST(ToneKernels, AnyValueHasATone) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<float> values{0, -0.0F, -1, -kInfinity, NAN, kInfinity, 1e38F, 1e-40F};
  encodeTones(values.data(), values.size(), 10);
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ(values[i], 0) << i;
  EXPECT_NEAR(values[5], 1, 1e-6);
  EXPECT_NEAR(values[6], 1, 1e-6);
  EXPECT_NEAR(values[7], 0, 1e-30);
}

// What is beyond the last value stays as it is.
TEST(ToneKernels, EndsWithTheLastValue) {
  for (size_t count = 0; count < 20; ++count) {
    std::vector<float> values(21, 0.5F);
    encodeTones(values.data(), count, 1);
    for (size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i] == 0.5F, i >= count) << count << ' ' << i;
  }
}

}  // namespace
}  // namespace cloudbake
