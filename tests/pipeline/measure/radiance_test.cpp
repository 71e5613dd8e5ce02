// The judge of fits to a volume, on a ball whose picture is known in closed form.
#include "pipeline/measure/radiance.h"

#include <array>
#include <cmath>
#include <map>

#include "bake/lobe/directions.h"
#include "bake/lobe/volume_target.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/pipeline/shape_clouds.h"

namespace cloudbake {
namespace {

IntegrationField ballField(int voxels) {
  Warnings warnings;
  return buildField(ball(), settingsFor({"bake-voxels=" + std::to_string(voxels)}).field, Method::kSweep, warnings);
}

// Two points with one light: C is 0.2 and 0.6 at the first, with weights 1 and 3, and 0.5 at the second with weight 2.
TEST(Radiance, ErrorsByHand) {
  VolumeTruth truth;
  truth.seen = {4, 7};
  truth.weights = {4, 2};
  truth.mean = {0.5F, 0.5F};
  truth.square = {(0.04F + 3 * 0.36F) / 4, 0.25F};
  const RadianceError error = compareRadiance(truth, 1, [](size_t i, size_t) { return i == 0 ? 0.25 : 0.5; });
  EXPECT_NEAR(error.rms, std::sqrt((0.0025 + 3 * 0.1225) / 6), 1e-6);
  EXPECT_NEAR(error.limit, std::sqrt((0.09 + 3 * 0.01) / 6), 1e-6);
  const double exposure = (4 * 0.5 * 0.25 + 2 * 0.5 * 0.5) / (4 * 0.0625 + 2 * 0.25);
  EXPECT_NEAR(error.exposure, exposure, 1e-6);
  EXPECT_NEAR(
      error.exposed_rms,
      std::sqrt((std::pow(0.2 - 0.25 * exposure, 2) + 3 * std::pow(0.6 - 0.25 * exposure, 2) + 2 * std::pow(0.5 - 0.5 * exposure, 2)) / 6),
      1e-6);
  EXPECT_NEAR(compareRadiance(truth, 1, [](size_t, size_t) { return 0.5; }).rms, error.limit, 1e-7);
  EXPECT_EQ(compareRadiance(truth, 1, [](size_t, size_t) { return 0.0; }).exposure, 1);
  EXPECT_EQ(compareRadiance({}, 1, [](size_t, size_t) { return 0.0; }).rms, 0);
}

// Neither shares code with the other, and their views differ.
TEST(Radiance, MarchesAgreeWithTheTarget) {
  const BakePoints points{ball().surface.positions, ball().surface.normals};
  const IntegrationField judges = ballField(48);
  const IntegrationField targets = ballField(60);
  const std::vector<Vec3> lights{{0, 1, 0}, {0, -1, 0}, {0.6F, 0, 0.8F}, {-0.6F, 0, -0.8F}}, axes{lights[0], lights[2]};
  for (const VolumeLight& volume : {VolumeLight{}, VolumeLight{0.5F, {4}, 0}, VolumeLight{1, {2}, 0.4F}}) {
    const VolumeTruth truth = marchVolume(points, *judges.coverage, lights, std::array{3.5F}, {volume}).front();
    EXPECT_EQ(truth.seen.size(), points.positions.size());
    const VolumeTarget target = volumeTarget(points, axes, *targets.coverage, {{3.5F}, volume, 4});
    const RadianceError error = compareRadiance(
        truth, lights.size(), [&](size_t i, size_t j) { return double(target.radiance[truth.seen[i] * lights.size() + j]); });
    EXPECT_GT(error.limit, 0.03) << "views differ";
    EXPECT_LT(error.rms, std::sqrt(error.limit * error.limit + 0.03 * 0.03)) << "the target is nearly the mean";
  }
}

TEST(Radiance, AVertexInsideIsNotSeen) {
  const std::vector<Vec3> positions{{0, 0, 0}, {0, 1, 0}}, normals{{0, 1, 0}, {0, 1, 0}};
  const IntegrationField field = ballField(40);
  const std::vector<Vec3> up{{0, 1, 0}};
  EXPECT_EQ(marchVolume({positions, normals}, *field.coverage, up, std::array{2.0F}, {}).front().seen, std::vector<size_t>{1});
}

// Lights are marched to once for all of them.
TEST(Radiance, EveryExtinctionIsAsIfAlone) {
  const std::vector<Vec3> positions{{0, 1, 0}, {1, 0, 0}}, lights{{0, 1, 0}, {0, -1, 0}, {0.6F, 0, 0.8F}};
  const IntegrationField field = ballField(24);
  const std::array extinctions{1.0F, 4.0F};
  const std::vector<VolumeTruth> all = marchVolume({positions, positions}, *field.coverage, lights, extinctions, {});
  ASSERT_EQ(all.size(), 2U);
  EXPECT_NE(all[0].mean, all[1].mean);
  for (size_t e = 0; e < 2; ++e) {
    const VolumeTruth alone = marchVolume({positions, positions}, *field.coverage, lights, {&extinctions[e], 1}, {}).front();
    EXPECT_EQ(all[e].seen, alone.seen);
    EXPECT_EQ(all[e].weights, alone.weights);
    EXPECT_EQ(all[e].mean, alone.mean);
    EXPECT_EQ(all[e].square, alone.square);
    EXPECT_EQ(all[e].views, alone.views);
  }
}

// The order of the shadings that the fit promises.
TEST(Radiance, OfAllShadings) {
  const Settings settings =
      resolve(sourceOf(SourceKind::kSculpt),
              options({"lobe=fit", "fit-to=volume", "extinction=3", "truth-vertices=40", "bake-voxels=40"}, kMeasure));
  const BakeParameters parameters = parametersFor(torus(), settings);
  Warnings warnings;
  Stopwatch watch;
  StageSeconds seconds;
  const IntegrationField field = buildField(torus(), settings.field, Method::kSweep, warnings);
  const BakedLobes baked = bakeLobes(torus(), field, settings.lobe, parameters, warnings, watch, seconds);
  const std::vector<RadianceFigures> all = measureRadiance(torus(), field, baked, settings, parameters);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_NEAR(all[0].extinction, 3, 1e-6);
  EXPECT_GT(all[0].pairs, all[0].vertices);
  std::map<std::string, RadianceError> by_name(all[0].shadings.begin(), all[0].shadings.end());
  ASSERT_EQ(by_name.size(), 7U);
  const RadianceError& fitted = by_name.at("fitted to volume");
  EXPECT_LT(fitted.rms, 0.7 * by_name.at("published lobe").rms);
  EXPECT_LT(fitted.rms, 0.7 * by_name.at("exact T").rms);
  EXPECT_LT(fitted.rms, 0.7 * by_name.at("fitted to T").rms);
  EXPECT_LT(by_name.at("sh3").rms, by_name.at("sh1").rms);
  EXPECT_LT(by_name.at("sh3").rms, fitted.rms);
  for (const auto& [name, error] : by_name) {
    EXPECT_LE(error.exposed_rms, error.rms) << name;
    EXPECT_GE(error.exposed_rms, 0.9 * error.limit) << name;
    EXPECT_EQ(error.limit, fitted.limit) << name;
  }
}

}  // namespace
}  // namespace cloudbake
