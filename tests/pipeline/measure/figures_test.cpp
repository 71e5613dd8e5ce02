// Figures of a bake against exact chords.
#include "pipeline/measure/figures.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "bake/lobe/fit_lobe.h"
#include "core/harmonics.h"
#include "core/lobe_lighting.h"
#include "pipeline/measure/oracle.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/pipeline/shape_clouds.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

struct Measured {
  MeasuredFigures figures;
  BakedLobes baked;
  BakeParameters parameters;
  Settings settings;
  IntegrationField field;
};
Measured measure(const Cloud& cloud, std::vector<std::string> texts) {
  texts.insert(texts.begin(), {"lobe=mean", "fit-to=transmittance"});  // unless a test chooses another
  Measured m;
  m.settings = resolve(sourceOf(SourceKind::kSculpt), options(texts, kMeasure));
  m.parameters = parametersFor(cloud, m.settings);
  Warnings warnings;
  Stopwatch watch;
  StageSeconds seconds;
  m.field = buildField(cloud, m.settings.field, m.settings.lobe.bake.method, warnings);
  m.baked = bakeLobes(cloud, m.field, m.settings.lobe, m.parameters, warnings, watch, seconds);
  m.figures = measureBake(cloud, m.field, m.baked, m.settings, m.parameters);
  return m;
}

TEST(Figures, OfAMeanLobe) {
  const Measured coarse = measure(ball(), {"rays=24", "voxels=20", "truth-vertices=60"}),
                 fine = measure(ball(), {"rays=400", "voxels=50", "truth-vertices=60"});
  EXPECT_EQ(coarse.figures.bake.vertices, 60U);
  EXPECT_FALSE(coarse.figures.bake.is_fit || coarse.figures.harmonics);
  EXPECT_TRUE(coarse.figures.fit.empty());
  EXPECT_LT(fine.figures.bake.lobe.angle_rms_degrees, 1);
  EXPECT_LT(fine.figures.bake.lobe.angle_rms_degrees, coarse.figures.bake.lobe.angle_rms_degrees / 2);
  EXPECT_LT(fine.figures.lengths.rms, coarse.figures.lengths.rms);
  EXPECT_LT(fine.figures.lengths.rms, 0.1);
  // The lobe of the ball is cos^6 of half the angle where exp(−σℓ) falls with the cosine: no number of rays mends that.
  EXPECT_NEAR(fine.figures.bake.transmittance.rms, coarse.figures.bake.transmittance.rms, 0.02);
  EXPECT_GT(fine.figures.bake.transmittance.rms, 1.5 * fine.figures.lengths.rms);
}

// The second route: lengths from the oracle, lobes as they are.
TEST(Figures, OfAFitPerExtinction) {
  const Measured m = measure(torus(), {"lobe=fit", "rays=36", "voxels=30", "extinction=1:4", "truth-vertices=40"});
  EXPECT_TRUE(m.figures.bake.is_fit);
  ASSERT_EQ(m.figures.fit.size(), 3U);
  const Oracle oracle = askOracle(torus(), m.settings.field, 40, {1, {}, *m.parameters.bake.ray_length});
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  const Measured plain = measure(torus(), {"rays=36", "voxels=30", "truth-vertices=40"});
  for (const FitError& error : m.figures.fit) {
    const auto rms = [&](const std::vector<Lobe>& lobes, LobeShape shape) {
      double squares = 0;
      for (size_t i = 0; i < oracle.vertices.size(); ++i)
        for (size_t j = 0; j < directions.size(); ++j)
          squares += std::pow(lobeTransmittance(lobes[oracle.vertices[i]], directions[j], shape, float(error.extinction)) -
                                  std::exp(-error.extinction * oracle.lengths[i * directions.size() + j]),
                              2);
      return std::sqrt(squares / double(oracle.lengths.size()));
    };
    EXPECT_NEAR(error.fitted_rms, rms(m.baked.lobes, m.baked.shape), 1e-5);
    EXPECT_NEAR(error.mean_rms, rms(plain.baked.lobes, defaultMeanShape(torus().surface)), 1e-5);
    EXPECT_LT(error.fitted_rms, error.mean_rms);
  }
}

TEST(Figures, HarmonicsComeNearerThanALobe) {
  const Measured first = measure(torus(), {"rays=100", "voxels=30", "basis=sh1", "truth-vertices=40"}),
                 third = measure(torus(), {"rays=100", "voxels=30", "basis=sh3", "truth-vertices=40"});
  ASSERT_TRUE(first.figures.harmonics && third.figures.harmonics);
  EXPECT_EQ(third.figures.harmonics->order, 3);
  EXPECT_EQ(third.figures.harmonics->lobe_rms, third.figures.bake.transmittance.rms);
  EXPECT_LT(third.figures.harmonics->rms, third.figures.harmonics->lobe_rms);
  EXPECT_LT(third.figures.harmonics->rms, first.figures.harmonics->rms);
  const Oracle oracle = askOracle(torus(), third.settings.field, 40, {1, {}, *third.parameters.bake.ray_length});
  const std::vector<float> coefficients = bakeHarmonics({oracle.positions, {}}, third.field, 3, third.settings.lobe, third.parameters);
  const std::vector<Vec3> directions = bothSenses(oracle.axes);
  double squares = 0;
  for (size_t i = 0; i < oracle.vertices.size(); ++i)
    for (size_t j = 0; j < directions.size(); ++j)
      squares += std::pow(harmonicTransmittance({&coefficients[16 * i], 16}, directions[j]) -
                              std::exp(-double(third.parameters.extinction) * oracle.lengths[i * directions.size() + j]),
                          2);
  EXPECT_NEAR(third.figures.harmonics->rms, std::sqrt(squares / double(oracle.lengths.size())), 1e-5);
}

MeasuredFigures handmade() {
  MeasuredFigures f;
  f.bake.truth = "Embree, all hits";
  f.bake.vertices = 40;
  f.bake.lobe = {1.25, 1, 2, 3, 40, 2, 0.05, -0.025};
  f.bake.transmittance = {0.125, -0.0625};
  f.lengths = {0.03125, 0.015625};
  f.fit = {{2, 0.25, 0.125}};
  f.harmonics = HarmonicError{2, 0.125, 0.0625};
  return f;
}

TEST(Figures, AsText) {
  const std::string text = figuresText(handmade());
  for (const char* piece :
       {"truth          Embree, all hits, 40 vertices, 4096 directions\n",
        "direction      rms 1.250°, median 1.000°, p95 2.000°, max 3.00° (left out: 2", "density        rms 5.000 %, bias -2.500 %",
        "rms 0.0312, bias +0.0156 of the lengths; rms 0.1250, bias -0.0625 of the lobe (512 directions)",
        "extinction 2: rms of T 0.1250, of the mean lobe 0.2500, ratio 0.500", "order 2: rms of T 0.0625, of the lobe 0.1250, ratio 0.500"})
    EXPECT_TRUE(contains(text, piece)) << piece << "\n" << text;
}

TEST(Figures, AsJson) {
  const Json json = figuresJson(handmade());
  EXPECT_EQ(json["truth"], "Embree, all hits");
  EXPECT_EQ(json["vertices"], 40);
  EXPECT_EQ(json["direction_degrees"]["rms"], 1.25);
  EXPECT_EQ(json["density"]["bias"], -0.025);
  EXPECT_EQ(json["transmittance_of_lengths"]["rms"], 0.03125);
  EXPECT_EQ(json["transmittance_of_lengths"]["bias"], 0.015625);
  EXPECT_EQ(json["transmittance_of_lobe"]["rms"], 0.125);
  EXPECT_EQ(json["transmittance_of_lobe"]["bias"], -0.0625);
  EXPECT_EQ(json["fit"], Json::parse(R"([{"extinction": 2.0, "mean_rms": 0.25, "fitted_rms": 0.125}])"));
  EXPECT_EQ(json["harmonics"], Json::parse(R"({"order": 2, "lobe_rms": 0.125, "rms": 0.0625})"));
  MeasuredFigures plain = handmade();
  plain.fit.clear();
  plain.harmonics.reset();
  EXPECT_FALSE(figuresJson(plain).contains("fit") || figuresJson(plain).contains("harmonics"));
}

}  // namespace
}  // namespace cloudbake
