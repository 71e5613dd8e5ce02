#include "bake/level_set.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Interpolation.h>

#include "core/error.h"
#include "core/level_set_type.h"
#include "tests/shapes.h"

using namespace cloudbake;

namespace {

float phiAt(const LevelSet& level_set, Vec3 world) {
  const Vec3 p = level_set.frame.toIndex(world);
  return float(openvdb::tools::BoxSampler::sample(level_set.grid->vdb->tree(), openvdb::Vec3d(p.x, p.y, p.z)) * level_set.frame.voxel_size);
}

LevelSet ofSpheres(std::vector<Sphere> spheres, LevelSetSettings settings = {}) {
  Warnings warnings;
  return levelSetFromSpheres(spheres, settings, warnings);
}

const double kUnitBallVolume = 4 * kPi / 3;

}  // namespace

// φ of one sphere is |x| − R inside the band, clipped beyond it.
TEST(LevelSet, BallIsADistance) {
  const LevelSet ball = ofSpheres({{{0, 0, 0}, 1}});
  const float h = float(ball.frame.voxel_size);
  EXPECT_FLOAT_EQ(h, 0.02F);
  for (const Vec3 direction : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0.6F, 0, 0.8F}})
    for (const float offset : {-2.5F, -1.0F, 0.0F, 1.0F, 2.5F})
      EXPECT_NEAR(phiAt(ball, direction * (1 + offset * h)), offset * h, 0.02 * h);
  EXPECT_FLOAT_EQ(phiAt(ball, {0, 0, 0}), -3 * h);
  EXPECT_FLOAT_EQ(phiAt(ball, {2, 0, 0}), 3 * h);
  EXPECT_NEAR(insideVolume(ball), kUnitBallVolume, 0.01);
}

// With a blend the union is raised by blend/4 where two surfaces are equally far, and the exact union elsewhere.
TEST(LevelSet, BlendRaisesTheCreaseByAQuarter) {
  const std::vector<Sphere> two{{{-0.8F, 0, 0}, 1}, {{0.8F, 0, 0}, 1}};
  LevelSetSettings settings;
  settings.voxels = 200;
  const float crease = 0.6F;  // √(1 − 0.8²)
  EXPECT_NEAR(phiAt(ofSpheres(two, settings), {0, crease, 0}), 0, 0.01);
  settings.blend = 0.08F;
  const LevelSet blended = ofSpheres(two, settings);
  EXPECT_NEAR(phiAt(blended, {0, crease, 0}), -0.02, 0.002);
  EXPECT_NEAR(phiAt(blended, {-1.8F, 0, 0}), 0, 0.001);
}

// The order of the spheres and a second copy of all of them in place change little or nothing.
TEST(LevelSet, OrderOfSpheresDoesNotMatter) {
  const std::vector<Sphere> one_way{{{-0.5F, 0, 0}, 1}, {{0.7F, 0.2F, 0}, 0.8F}, {{0, 0.9F, 0.3F}, 0.6F}};
  const std::vector<Sphere> other_way(one_way.rbegin(), one_way.rend());
  LevelSetSettings settings;
  settings.blend = 0.1F;
  const LevelSet a = ofSpheres(one_way, settings), b = ofSpheres(other_way, settings);
  EXPECT_NEAR(insideVolume(a), insideVolume(b), 1e-5);
}

// Coincident spheres count once without a blend: the union of a set with itself.
TEST(LevelSet, CoincidentSpheresAreOne) {
  EXPECT_DOUBLE_EQ(insideVolume(ofSpheres({{{0, 0, 0}, 1}, {{0, 0, 0}, 1}})), insideVolume(ofSpheres({{{0, 0, 0}, 1}})));
}

// A half ball: 2π/3. The plane is at y = 0 and nothing lies under it.
TEST(LevelSet, FlatBaseCutsTheCloud) {
  LevelSetSettings settings;
  settings.flat_base = 0.0F;
  const LevelSet half_ball = ofSpheres({{{0, 0, 0}, 1}}, settings);
  EXPECT_NEAR(insideVolume(half_ball), kUnitBallVolume / 2, 0.02);
  EXPECT_GT(phiAt(half_ball, {0, -0.1F, 0}), 0);
  EXPECT_LT(phiAt(half_ball, {0, 0.1F, 0}), 0);
  settings.flat_base = 2.0F;
  EXPECT_THROW(ofSpheres({{{0, 0, 0}, 1}}, settings), InputError);
}

// Spheres under 1.5 voxels are counted and still there: none is lost in silence.
TEST(LevelSet, SmallSpheresAreReported) {
  Warnings warnings;
  const std::vector<Sphere> spheres{{{0, 0, 0}, 1}, {{1.2F, 0, 0}, 0.02F}, {{-1.2F, 0, 0}, 0.5F}};
  const LevelSet level_set = levelSetFromSpheres(spheres, {}, warnings);
  ASSERT_TRUE(warnings.entries().contains(WarningKind::kSphereTooSmall));
  EXPECT_EQ(warnings.entries().at(WarningKind::kSphereTooSmall).count, 1U);
  EXPECT_LT(phiAt(level_set, {1.2F, 0, 0}), 0.01F);
}

// Scales by powers of two: the same index coordinates, so the same bits.
TEST(LevelSet, PowersOfTwoScaleExactly) {
  const std::vector<Sphere> small{{{0.1F, 0.2F, 0}, 0.7F}, {{-0.4F, 0, 0.3F}, 0.5F}};
  std::vector<Sphere> large = small;
  for (Sphere& s : large) s.center = s.center * 1024, s.radius *= 1024;
  const LevelSet a = ofSpheres(small), b = ofSpheres(large);
  EXPECT_EQ(a.grid->vdb->activeVoxelCount(), b.grid->vdb->activeVoxelCount());
  for (auto value = a.grid->vdb->cbeginValueOn(); value; ++value) ASSERT_EQ(*value, b.grid->vdb->tree().getValue(value.getCoord()));
}

// OpenVDB's transforms throw under 1.4e-5; a frame at voxel size 1 does not.
TEST(LevelSet, WorksAtEverySizeAndPlace) {
  for (const float scale : {1e-6F, 1.0F, 1e6F}) {
    EXPECT_NEAR(insideVolume(ofSpheres({{{0, 0, 0}, scale}})) / std::pow(scale, 3), kUnitBallVolume, 0.01);
    Warnings warnings;
    EXPECT_NEAR(insideVolume(levelSetFromMesh(ballMesh(scale, 4), {}, warnings)) / std::pow(scale, 3), kUnitBallVolume, 0.03);
    EXPECT_TRUE(warnings.empty());
  }
  EXPECT_NEAR(insideVolume(ofSpheres({{{1000, -1000, 1000}, 1}})), kUnitBallVolume, 0.02);
}

// At 1e6 radii from the origin float32 steps are 6 % of a radius: said, not hidden.
TEST(LevelSet, FarAwayIsWarned) {
  Warnings near, far;
  const std::vector<Sphere> at_1000{{{1000, 0, 0}, 1}}, at_million{{{1e6F, 0, 0}, 1}};
  levelSetFromSpheres(at_1000, {}, near);
  levelSetFromSpheres(at_million, {}, far);
  EXPECT_FALSE(near.entries().contains(WarningKind::kCoarseCoordinates));
  EXPECT_TRUE(far.entries().contains(WarningKind::kCoarseCoordinates));
}

TEST(LevelSet, RefusesWhatCannotBe) {
  Warnings warnings;
  LevelSetSettings absurd;
  absurd.voxels = 1000000000;
  EXPECT_THROW(ofSpheres({{{0, 0, 0}, 1}}, absurd), InputError);
  EXPECT_THROW(levelSetFromMesh(ballMesh(1, 2), absurd, warnings), InputError);
  EXPECT_THROW(ofSpheres({}), InputError);
  EXPECT_THROW(ofSpheres({{{NAN, 0, 0}, 1}}), InputError);
  EXPECT_THROW(ofSpheres({{{0, 0, 0}, 0}}), InputError);
  EXPECT_THROW(levelSetFromMesh({}, {}, warnings), InputError);
  SurfaceMesh broken = ballMesh(1, 1);
  broken.positions[7].y = NAN;
  try {
    levelSetFromMesh(broken, {}, warnings);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("vertex 7"), std::string::npos);
  }
}

// A hollow ball: a reversed inner shell is a cavity, an unreversed one counts once. OpenVDB alone fills both.
TEST(LevelSet, CavityFollowsTheWindingNumber) {
  Warnings warnings;
  const SurfaceMesh outer = ballMesh(1, 5);
  SurfaceMesh inner = ballMesh(0.5F, 5);
  const LevelSet solid = levelSetFromMesh(merged(outer, inner), {}, warnings);
  EXPECT_NEAR(insideVolume(solid), kUnitBallVolume, 0.02);
  EXPECT_LT(phiAt(solid, {0, 0, 0}), 0);
  reverse(inner);
  const LevelSet hollow = levelSetFromMesh(merged(outer, inner), {}, warnings);
  EXPECT_NEAR(insideVolume(hollow), kUnitBallVolume * 7 / 8, 0.02);
  EXPECT_GT(phiAt(hollow, {0, 0, 0}), 0);
}

TEST(LevelSet, InvertedMeshIsTheSameSolid) {
  Warnings warnings;
  SurfaceMesh ball = ballMesh(1, 5);
  reverse(ball);
  EXPECT_NEAR(insideVolume(levelSetFromMesh(ball, {}, warnings)), kUnitBallVolume, 0.02);
  EXPECT_TRUE(warnings.entries().contains(WarningKind::kInvertedMesh));
}

// A sheet of a fifth of a voxel between two layers of the grid (the small box shifts the centre): lost, and said so.
TEST(LevelSet, ThinSheetIsReported) {
  Warnings warnings;
  levelSetFromMesh(merged(boxMesh({-1, -0.002F, -1}, {1, 0.002F, 1}), boxMesh({0, 1.002F, 0}, {0.02F, 1.022F, 0.02F})), {}, warnings);
  EXPECT_TRUE(warnings.entries().contains(WarningKind::kVolumeMismatch));
}

// A hole narrower than the band closes by itself; half a ball does not, and is refused by its volume.
TEST(LevelSet, OpenMeshIsJudgedByItsVolume) {
  Warnings warnings;
  SurfaceMesh pinhole = ballMesh(1, 5);
  pinhole.triangles.pop_back();
  EXPECT_NEAR(insideVolume(levelSetFromOpenMesh(pinhole, {}, warnings)), kUnitBallVolume, 0.03);
  SurfaceMesh half_ball = ballMesh(1, 5);
  std::erase_if(half_ball.triangles, [&](const Triangle& t) { return half_ball.positions[t[0]].y < 0; });
  EXPECT_THROW(levelSetFromOpenMesh(half_ball, {}, warnings), InputError);
}
