#include "bake/lobe/inside_length.h"

#include <gtest/gtest.h>

#include "bake/lobe/directions.h"
#include "core/random.h"

using namespace cloudbake;

namespace {

constexpr float kRadius = 1;
float ballSdf(Vec3 x) { return length(x) - kRadius; }

struct QuadratureError {
  double mean, rms;
};

// Rays into the ball from points on its surface, as a bake shoots them; the exact chord is max(0, −2 o·ω).
QuadratureError errorOf(Quadrature quadrature, int steps) {
  const int rays = 200000;
  double sum = 0, squares = 0;
  std::vector<Vec3> ends(2);
  for (int i = 0; i < rays; ++i) {
    uniformDirections(mix64(uint64_t(i) + 1), ends);
    const Vec3 origin = ends[0] * kRadius;
    const double exact = std::max(0.0, -2 * (double(origin.x) * ends[1].x + double(origin.y) * ends[1].y + double(origin.z) * ends[1].z));
    const double error = insideLength(ballSdf, {origin, ends[1]}, {quadrature, steps, 4.0F}) - exact;
    sum += error, squares += error * error;
  }
  return {sum / rays, std::sqrt(squares / rays)};
}

double slope(double coarse, double fine, double refinement) { return std::log(coarse / fine) / std::log(refinement); }

}  // namespace

// midpoint: rms error O(Δ).
TEST(InsideLength, MidpointConvergesWithSlopeOne) {
  EXPECT_NEAR(slope(errorOf(Quadrature::kMidpoint, 20).rms, errorOf(Quadrature::kMidpoint, 160).rms, 8), 1, 0.1);
}

// crossing: O(Δ²) in the mean, O(Δ^1.5) in the rms, as chords that graze within a step are missed whole.
TEST(InsideLength, CrossingConvergesWithSlopesTwoAndThreeHalves) {
  const QuadratureError coarse = errorOf(Quadrature::kCrossing, 20), fine = errorOf(Quadrature::kCrossing, 160);
  EXPECT_NEAR(slope(std::fabs(coarse.mean), std::fabs(fine.mean), 8), 2, 0.2);
  EXPECT_NEAR(slope(coarse.rms, fine.rms, 8), 1.5, 0.15);
}

// A chord that starts on the surface: sample j counts while jΔ < chord, so `end` gives floor(chord/Δ)Δ, Δ/2 too little on average;
// midpoint rounds instead and is unbiased.
TEST(InsideLength, EndLosesHalfAStepOfTheFirstChord) {
  const int rays = 20000, steps = 40;
  const double step = 4.0 / steps;
  double bias[3] = {};
  std::vector<Vec3> w(1);
  for (int i = 0; i < rays; ++i) {
    uniformDirections(mix64(uint64_t(i) + 1), w);
    if (w[0].z > -0.2F) w[0].z = -0.2F - 0.8F * std::fabs(w[0].z), w[0] = *normalized(w[0]);
    const Ray ray{{0, 0, kRadius * (1 - 1e-6F)}, w[0]};
    const double exact = -2.0 * w[0].z * kRadius;
    for (const Quadrature q : {Quadrature::kCrossing, Quadrature::kMidpoint, Quadrature::kEnd})
      bias[int(q)] += (insideLength(ballSdf, ray, {q, steps, 4.0F}) - exact) / rays;
  }
  EXPECT_NEAR(bias[int(Quadrature::kEnd)], -step / 2, 0.03 * step);
  EXPECT_NEAR(bias[int(Quadrature::kMidpoint)], 0, 0.03 * step);
  EXPECT_NEAR(bias[int(Quadrature::kCrossing)], 0, 0.03 * step);
}

// Two slabs with a gap, by hand: inside 1–2 and 3–5 of a ray of 6. Gaps do not count.
TEST(InsideLength, GapsDoNotCount) {
  const auto slabs = [](Vec3 p) { return std::min(std::fabs(p.x - 1.5F) - 0.5F, std::fabs(p.x - 4) - 1); };
  EXPECT_NEAR(insideLength(slabs, {{0, 0, 0}, {1, 0, 0}}, {Quadrature::kCrossing, 60, 6}), 3, 1e-5);
  EXPECT_NEAR(insideLength(slabs, {{0, 0, 0}, {1, 0, 0}}, {Quadrature::kMidpoint, 60, 6}), 3, 1e-5);
  EXPECT_NEAR(insideLength(slabs, {{0, 0, 0}, {-1, 0, 0}}, {Quadrature::kCrossing, 60, 6}), 0, 0);
}

// One step, a ray along an axis, a ray that ends inside, a start exactly on φ = 0: finite and right.
TEST(InsideLength, EdgeCases) {
  EXPECT_EQ(insideLength(ballSdf, {{0, 0, 0}, {0, 1, 0}}, {Quadrature::kCrossing, 1, 0.5F}), 0.5F);
  EXPECT_NEAR(insideLength(ballSdf, {{-1, 0, 0}, {1, 0, 0}}, {Quadrature::kCrossing, 100, 3}), 2, 1e-5);
  EXPECT_EQ(insideLength(ballSdf, {{-1, 0, 0}, {-1, 0, 0}}, {Quadrature::kCrossing, 100, 3}), 0);
  EXPECT_EQ(insideLength([](Vec3) { return 0.0F; }, {{0, 0, 0}, {1, 0, 0}}, {Quadrature::kCrossing, 10, 1}), 0);
  EXPECT_LT(insideLength(ballSdf, {{-1, 1, 0}, {1, 0, 0}}, {Quadrature::kCrossing, 100, 3}), 0.01F);  // tangent
}
