// Assets with lobes in closed form are judged as docs/check.md says: sound ones pass, and damaged ones fail with the cause that was done
// to them.
#include "pipeline/check/check.h"

#include <set>

#include "pipeline/library/cloudbake.h"
#include "tests/pipeline/check/check_helpers.h"
#include "tests/pipeline/option_samples.h"

namespace cloudbake {
namespace {

CheckReport check(const std::string& glb, std::vector<std::string> texts = {}) {
  const TestFolder folder;
  texts.emplace_back("truth-vertices=40");
  return checkAsset(resolve(sourceOf(SourceKind::kSculpt, folder.write("asset.glb", glb)), options(texts, kCheck)));
}
CheckReport check(const TestAsset& asset, const std::vector<std::string>& texts = {}) { return check(glbOf(asset), texts); }

// A direction that has nothing to do with the vertex.
Vec3 drawnDirection(size_t v) {
  const auto draw = [&](uint32_t i) { return uniformFloat(hashDraw(5, uint32_t(v), i)) - 0.5F; };
  return normalized(Vec3{draw(0), draw(1), draw(2)}).value_or(Vec3{1, 0, 0});
}

std::vector<std::string> boundKeys(const CheckReport& report) {
  std::vector<std::string> keys;
  for (const FigureBound& bound : report.bounds) keys.emplace_back(bound.field->key);
  return keys;
}

TEST(Check, LobesOfABallAreSound) {
  const CheckReport report = check(ballAsset());
  EXPECT_EQ(causeOf(report), "sound") << whatOf(report);
  ASSERT_TRUE(report.figures);
  EXPECT_EQ(report.figures->bake.vertices, 40U);
  EXPECT_FALSE(report.figures->bake.is_fit);
  EXPECT_LT(report.figures->bake.lobe.angle_rms_degrees, 3);
  EXPECT_LT(std::fabs(report.figures->bake.lobe.density_bias), 0.1);
  EXPECT_EQ(report.run.vertices, 162U);
  EXPECT_EQ(report.run.triangles, 320U);
  EXPECT_EQ(report.file.first_set, 0);
  EXPECT_TRUE(report.file.faults.empty());
  EXPECT_EQ(boundKeys(report), (std::vector<std::string>{"direction_median_degrees", "direction_rms_degrees", "density_bias"}));
  EXPECT_EQ(report.bounds[0].most, 10);
  EXPECT_EQ(report.bounds[1].most, 20);
  EXPECT_EQ(report.bounds[2].most, 0.25);
}

TEST(Check, OnlyBakedGltfCanBeChecked) {
  const TestFolder folder;
  const auto run = [&](const std::filesystem::path& file, const std::vector<std::string>& texts = {}) {
    checkAsset(resolve(sourceOf(SourceKind::kSculpt, file), options(texts, kCheck)));
  };
  expectError<InputError>([&] { run(folder.write("a.obj", kTetrahedronObj)); }, "not a baked asset");
  const auto asset = folder.write("a.GLB", glbOf(ballAsset()));
  expectError<InputError>([&] { run(asset, {"against=" + (folder.path / "a.obj").string()}); }, "not a baked asset");
  EXPECT_NO_THROW(run(asset, {"truth-vertices=1"})) << "extensions may be in upper case";
}

TEST(Check, BoundsReplaceTheDefaults) {
  EXPECT_EQ(causeOf(check(tilted(8))), "sound") << "8 degrees are less than the default bounds";
  const CheckReport strict = check(tilted(8), {"max-angle=4"});
  EXPECT_EQ(causeOf(strict), "bound") << whatOf(strict);
  EXPECT_TRUE(contains(whatOf(strict), "direction is off by")) << whatOf(strict);
  EXPECT_EQ(boundKeys(strict), std::vector<std::string>{"direction_rms_degrees"});
  EXPECT_NEAR(strict.figures->bake.lobe.angle_rms_degrees, 8, 1);
  EXPECT_EQ(boundKeys(check(tilted(8), {"max-surface-rms=0.9"})), (std::vector<std::string>{"surface_vertex_rms", "surface_pixel_rms"}));
  EXPECT_TRUE(check(tilted(8), {"max-surface-rms=0.0001"}).verdict);
  const CheckReport both = check(tilted(8), {"max-angle=30", "max-transmittance-rms=0.9"});
  EXPECT_EQ(causeOf(both), "sound");
  EXPECT_EQ(boundKeys(both), (std::vector<std::string>{"direction_rms_degrees", "transmittance_rms"}));
}

TEST(Check, NamesWhatWasDoneToAllLobes) {
  const auto mirrored = changedBall([](Lobe lobe, size_t) {
    return Lobe{{-lobe.direction.x, lobe.direction.y, lobe.direction.z}, lobe.thickness};
  });
  EXPECT_EQ(causeOf(check(mirrored)), "handedness");
  const auto outward = changedBall([](Lobe lobe, size_t) { return Lobe{-lobe.direction, lobe.thickness}; });
  EXPECT_EQ(causeOf(check(outward)), "inverted");
  const CheckReport swapped = check(withSwappedSets(glbOf(ballAsset())));
  EXPECT_EQ(causeOf(swapped), "sets-swapped") << whatOf(swapped);
}

// Three times the thickness of a ball is more than its diagonal: the file shows the symptom and the diagnosis finds the cause.
TEST(Check, ScaledThicknessIsTooDense) {
  const CheckReport report = check(changedBall([](Lobe lobe, size_t) { return Lobe{lobe.direction, 3 * lobe.thickness}; }));
  EXPECT_EQ(causeOf(report), "units");
  ASSERT_EQ(report.file.faults.size(), 1U);
  EXPECT_EQ(report.file.faults[0].cause, "too-dense");
  EXPECT_TRUE(contains(report.file.faults[0].what, "at 162 vertices")) << report.file.faults[0].what;
}

// The mean of d may be off by a quarter, above the truth or below it.
TEST(Check, TheDensityMayBeBiasedByAQuarterEitherWay) {
  const auto scaled = [](float factor) {
    return check(changedBall([&](Lobe lobe, size_t) { return Lobe{lobe.direction, factor * lobe.thickness}; }));
  };
  for (const float factor : {0.6F, 1.4F}) {
    const CheckReport report = scaled(factor);
    EXPECT_NEAR(report.figures->bake.lobe.density_bias, factor - 1, 0.1) << factor;
    EXPECT_EQ(causeOf(report), "units") << factor;
    EXPECT_EQ(whatOf(report).find("density is off by "), 0U) << factor << ": " << whatOf(report);
    EXPECT_TRUE(contains(whatOf(report), "% bias, over 25%")) << whatOf(report);
  }
}

// A part of the lobes of two balls was replaced. No single change of all lobes explains that, so only the bound of the bias can find it.
TEST(Check, ABiasThatNoSingleChangeExplains) {
  const auto replacedWhere = [](float least_draw, float factor) {
    TestAsset large = ballAsset(), small = ballAsset(0.1F, 2, {9, 0, 0});
    large.info.separate = true;
    for (TestAsset* ball : {&large, &small})
      for (size_t v = 0; v < ball->lobes.size(); ++v)
        if (drawnDirection(v).x > least_draw) ball->lobes[v].thickness *= factor;
    return check(glbOf({large, small}));
  };
  const CheckReport untouched = replacedWhere(1, 1);
  EXPECT_EQ(causeOf(untouched), "sound") << whatOf(untouched);
  EXPECT_LT(std::fabs(untouched.figures->bake.lobe.density_bias), 0.1);
  for (const auto& [least_draw, factor] : {std::pair(0.15F, 0.001F), std::pair(-0.1F, 1.7F)}) {
    const CheckReport report = replacedWhere(least_draw, factor);
    EXPECT_EQ(report.figures->bake.lobe.density_bias < 0, factor < 1);
    EXPECT_FALSE(report.diagnosis->explained()) << causeOf(report);
    EXPECT_EQ(causeOf(report), factor < 1 ? "stale" : "bound") << whatOf(report);
    EXPECT_EQ(overBound(report.figures->bake, report.bounds).find("density is off by "), 0U) << factor;
  }
}

// A single vertex that no bound notices.
TEST(Check, OneVertexThatIsTooDense) {
  const CheckReport report = check(changedBall([](Lobe lobe, size_t v) { return Lobe{lobe.direction, v == 161 ? 9 : lobe.thickness}; }));
  EXPECT_EQ(causeOf(report), "too-dense");
  EXPECT_TRUE(contains(whatOf(report), "at 1 vertices")) << whatOf(report);
}

TEST(Check, StrippedSets) {
  const CheckReport report = check(withoutSets(glbOf(ballAsset())));
  EXPECT_EQ(causeOf(report), "stripped");
  EXPECT_FALSE(report.figures || report.diagnosis);
  EXPECT_EQ(report.file.first_set, -1);
  EXPECT_EQ(report.run.vertices, 162U);
}

TEST(Check, MovedSetsAreReadWhereTheyAre) {
  const auto moved = [](const std::string& glb) { return replaced(replaced(glb, "TEXCOORD_1", "TEXCOORD_3"), "TEXCOORD_0", "TEXCOORD_2"); };
  const CheckReport report = check(moved(glbOf(ballAsset())));
  EXPECT_EQ(causeOf(report), "moved");
  EXPECT_TRUE(contains(whatOf(report), "; apart from that the lobes are intact")) << whatOf(report);
  EXPECT_EQ(report.file.first_set, 2);
  const CheckReport worse = check(moved(glbOf(changedBall([](Lobe lobe, size_t) { return Lobe{-lobe.direction, lobe.thickness}; }))));
  EXPECT_EQ(causeOf(worse), "moved");
  EXPECT_TRUE(contains(whatOf(worse), "; also ")) << whatOf(worse);
}

// k, b and σ are then the defaults: σ = 7 / longest side.
TEST(Check, WithoutMetadataTheDefaultsApply) {
  TestAsset asset = ballAsset();
  asset.info.extinction = 123;
  const CheckReport report = check(replaced(glbOf(asset), "\"cloudbake\":", "\"cloudfake\":"));
  EXPECT_EQ(causeOf(report), "sound") << whatOf(report);
  EXPECT_EQ(report.run.info.lobe, "mean");
  EXPECT_NEAR(report.run.info.extinction, 7 / boundingBox(asset.mesh).longestSide(), 1e-5);
  EXPECT_EQ(report.run.info.method, "");
  ASSERT_EQ(report.file.harmless.size(), 1U);
  EXPECT_EQ(report.file.harmless[0].cause, "no-metadata");
}

std::string fittedGlb(const std::string& to = "transmittance") {
  return bake(boxMesh({0, 0, 0}, {2, 1, 1}), {{"fit-to", to}, {"rays", "256"}, {"voxels", "40"}}).glb;
}

// Judged by its transmittance alone, beside the exact mean lobe and a lobe fitted anew.
TEST(Check, FittedLobes) {
  const std::string glb = fittedGlb();
  const CheckReport report = check(glb);
  EXPECT_EQ(causeOf(report), "sound") << whatOf(report);
  ASSERT_TRUE(report.figures && report.figures->bake.is_fit);
  EXPECT_EQ(boundKeys(report), std::vector<std::string>{"transmittance_rms"});
  EXPECT_DOUBLE_EQ(report.bounds[0].most, 1.1 * report.figures->best_fit_rms + 0.02);
  EXPECT_GT(report.figures->best_fit_rms, 0);
  EXPECT_LT(report.figures->best_fit_rms, report.figures->mean_rms);
  EXPECT_LT(report.figures->best_fit_rms, report.figures->bake.transmittance.rms + 0.01);
  EXPECT_TRUE(boundKeys(check(glb, {"max-angle=0.001"})) == std::vector<std::string>{"transmittance_rms"}) << "angles mean nothing here";
  const CheckReport tight = check(glb, {"max-transmittance-rms=0.001"});
  EXPECT_EQ(causeOf(tight), "bound") << whatOf(tight);
  EXPECT_TRUE(contains(tight.verdict->cure, "a single lobe cannot come closer")) << tight.verdict->cure;
}

TEST(Check, TheNumbersShowAFitWithoutMetadata) {
  for (const char* to : {"transmittance", "volume"}) {
    const CheckReport report = check(replaced(fittedGlb(to), "\"cloudbake\":", "\"cloudfake\":"));
    EXPECT_EQ(causeOf(report), "sound") << to << ": " << whatOf(report);
    EXPECT_EQ(report.run.info.lobe, "fit");
    EXPECT_EQ(report.run.info.volume.has_value(), to == std::string("volume"));
  }
}

// Rays as long as those of the bake are too short where the mesh was scaled with its lobes.
TEST(Check, AMeshThatWasScaledSince) {
  TestAsset asset = ballAsset(1.5F);
  asset.info = ballAsset(0.5F).info;
  const CheckReport report = check(asset);
  EXPECT_EQ(causeOf(report), "sound") << whatOf(report);
  EXPECT_LT(std::fabs(report.figures->bake.lobe.density_bias), 0.1);
}

TEST(Check, RaysAreAsLongAsThoseOfTheBake) {
  TestAsset asset = ballAsset();
  asset.info.ray_length = 1;
  for (Lobe& lobe : asset.lobes) lobe.thickness = 1;
  const CheckReport report = check(asset);
  EXPECT_EQ(causeOf(report), "sound") << whatOf(report);
}

TEST(Check, LobesOfAnotherMeshAreStale) {
  const auto other = [](Lobe lobe, size_t v) {
    return Lobe{drawnDirection(v), (0.3F + drawnDirection(v).y * drawnDirection(v).y) * lobe.thickness};
  };
  const CheckReport all = check(changedBall(other));
  EXPECT_EQ(causeOf(all), "stale");
  EXPECT_TRUE(contains(whatOf(all), "the lobes are those of another mesh")) << whatOf(all);
  const CheckReport some = check(changedBall([&](Lobe lobe, size_t v) { return v % 3 == 0 ? other(lobe, v) : lobe; }));
  EXPECT_EQ(causeOf(some), "part");
  const CheckReport turned = check(changedBall([](Lobe lobe, size_t v) { return Lobe{drawnDirection(v), lobe.thickness}; }));
  EXPECT_EQ(causeOf(turned), "direction") << whatOf(turned);
}

// A poor bake is told from a changed one: its lobes are what its settings give.
TEST(Check, RoughAndTooCoarseBakes) {
  const auto baked = [](const SurfaceMesh& mesh, std::vector<std::pair<std::string, std::string>> options) {
    options.emplace_back("lobe", "mean");
    return check(bake(mesh, options).glb, {"max-angle=1"});
  };
  const SurfaceMesh bar = boxMesh({0, 0, 0}, {3, 1, 0.8F});
  EXPECT_EQ(causeOf(baked(bar, {{"rays", "16"}})), "rough");
  EXPECT_EQ(causeOf(baked(bar, {{"method", "rays"}, {"sampler", "uniform"}})), "rough");
  EXPECT_EQ(causeOf(baked(bar, {{"method", "rays"}})), "bound") << "100 stratified rays are not few";
  EXPECT_EQ(causeOf(baked(boxMesh({0, 0, 0}, {3, 1, 0.02F}), {{"voxels", "30"}})), "too-coarse");
}

// Whatever option a bake is given, check bakes the lobes anew as they are, from what the asset records. The lobes may be rough or over a
// bound, but they are not mistaken for those of another mesh, or for damaged ones.
TEST(Check, NoOptionOfABakeLooksLikeDamage) {
  const SurfaceMesh bar = boxMesh({0, 0, 0}, {3, 1, 0.8F});
  const std::set<std::string> harmless{"sound", "rough", "too-coarse", "bound"};
  // What an option may need.
  const std::vector<Options> companions{{}, {{"method", "rays"}}, {{"pack", "8"}}};
  const std::set<std::string_view> in_voxels{"voxels", "bake-voxels"};  // the samples are 2, which no fit can be made in
  const auto bakedWith = [&](const Option& option) {
    for (Options given : companions) {
      given.emplace_back(option.name, samplesOf(option).one);
      if (in_voxels.contains(option.name)) given.emplace_back("lobe", "mean");
      try {
        return bake(bar, given).glb;
      } catch (const UsageError&) {
      }
    }
    return std::string();
  };
  for (const Option& option : optionTable()) {
    const bool is_of_meshes = (option.commands & kBake) && (option.inputs & kFromSculpt) && !(option.bits & kOfInputFile);
    if (!is_of_meshes || option.files.kind != FileUse::kNone) continue;
    const std::string glb = bakedWith(option);
    ASSERT_NE(glb, "") << option.name << " needs other companions";
    const CheckReport report = check(glb);
    EXPECT_TRUE(harmless.contains(causeOf(report))) << option.name << " " << samplesOf(option).one << ": " << whatOf(report);
  }
}

TEST(Check, SeparateObjectsAreJudgedAlone) {
  TestAsset outer = ballAsset(), inner = ballAsset(0.6F, 2, {0.9F, 0, 0});
  EXPECT_NE(causeOf(check(glbOf({outer, inner}), {"max-angle=4"})), "sound") << "each is in the other's light";
  outer.info.separate = true;
  const CheckReport report = check(glbOf({outer, inner}), {"max-angle=4"});
  EXPECT_EQ(causeOf(report), "sound") << whatOf(report);
  EXPECT_EQ(report.figures->bake.vertices, 40U);
}

TEST(Check, AgainstAnEarlierAsset) {
  const TestFolder folder;
  const auto before = folder.write("before.glb", glbOf(ballAsset()));
  const CheckReport report = check(ballAsset(), {"against=" + before.string()});
  EXPECT_EQ(causeOf(report), "sound");
  EXPECT_TRUE(report.comparison);
  EXPECT_FALSE(report.figures) << "nothing is measured against chords";
}

}  // namespace
}  // namespace cloudbake
