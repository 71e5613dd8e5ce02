#include "bake/lobe/light_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/exp_log.h"

namespace cloudbake {
namespace {

// Lengths with the cases at the ends: a little below 0, as a sharpened field gives, and so long that nothing is left.
std::vector<float> lengthsOfAllSizes(size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> exponent(-4, 3);
  std::vector<float> lengths{0, -0.01F, -0.3F, 43, 44, 87, 90, 1e4F};
  while (lengths.size() < count) lengths.push_back(std::pow(10.0F, exponent(random)));
  return lengths;
}

// The same sums one after the other, in the order that the kernel promises: eight lanes, then the lanes.
float plainSum(const std::vector<float>& exponents, const std::vector<float>& octave_weights, const std::vector<float>& lengths,
               const std::vector<float>& weights, const std::vector<float>& phases, const std::vector<int32_t>& views) {
  float lanes[8] = {}, sum = 0;
  for (size_t n = 0; n < lengths.size(); ++n) {
    float light = 0;
    for (size_t i = 0; i < exponents.size(); ++i) {
      const float phase = phases.empty() ? 1 : phases[i * phases.size() / exponents.size() + size_t(views[n])];
      light += octave_weights[i] * phase * expMinus(std::max(exponents[i] * lengths[n], 0.0F));
    }
    lanes[n % 8] += light * weights[n];
  }
  for (const float lane : lanes) sum += lane;
  return sum;
}

TEST(LightKernels, SumIsThatOfPlainCodeBitForBit) {
  const std::vector<float> lengths = lengthsOfAllSizes(64), phases{0.3F, 1.7F, 0.9F, 1.1F};
  std::vector<float> ones(lengths.size(), 1), falling;
  std::vector<int32_t> views;
  for (size_t n = 0; n < lengths.size(); ++n) falling.push_back(1 / float(n + 1)), views.push_back(int32_t(n % 2));
  const std::vector<std::vector<float>> weights{ones, falling};
  // Exponents 1 and 3 and no squares: σ = 3 with a = 1/3, and σ = 1 with a = 3
  const LightTerms terms{{{1, false}, {3, false}}, {1, 0, 0, 1}, {0.75F, 0.25F}};
  float scratch[8 * 4], sums[2];
  for (const bool has_phases : {false, true}) {
    const LitSamples samples{lengths.data(), views.data(), lengths.size(), has_phases ? phases.data() : nullptr, 2};
    sumLight(terms, samples, weights, scratch, sums);
    const std::vector<float> used = has_phases ? phases : std::vector<float>{};
    EXPECT_EQ(sums[0], plainSum({3, 1}, terms.octave_weights, lengths, ones, used, views));
    EXPECT_EQ(sums[1], plainSum({1, 3}, terms.octave_weights, lengths, falling, used, views));
  }
}

// e^(−2ℓ) as a square is as near as the exponential itself, to a few units in the last place.
TEST(LightKernels, SquaresStandForExponentials) {
  const std::vector<float> lengths{0, 0.1F, 0.5F, 1, 2, 5, 10, 40};
  const std::vector<int32_t> views(8);
  const LightTerms terms{{{1, false}, {2, true}}, {0, 1}, {1}};
  float scratch[8 * 4], sums[2];
  for (size_t n = 0; n < 8; ++n) {
    std::vector<float> one(8);
    one[n] = 1;
    const std::vector<std::vector<float>> weights{one, one};
    sumLight(terms, {lengths.data(), views.data(), 8}, weights, scratch, sums);
    EXPECT_NEAR(sums[0] / std::exp(-lengths[n]), 1, 1e-6) << n;
    EXPECT_NEAR(sums[1] / std::exp(-2 * lengths[n]), 1, 1e-6) << n;
  }
}

}  // namespace
}  // namespace cloudbake
