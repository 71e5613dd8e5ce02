// Which field is built of which cloud, and the lattice that it gets; what is looked up in it is held to closed forms.
#include "pipeline/fields/fields.h"

#include <algorithm>
#include <cmath>

#include "bake/field/level_set.h"
#include "bake/lobe/directions.h"
#include "bake/lobe/sweep.h"
#include "bake/mesh/repair.h"
#include "core/ray_scene.h"
#include "io/file/write_file.h"
#include "io/volume/vdb.h"
#include "tests/pipeline/pipeline_helpers.h"
#include "tests/pipeline/shape_clouds.h"
#include "tests/shapes.h"

namespace cloudbake {
namespace {

constexpr double kBallVolume = 4 * kPi / 3;

// A ball with a hole where the triangles around its first vertex were, and what closes it, if that is wanted.
Cloud openBall(bool filled) {
  SurfaceMesh mesh = ballMesh(1, 3);
  std::erase_if(mesh.triangles, [](const Triangle& t) { return std::count(t.begin(), t.end(), 0U) > 0; });
  Cloud cloud = cloudOf(mesh);
  uint64_t holes = 0;
  if (filled) cloud.filled = closedByFilling(mesh, holes);
  return cloud;
}

Cloud spheresCloud() {
  Cloud cloud;
  cloud.spheres = {{{0, 0, 0}, 1}, {{1.5F, 0, 0}, 1}};
  cloud.exact_spheres = true;
  cloud.surface = ballMesh(1, 2);
  return cloud;
}

FieldSettings fieldSettings(const std::vector<std::string>& texts, SourceKind kind = SourceKind::kSculpt) {
  return settingsFor(texts, kind).field;
}

struct Built {
  IntegrationField field;
  Warnings warnings;
};
Built build(const Cloud& cloud, const FieldSettings& settings, Method method) {
  Built built;
  built.field = buildField(cloud, settings, method, built.warnings);
  return built;
}

double volumeOf(const CoverageField& field) {
  double sum = 0;
  for (const float fraction : field.fractions) sum += fraction;
  return sum * std::pow(field.frame.voxel_size, 3);
}

bool warns(const Warnings& warnings, WarningKind kind) { return warnings.entries().contains(kind); }

// --- Which field ---

TEST(Fields, ASweepOfAClosedMeshAddsUpItsCoverage) {
  const Built built = build(ball(), fieldSettings({"voxels=30"}), Method::kSweep);
  EXPECT_EQ(built.field.kind, "coverage");
  ASSERT_TRUE(built.field.coverage);
  EXPECT_FALSE(built.field.dense);
  EXPECT_NEAR(volumeOf(*built.field.coverage), signedVolume(ball().surface), 0.01 * kBallVolume);
  EXPECT_TRUE(built.warnings.empty());
}

TEST(Fields, ALevelSetIsSweptWhereItIsAskedFor) {
  const Built built = build(ball(), fieldSettings({"voxels=30", "field=levelset"}), Method::kSweep);
  EXPECT_EQ(built.field.kind, "level set");
  ASSERT_TRUE(built.field.coverage);
  EXPECT_NEAR(volumeOf(*built.field.coverage), kBallVolume, 0.03 * kBallVolume);
}

TEST(Fields, RaysMarchTheLevelSet) {
  const Built built = build(ball(), fieldSettings({"voxels=30", "method=rays"}), Method::kRays);
  EXPECT_EQ(built.field.kind, "level set");
  EXPECT_TRUE(built.field.dense && !built.field.coverage);
}

TEST(Fields, AnOpenMeshIsBoundedByWhatClosesIt) {
  const Cloud open = openBall(true);
  ASSERT_TRUE(!open.closed && open.filled);
  const Built swept = build(open, fieldSettings({"voxels=30", "field=coverage"}), Method::kSweep);
  EXPECT_EQ(swept.field.kind, "coverage");
  EXPECT_NEAR(volumeOf(*swept.field.coverage), kBallVolume, 0.03 * kBallVolume);
  EXPECT_FALSE(warns(swept.warnings, WarningKind::kFieldFallback));
}

// Without one there is no coverage: the level set takes its place, which is told where coverage was asked for.
TEST(Fields, WithoutASolidTheLevelSetIsTaken) {
  const Cloud open = openBall(false);
  const Built asked = build(open, fieldSettings({"voxels=30", "field=coverage"}), Method::kSweep),
              left = build(open, fieldSettings({"voxels=30"}), Method::kSweep);
  for (const Built* built : {&asked, &left}) {
    EXPECT_EQ(built->field.kind, "level set");
    EXPECT_NEAR(volumeOf(*built->field.coverage), kBallVolume, 0.05 * kBallVolume);
  }
  EXPECT_TRUE(warns(asked.warnings, WarningKind::kFieldFallback));
  EXPECT_FALSE(warns(left.warnings, WarningKind::kFieldFallback));
}

// Half of a ball is too open for a flood from outside: a wrap gives it a volume, and says how wide a hole it closed.
TEST(Fields, WhatAFloodWouldEnterIsWrapped) {
  SurfaceMesh half = ballMesh(1, 3);
  std::erase_if(half.triangles,
                [&](const Triangle& t) { return half.positions[t[0]].y + half.positions[t[1]].y + half.positions[t[2]].y > 0; });
  const Built built = build(cloudOf(half), fieldSettings({"voxels=30"}), Method::kSweep);
  EXPECT_EQ(built.field.kind, "level set");
  ASSERT_TRUE(warns(built.warnings, WarningKind::kVolumeMismatch));
  EXPECT_TRUE(contains(built.warnings.entries().at(WarningKind::kVolumeMismatch).first, "closed by a wrap, across holes of up to "));
  EXPECT_GT(volumeOf(*built.field.coverage), 0.3 * kBallVolume);
}

// --close wrap: always the wrap, also of a closed mesh. It stands off the surface, so that its volume is the larger one.
TEST(Fields, AWrapIsTakenWhereItIsAskedFor) {
  Cloud wrapped = ball();
  wrapped.wrapped = true;
  const Built swept = build(wrapped, fieldSettings({"voxels=30"}), Method::kSweep),
              plain = build(ball(), fieldSettings({"voxels=30"}), Method::kSweep);
  EXPECT_EQ(swept.field.kind, "coverage");
  EXPECT_GT(volumeOf(*swept.field.coverage), 1.002 * volumeOf(*plain.field.coverage));
  EXPECT_LT(volumeOf(*swept.field.coverage), 1.3 * kBallVolume);
  Warnings warnings;
  EXPECT_GT(insideVolume(levelSetOf(wrapped, fieldSettings({"voxels=30"}), Lattice::kSurface, warnings)),
            1.002 * insideVolume(levelSetOf(ball(), fieldSettings({"voxels=30"}), Lattice::kSurface, warnings)));
}

TEST(Fields, SpheresAreALevelSetOfTheirOwn) {
  // Two balls of radius 1, 1.5 apart: the union is two balls less a lens of two caps of height 1/4.
  const double cap = kPi * 0.0625 * (3 - 0.25) / 3, exact = 2 * kBallVolume - 2 * cap;
  const Cloud cloud = spheresCloud();
  Warnings warnings;
  const LevelSet level_set = levelSetOf(cloud, fieldSettings({"voxels=50"}, SourceKind::kSpheres), Lattice::kSurface, warnings);
  EXPECT_NEAR(insideVolume(level_set), exact, 0.02 * exact);
  EXPECT_NEAR(level_set.frame.voxel_size, 3.5 / 50, 1e-6);
  const LevelSet blended = levelSetOf(cloud, fieldSettings({"voxels=50", "blend=10%"}, SourceKind::kSpheres), Lattice::kSurface, warnings);
  EXPECT_GT(insideVolume(blended), insideVolume(level_set) + 0.01) << "the neck is filled";
  const LevelSet cut = levelSetOf(cloud, fieldSettings({"voxels=50", "flat-base=0"}, SourceKind::kSpheres), Lattice::kSurface, warnings);
  EXPECT_NEAR(insideVolume(cut), exact / 2, 0.03 * exact);
}

// --- Which lattice ---

TEST(Fields, VoxelsAreCountedAlongTheLongestSide) {
  const double longest = boundingBox(ball().surface).longestSide();
  for (const Method method : {Method::kSweep, Method::kRays}) {
    EXPECT_NEAR(build(ball(), fieldSettings({"voxels=25"}), method).field.voxelSize(), longest / 25, 1e-6);
    EXPECT_NEAR(build(ball(), fieldSettings({"voxels=25", "voxel-size=0.125"}), method).field.voxelSize(), 0.125, 1e-9);
    EXPECT_NEAR(build(ball(), fieldSettings({"voxels=25", "bake-voxels=20"}), method).field.voxelSize(), longest / 20, 1e-6);
    EXPECT_NEAR(build(ball(), fieldSettings({"voxel-size=0.125", "bake-voxels=20"}), method).field.voxelSize(), longest / 20, 1e-6)
        << "--bake-voxels is the field's own";
  }
  Warnings warnings;
  const FieldSettings both = fieldSettings({"voxels=25", "bake-voxels=20"});
  EXPECT_NEAR(levelSetOf(ball(), both, Lattice::kSurface, warnings).frame.voxel_size, longest / 25, 1e-6) << "the surface keeps its own";
  EXPECT_NEAR(levelSetOf(ball(), both, Lattice::kIntegration, warnings).frame.voxel_size, longest / 20, 1e-6);
}

// A level set that is there is used, unless the field is to have voxels of its own.
TEST(Fields, AVolumeKeepsItsVoxels) {
  Cloud volume = ball();
  Warnings warnings;
  volume.level_set = levelSetOf(ball(), fieldSettings({"voxel-size=0.11"}), Lattice::kSurface, warnings);
  volume.voxel_size = 0.11F;
  for (const Method method : {Method::kSweep, Method::kRays}) {
    EXPECT_NEAR(build(volume, fieldSettings({}), method).field.voxelSize(), 0.11, 1e-7);
    EXPECT_NEAR(build(volume, fieldSettings({"bake-voxels=20"}), method).field.voxelSize(), boundingBox(volume.surface).longestSide() / 20,
                1e-6);
  }
  EXPECT_EQ(levelSetOf(volume, fieldSettings({}), Lattice::kIntegration, warnings).grid, volume.level_set->grid);
  EXPECT_EQ(levelSetOf(volume, fieldSettings({"bake-voxels=20"}), Lattice::kSurface, warnings).grid, volume.level_set->grid);
}

// "5 x noise (3 octaves)", says the table.
TEST(Fields, TheSpacingOfNoiseUnlessGiven) {
  const Cloud cloud = spheresCloud();
  Warnings warnings;
  const auto bytes = [&](const std::vector<std::string>& texts) {
    return hashBytes(encodeVdb(levelSetOf(cloud, fieldSettings(texts, SourceKind::kSpheres), Lattice::kSurface, warnings)));
  };
  EXPECT_STREQ(findOption("noise-size", kGrow)->fallback, "5 x noise (3 octaves)");
  const double five = 1.5 * billowSlope(3);
  EXPECT_NEAR(five, 5, 0.5);
  const auto three = [&](const std::string& more) {
    return bytes(more.empty() ? std::vector<std::string>{"voxels=24", "noise=0.1", "noise-octaves=3"}
                              : std::vector<std::string>{"voxels=24", "noise=0.1", "noise-octaves=3", more});
  };
  const std::string unset = three("");
  EXPECT_EQ(unset, three("noise-size=" + shortestText(1.5F * (0.1F * float(billowSlope(3))))));
  EXPECT_NE(unset, three("noise-size=0.8"));
  EXPECT_NE(unset, three("seed=2"));
  EXPECT_NE(unset, bytes({"voxels=24", "noise=0.1", "noise-octaves=2"}));
  EXPECT_EQ(bytes({"voxels=24"}), bytes({"voxels=24", "noise=0"})) << "no noise is what is not asked for";
  // Shares are of the longest side, 3.5.
  EXPECT_EQ(bytes({"voxels=24", "noise=12.5%", "noise-size=75%"}), bytes({"voxels=24", "noise=0.4375", "noise-size=2.625"}));
}

// Without a number of octaves there are as many, up to 3, as the voxels can show, and so no warning.
TEST(Fields, TheOctavesOfNoiseUnlessGiven) {
  const Cloud cloud = spheresCloud();
  const auto octavesOf = [&](const std::string& voxels, const std::string& noise) {
    Warnings warnings, none;
    const auto bytes = [&](const std::vector<std::string>& texts, Warnings& told) {
      return hashBytes(encodeVdb(levelSetOf(cloud, fieldSettings(texts, SourceKind::kSpheres), Lattice::kSurface, told)));
    };
    const std::string unset = bytes({voxels, noise}, none);
    EXPECT_TRUE(none.empty()) << voxels << " " << noise;
    for (int octaves = 1; octaves <= 3; ++octaves)
      if (unset == bytes({voxels, noise, "noise-octaves=" + std::to_string(octaves)}, warnings)) return octaves;
    return 0;
  };
  EXPECT_EQ(octavesOf("voxels=48", "noise=6%"), 3);  // 3.7 voxels wide
  EXPECT_EQ(octavesOf("voxels=48", "noise=2.5%"), 2);
  EXPECT_EQ(octavesOf("voxels=48", "noise=1.5%"), 1);
}

// Without a softness the base is as soft as the blend, and without a size its bumps are five times as wide as high.
TEST(Fields, BasesOfGrownClouds) {
  Cloud cloud;
  cloud.spheres = {{{0, 0, 0}, 1}, {{1.5F, 0, 0}, 1}};
  Warnings warnings;
  const auto bytes = [&](std::vector<std::string> texts) {
    for (const char* text : {"voxels=24", "flat-base=-0.3", "blend=0.1"}) texts.push_back(text);
    return hashBytes(encodeVdb(levelSetOf(cloud, fieldSettings(texts, SourceKind::kSpheres), Lattice::kSurface, warnings)));
  };
  const std::string plain = bytes({}), bumpy = bytes({"base-bumps=0.1"});
  EXPECT_EQ(plain, bytes({"base-softness=0.1"}));
  EXPECT_NE(plain, bytes({"base-softness=0.5"}));
  EXPECT_EQ(plain, bytes({"base-bumps=0"}));
  EXPECT_NE(plain, bumpy);
  EXPECT_STREQ(findOption("base-bump-size", kGrow)->fallback, "5 x base-bumps");
  EXPECT_EQ(bumpy, bytes({"base-bumps=0.1", "base-bump-size=0.5"}));
  EXPECT_NE(bumpy, bytes({"base-bumps=0.1", "base-bump-size=0.7"}));
  EXPECT_NE(bumpy, bytes({"base-bumps=0.1", "seed=2"}));
}

// --- What is looked up ---

TEST(Fields, BothSensesOfEveryAxisInTurn) {
  const std::vector<Vec3> axes{{1, 0, 0}, {0, 0.6F, 0.8F}};
  EXPECT_EQ(bothSenses(axes), (std::vector<Vec3>{{1, 0, 0}, {-1, 0, 0}, {0, 0.6F, 0.8F}, {0, -0.6F, -0.8F}}));
  EXPECT_TRUE(bothSenses({}).empty());
}

// From a point p of the unit sphere along ω the chord is −2 p·ω, and nothing on the outer side.
TEST(Fields, LengthsAreChordsOfTheBall) {
  const std::vector<Vec3> axes = sweepAxes(20), directions = bothSenses(axes);
  const std::vector<size_t> chosen = evenlySpread(ball().surface.positions.size(), 30);
  const std::vector<Vec3> points = pick(ball().surface.positions, chosen);
  for (const Method method : {Method::kSweep, Method::kRays}) {
    BakeSettings bake;
    bake.method = method;
    bake.ray_length = 3.5F;
    const Built built = build(ball(), fieldSettings({"voxels=50"}), method);
    const std::vector<float> lengths = estimatedLengths(points, axes, built.field, bake);
    ASSERT_EQ(lengths.size(), points.size() * directions.size());
    double squares = 0;
    for (size_t v = 0; v < points.size(); ++v)
      for (size_t i = 0; i < directions.size(); ++i)
        squares += std::pow(lengths[v * directions.size() + i] - std::max(0.0F, -2 * dot(points[v], directions[i])), 2);
    EXPECT_LT(std::sqrt(squares / double(lengths.size())), 0.05) << built.field.kind;
    // A ray that ends after 0.5 sees no more.
    bake.ray_length = 0.5F;
    const std::vector<float> cut = estimatedLengths(points, axes, built.field, bake);
    EXPECT_LT(*std::max_element(cut.begin(), cut.end()), 0.5 + built.field.voxelSize());
  }
}

TEST(Fields, MeanLobesOfEitherMethodAreTheBalls) {
  for (const Method method : {Method::kSweep, Method::kRays}) {
    BakeSettings bake = settingsFor({method == Method::kSweep ? "method=sweep" : "method=rays"}).lobe.bake;
    bake.ray_length = 3.5F;
    const Built built = build(ball(), fieldSettings({"voxels=50"}), method);
    Warnings warnings;
    const std::vector<Lobe> lobes = meanLobes({ball().surface.positions, ball().surface.normals}, built.field, bake, warnings);
    ASSERT_EQ(lobes.size(), ball().surface.positions.size());
    double angle = 0, thickness = 0;
    for (size_t v = 0; v < lobes.size(); ++v) {
      angle += angleDegrees(lobes[v].direction, -ball().surface.positions[v]) / double(lobes.size());
      thickness += lobes[v].thickness / double(lobes.size());
    }
    EXPECT_LT(angle, 5);
    EXPECT_NEAR(thickness, 2, 0.05);
  }
}

// --- The truth ---

TEST(Fields, TheTruthOfEachKindOfCloud) {
  const FieldSettings settings = fieldSettings({"voxels=30"});
  const Ray through{{-3, 0, 0}, {1, 0, 0}};
  const auto closed = referenceFor(ball(), settings), filled = referenceFor(openBall(true), settings),
             spheres = referenceFor(spheresCloud(), settings), marched = referenceFor(openBall(false), settings);
  EXPECT_TRUE(contains(closed->name(), RayScene::kName));
  EXPECT_EQ(closed->name(), filled->name());
  EXPECT_TRUE(contains(spheres->name(), "sphere"));
  EXPECT_TRUE(contains(marched->name(), "march"));
  EXPECT_NEAR(spheres->insideLength(through, 10), 3.5, 1e-6);
  EXPECT_NEAR(closed->insideLength(through, 10), 2, 0.02);
  EXPECT_NEAR(filled->insideLength(through, 10), 2, 0.05);
  EXPECT_NEAR(marched->insideLength(through, 10), 2, 0.1);
  for (const Cloud& cloud : {ball(), openBall(true), spheresCloud()}) EXPECT_FALSE(truthIsMarched(cloud));
  EXPECT_TRUE(truthIsMarched(openBall(false)));
}

// A blended cloud is not its spheres: its own surface is what its truth is of.
TEST(Fields, SpheresAreTheTruthOnlyWhereTheyAreTheShape) {
  Cloud blended = spheresCloud();
  blended.exact_spheres = false;
  EXPECT_TRUE(contains(referenceFor(blended, fieldSettings({}))->name(), RayScene::kName));
}

TEST(Fields, EvenlySpreadIndices) {
  EXPECT_EQ(evenlySpread(10, 5), (std::vector<size_t>{0, 2, 4, 6, 8}));
  EXPECT_EQ(evenlySpread(3, 5), (std::vector<size_t>{0, 1, 2}));
  EXPECT_TRUE(evenlySpread(0, 5).empty());
  EXPECT_TRUE(evenlySpread(5, 0).empty());
  for (size_t count = 1; count < 60; ++count)
    for (size_t wanted = 1; wanted < 60; ++wanted) {
      const std::vector<size_t> indices = evenlySpread(count, wanted);
      ASSERT_EQ(indices.size(), std::min(count, wanted));
      size_t least = count, most = 0;
      for (size_t i = 0; i + 1 < indices.size(); ++i) {
        least = std::min(least, indices[i + 1] - indices[i]);
        most = std::max(most, indices[i + 1] - indices[i]);
      }
      ASSERT_LT(indices.back(), count);
      ASSERT_TRUE(indices.size() < 2 || most <= least + 1) << count << " " << wanted;
    }
}

TEST(Fields, PickTakesThoseIndices) {
  const std::vector<size_t> indices{2, 0};
  EXPECT_EQ(pick(std::vector<int>{5, 6, 7}, indices), (std::vector<int>{7, 5}));
  EXPECT_TRUE(pick(std::vector<int>{}, indices).empty()) << "normals may be missing";
}

}  // namespace
}  // namespace cloudbake
