// Vertices are matched by place, whatever their order, and what a tool did to their lobes is found.
#include "pipeline/check/against.h"

#include <numeric>

#include "pipeline/library/cloudbake.h"
#include "tests/pipeline/check/check_helpers.h"

namespace cloudbake {
namespace {

SurfaceMesh pointsOf(std::vector<Vec3> positions, std::vector<Vec3> normals = {}) {
  SurfaceMesh mesh;
  mesh.positions = std::move(positions);
  mesh.normals = std::move(normals);
  return mesh;
}

// The diagonal of these is 10·√3, so that positions agree within 1.73e-3.
const std::vector<Vec3> kFar{{0, 0, 0}, {10, 10, 10}, {10, 0, 0}, {0, 10, 0}, {5, 5, 5}};

TEST(MatchVertices, InAnyOrder) {
  const std::vector<Vec3> turned(kFar.rbegin(), kFar.rend());
  EXPECT_EQ(matchVertices(pointsOf(turned), pointsOf(kFar)), (std::vector<uint32_t>{4, 3, 2, 1, 0}));
}

TEST(MatchVertices, WithinATenThousandthOfTheDiagonal) {
  for (const Vec3 way :
       {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{0.577F, 0.577F, -0.577F}}) {
    EXPECT_EQ(matchVertices(pointsOf({Vec3{5, 5, 5} + 1.7e-3F * way}), pointsOf(kFar)), std::vector<uint32_t>{4})
        << way.x << way.y << way.z;
    EXPECT_EQ(matchVertices(pointsOf({Vec3{5, 5, 5} + 1.8e-3F * way}), pointsOf(kFar)), std::vector<uint32_t>{kUnmatched});
  }
}

TEST(MatchVertices, TheNearestOfTwo) {
  std::vector<Vec3> before = kFar;
  before.push_back({5.001F, 5, 5});
  EXPECT_EQ(matchVertices(pointsOf({{5.0004F, 5, 5}, {5.0006F, 5, 5}}), pointsOf(before)), (std::vector<uint32_t>{4, 5}));
}

TEST(MatchVertices, TheBestNormalOfEquallyNear) {
  const SurfaceMesh before = pointsOf({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}});
  const Vec3 mostly_y = *normalized(Vec3{0.3F, 1, 0.2F});
  EXPECT_EQ(matchVertices(pointsOf({{0, 0, 0}, {0, 0, 0}}, {mostly_y, {0, 0, 1}}), before), (std::vector<uint32_t>{1, 2}));
  EXPECT_LT(matchVertices(pointsOf({{0, 0, 0}}), before)[0], 3U) << "without normals any of them will do";
}

TEST(MatchVertices, NothingNear) {
  EXPECT_EQ(matchVertices(pointsOf({{1e30F, 0, 0}, {NAN, 0, 0}, {INFINITY, 0, 0}, {-40, 0, 0}}), pointsOf(kFar)),
            std::vector<uint32_t>(4, kUnmatched));
  EXPECT_EQ(matchVertices(pointsOf({{0, 0, 0}}), SurfaceMesh{}), std::vector<uint32_t>{kUnmatched});
  EXPECT_TRUE(matchVertices(SurfaceMesh{}, pointsOf(kFar)).empty());
}

// Without an extent only the same place is the same.
TEST(MatchVertices, ASinglePoint) {
  EXPECT_EQ(matchVertices(pointsOf({{1, 2, 3}, {1, 2, 3.001F}}), pointsOf({{1, 2, 3}})), (std::vector<uint32_t>{0, kUnmatched}));
}

// --- checkAgainst ---

CheckReport compare(const std::string& glb, const std::string& before, const ErrorBounds& bounds = {}) {
  const TestFolder folder;
  JudgeSettings settings;
  settings.against = folder.write("before.glb", before);
  settings.bounds = bounds;
  return checkAgainst(folder.write("after.glb", glb), settings);
}
CheckReport compare(const TestAsset& asset, const ErrorBounds& bounds = {}) { return compare(glbOf(asset), glbOf(ballAsset()), bounds); }

// The same mesh with its vertices in the opposite order.
TestAsset reordered(TestAsset asset) {
  const auto last = uint32_t(asset.lobes.size()) - 1;
  std::reverse(asset.lobes.begin(), asset.lobes.end());
  std::reverse(asset.mesh.positions.begin(), asset.mesh.positions.end());
  std::reverse(asset.mesh.normals.begin(), asset.mesh.normals.end());
  for (Triangle& t : asset.mesh.triangles)
    for (uint32_t& v : t) v = last - v;
  return asset;
}

TEST(CheckAgainst, TheSameInAnotherOrderIsSound) {
  const CheckReport report = compare(reordered(ballAsset()));
  EXPECT_EQ(causeOf(report), "sound") << whatOf(report);
  ASSERT_TRUE(report.comparison);
  EXPECT_EQ(report.comparison->matched, 162U);
  EXPECT_EQ(report.comparison->added, 0U);
  EXPECT_EQ(report.comparison->lost, 0U);
  EXPECT_LT(report.comparison->difference.lobe.angle_max_degrees, 1e-3);
  EXPECT_LT(report.comparison->difference.transmittance.rms, 1e-6);
  EXPECT_LT(report.comparison->density_max, 1e-6);
  EXPECT_EQ(report.run.command, "check");
  EXPECT_EQ(report.run.vertices, 162U);
  EXPECT_EQ(report.run.triangles, 320U);
}

TEST(CheckAgainst, DefaultBounds) {
  EXPECT_EQ(causeOf(compare(tilted(0.08))), "sound");
  const CheckReport report = compare(tilted(0.12));
  EXPECT_EQ(causeOf(report), "changed");
  EXPECT_TRUE(contains(whatOf(report), "direction differs from before by 0.12° rms, over 0.1°")) << whatOf(report);
  ASSERT_EQ(report.bounds.size(), 2U);
  EXPECT_STREQ(report.bounds[0].field->key, "direction_rms_degrees");
  EXPECT_EQ(report.bounds[0].most, 0.1);
  EXPECT_STREQ(report.bounds[1].field->key, "density_rms");
  EXPECT_EQ(report.bounds[1].most, 0.001);
}

TEST(CheckAgainst, GivenBoundsReplaceThem) {
  ErrorBounds loose;
  loose.angle_degrees = 3;
  const CheckReport report = compare(tilted(2), loose);
  EXPECT_EQ(causeOf(report), "sound") << whatOf(report);
  EXPECT_EQ(report.bounds.size(), 1U);
  EXPECT_NEAR(report.comparison->difference.lobe.angle_rms_degrees, 2, 1e-3);
  ErrorBounds tight;
  tight.transmittance_rms = 1e-9;
  EXPECT_TRUE(contains(whatOf(compare(tilted(2), tight)), "transmittance differs from before by")) << whatOf(compare(tilted(2), tight));
}

TEST(CheckAgainst, LargestDifferenceOfThickness) {
  const CheckReport report = compare(changedBall([](Lobe lobe, size_t v) { return Lobe{lobe.direction, v == 7 ? 2.5F : lobe.thickness}; }));
  EXPECT_NEAR(report.comparison->density_max, 0.25, 1e-5);
  const CheckReport less = compare(changedBall([](Lobe lobe, size_t v) { return Lobe{lobe.direction, v == 7 ? 1.5F : lobe.thickness}; }));
  EXPECT_NEAR(less.comparison->density_max, 0.25, 1e-5);
  EXPECT_EQ(causeOf(report), "changed");
  EXPECT_TRUE(contains(whatOf(report), "density differs from before")) << whatOf(report);
}

TEST(CheckAgainst, NamesTheCause) {
  const auto mirrored = changedBall([](Lobe lobe, size_t) {
    return Lobe{{lobe.direction.x, -lobe.direction.y, lobe.direction.z}, lobe.thickness};
  });
  const CheckReport report = compare(reordered(mirrored));
  EXPECT_EQ(causeOf(report), "handedness");
  EXPECT_TRUE(contains(whatOf(report), "differs from before by")) << whatOf(report);
  EXPECT_TRUE(contains(whatOf(report), "; likely cause: ")) << whatOf(report);
  EXPECT_EQ(causeOf(compare(changedBall([](Lobe lobe, size_t) { return Lobe{lobe.direction, 10 * lobe.thickness}; }))), "units");
  EXPECT_EQ(causeOf(compare(withSwappedSets(glbOf(ballAsset())), glbOf(ballAsset()))), "sets-swapped");
}

TEST(CheckAgainst, VerticesThatCameAndWent) {
  // Another object, away from the ball, so that it has no vertex in common.
  const TestAsset ball = ballAsset(), other = ballAsset(0.5F, 0, {5, 0, 0});
  const CheckReport more = compare(glbOf({ball, other}), glbOf(ball));
  EXPECT_EQ(causeOf(more), "new-vertices");
  EXPECT_EQ(more.comparison->matched, 162U);
  EXPECT_EQ(more.comparison->added, 12U);
  EXPECT_EQ(more.comparison->lost, 0U);
  EXPECT_TRUE(contains(whatOf(more), "12 vertices")) << whatOf(more);
  const CheckReport fewer = compare(glbOf(ball), glbOf({ball, other}));
  EXPECT_EQ(causeOf(fewer), "sound") << "an optimiser may drop vertices";
  EXPECT_EQ(fewer.comparison->added, 0U);
  EXPECT_EQ(fewer.comparison->lost, 12U);
}

TEST(CheckAgainst, AMeshThatWasMoved) {
  const CheckReport report = compare(ballAsset(1, 2, {9, 0, 0}));
  EXPECT_EQ(causeOf(report), "moved-mesh");
  EXPECT_EQ(report.comparison->matched, 0U);
  EXPECT_EQ(report.comparison->added, 162U);
  EXPECT_EQ(report.comparison->lost, 162U);
}

TEST(CheckAgainst, SetsThatAreGoneOrElsewhere) {
  const std::string ball = glbOf(ballAsset());
  const CheckReport stripped = compare(withoutSets(ball), ball);
  EXPECT_EQ(causeOf(stripped), "stripped");
  EXPECT_EQ(stripped.comparison->sets, "none");
  EXPECT_EQ(stripped.comparison->sets_before, "TEXCOORD_0 to TEXCOORD_1");
  const CheckReport moved = compare(replaced(replaced(ball, "TEXCOORD_1", "TEXCOORD_2"), "TEXCOORD_0", "TEXCOORD_1"), ball);
  EXPECT_EQ(causeOf(moved), "moved");
  expectError<InputError>([&] { compare(ball, withoutSets(ball)); }, "nothing to compare with");
}

TEST(CheckAgainst, TellsTheMaterials) {
  std::vector<SculptMaterial> materials(2);
  materials[0].name = "snow";
  const CheckReport report = compare(glbOf({ballAsset()}, materials), glbOf(ballAsset()));
  EXPECT_EQ(report.comparison->materials.substr(0, 4), "snow") << report.comparison->materials;
  EXPECT_FALSE(contains(report.comparison->materials_before, "snow"));
}

// The metadata of the asset counts; without it, that of the asset before.
TEST(CheckAgainst, MetadataOfEither) {
  TestAsset asset = ballAsset();
  asset.info.extinction = 9;
  const std::string glb = glbOf(asset), before = glbOf(ballAsset());
  EXPECT_EQ(compare(glb, before).run.info.extinction, 9);
  EXPECT_EQ(compare(replaced(before, "\"cloudbake\":", "\"cloudfake\":"), glb).run.info.extinction, 9);
}

TEST(CheckAgainst, OtherConstants) {
  const auto with = [](const auto& change) {
    TestAsset asset = ballAsset();
    change(asset.info);
    return compare(asset);
  };
  EXPECT_EQ(causeOf(with([](AssetInfo&) {})), "sound");
  EXPECT_EQ(causeOf(with([](AssetInfo& info) { info.seed = 9, info.input_hash = "other"; })), "sound") << "no engine reads these";
  const CheckReport bias = with([](AssetInfo& info) { info.shape.bias = 1; });
  EXPECT_EQ(causeOf(bias), "constants");
  EXPECT_TRUE(contains(whatOf(bias), "other constants than before: bias 1 instead of -0.006")) << whatOf(bias);
  EXPECT_EQ(causeOf(with([](AssetInfo& info) { info.shape.exponent = 8; })), "constants");
  EXPECT_EQ(causeOf(with([](AssetInfo& info) { info.extinction *= 1.01F; })), "constants");
  EXPECT_EQ(causeOf(with([](AssetInfo& info) { info.extinction_low = 1, info.extinction_high = 9; })), "constants");
  EXPECT_EQ(causeOf(with([](AssetInfo& info) { info.lobe = "fit"; })), "constants");
  EXPECT_EQ(causeOf(with([](AssetInfo& info) { info.volume.emplace(); })), "constants");
}

TEST(CheckAgainst, OtherHarmonics) {
  const auto baked = [](const char* basis, const char* rays) {
    return bake(boxMesh({0, 0, 0}, {2, 1, 1}), {{"basis", basis}, {"rays", rays}, {"voxels", "20"}}).glb;
  };
  const std::string before = baked("sh1", "64");
  EXPECT_EQ(causeOf(compare(before, before)), "sound");
  EXPECT_EQ(*compare(before, before).comparison->harmonics_rms, 0);
  const CheckReport none = compare(bake(boxMesh({0, 0, 0}, {2, 1, 1}), {{"rays", "64"}, {"voxels", "20"}}).glb, before);
  EXPECT_EQ(causeOf(none), "constants") << "harmonic_order differs";
  std::string damaged = before;
  Warnings told;
  const float coefficient = decodeGlb("a.glb", before, told).harmonics[0];
  const std::string bytes(reinterpret_cast<const char*>(&coefficient), sizeof coefficient);
  const float other = 0.5F * coefficient;
  damaged.replace(damaged.rfind(bytes), sizeof other, reinterpret_cast<const char*>(&other), sizeof other);
  const CheckReport changed = compare(damaged, before);
  EXPECT_EQ(causeOf(changed), "harmonics") << whatOf(changed);
  EXPECT_TRUE(contains(whatOf(changed), "T by the spherical harmonics differs from before by")) << whatOf(changed);
}

}  // namespace
}  // namespace cloudbake
