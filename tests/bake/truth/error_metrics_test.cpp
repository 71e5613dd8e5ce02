#include "bake/truth/error_metrics.h"

#include <gtest/gtest.h>

#include "core/lobe_lighting.h"

using namespace cloudbake;

// Four vertices with angles 0, 3, 4 degrees and one without a direction, by hand.
TEST(ErrorMetrics, FiguresByHand) {
  const auto tilted = [](double degrees) { return Vec3{0, float(std::sin(degrees * kPi / 180)), float(std::cos(degrees * kPi / 180))}; };
  Truth truth;
  truth.lobes.assign(4, {{0, 0, 1}, 2});
  truth.concentration = {0.5, 0.5, 0.1, 0.09};
  const std::vector<Lobe> estimate{{tilted(0), 2}, {tilted(3), 2.2F}, {tilted(4), 2}, {tilted(90), 9}};
  const LobeError error = compareLobes(estimate, truth);
  EXPECT_EQ(error.vertices, 4U);
  EXPECT_EQ(error.left_out, 1U);
  EXPECT_NEAR(error.angle_rms_degrees, std::sqrt(25.0 / 3), 1e-4);
  EXPECT_NEAR(error.angle_median_degrees, 3, 1e-4);
  EXPECT_NEAR(error.angle_max_degrees, 4, 1e-4);
  EXPECT_NEAR(error.density_rms, 0.1 / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(error.density_bias, 0.1 / 3, 1e-6);
}

TEST(ErrorMetrics, TransmittanceByHand) {
  const float estimate[] = {1, 2}, truth[] = {1, 1};
  const TransmittanceError error = compareLengths(estimate, truth, 2);
  const double difference = std::exp(-4.0) - std::exp(-2.0);
  EXPECT_NEAR(error.bias, difference / 2, 1e-9);
  EXPECT_NEAR(error.rms, std::fabs(difference) / std::sqrt(2.0), 1e-9);
}

// A lobe compared with the lengths that it itself predicts has no error.
TEST(ErrorMetrics, LobeAgreesWithItself) {
  const std::vector<Lobe> lobes{{{0, 0, 1}, 2}};
  const LobeShape shape{3, -0.01F};
  const std::vector<Vec3> directions{{0, 0, 1}, {1, 0, 0}, {0, 0.6F, 0.8F}};
  std::vector<float> lengths;
  for (const Vec3& w : directions) lengths.push_back(lobeThickness(lobes[0], w, shape));
  EXPECT_NEAR(compareTransmittance(lobes, shape, directions, lengths, 1.5).rms, 0, 1e-7);
  lengths[1] += 1;
  EXPECT_GT(compareTransmittance(lobes, shape, directions, lengths, 1.5).rms, 0.1);
}

TEST(ErrorMetrics, NothingMeasuredIsZeroNotNan) {
  Truth truth;
  truth.lobes.assign(1, {{0, 0, 1}, 0});
  truth.concentration = {0};
  const std::vector<Lobe> estimate{{{0, 0, 1}, 0}};
  EXPECT_EQ(compareLobes(estimate, truth).angle_rms_degrees, 0);
  EXPECT_EQ(compareLobes(estimate, truth).left_out, 1U);
}

// A weight of 0 leaves a direction out, and a scale of all weights changes nothing.
TEST(ErrorMetrics, WeightsDirections) {
  const std::vector<Lobe> lobes{{{0, 0, 1}, 2}};
  const std::vector<Vec3> directions{{0, 0, 1}, {0, 0, -1}};
  const LobeShape shape{3, 0};
  const std::vector<float> lengths{2, 1};  // exact along +z, where T = exp(-2σ); along −z the lobe has T = 1
  const double missed = 1 - std::exp(-1.0);
  EXPECT_NEAR(compareTransmittance(lobes, shape, directions, lengths, 1).rms, missed / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(compareTransmittance(lobes, shape, directions, lengths, 1, std::vector<float>{1, 0}).rms, 0, 1e-6);
  EXPECT_NEAR(compareTransmittance(lobes, shape, directions, lengths, 1, std::vector<float>{10, 30}).rms, missed * std::sqrt(0.75), 1e-6);
  EXPECT_NEAR(compareTransmittance(lobes, shape, directions, lengths, 1, std::vector<float>{0, 5}).bias, missed, 1e-6);
}

TEST(ErrorMetrics, ComparesTheTransmittanceOfLobes) {
  const std::vector<Lobe> thin{{{0, 0, 1}, 1}}, thick{{{0, 0, 1}, 3}};
  const std::vector<Vec3> toward{{0, 0, 1}}, away{{0, 0, -1}};
  EXPECT_NEAR(compareLobeTransmittance(thin, thick, {3, 0}, toward, 0.5).bias, std::exp(-0.5) - std::exp(-1.5), 1e-6);
  EXPECT_EQ(compareLobeTransmittance(thin, thick, {3, 0}, away, 0.5).rms, 0);
}
