#include "bake/lobe/fit_lobe.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>

#include "bake/field/level_set.h"
#include "bake/lobe/directions.h"
#include "bake/mesh/mesh_topology.h"
#include "bake/mesh/surface.h"
#include "bake/truth/error_metrics.h"
#include "bake/truth/reference.h"
#include "core/exp_log.h"
#include "core/lobe_lighting.h"
#include "core/random.h"
#include "tests/bake/lobe_helpers.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

Lobe fitLobe(const Lobe& start, const FitSamples& samples, const FitSettings& settings) {
  return fitLobes({&start, 1}, samples, settings)[0];
}

// A core and thirty puffs on a spiral around it, its exact chords and its mean lobes.
struct Lumpy {
  float longest = 0, extinction = 0;
  std::vector<Vec3> positions, directions, judges;
  std::vector<Lobe> means;
  std::vector<float> lengths, judged;  // along directions, along judges
  FitSamples samples() const { return {directions, lengths, {}}; }
  FitSamples row(size_t v) const { return {directions, std::span(lengths).subspan(v * directions.size(), directions.size()), {}}; }
};

const Lumpy& lumpyCloud() {
  static const Lumpy cloud = [] {
    std::vector<Sphere> spheres{{{0, 0, 0}, 0.8F}};
    for (const Vec3& d : fibonacciDirections(30))
      spheres.push_back({{d.x, 0.7F * d.y, d.z}, 0.3F + 0.2F * uniformFloat(hashDraw(1, uint32_t(spheres.size()), 0))});
    Warnings warnings;
    LevelSetSettings settings;
    settings.voxels = 60;
    const SurfaceMesh mesh = meshFromLevelSet(levelSetFromSpheres(spheres, settings, warnings), {}, warnings);
    Lumpy c;
    c.longest = boundingBox(mesh).longestSide();
    c.extinction = 7 / c.longest;
    for (size_t i = 0; i < 500; ++i) c.positions.push_back(mesh.positions[i * mesh.positions.size() / 500]);
    c.directions = fibonacciDirections(100), c.judges = fibonacciDirections(512);
    const auto reference = sphereReference(spheres);
    c.means = trueLobes(*reference, c.positions, fibonacciDirections(1024), INFINITY).lobes;
    c.lengths = trueLengths(*reference, c.positions, c.directions, INFINITY);
    c.judged = trueLengths(*reference, c.positions, c.judges, INFINITY);
    return c;
  }();
  return cloud;
}

double uniform(uint32_t ray, uint32_t dimension) { return uniformDouble(hashDraw(7, ray, dimension)); }

Vec3 randomDirection(uint32_t ray) {
  Vec3 direction;
  uniformDirections(hashDraw(11, ray, 0), {&direction, 1});
  return direction;
}

// The formula in double, straight from docs/lobe_math.md.
double formulaError(const Lobe& lobe, const FitSamples& s, const FitSettings& settings) {
  double sum = 0, weights = 0;
  for (size_t j = 0; j < s.directions.size(); ++j) {
    const Vec3 l = s.directions[j], o = lobe.direction;
    const double h = std::max(0.0, (double(l.x) * o.x + double(l.y) * o.y + double(l.z) * o.z) / 2 + 0.5);
    const double thickness = std::max(0.0, std::pow(h, double(settings.shape.exponent)) * lobe.thickness + settings.shape.bias);
    const double weight = s.weights.empty() ? 1 : s.weights[j];
    for (const float sigma : settings.extinctions)
      sum += weight * std::pow(std::exp(-sigma * thickness) - std::exp(-double(sigma) * s.lengths[j]), 2);
    weights += weight;
  }
  return sum / (weights * double(settings.extinctions.size()));
}

// Downhill by a second route: Nelder and Mead's simplex (1965) on the formula in double, without any derivative. The parameters are
// two components of o on the tangent plane of the start, and log d.
double descendBySimplex(const Lobe& start, const FitSamples& samples, const FitSettings& settings, int steps) {
  using Point = std::array<double, 3>;
  const auto [u, v] = frameAround(start.direction);
  const auto error = [&, u = u, v = v](const Point& x) {
    const auto o = normalized(start.direction + float(x[0]) * u + float(x[1]) * v);
    return formulaError({*o, float(start.thickness * std::exp(x[2]))}, samples, settings);
  };
  std::array<std::pair<double, Point>, 4> simplex;
  for (size_t i = 0; i < 4; ++i) {
    Point x{};
    if (i > 0) x[i - 1] = 0.5;
    simplex[i] = {error(x), x};
  }
  for (int i = 0; i < steps; ++i) {
    std::sort(simplex.begin(), simplex.end());
    const auto along = [&](double t) {  // from the worst point through the middle of the others: t = 1 is that middle
      Point x;
      for (size_t a = 0; a < 3; ++a)
        x[a] = simplex[3].second[a] * (1 - t) + t * (simplex[0].second[a] + simplex[1].second[a] + simplex[2].second[a]) / 3;
      return std::pair{error(x), x};
    };
    auto next = along(2);
    if (next < simplex[0])
      next = std::min(next, along(3));
    else if (next > simplex[2])
      next = std::min(next, along(next < simplex[3] ? 1.5 : 0.5));
    if (next < simplex[3]) {
      simplex[3] = next;
      continue;
    }
    for (size_t k = 1; k < 4; ++k) {
      for (size_t a = 0; a < 3; ++a) simplex[k].second[a] = (simplex[k].second[a] + simplex[0].second[a]) / 2;
      simplex[k].first = error(simplex[k].second);
    }
  }
  return std::min_element(simplex.begin(), simplex.end())->first;
}

std::vector<float> lengthsOfLobe(const Lobe& lobe, LobeShape shape, std::span<const Vec3> directions) {
  std::vector<float> lengths;
  for (const Vec3& l : directions) lengths.push_back(lobeThickness(lobe, l, shape));
  return lengths;
}

// Turned by an angle towards some direction across.
Vec3 turned(Vec3 o, double degrees, uint32_t ray) {
  const auto [u, v] = frameAround(o);
  const double azimuth = 2 * kPi * uniform(ray, 5), angle = degrees * kPi / 180;
  const Vec3 across = float(std::cos(azimuth)) * u + float(std::sin(azimuth)) * v;
  return *normalized(float(std::cos(angle)) * o + float(std::sin(angle)) * across);
}

double rms(const std::vector<Lobe>& lobes, LobeShape shape, double extinction) {
  return compareTransmittance(lobes, shape, lumpyCloud().judges, lumpyCloud().judged, extinction).rms;
}

}  // namespace

TEST(ExpLog, AgreeWithTheLibrary) {
  for (uint32_t i = 0; i < 20000; ++i) {
    const auto x = float(88 * uniform(i, 0) - 1), y = float(std::exp(-30 * uniform(i, 1)) * 2);
    ASSERT_NEAR(expMinus(std::min(x, 87.0F)) / std::exp(-double(std::min(x, 87.0F))), 1, 0x1p-22) << x;
    ASSERT_NEAR(minusLog(y), -std::log(double(y)), 0x1p-22 * std::max(std::fabs(std::log(double(y))), std::fabs(y - 1.0))) << y;
  }
  EXPECT_EQ(expMinus(0), 1);
  EXPECT_EQ(minusLog(1), 0);
  for (const float x : {88.0F, 1e10F, std::numeric_limits<float>::max(), std::numeric_limits<float>::infinity()})
    EXPECT_EQ(expMinus(x), expMinus(87));
  for (const float x : {-3.0F, -0.0F, 0.0F, 1e-30F, 0.5F, 2.0F, 1e30F}) {
    EXPECT_EQ(atLeast(x, 0.5F), std::max(x, 0.5F));
    EXPECT_EQ(atMost(x, 0.5F), std::min(x, 0.5F));
  }
}

TEST(FitLobe, ErrorIsThatOfTheFormula) {
  const Lumpy& cloud = lumpyCloud();
  std::vector<float> weights;
  for (uint32_t j = 0; j < 100; ++j) weights.push_back(float(uniform(j, 3)));
  for (const LobeShape shape : {LobeShape{4, 0}, LobeShape{3, -0.02F}, LobeShape{0, 0}, LobeShape{0.5F, 0.1F}, LobeShape{7.3F, -0.1F}})
    for (size_t v = 0; v < 500; v += 10) {
      const FitSettings settings{shape, {0.5F * cloud.extinction, 3 * cloud.extinction}};
      FitSamples samples = cloud.row(v);
      if (v % 20 == 0) samples.weights = weights;
      const Lobe lobe{randomDirection(uint32_t(v)), float(3 * uniform(uint32_t(v), 4))};
      const double truth = formulaError(lobe, samples, settings);
      ASSERT_NEAR(lobeError(lobe, samples, settings), truth, 2e-6 * truth + 1e-9) << shape.exponent;
    }
}

// T of a known lobe leads back to it from 30° off in few steps: with a wrong derivative it would not.
TEST(FitLobe, RecoversALobe) {
  const auto directions = fibonacciDirections(100);
  for (const LobeShape shape : {LobeShape{4, 0}, LobeShape{3, -0.05F}, LobeShape{2.5F, 0.1F}, LobeShape{6.5F, 0}, LobeShape{2, -0.2F}})
    for (uint32_t i = 0; i < 50; ++i) {
      const Lobe truth{randomDirection(i), float(0.3 + 2 * uniform(i, 1))};
      const auto lengths = lengthsOfLobe(truth, shape, directions);
      const Lobe start{turned(truth.direction, 30, i), truth.thickness * float(0.5 + 1.5 * uniform(i, 2))};
      const FitSettings settings{shape, {1, 3}, 7};
      const Lobe fitted = fitLobe(start, {directions, lengths, {}}, settings);
      ASSERT_LT(angleDegrees(fitted.direction, truth.direction), 0.02) << shape.exponent << ' ' << i;
      ASSERT_NEAR(fitted.thickness / truth.thickness, 1, 5e-4) << shape.exponent << ' ' << i;
    }
}

// Surface of a ball: ℓ = 2R max(0, cos θ) about the inward normal. o stays there by symmetry; d is found by trying all of them.
TEST(FitLobe, BallByTrial) {
  const auto directions = fibonacciDirections(400);
  for (const float radius : {1e-6F, 1.0F, 1e6F})
    for (uint32_t i = 0; i < 20; ++i) {
      const Vec3 inward = randomDirection(i);
      std::vector<float> lengths;
      for (const Vec3& l : directions) lengths.push_back(2 * radius * std::max(0.0F, dot(l, inward)));
      const FitSamples samples{directions, lengths, {}};
      const FitSettings settings{{4, 0}, {3.5F / radius}};
      const Lobe fitted = fitLobe({turned(inward, 20, i), 5 * radius}, samples, settings);
      double least = 1;
      for (float d = 0.1F; d < 5; d *= 1.01F) least = std::min(least, formulaError({inward, d * radius}, samples, settings));
      EXPECT_LT(angleDegrees(fitted.direction, inward), 0.7);
      EXPECT_LE(lobeError(fitted, samples, settings), least * (1 + 1e-4));
    }
}

TEST(FitLobe, NeverWorseThanItsStartAndFinite) {
  const auto directions = fibonacciDirections(100);
  const float inf = std::numeric_limits<float>::infinity();
  int improved = 0;
  for (uint32_t i = 0; i < 4000; ++i) {
    // Lengths: all zero, all equal, one direction only, all beyond any T, infinite, random with zeros
    std::vector<float> lengths(100, 0.0F);
    const float size = std::pow(10.0F, float(int(i % 13) - 6));
    for (size_t j = 0; j < 100; ++j) {
      const auto draw = float(uniform(i, uint32_t(100 + j)));
      const float choices[] = {0, 1, j == i % 100 ? 1.0F : 0.0F, 1e6F, inf, draw < 0.3F ? 0 : draw};
      lengths[j] = choices[i % 6] * size;
    }
    const Lobe start{randomDirection(i), i % 7 == 0 ? 0 : float(3 * uniform(i, 1)) * size};
    const float exponents[] = {0, 0.5F, 3, 4, 12}, biases[] = {-0.5F, -0.01F, 0, 0.2F};
    const FitSettings settings{{exponents[i % 5], biases[i % 4] * size}, {0.5F / size, 8 / size}};
    const Lobe fitted = fitLobe(start, {directions, lengths, {}}, settings);
    ASSERT_TRUE(isFinite(fitted.direction) && std::isfinite(fitted.thickness)) << i;
    ASSERT_NEAR(length(fitted.direction), 1, 1e-6) << i;
    ASSERT_GE(fitted.thickness, 0) << i;
    const FitSamples samples{directions, lengths, {}};
    ASSERT_LE(lobeError(fitted, samples, settings), lobeError(start, samples, settings)) << i;
    ASSERT_LE(formulaError(fitted, samples, settings), formulaError(start, samples, settings) * (1 + 1e-5) + 1e-9) << i;
    improved += lobeError(fitted, samples, settings) < 0.9 * lobeError(start, samples, settings);
  }
  EXPECT_GT(improved, 2000);
}

// d = 0 and an undefined direction say nothing of the cloud; the fit must not stay there.
TEST(FitLobe, LeavesAnEmptyStart) {
  const Lumpy& cloud = lumpyCloud();
  const FitSettings settings{{4, 0}, {cloud.extinction}};
  for (size_t v = 0; v < 500; v += 7) {
    const double from_mean = lobeError(fitLobe(cloud.means[v], cloud.row(v), settings), cloud.row(v), settings);
    const Lobe empty{-cloud.means[v].direction, 0};
    EXPECT_LT(lobeError(fitLobe(empty, cloud.row(v), settings), cloud.row(v), settings), 1.1 * from_mean + 1e-6) << v;
  }
}

TEST(FitLobe, WithoutDirectionsOrStepsTheStartIsKept) {
  const Lobe start{{0, 1, 0}, 2};
  EXPECT_EQ(fitLobe(start, {}, {{4, 0}, {1}}).thickness, 2);
  EXPECT_TRUE(fitLobes({}, lumpyCloud().samples(), {{4, 0}, {1}}).empty());
  const std::vector<float> none(100, 0.0F);
  const FitSamples unweighted{lumpyCloud().directions, lumpyCloud().row(0).lengths, none};
  EXPECT_EQ(lobeError(start, unweighted, {{4, 0}, {1}}), 0);
  EXPECT_EQ(fitLobe(start, unweighted, {{4, 0}, {1}}).direction, start.direction);

  FitSettings settings{{4, 0}, {0.7F}};
  auto fitted = fitLobes(lumpyCloud().means, lumpyCloud().samples(), settings);
  for (Lobe& lobe : fitted) lobe.thickness *= 1.0001F;
  settings.iterations = 0;
  EXPECT_TRUE(sameBytes(fitted, fitLobes(fitted, lumpyCloud().samples(), settings)));
}

// 36 other starts, followed downhill by a second route that knows no derivative, reach the same error: they gain under 1 % over all
// vertices, and that route is no poor judge.
TEST(FitLobe, OtherStartsGainNothing) {
  const Lumpy& cloud = lumpyCloud();
  const FitSettings settings{{4, 0}, {cloud.extinction}};
  const auto fitted = fitLobes(cloud.means, cloud.samples(), settings);
  std::vector<double> ours(fitted.size()), others(fitted.size());
  tbb::parallel_for(size_t(0), fitted.size(), [&](size_t v) {
    ours[v] = formulaError(fitted[v], cloud.row(v), settings);
    std::vector<std::pair<double, Lobe>> starts;
    for (const Vec3& o : fibonacciDirections(12))
      for (const float d : {0.1F, 0.4F, 1.5F}) {
        const Lobe start{o, d * cloud.longest};
        starts.emplace_back(descendBySimplex(start, cloud.row(v), settings, 8), start);
      }
    std::sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    others[v] = 1;
    for (size_t i = 0; i < 4; ++i) others[v] = std::min(others[v], descendBySimplex(starts[i].second, cloud.row(v), settings, 60));
  });
  double sum = 0, sum_others = 0, least = 0;
  for (size_t v = 0; v < ours.size(); ++v) sum += ours[v], sum_others += others[v], least += std::min(ours[v], others[v]);
  std::printf("[figures] 500 vertices: error %.6f, of 36 other starts %.6f, of both %.6f\n", sum / 500, sum_others / 500, least / 500);
  EXPECT_GT(least, 0.99 * sum);
  EXPECT_LT(sum_others, 1.01 * sum);
}

// Scale by 2^10: directions bit for bit, densities × 2^10. By other factors: to rounding.
TEST(FitLobe, FollowsTheScale) {
  const Lumpy& cloud = lumpyCloud();
  const FitSettings settings{{3.5F, -0.01F}, extinctionSteps(cloud.extinction / 2, cloud.extinction * 2)};
  const auto fitted = fitLobes(cloud.means, cloud.samples(), settings);
  for (const float scale : {1024.0F, 0x1p-20F, 1e6F, 1e-6F}) {
    auto starts = cloud.means;
    auto lengths = cloud.lengths;
    for (Lobe& lobe : starts) lobe.thickness *= scale;
    for (float& l : lengths) l *= scale;
    FitSettings scaled = settings;
    scaled.shape.bias *= scale;
    for (float& sigma : scaled.extinctions) sigma /= scale;
    const auto other = fitLobes(starts, {cloud.directions, lengths, {}}, scaled);
    const bool exact = scale == 1024.0F || scale == 0x1p-20F;
    for (size_t v = 0; v < fitted.size(); ++v) {
      if (exact) {
        ASSERT_EQ(other[v].direction, fitted[v].direction) << v;
        ASSERT_EQ(other[v].thickness, fitted[v].thickness * scale) << v;
      }
      ASSERT_NEAR(lobeError(other[v], {cloud.directions, std::span(lengths).subspan(v * 100, 100), {}}, scaled) /
                      lobeError(fitted[v], cloud.row(v), settings),
                  1, 0.01);
    }
    EXPECT_EQ(fitShape(starts, {cloud.directions, lengths, {}}, scaled, {}).exponent,
              fitShape(cloud.means, cloud.samples(), settings, {}).exponent);
  }
}

TEST(FitLobe, SameBytesForAnyThreadCountAndOrder) {
  const Lumpy& cloud = lumpyCloud();
  const FitSettings settings{{4, 0}, extinctionSteps(cloud.extinction / 2, cloud.extinction * 2)};
  const auto fitted = fitLobes(cloud.means, cloud.samples(), settings);
  const LobeShape shape = fitShape(cloud.means, cloud.samples(), settings, {true, true, 100});
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_TRUE(sameBytes(fitted, fitLobes(cloud.means, cloud.samples(), settings))) << threads;
    const LobeShape again = fitShape(cloud.means, cloud.samples(), settings, {true, true, 100});
    EXPECT_TRUE(again.exponent == shape.exponent && again.bias == shape.bias) << threads;
  }
  std::vector<Lobe> one_by_one(fitted.size());
  for (size_t v = fitted.size(); v-- > 0;) one_by_one[v] = fitLobe(cloud.means[v], cloud.row(v), settings);
  EXPECT_TRUE(sameBytes(fitted, one_by_one));
}

// Lengths without weight change nothing; weights serve the lights that have them.
TEST(FitLobe, WeightsChooseTheLights) {
  const Lumpy& cloud = lumpyCloud();
  const FitSettings settings{{4, 0}, {cloud.extinction}};
  std::vector<float> weights, lengths = cloud.lengths;
  for (const Vec3& l : cloud.directions) weights.push_back(l.y > 0.3F ? 5.0F : 0.0F);
  for (size_t i = 0; i < lengths.size(); ++i)
    if (weights[i % 100] == 0) lengths[i] = 10 * cloud.longest * float(uniform(uint32_t(i), 9));
  const auto uniform_fit = fitLobes(cloud.means, cloud.samples(), settings);
  const auto fitted = fitLobes(cloud.means, {cloud.directions, cloud.lengths, weights}, settings);
  EXPECT_TRUE(sameBytes(fitted, fitLobes(cloud.means, {cloud.directions, lengths, weights}, settings)));
  double error = 0, uniform_error = 0;
  for (size_t v = 0; v < fitted.size(); ++v) {
    const FitSamples samples{cloud.directions, cloud.row(v).lengths, weights};
    error += formulaError(fitted[v], samples, settings), uniform_error += formulaError(uniform_fit[v], samples, settings);
  }
  std::printf("[figures] sun arc: mean square error %.5f, uniform fit %.5f\n", error / 500, uniform_error / 500);
  EXPECT_LT(error, 0.6 * uniform_error);
}

// Against the mean lobe at its defaults, k = 3 and b = −0.3 % of the longest side, judged in 512 other directions.
TEST(FitLobe, BetterThanTheMeanLobe) {
  const Lumpy& cloud = lumpyCloud();
  const LobeShape mean_shape{3, -0.003F * cloud.longest};
  FitSettings settings{{4, 0}, {cloud.extinction}};
  settings.shape = fitShape(cloud.means, cloud.samples(), settings, {true, true});
  const double ratio = rms(fitLobes(cloud.means, cloud.samples(), settings), settings.shape, cloud.extinction) /
                       rms(cloud.means, mean_shape, cloud.extinction);
  std::printf("[figures] lumpy cloud: k %.3f, b %.2f %%, rms of T %.3f of the mean lobe's\n", settings.shape.exponent,
              100 * settings.shape.bias / cloud.longest, ratio);
  EXPECT_LT(ratio, 0.7);

  const FitSettings range{{4, 0}, extinctionSteps(cloud.extinction / 2, cloud.extinction * 2)};
  const auto fitted = fitLobes(cloud.means, cloud.samples(), range);
  double sum = 0;
  for (int i = 0; i <= 8; ++i) {
    const double extinction = cloud.extinction * std::pow(2.0, i / 4.0 - 1);
    const double at_one = rms(fitted, range.shape, extinction) / rms(cloud.means, mean_shape, extinction);
    EXPECT_LT(at_one, 1) << i;
    sum += at_one / 9;
  }
  std::printf("[figures] lumpy cloud, fitted for sigma/2 ... 2 sigma with k 4, b 0: %.3f on average\n", sum);
  EXPECT_LT(sum, 0.72);
}

// Lengths made by lobes of one shape lead back to that shape; what is not searched stays.
TEST(FitShape, RecoversTheShape) {
  const auto directions = fibonacciDirections(100);
  const auto made = [&](LobeShape shape, std::vector<Lobe>& starts) {
    std::vector<float> lengths;
    starts.clear();
    for (uint32_t i = 0; i < 300; ++i) {
      const Lobe lobe{randomDirection(i), float(0.3 + 2 * uniform(i, 1))};
      const auto row = lengthsOfLobe(lobe, shape, directions);
      lengths.insert(lengths.end(), row.begin(), row.end());
      starts.push_back({turned(lobe.direction, 20, i), lobe.thickness});
    }
    return lengths;
  };
  std::vector<Lobe> starts;
  const FitSettings settings{{4, 0}, {1}};
  for (const float exponent : {1.0F, 2.5F, 6.0F, 8.125F}) {
    const auto lengths = made({exponent, 0}, starts);
    const LobeShape shape = fitShape(starts, {directions, lengths, {}}, settings, {});
    EXPECT_EQ(shape.exponent, exponent);
    EXPECT_EQ(shape.bias, 0);
  }
  for (const LobeShape truth : {LobeShape{4, 0.12F}, LobeShape{4, -0.24F}}) {
    const auto lengths = made(truth, starts);
    const LobeShape shape = fitShape(starts, {directions, lengths, {}}, settings, {false, true});
    EXPECT_EQ(shape.exponent, 4);
    EXPECT_NEAR(shape.bias, truth.bias, 1e-6);
    const LobeShape both = fitShape(starts, {directions, lengths, {}}, {{5, 0}, {1}}, {true, true});
    EXPECT_NEAR(both.exponent, 4, 0.13);
    EXPECT_NEAR(both.bias, truth.bias, 0.011);
  }
  const auto lengths = made({6, 0.12F}, starts);
  EXPECT_EQ(fitShape(starts, {directions, lengths, {}}, settings, {true, false}).bias, 0);
  EXPECT_EQ(fitShape(starts, {directions, lengths, {}}, settings, {false, true}).exponent, 4);
  EXPECT_EQ(fitShape(starts, {directions, lengths, {}}, settings, {false, false}).exponent, 4);

  // A b beyond what is searched does not keep k from being searched
  const auto far = made({6, -0.9F}, starts);
  EXPECT_EQ(fitShape(starts, {directions, far, {}}, {{4, -0.9F}, {1}}, {true, false}).exponent, 6);
}

// The vertices of a mesh often come part by part. The shape must suit all of them and not the first part: it is compared with all exponents
// in steps of a quarter, each fitted to every vertex.
TEST(FitShape, SuitsTheWholeMeshAndNotItsFirstPart) {
  const auto directions = fibonacciDirections(60);
  std::vector<Lobe> starts;
  std::vector<float> lengths;
  for (uint32_t i = 0; i < 240; ++i) {
    const LobeShape shape{i < 60 ? 1.5F : 8, 0};
    const Lobe lobe{randomDirection(i), float(0.3 + 2 * uniform(i, 1))};
    const auto row = lengthsOfLobe(lobe, shape, directions);
    lengths.insert(lengths.end(), row.begin(), row.end());
    starts.push_back(lobe);
  }
  const FitSamples samples{directions, lengths, {}};
  const auto errorWith = [&](float exponent) {
    const FitSettings settings{{exponent, 0}, {1}};
    const auto fitted = fitLobes(starts, samples, settings);
    double sum = 0;
    for (size_t v = 0; v < fitted.size(); ++v)
      sum += formulaError(fitted[v], {directions, std::span(lengths).subspan(60 * v, 60), {}}, settings);
    return sum;
  };
  double least = INFINITY;
  for (float exponent = 0.5F; exponent <= 12; exponent += 0.25F) least = std::min(least, errorWith(exponent));
  const LobeShape found = fitShape(starts, samples, {{4, 0}, {1}}, {.vertices = 40});
  EXPECT_LT(errorWith(found.exponent), 1.02 * least) << found.exponent;
  EXPECT_GT(errorWith(1.5F), 1.5 * least) << "the first part alone would choose another shape";
}

TEST(ExtinctionSteps, EqualFactorsOfAtMostTwo) {
  EXPECT_EQ(extinctionSteps(3, 3), std::vector<float>{3});
  EXPECT_EQ(extinctionSteps(1, 2), (std::vector<float>{1, 2}));
  EXPECT_EQ(extinctionSteps(0.5F, 2), (std::vector<float>{0.5F, 1, 2}));
  const auto steps = extinctionSteps(1, 10);
  ASSERT_EQ(steps.size(), 5U);
  for (size_t i = 0; i < steps.size(); ++i) EXPECT_NEAR(steps[i], std::pow(10.0, double(i) / 4), 1e-5);
}
