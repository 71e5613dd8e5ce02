// Lobes of a whole cloud: what a fit gains, what smoothing and harmonics add.
#include "pipeline/lobes/lobes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "bake/lobe/fit_lobe.h"
#include "bake/lobe/sweep.h"
#include "bake/lobe/volume_target.h"
#include "core/harmonics.h"
#include "core/lobe_lighting.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/pipeline/shape_clouds.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

struct Baked {
  BakedLobes baked;
  IntegrationField field;
  BakeParameters parameters;
  Settings settings;
  StageSeconds seconds;
};
Baked bake(const Cloud& cloud, std::vector<std::string> texts) {
  texts.insert(texts.begin(), {"lobe=mean", "fit-to=transmittance"});  // unless a test chooses another
  texts.push_back("voxels=30");
  Baked b;
  b.settings = settingsFor(texts);
  b.parameters = parametersFor(cloud, b.settings);
  Warnings warnings;
  b.field = buildField(cloud, b.settings.field, b.settings.lobe.bake.method, warnings);
  Stopwatch watch;
  b.baked = bakeLobes(cloud, b.field, b.settings.lobe, b.parameters, warnings, watch, b.seconds);
  return b;
}
std::vector<std::string> stages(const Baked& b) {
  std::vector<std::string> names;
  for (const auto& [name, seconds] : b.seconds) names.push_back(name);
  return names;
}

// --- Light sets ---

TEST(Lobes, LightsOverTheWholeSphere) {
  const LightSet set = lightSet(std::nullopt, 100);
  EXPECT_EQ(set.axes, sweepAxes(100));
  EXPECT_TRUE(set.weights.empty()) << "all count the same";
}

TEST(Lobes, LightsOfASunStayOnItsArc) {
  const SunArc arc{5, 60, 80, 120};
  const LightSet set = lightSet(arc, 100);
  ASSERT_EQ(set.weights.size(), 2 * set.axes.size());
  EXPECT_NEAR(double(set.axes.size()), 101, 20);
  float lowest = 90, highest = -90, first = 180, last = -180;
  for (size_t i = 0; i + 1 < set.axes.size(); ++i) {
    const Vec3 l = set.axes[i];
    EXPECT_NEAR(length(l), 1, 1e-5);
    const float elevation = std::asin(l.y) * float(180 / kPi), azimuth = std::atan2(l.x, l.z) * float(180 / kPi);
    lowest = std::min(lowest, elevation), highest = std::max(highest, elevation);
    first = std::min(first, azimuth), last = std::max(last, azimuth);
  }
  // Middles of equal cells: the arc is covered to within half a cell, of about 55·40/100 = 4.7° a side.
  EXPECT_GT(lowest, 5);
  EXPECT_LT(lowest, 5 + 4);
  EXPECT_LT(highest, 60);
  EXPECT_GT(highest, 60 - 4);
  EXPECT_GT(first, 80);
  EXPECT_LT(first, 80 + 4);
  EXPECT_LT(last, 120);
  EXPECT_GT(last, 120 - 4);
}

// The sky comes from the zenith, with half the weight of the whole arc; a sun below the ground shines on nothing.
TEST(Lobes, TheZenithHasHalfTheWeightOfTheArc) {
  for (const SunArc& arc : {SunArc{5, 60, 80, 120}, SunArc{30, 30, 90, 90}, SunArc{}}) {
    const LightSet set = lightSet(arc, 50);
    EXPECT_EQ(set.axes.back(), (Vec3{0, 1, 0}));
    double suns = 0;
    for (size_t i = 0; i + 1 < set.axes.size(); ++i) {
      suns += set.weights[2 * i];
      EXPECT_EQ(set.weights[2 * i], set.weights[0]);
    }
    EXPECT_GT(suns, 0);
    EXPECT_FLOAT_EQ(set.weights[2 * set.axes.size() - 2], float(suns / 2));
    for (size_t i = 0; i < set.axes.size(); ++i) EXPECT_EQ(set.weights[2 * i + 1], 0);
  }
}

// --- Fits ---

// The mean lobe where the fit starts, with the same k and b, on the lights that it is made for: no vertex is worse off.
TEST(Lobes, AFitIsNeverWorseThanItsStart) {
  for (const char* arc : {"", "sun-arc=10:40,60:120"}) {
    std::vector<std::string> texts{"lobe=fit", "rays=36"};
    if (*arc) texts.push_back(arc);
    const Baked fit = bake(torus(), texts), mean = bake(torus(), {"rays=36"});
    const LightSet lights = lightSet(fit.settings.lobe.sun_arc, 100);
    const std::vector<Vec3> directions = bothSenses(lights.axes);
    const std::vector<float> lengths = estimatedLengths(torus().surface.positions, lights.axes, fit.field, fit.parameters.bake);
    FitSettings settings;
    settings.shape = fit.baked.shape;
    settings.extinctions = extinctionSteps(fit.parameters.extinction_low, fit.parameters.extinction_high);
    double gained = 0, before = 0;
    for (size_t v = 0; v < torus().surface.positions.size(); ++v) {
      const FitSamples samples{directions, std::span(lengths).subspan(v * directions.size(), directions.size()), lights.weights};
      const double start = lobeError(mean.baked.lobes[v], samples, settings), end = lobeError(fit.baked.lobes[v], samples, settings);
      ASSERT_LE(end, start + 1e-9) << v;
      gained += start - end, before += start;
    }
    EXPECT_GT(gained, 0.2 * before);
  }
}

// Suns are above the horizon, and the zenith stands for the sky.
TEST(Lobes, LightsOfAFitToAVolume) {
  const LightSet lights = fitLights({}, true, 100);
  ASSERT_EQ(lights.axes.size(), 51U);
  ASSERT_EQ(lights.weights.size(), 102U);
  EXPECT_EQ(lights.axes.back(), (Vec3{0, 1, 0}));
  for (size_t i = 0; i < 100; ++i) {
    const float height = i % 2 ? -lights.axes[i / 2].y : lights.axes[i / 2].y;
    ASSERT_EQ(lights.weights[i], height > 0 ? 1.0F : 0.1F) << i;
  }
  EXPECT_FLOAT_EQ(lights.weights[100], 5);
  EXPECT_EQ(lights.weights[101], 0);
  EXPECT_EQ(fitLights(SunArc{}, true, 100).axes, lightSet(SunArc{}, 100).axes);
  EXPECT_TRUE(fitLights({}, false, 100).weights.empty());
}

// k and b are found, b is above 0, and no vertex is worse off than with its mean lobe and the same k and b, by more than the fit's few
// samples allow.
TEST(Lobes, AFitToAVolume) {
  for (const char* octaves : {"octaves=0", "octaves=6"}) {
    const Baked fit = bake(torus(), {"lobe=fit", "fit-to=volume", "rays=36", octaves}), mean = bake(torus(), {"rays=36"});
    EXPECT_GT(fit.baked.shape.bias * fit.parameters.extinction, 0.05F);
    EXPECT_LT(fit.baked.shape.exponent, 4);
    const LightSet lights = fitLights({}, true, 100);
    const std::vector<Vec3> directions = bothSenses(lights.axes);
    const SurfaceMesh& surface = torus().surface;
    const std::vector<float> lengths = estimatedLengths(surface.positions, lights.axes, fit.field, fit.parameters.bake);
    FitSettings settings;
    settings.shape = fit.baked.shape;
    settings.extinctions = extinctionSteps(fit.parameters.extinction_low, fit.parameters.extinction_high);
    const VolumeTarget target = volumeTarget({surface.positions, surface.normals}, lights.axes, *fit.field.coverage,
                                             {settings.extinctions, fit.settings.lobe.volume.over({}), *fit.parameters.bake.ray_length});
    const size_t row = target.radiance.size() / surface.positions.size();
    double fitted_sum = 0, mean_sum = 0;
    for (size_t v = 0; v < surface.positions.size(); ++v) {
      const FitSamples samples{directions, std::span(lengths).subspan(v * directions.size(), directions.size()), lights.weights,
                               std::span(target.radiance).subspan(v * row, row)};
      const double fitted = lobeError(fit.baked.lobes[v], samples, settings), own = lobeError(mean.baked.lobes[v], samples, settings);
      fitted_sum += fitted, mean_sum += own;
      ASSERT_LE(std::sqrt(fitted), std::sqrt(own) + 0.02) << v;
    }
    std::printf("[figures] mean square with the mean lobes %.5f, fitted %.5f\n", mean_sum / double(surface.positions.size()),
                fitted_sum / double(surface.positions.size()));
    EXPECT_LT(fitted_sum, 0.9 * mean_sum);
    ASSERT_EQ(fit.baked.fit.size(), 3U);
    for (const FitError& error : fit.baked.fit) EXPECT_LT(error.fitted_rms, 0.7 * error.mean_rms) << error.extinction;
  }
}

// Harmonics of a vertex are of what the lobe is fitted to. Those of a lattice are of the light that arrives, because a lattice is marched.
TEST(Lobes, HarmonicsOfAVolume) {
  const Baked b = bake(ball(), {"lobe=fit", "fit-to=volume", "octaves=3", "extinction=3.5", "exponent=2", "bias=1%"});
  const Vec3 top{0, 1, 0};
  const auto lightFrom = [&](const LobeSettings& settings, Vec3 direction) {
    const std::vector<float> coefficients = bakeHarmonics({{&top, 1}, {&top, 1}}, b.field, 3, settings, b.parameters);
    return harmonicTransmittance(coefficients, direction);
  };
  LobeSettings transmittance = b.settings.lobe;
  transmittance.fit_to_volume = false;
  EXPECT_GT(lightFrom(transmittance, top), lightFrom(b.settings.lobe, top) + 0.05F);
  EXPECT_NEAR(lightFrom(b.settings.lobe, top), 0.68F, 0.07F);
  LobeSettings settings = b.settings.lobe;
  settings.harmonic_order = 3, settings.lattice_cells = 8;
  const HarmonicLattice scattered = bakeLattice(ball(), b.field, settings, b.parameters);
  settings.fit_to_volume = false;
  const HarmonicLattice once = bakeLattice(ball(), b.field, settings, b.parameters);
  double difference = 0;
  for (size_t i = 0; i < scattered.coefficients.size(); i += 16)
    difference += double(scattered.coefficients[i]) - double(once.coefficients[i]);
  EXPECT_GT(difference, 0) << "less is dark";
}

TEST(Lobes, AFitTellsItsErrorPerExtinction) {
  const Baked fit = bake(torus(), {"lobe=fit", "rays=36", "extinction=1:4"}), mean = bake(torus(), {"rays=36"});
  EXPECT_TRUE(mean.baked.fit.empty());
  ASSERT_EQ(fit.baked.fit.size(), 3U) << "1, 2, 4: factors of at most 2";
  EXPECT_NEAR(fit.baked.fit[0].extinction, 1, 1e-6);
  EXPECT_NEAR(fit.baked.fit[1].extinction, 2, 1e-5);
  EXPECT_NEAR(fit.baked.fit[2].extinction, 4, 1e-6);
  // Anew: rms of T over lights that the fit has not seen, of both kinds of lobes.
  const std::vector<Vec3> axes = sweepAxes(512), directions = bothSenses(axes);
  const std::vector<float> lengths = estimatedLengths(torus().surface.positions, axes, fit.field, fit.parameters.bake);
  for (const FitError& error : fit.baked.fit) {
    const auto rms = [&](const std::vector<Lobe>& lobes, LobeShape shape) {
      double squares = 0;
      for (size_t v = 0; v < lobes.size(); ++v)
        for (size_t i = 0; i < directions.size(); ++i)
          squares += std::pow(lobeTransmittance(lobes[v], directions[i], shape, float(error.extinction)) -
                                  std::exp(-error.extinction * lengths[v * directions.size() + i]),
                              2);
      return std::sqrt(squares / double(lengths.size()));
    };
    EXPECT_NEAR(error.fitted_rms, rms(fit.baked.lobes, fit.baked.shape), 1e-4);
    EXPECT_NEAR(error.mean_rms, rms(mean.baked.lobes, defaultMeanShape(torus().surface)), 1e-4);
    EXPECT_LT(error.fitted_rms, error.mean_rms);
  }
  EXPECT_EQ(stages(fit), (std::vector<std::string>{"bake", "fit"}));
  EXPECT_EQ(stages(mean), (std::vector<std::string>{"bake"}));
}

// k and b are the caller's unless a search is asked for; a search comes nearer.
TEST(Lobes, ASearchFindsExponentAndBias) {
  const Baked given = bake(ball(), {"lobe=fit", "rays=36", "exponent=2", "bias=0.01"}),
              searched = bake(ball(), {"lobe=fit", "rays=36", "exponent=fit", "bias=fit"});
  EXPECT_EQ(given.baked.shape.exponent, 2);
  EXPECT_EQ(given.baked.shape.bias, 0.01F);
  EXPECT_FALSE(searched.baked.shape.exponent == 4 && searched.baked.shape.bias == 0);
  for (size_t i = 0; i < searched.baked.fit.size(); ++i) EXPECT_LT(searched.baked.fit[i].fitted_rms, given.baked.fit[i].fitted_rms + 1e-3);
  const Baked exponent_only = bake(ball(), {"lobe=fit", "rays=36", "exponent=fit", "bias=0.01"});
  EXPECT_EQ(exponent_only.baked.shape.bias, 0.01F);
}

// The exponent is chosen by 256 vertices of the whole mesh. A small, translucent ball that comes first in the list would choose another one
// than the large, opaque one beside it, which has four times as many vertices. Against whole exponents that are given.
TEST(Lobes, ASearchLooksAtTheWholeMesh) {
  const SurfaceMesh small = ballMesh(0.3F, 3);
  const Cloud cloud = cloudOf(merged(small, ballMesh(2, 4, {2.5F, 0, 0})));
  const auto rmsWith = [&](const std::string& exponent) {
    return bake(cloud, {"lobe=fit", "rays=36", "extinction=4", "exponent=" + exponent}).baked.fit[0].fitted_rms;
  };
  double least = 1;
  for (const char* exponent : {"3", "4", "5", "6", "7"}) least = std::min(least, rmsWith(exponent));
  EXPECT_LT(rmsWith("fit"), 1.01 * least);
}

// A fit's figures are of 2000 vertices of the whole mesh, and so about those of all vertices: a ball and, behind it in the list, a ring
// around it.
TEST(Lobes, AFitIsJudgedOnTheWholeMesh) {
  const Cloud cloud = cloudOf(merged(ballMesh(1, 4), torusMesh(2, 0.3F, 100, 25)));
  ASSERT_GT(cloud.surface.positions.size(), 5000U);
  const Baked fit = bake(cloud, {"lobe=fit", "rays=36", "extinction=4"});
  const std::vector<Vec3> axes = sweepAxes(128), directions = bothSenses(axes);
  const std::vector<float> lengths = estimatedLengths(cloud.surface.positions, axes, fit.field, fit.parameters.bake);
  double squares = 0, of_ball = 0;
  const size_t vertices = cloud.surface.positions.size(), in_ball = 2562;
  for (size_t v = 0; v < vertices; ++v)
    for (size_t i = 0; i < directions.size(); ++i) {
      const double error =
          lobeTransmittance(fit.baked.lobes[v], directions[i], fit.baked.shape, 4) - std::exp(-4.0 * lengths[v * directions.size() + i]);
      squares += error * error;
      if (v < in_ball) of_ball += error * error;
    }
  const double rms = std::sqrt(squares / double(lengths.size())), rms_of_ball = std::sqrt(of_ball / double(in_ball * directions.size()));
  EXPECT_NEAR(fit.baked.fit[0].fitted_rms / rms, 1, 0.02);
  EXPECT_GT(std::fabs(rms_of_ball / rms - 1), 0.04) << "the two parts differ";
}

// --- Smoothing ---

// It moves lobes towards their neighbours', so that they differ less across an edge.
TEST(Lobes, SmoothingEvensOutNeighbours) {
  const Baked plain = bake(torus(), {"rays=16"}), smooth = bake(torus(), {"rays=16", "smooth=3"});
  const auto roughness = [](const std::vector<Lobe>& lobes) {
    double sum = 0;
    for (const auto& [a, b, c] : torus().surface.triangles)
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
        sum += length(lobes[from].direction * lobes[from].thickness - lobes[to].direction * lobes[to].thickness);
    return sum;
  };
  EXPECT_LT(roughness(smooth.baked.lobes), 0.98 * roughness(plain.baked.lobes));
  EXPECT_EQ(stages(smooth), (std::vector<std::string>{"bake", "smooth"}));
}

// A fit's figures are of the lobes that will be written: smoothed ones.
TEST(Lobes, AFitIsJudgedAsItWillBeWritten) {
  const Baked plain = bake(torus(), {"lobe=fit", "rays=36", "extinction=2"}),
              smooth = bake(torus(), {"lobe=fit", "rays=36", "extinction=2", "smooth=9"});
  EXPECT_GT(smooth.baked.fit[0].fitted_rms, plain.baked.fit[0].fitted_rms + 1e-4);
  EXPECT_EQ(smooth.baked.fit[0].mean_rms, plain.baked.fit[0].mean_rms);
}

// --- Harmonics ---

// On the ball T = exp(−σ · max(0, −2 p·l)): its mean over the sphere is 1/2 + (1 − e^−2σ)/(4σ), and it grows along p alone.
TEST(Lobes, HarmonicsOfTheBall) {
  const Baked b = bake(ball(), {"rays=400", "extinction=2", "basis=sh1"});
  const std::vector<float> coefficients = bakeHarmonics({ball().surface.positions, {}}, b.field, 1, b.settings.lobe, b.parameters);
  ASSERT_EQ(coefficients.size(), 4 * ball().surface.positions.size());
  const double mean = 0.5 + (1 - std::exp(-4.0)) / 8;
  double constant = 0, angle = 0;
  const double count = double(ball().surface.positions.size());
  for (size_t v = 0; v < ball().surface.positions.size(); ++v) {
    const float* c = &coefficients[4 * v];
    constant += c[0] / count;
    angle += angleDegrees(*normalized({c[3], c[1], c[2]}), ball().surface.positions[v]) / count;
  }
  EXPECT_NEAR(constant, std::sqrt(4 * kPi) * mean, 0.03);
  EXPECT_LT(angle, 2);
  EXPECT_EQ(bakeHarmonics({ball().surface.positions, {}}, b.field, 3, b.settings.lobe, b.parameters).size(),
            16 * ball().surface.positions.size());
}

// Cells of one size over the box and one around it. In the middle of the ball T is exp(−σ) in every direction; at a corner of the lattice
// most of the sphere sees nothing of it.
TEST(Lobes, ALatticeAroundTheBall) {
  const Baked b = bake(ball(), {"rays=100", "extinction=2", "basis=sh1"});
  LobeSettings settings = b.settings.lobe;
  settings.lattice_cells = 5;
  const HarmonicLattice lattice = bakeLattice(ball(), b.field, settings, b.parameters);
  const Box box = boundingBox(ball().surface);
  EXPECT_EQ(lattice.cells, (std::array<int, 3>{7, 7, 7}));
  EXPECT_FLOAT_EQ(lattice.cell_size, box.longestSide() / 5);
  EXPECT_EQ(lattice.order, 1);
  EXPECT_EQ(lattice.extinction, 2);
  EXPECT_NEAR(lattice.origin.x, -3 * lattice.cell_size, 1e-5);
  ASSERT_EQ(lattice.coefficients.size(), 4U * 343);
  const float* middle = &lattice.coefficients[4 * 171];
  EXPECT_NEAR(middle[0], std::sqrt(4 * kPi) * std::exp(-2), 0.03);
  for (int i = 1; i < 4; ++i) EXPECT_NEAR(middle[i], 0, 0.02);
  EXPECT_GT(lattice.coefficients[0], 0.9 * std::sqrt(4 * kPi));
  // x runs fastest: the cell after the middle one lies on its +x side, where the light of +x is brighter.
  EXPECT_GT(harmonicTransmittance({&lattice.coefficients[4 * 172], 4}, {1, 0, 0}),
            harmonicTransmittance({&lattice.coefficients[4 * 172], 4}, {-1, 0, 0}));
}

TEST(Lobes, ALatticeOfALongCloudHasCubesForCells) {
  const Cloud bar = cloudOf(boxMesh({0, 0, 0}, {4, 1, 2}));
  const Baked b = bake(bar, {"rays=16", "basis=sh1"});
  LobeSettings settings = b.settings.lobe;
  settings.lattice_cells = 8;
  const HarmonicLattice lattice = bakeLattice(bar, b.field, settings, b.parameters);
  EXPECT_EQ(lattice.cells, (std::array<int, 3>{10, 4, 6}));
  EXPECT_EQ(lattice.cell_size, 0.5F);
  EXPECT_EQ(lattice.origin, (Vec3{-0.25F, -0.25F, -0.25F}));
}

}  // namespace
}  // namespace cloudbake
