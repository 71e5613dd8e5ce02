// The noises at many points have the bits of the noise at one point, on every target of Highway that this CPU can run.
#include "preview/backdrop/noise_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "core/random.h"
#include "preview/backdrop/terrain_kernels.h"
#include "tests/forced_target.h"

namespace cloudbake {
namespace {

constexpr size_t kPoints = 1003;  // so that no vector ends with the last

/// Coordinates of both signs, some on the lattice, some far out.
struct Points {
  std::vector<float> x, y, z, limit;
  Points() {
    for (size_t i = 0; i < kPoints; ++i) {
      const auto draw = [i](uint32_t what) { return uniformFloat(hashDraw(3, uint32_t(i), what)); };
      const float range = i % 5 == 0 ? 40000 : 40;
      const auto coordinate = [&](uint32_t what) {
        const float c = (draw(what) - 0.5F) * range;
        return i % 7 == 0 ? std::round(c) : c;
      };
      x.push_back(coordinate(0)), y.push_back(coordinate(1)), z.push_back(coordinate(2));
      limit.push_back(i % 3 == 0 ? INFINITY : draw(3));
    }
  }
};

// Equal, and of the same sign where 0; the kernels are compared with what works on one point.
void expectSameBits(const std::vector<float>& found, const std::vector<float>& expected, const char* what, int64_t target) {
  for (size_t i = 0; i < kPoints; ++i)
    ASSERT_EQ(std::bit_cast<uint32_t>(found[i] + 0.0F), std::bit_cast<uint32_t>(expected[i] + 0.0F)) << what << i << ' ' << target;
}

TEST(NoiseKernels, HaveTheBitsOfOnePoint) {
  const Points p;
  const FbmSettings fbm{.octaves = 5, .gain = 0.6F, .seed = 11}, tiling{.octaves = 3, .gain = 0.4F, .seed = 5, .period = 12};
  std::vector<float> value(kPoints), slope_x(kPoints), slope_y(kPoints), a(kPoints), b(kPoints), c(kPoints);
  for (const int64_t target : runnableTargets()) {
    const ForcedTarget forced(target);
    fbmValues2(p.x.data(), p.y.data(), kPoints, fbm, a.data());
    for (size_t i = 0; i < kPoints; ++i) value[i] = fbmValueOnly2({p.x[i], p.y[i]}, fbm);
    expectSameBits(a, value, "fbm 2", target);

    for (const FbmSettings& settings : {fbm, tiling}) {
      fbmGradients2(p.x.data(), p.y.data(), kPoints, settings, b.data(), c.data());
      for (size_t i = 0; i < kPoints; ++i) {
        const Vec2 gradient = fbmGradient2({p.x[i], p.y[i]}, settings).gradient;
        slope_x[i] = gradient.x, slope_y[i] = gradient.y;
      }
      expectSameBits(b, slope_x, "gradient x", target);
      expectSameBits(c, slope_y, "gradient y", target);
    }
  }
}

// The octaves of the ground, each from the noise at one point, in double where they turn.
TEST(NoiseKernels, ErodedSumsHaveTheBitsOfOnePoint) {
  const Points p;
  constexpr size_t kPlaces = kPoints / kPlacesTogether * kPlacesTogether;
  const ErodedOctaves octaves{9, 0.5F, 2.1, 7, 13};
  std::vector<double> x(p.x.begin(), p.x.begin() + kPlaces), y(p.y.begin(), p.y.begin() + kPlaces);
  x[0] = 1e12, y[1] = -1e12;  // beyond the lattice's numbers
  std::vector<float> expected(kPoints), sums(kPoints);
  for (size_t i = 0; i < kPlaces; ++i) {
    double at_x = x[i], at_y = y[i];
    float weight = 1, slope_x = 0, slope_y = 0;
    for (uint32_t octave = 0; octave < 9; ++octave, weight *= 0.5F) {
      const Noise2 noise =
          valueNoise2({float(std::clamp(at_x, -0x1p29, 0x1p29)), float(std::clamp(at_y, -0x1p29, 0x1p29))}, {.seed = 7 + octave * 13});
      slope_x += noise.gradient.x, slope_y += noise.gradient.y;
      expected[i] += weight * noise.value / (1 + slope_x * slope_x + slope_y * slope_y);
      const double turned_x = 2.1 * (0.8 * at_x - 0.6 * at_y);
      at_y = 2.1 * (0.6 * at_x + 0.8 * at_y), at_x = turned_x;
    }
  }
  for (const int64_t target : runnableTargets()) {
    const ForcedTarget forced(target);
    erodedSums(x.data(), y.data(), kPlaces, octaves, sums.data());
    expectSameBits(sums, expected, "eroded", target);
  }
}

// Under its limit a value is exact; elsewhere it is not under it.
TEST(NoiseKernels, LimitsSpareWhatIsNotNeeded) {
  const Points p;
  const FbmSettings fbm{.octaves = 5, .gain = 0.6F, .seed = 11};
  std::vector<float> value(kPoints);
  size_t under = 0;
  for (const int64_t target : runnableTargets()) {
    const ForcedTarget forced(target);
    fbmValues3(p.x.data(), p.y.data(), p.z.data(), p.limit.data(), kPoints, fbm, value.data());
    for (size_t i = 0; i < kPoints; ++i) {
      const float exact = fbmValueOnly3({p.x[i], p.y[i], p.z[i]}, fbm);
      if (exact < p.limit[i]) {
        ASSERT_EQ(std::bit_cast<uint32_t>(value[i]), std::bit_cast<uint32_t>(exact)) << i << ' ' << target;
        ++under;
      } else {
        ASSERT_GE(value[i], p.limit[i]);
        ASSERT_LE(value[i], exact);
      }
    }
  }
  EXPECT_GT(under, kPoints / 2);
}

TEST(NoiseKernels, WriteNoFurtherThanTheCount) {
  const Points p;
  for (const size_t count : {0U, 1U, 5U, 16U, 17U}) {
    std::vector<float> value(40, -7);
    fbmValues2(p.x.data(), p.y.data(), count, {}, value.data());
    for (size_t i = 0; i < value.size(); ++i) EXPECT_EQ(value[i] == -7, i >= count) << count;
  }
}

}  // namespace
}  // namespace cloudbake
