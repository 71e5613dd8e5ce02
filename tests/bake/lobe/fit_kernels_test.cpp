#include "bake/lobe/fit_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "bake/lobe/directions.h"

namespace cloudbake {
namespace {

struct Problem {
  std::vector<float> x, y, z, weights, targets;
  FitLights lights() const { return {x.data(), y.data(), z.data(), weights.data(), x.size()}; }
};

// Lights over the sphere, the first one opposite to +Y, with uneven weights and targets between 0 and 1.
Problem problemFor(size_t lights, size_t extinctions) {
  Problem problem;
  std::vector<Vec3> directions = fibonacciDirections(int(lights));
  directions[0] = {0, -1, 0};
  for (size_t j = 0; j < lights; ++j) {
    problem.x.push_back(directions[j].x), problem.y.push_back(directions[j].y), problem.z.push_back(directions[j].z);
    problem.weights.push_back(float(j % 5) / float(2 * lights));
  }
  for (size_t i = 0; i < lights * extinctions; ++i) problem.targets.push_back(float((i * 7) % 31) / 30);
  return problem;
}

double thicknessTowards(const FitLobe& lobe, double u, double v, double w, Vec3 light) {
  const double along[] = {double(lobe.direction.x) + u * lobe.tangent.x + v * lobe.bitangent.x,
                          double(lobe.direction.y) + u * lobe.tangent.y + v * lobe.bitangent.y,
                          double(lobe.direction.z) + u * lobe.tangent.z + v * lobe.bitangent.z};
  const double h = std::max(1e-7, 0.5 * (along[0] * light.x + along[1] * light.y + along[2] * light.z) + 0.5);
  return std::max(0.0, std::pow(h, double(lobe.exponent)) * lobe.thickness * std::exp(w) + lobe.bias);
}

// The sums in double precision, with slopes of s from differences.
FitSums plainSums(const Problem& problem, const FitLobe& lobe, const std::vector<float>& extinctions) {
  constexpr double kStep = 1e-5;
  FitSums sums;
  for (size_t j = 0; j < problem.x.size(); ++j) {
    const Vec3 light{problem.x[j], problem.y[j], problem.z[j]};
    const auto at = [&](double u, double v, double w) { return thicknessTowards(lobe, u, v, w, light); };
    const double s = at(0, 0, 0),
                 slopes[3] = {(at(kStep, 0, 0) - at(-kStep, 0, 0)) / (2 * kStep), (at(0, kStep, 0) - at(0, -kStep, 0)) / (2 * kStep),
                              (at(0, 0, kStep) - at(0, 0, -kStep)) / (2 * kStep)};
    for (size_t i = 0; i < extinctions.size(); ++i) {
      const double t = std::exp(-extinctions[i] * s), residual = t - problem.targets[i * problem.x.size() + j], w = problem.weights[j];
      sums.error += w * residual * residual;
      size_t k = 0;
      for (size_t a = 0; a < 3; ++a) {
        sums.gradient[a] += w * residual * -extinctions[i] * t * slopes[a];
        for (size_t b = a; b < 3; ++b) sums.hessian[k++] += w * std::pow(extinctions[i] * t, 2) * slopes[a] * slopes[b];
      }
    }
  }
  return sums;
}

// With a bias below 0, s is cut off at some lights. σ of 1 and 2 share an exponential, 1 and 3 do not.
TEST(FitKernels, SumsAreThoseOfTheFormula) {
  for (const std::vector<float>& extinctions : {std::vector<float>{1}, std::vector<float>{1, 2, 4}, std::vector<float>{1, 3}})
    for (const float bias : {0.3F, 0.0F, -0.2F})
      for (const float exponent : {0.7F, 3.0F}) {
        const Problem problem = problemFor(104, extinctions.size());
        const FitLobe lobe{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, exponent, bias, 1.7F};
        std::vector<float> scratch((4 + extinctions.size()) * problem.x.size());
        const FitSums got = sumFit(problem.lights(), lobe, extinctions, problem.targets.data(), scratch.data()),
                      want = plainSums(problem, lobe, extinctions);
        EXPECT_NEAR(got.error, want.error, 1e-6);
        for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(got.gradient[i], want.gradient[i], 2e-6) << i << " k " << exponent << " b " << bias;
        for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(got.hessian[i], want.hessian[i], 5e-6) << i << " k " << exponent << " b " << bias;
      }
}

TEST(FitKernels, TransmittanceIsTheExponential) {
  const std::vector<float> lengths{0, 0.01F, 0.5F, 2, 30, 400, -0.1F, 1}, extinctions{1, 2, 5};
  std::vector<float> rows(24);
  transmittanceRows(lengths.data(), lengths.size(), 1.5F, extinctions, rows.data());
  for (size_t i = 0; i < extinctions.size(); ++i)
    for (size_t j = 0; j < lengths.size(); ++j)
      EXPECT_NEAR(rows[i * 8 + j], std::exp(-1.5 * extinctions[i] * std::max(0.0F, lengths[j])), 3e-7) << lengths[j];
}

}  // namespace
}  // namespace cloudbake
